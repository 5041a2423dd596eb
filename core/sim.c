/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The life of a simulation: plan, walls, particles, forces at t = 0; small questions about it; its end.
 */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"
#include "core/neighbours.h"

static int create_scratch(struct calx_sim *s, struct calx_error *e)
{
    s->columns = calloc((size_t)s->threads, sizeof *s->columns);
    s->forces = calloc((size_t)s->threads, sizeof *s->forces);
    s->team = 1;
    s->share = calloc((size_t)s->threads + 1, sizeof *s->share);
    s->left = calloc((size_t)s->threads, sizeof *s->left);
    for (int t = 0; s->columns && s->forces && s->share && s->left && t < s->threads; t++)
        if (!(s->columns[t] = calx_memory_zeroed(2, sizeof **s->columns)))
            return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for threads");
    return s->columns && s->forces && s->share && s->left ? 0 : calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for threads");
}

static int create_classes(struct calx_sim *s, struct calx_error *e)
{
    s->classes = calloc(s->scene->probe_count + 1, sizeof *s->classes);
    for (size_t p = 0; s->classes && p < s->scene->probe_count; p++)
        if (calx_measure_has_classes(&s->scene->probes[p]) &&
            !(s->classes[p] = calx_memory_zeroed(s->n, 1)))
            return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for probes");
    return s->classes ? 0 : calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for probes");
}

static int first_forces(struct calx_sim *s, struct calx_error *e)
{
    CALX_TRY(calx_step_begin_stage(s, 0, e));
    s->stage_began = false;
    struct calx_pass pass = {.conduct = s->plan->conductance != NULL, .stage = -1};
    CALX_TRY(calx_step_forces(s, &pass, e));
    CALX_TRY(calx_pace_begin(s, e));
    s->wall_work = 0.5 * calx_ledger_wall_power(s) * s->dt; /* the force at t = 0 acts for half a step */
    CALX_TRY(calx_motion_start(s, e));
    calx_ledger_begin(s);
    calx_measure_begin_stage(s, 0);
    calx_guard_begin(s);
    calx_peak_start(s);
    return calx_guard_step(s, e);
}

static int create(struct calx_sim *s, struct calx_error *e)
{
    CALX_TRY(calx_plan_create(s, e));
    CALX_TRY(calx_walls_create(s, e));
    CALX_TRY(calx_particles_create(s, e));
    CALX_TRY(calx_slabs_create(s, e));
    CALX_TRY(calx_skin_choose(s, e));
    CALX_TRY(create_scratch(s, e));
    CALX_TRY(create_classes(s, e));
    CALX_TRY(calx_profile_create(s, e));
    CALX_TRY(calx_steady_create(s, e));
    s->engine = calx_engine_pick(NULL);
    return first_forces(s, e);
}

struct calx_sim *calx_sim_create(const struct calx_scene *scene, struct calx_registry *registry, int threads,
                                 struct calx_error *e)
{
    struct calx_sim *s = calloc(1, sizeof *s);
    if (!s) {
        calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory");
        return NULL;
    }
    s->scene = scene;
    s->registry = registry;
    s->threads = threads > 0 ? threads : omp_get_num_procs();
    if (create(s, e)) {
        calx_sim_free(s);
        return NULL;
    }
    return s;
}

static void free_threads(struct calx_sim *s)
{
    for (int t = 0; s->columns && t < s->threads; t++)
        free(s->columns[t]);
    for (int t = 0; s->forces && t < s->threads; t++)
        free(s->forces[t]);
    free(s->columns);
    free(s->forces);
    free(s->share);
    free(s->left);
    free(s->order);
    free(s->adders);
    free(s->waiting);
    free(s->passed);
}

void calx_sim_free(struct calx_sim *s)
{
    if (!s)
        return;
    calx_measure_clear(&s->measure);
    calx_plan_free(s);
    calx_store_free(s);
    calx_rows_free(&s->r);
    free_threads(s);
    for (size_t p = 0; s->classes && p < s->scene->probe_count; p++)
        free(s->classes[p]);
    void *all[] = {s->pairs.i, s->pairs.j, s->pairs.touching, s->pairs.history, s->pairs.apart_i, s->pairs.apart_j, s->blocks, s->groups,
                   s->collect_to, s->collect_from, s->tallies, s->posed, s->poses, s->stage_poses,
                   s->wall_angle, s->wall_shift, s->plates, s->wall_temperature, s->near_row, s->near_primitive,
                   s->wall_contacts, s->wall_contacts_next, s->wall_history, s->wall_history_next,
                   s->wall_force, s->block_wall_force, s->edge_i, s->edge_j, s->boundary_i, s->boundary_wall, s->boundary_at, s->edge_h,
                   s->boundary_h, s->boundary_t, s->carried, s->classes, s->saved, s->clocks,
                   s->profile_clocks, s->layer_sums, s->layers, s->steady_clocks, s->steady_numbers, s->slab_cell, s->slab_face, s->slab_temperature, s->slab_heat,
                   s->block_faces};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
    free(s);
}

bool calx_sim_done(const struct calx_sim *s)
{
    return s->done;
}

double calx_sim_time(const struct calx_sim *s)
{
    return s->time;
}

double calx_sim_end(const struct calx_sim *s)
{
    double end = s->stage_start;
    for (size_t k = (size_t)s->stage; k < s->scene->stage_count; k++)
        end += s->scene->stages[k].duration;
    return end;
}

int64_t calx_sim_step_count(const struct calx_sim *s)
{
    return s->step;
}

int64_t calx_sim_evaluation_count(const struct calx_sim *s)
{
    return s->evaluations;
}

size_t calx_sim_particle_count(const struct calx_sim *s)
{
    return s->n;
}

size_t calx_sim_contact_count(const struct calx_sim *s)
{
    int64_t count = 0;
    for (size_t b = 0; b < s->block_count; b++)
        count += s->tallies[b].contacts + s->tallies[b].wall_contacts;
    return (size_t)count;
}

double calx_sim_dt(const struct calx_sim *s)
{
    return s->dt;
}

int calx_sim_stage(const struct calx_sim *s)
{
    return s->stage;
}

bool calx_sim_stage_began(const struct calx_sim *s)
{
    return s->stage_began;
}

const struct calx_scene *calx_sim_scene(const struct calx_sim *s)
{
    return s->scene;
}

struct calx_measure_cache *calx_sim_measure_cache(struct calx_sim *s)
{
    return &s->measure;
}

uint8_t *calx_sim_probe_classes(struct calx_sim *s, size_t probe)
{
    return s->classes[probe];
}

static size_t network_bytes(const struct calx_sim *s)
{
    return s->edge_capacity * 16 + s->boundary_capacity * 48;
}

struct calx_features calx_sim_features(const struct calx_sim *s)
{
    struct calx_features f = s->features;
    struct calx_row_view views[32];
    struct calx_rows_arrays rows = s->r;
    size_t count = calx_rows_arrays_list(s, &rows, views), per_row = 0;
    for (size_t k = 0; k < count; k++)
        per_row += views[k].bytes;
    f.bytes = s->r.rows * per_row + s->pairs.places * (8 + 8 * s->plan->history) + s->pairs.places / 8 + s->pairs.apart * 8 +
              s->near_count * (24 + 16 * s->plan->history) + (s->r.rows - s->n) * 8 +
              s->primitive_count * sizeof(struct calx_posed) + network_bytes(s) +
              s->block_count * (sizeof(struct calx_row_block) + sizeof(struct calx_tally));
    return f;
}

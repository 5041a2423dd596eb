/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The whole state as named blocks of bytes: one table says which arrays there are, how long they are and where their pointers stand; saving and
 * restoring walk the same table, so nothing can be in one and not in the other. Layout and lists are saved as they
 * are: a resumed run goes on with the same bits.
 */
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

/* The numbers that are not arrays. */
struct scalars {
    double time, stage_start, dt_now, held, speed, skin, drift, sifted, wall_drift, gravity[3], memory[CALX_MEMORY];
    int64_t step, stage_step, rebuilds, built_step;
    int32_t stage, models;
    uint8_t done, stage_began, built;
    uint64_t n, rows, places, apart, reach, block_count, group_count, near_count, edge_capacity, boundary_capacity,
        collect_count;
    long double dissipated, wall_work, outside_work, wall_heat, dissipation_heat, energy0, heat0;
    double wall_power, potential0, scale, heat_scale, coldest, hottest, overlap_seen, trusted;
    double dt, heat_dt, pace_time, pace_overlap, checked;
    int64_t contacts_seen, look_from, look_due, heat_every, pace_step, pace_level, pace_due;
    struct calx_peak peak;
    double sweeps, residual;
};

#define COPY_SCALARS(to, from)                                                                     \
    do {                                                                                           \
        (to)->time = (from)->time, (to)->stage_start = (from)->stage_start;                        \
        (to)->held = (from)->held;                                                                 \
        (to)->dt_now = (from)->dt_now, (to)->speed = (from)->speed, (to)->skin = (from)->skin;     \
        (to)->drift = (from)->drift, (to)->sifted = (from)->sifted, (to)->wall_drift = (from)->wall_drift;                        \
        memcpy((to)->gravity, (from)->gravity, sizeof (to)->gravity);                              \
        memcpy((to)->memory, (from)->memory, sizeof (to)->memory);                                 \
        (to)->step = (from)->step, (to)->stage_step = (from)->stage_step;                          \
        (to)->built_step = (from)->built_step;                                                     \
        (to)->rebuilds = (from)->rebuilds, (to)->stage = (from)->stage;                            \
        (to)->done = (from)->done, (to)->stage_began = (from)->stage_began;                        \
        (to)->built = (from)->built, (to)->n = (from)->n;                                          \
        (to)->block_count = (from)->block_count, (to)->group_count = (from)->group_count;          \
        (to)->near_count = (from)->near_count, (to)->edge_capacity = (from)->edge_capacity;        \
        (to)->boundary_capacity = (from)->boundary_capacity;                                       \
        (to)->dissipated = (from)->dissipated, (to)->wall_work = (from)->wall_work;                \
        (to)->outside_work = (from)->outside_work, (to)->wall_heat = (from)->wall_heat;            \
        (to)->dissipation_heat = (from)->dissipation_heat, (to)->energy0 = (from)->energy0;        \
        (to)->heat0 = (from)->heat0, (to)->wall_power = (from)->wall_power;                        \
        (to)->potential0 = (from)->potential0, (to)->scale = (from)->scale;                        \
        (to)->coldest = (from)->coldest, (to)->hottest = (from)->hottest;                          \
        (to)->overlap_seen = (from)->overlap_seen, (to)->contacts_seen = (from)->contacts_seen;    \
        (to)->look_from = (from)->look_from, (to)->look_due = (from)->look_due;                    \
        (to)->trusted = (from)->trusted;                                                           \
        (to)->dt = (from)->dt, (to)->heat_dt = (from)->heat_dt;                                    \
        (to)->heat_every = (from)->heat_every, (to)->pace_time = (from)->pace_time;                \
        (to)->pace_step = (from)->pace_step, (to)->pace_level = (from)->pace_level;                \
        (to)->pace_due = (from)->pace_due, (to)->pace_overlap = (from)->pace_overlap;              \
        (to)->sweeps = (from)->sweeps, (to)->residual = (from)->residual;                          \
        (to)->checked = (from)->checked;                                                           \
        (to)->heat_scale = (from)->heat_scale, (to)->peak = (from)->peak;                          \
    } while (0)

/* An array of the state: where its pointer is and its bytes. */
struct array {
    char name[32];
    void **pointer;
    size_t bytes;
};

enum { ARRAYS_MAX = 128 };

struct array_list {
    size_t count;
    struct array items[ARRAYS_MAX];
};

static void add(struct array_list *l, const char *name, void *pointer, size_t bytes)
{
    struct array *a = &l->items[l->count++];
    snprintf(a->name, sizeof a->name, "%s", name);
    a->pointer = pointer;
    a->bytes = bytes;
}

static void list_rows(struct calx_sim *s, size_t rows, struct array_list *l)
{
    struct calx_rows_arrays *r = &s->r;
    add(l, "x", &r->x, rows * 4 * sizeof(double));
    add(l, "v", &r->v, rows * r->stride * sizeof(double));
    add(l, "a", &r->a, rows * r->stride * sizeof(double));
    add(l, "id", &r->id, rows * sizeof *r->id);
    add(l, "material", &r->material, rows * sizeof *r->material);
    if (r->inverse_capacity)
        add(l, "inverse_capacity", &r->inverse_capacity, rows * sizeof(double));
    if (r->heat_store)
        add(l, "heat_store", &r->heat_store, rows * sizeof(double));
    if (r->image)
        add(l, "image", &r->image, rows * sizeof *r->image);
    if (r->source)
        add(l, "source", &r->source, rows * sizeof *r->source);
    if (r->shift)
        add(l, "shift", &r->shift, rows);
    for (size_t k = 0; k < 2 * CALX_EXTRA_MAX; k++)
        if (r->extra[k]) {
            char name[32];
            snprintf(name, sizeof name, "extra%zu", k);
            add(l, name, &r->extra[k], rows * 4 * sizeof(double));
        }
}

static void list_contacts(struct calx_sim *s, const struct scalars *n, size_t columns, struct array_list *l)
{
    add(l, "blocks", &s->blocks, n->block_count * sizeof *s->blocks);
    add(l, "groups", &s->groups, n->group_count * sizeof *s->groups);
    add(l, "tallies", &s->tallies, n->block_count * sizeof *s->tallies);
    add(l, "pair_i", &s->pairs.i, n->places * sizeof *s->pairs.i);
    add(l, "pair_j", &s->pairs.j, n->places * sizeof *s->pairs.j);
    add(l, "touching", &s->pairs.touching, n->places / 8);
    add(l, "history", &s->pairs.history, n->places * s->plan->history * sizeof(double));
    add(l, "apart_i", &s->pairs.apart_i, n->apart * sizeof *s->pairs.apart_i);
    add(l, "apart_j", &s->pairs.apart_j, n->apart * sizeof *s->pairs.apart_j);
    add(l, "collect_to", &s->collect_to, n->collect_count * sizeof *s->collect_to);
    add(l, "collect_from", &s->collect_from, n->collect_count * sizeof *s->collect_from);
    if (!s->features.wall_contacts)
        return;
    add(l, "near_row", &s->near_row, n->near_count * sizeof *s->near_row);
    add(l, "near_primitive", &s->near_primitive, n->near_count * sizeof *s->near_primitive);
    add(l, "wall_contacts", &s->wall_contacts, n->near_count * sizeof *s->wall_contacts);
    add(l, "wall_contacts_next", &s->wall_contacts_next, n->near_count * sizeof *s->wall_contacts);
    add(l, "wall_history", &s->wall_history, n->near_count * columns * sizeof(double));
    add(l, "wall_history_next", &s->wall_history_next, n->near_count * columns * sizeof(double));
}

static void list_walls(struct calx_sim *s, const struct scalars *n, struct array_list *l)
{
    size_t walls = s->scene->wall_count;
    add(l, "posed", &s->posed, s->primitive_count * sizeof *s->posed);
    add(l, "poses", &s->poses, walls * sizeof *s->poses);
    add(l, "stage_poses", &s->stage_poses, walls * sizeof *s->stage_poses);
    add(l, "wall_angle", &s->wall_angle, walls * sizeof *s->wall_angle);
    add(l, "wall_shift", &s->wall_shift, walls * sizeof *s->wall_shift);
    add(l, "plates", &s->plates, walls * sizeof *s->plates);
    add(l, "wall_temperature", &s->wall_temperature, walls * sizeof *s->wall_temperature);
    if (s->slab_cells) {
        add(l, "slab_temperature", &s->slab_temperature, s->slab_cells * sizeof *s->slab_temperature);
        add(l, "slab_heat", &s->slab_heat, s->slab_faces * sizeof *s->slab_heat);
        add(l, "block_faces", &s->block_faces, n->block_count * s->slab_faces * sizeof *s->block_faces);
    }
    add(l, "wall_force", &s->wall_force, walls * sizeof *s->wall_force);
    add(l, "block_wall_force", &s->block_wall_force, n->block_count * walls * sizeof *s->block_wall_force);
    for (size_t p = 0; p < s->scene->probe_count; p++)
        if (s->classes[p]) {
            char name[32];
            snprintf(name, sizeof name, "classes%zu", p);
            add(l, name, &s->classes[p], s->n);
        }
}

static void list_profiles(struct calx_sim *s, struct array_list *l)
{
    size_t layers = 0;
    for (size_t p = 0; p < s->scene->profile_count; p++)
        layers += s->scene->profiles[p].layers;
    if (!layers)
        return;
    add(l, "profile_clocks", &s->profile_clocks, s->scene->profile_count * sizeof *s->profile_clocks);
    add(l, "layer_sums", &s->layer_sums, layers * sizeof *s->layer_sums);
    add(l, "layers", &s->layers, layers * sizeof *s->layers);
}

static void list_steady(struct calx_sim *s, struct array_list *l)
{
    size_t count = s->scene->steady_count;
    if (!count)
        return;
    add(l, "steady_clocks", &s->steady_clocks, count * sizeof *s->steady_clocks);
    add(l, "steady_numbers", &s->steady_numbers, calx_steady_numbers(s->scene, count) * sizeof *s->steady_numbers);
}

static void list_network(struct calx_sim *s, const struct scalars *n, struct array_list *l)
{
    if (!s->features.heat_network)
        return;
    add(l, "edge_i", &s->edge_i, n->edge_capacity * 4);
    add(l, "edge_j", &s->edge_j, n->edge_capacity * 4);
    add(l, "edge_h", &s->edge_h, n->edge_capacity * 8);
    add(l, "boundary_i", &s->boundary_i, n->boundary_capacity * 4);
    add(l, "boundary_h", &s->boundary_h, n->boundary_capacity * 8);
    add(l, "boundary_t", &s->boundary_t, n->boundary_capacity * 8);
    add(l, "boundary_wall", &s->boundary_wall, n->boundary_capacity * 4);
    add(l, "boundary_at", &s->boundary_at, n->boundary_capacity * sizeof *s->boundary_at);
}

static void list_all(struct calx_sim *s, const struct scalars *n, size_t columns, struct array_list *l)
{
    l->count = 0;
    list_rows(s, n->rows, l);
    list_contacts(s, n, columns, l);
    list_walls(s, n, l);
    list_network(s, n, l);
    list_profiles(s, l);
    list_steady(s, l);
}

int calx_sim_save(struct calx_sim *s, struct calx_block **blocks, size_t *count, struct calx_error *e)
{
    struct array_list list;
    free(s->saved);
    s->saved = calloc(1, sizeof(struct scalars));
    *blocks = calloc(ARRAYS_MAX + 1, sizeof **blocks);
    if (!s->saved || !*blocks)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for a restart point");
    struct scalars *n = s->saved;
    COPY_SCALARS(n, s);
    n->models = (int32_t)(s->plan - s->plans);
    n->rows = s->r.rows;
    n->places = s->pairs.places;
    n->apart = s->pairs.apart;
    n->reach = s->pairs.reach;
    n->collect_count = s->r.rows - s->n;
    list_all(s, n, s->plan->history, &list);
    *count = list.count + 1;
    (*blocks)[0] = (struct calx_block){"scalars", n, sizeof *n};
    for (size_t k = 0; k < list.count; k++) {
        struct calx_block *b = &(*blocks)[k + 1];
        memcpy(b->name, list.items[k].name, sizeof b->name);
        b->data = *list.items[k].pointer;
        b->bytes = list.items[k].bytes;
    }
    return 0;
}

static int misfit(const char *what, struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_INPUT, "the restart file does not fit this case: %s differs", what);
}

/* The row layout and lists must have the saved sizes before the arrays are filled. */
static int resize(struct calx_sim *s, const struct scalars *n, struct array_list *list, struct calx_error *e)
{
    calx_rows_free(&s->r);
    if (calx_rows_allocate(s, &s->r, n->rows))
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the restart point");
    list_all(s, n, s->plan->history, list);
    for (size_t k = 0; k < list->count; k++) {
        free(*list->items[k].pointer);
        *list->items[k].pointer = calx_memory_zeroed(list->items[k].bytes, 1);
        if (!*list->items[k].pointer)
            return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the restart point");
    }
    return 0;
}

int calx_sim_restore(struct calx_sim *s, const struct calx_block *blocks, size_t count, struct calx_error *e)
{
    struct array_list list;
    struct scalars n;
    if (!count || strcmp(blocks[0].name, "scalars") || blocks[0].bytes != sizeof n)
        return misfit("its header", e);
    memcpy(&n, blocks[0].data, sizeof n);
    if (n.n != s->n || n.models < 0 || (size_t)n.models >= s->plan_count || n.stage < 0 ||
        (size_t)n.stage >= s->scene->stage_count)
        return misfit("the number of particles, models or stages", e);
    s->plan = &s->plans[n.models];
    CALX_TRY(resize(s, &n, &list, e));
    if (count != list.count + 1)
        return misfit("what the models keep", e);
    COPY_SCALARS(s, &n);
    s->pairs.places = n.places;
    s->pairs.apart = n.apart;
    s->pairs.reach = n.reach;
    for (size_t k = 0; k < list.count; k++) {
        const struct calx_block *b = &blocks[k + 1];
        if (strncmp(b->name, list.items[k].name, sizeof b->name) || b->bytes != list.items[k].bytes)
            return misfit(list.items[k].name, e);
        if (b->bytes)
            memcpy(*list.items[k].pointer, b->data, b->bytes);
    }
    calx_pace_resume(s);
    calx_profile_resume(s);
    calx_steady_resume(s);
    calx_measure_clear(&s->measure);
    s->walls_changed = true;
    if (calx_team_form(s))
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the restart point");
    return calx_carried_list(s, e);
}

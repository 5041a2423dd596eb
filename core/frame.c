/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A frame: the present state copied in order of id, for output and measurement. Looking changes nothing.
 */
#include <stdlib.h>
#include <string.h>

#include "core/frame.h"

static int allocate(const struct calx_sim *s, struct calx_frame *f)
{
    size_t n = s->n;
    f->n = n;
    f->id = calx_memory_zeroed(n, sizeof *f->id);
    f->position = calx_memory_zeroed(n, sizeof *f->position);
    f->radius = calx_memory_zeroed(n, sizeof *f->radius);
    f->velocity = calx_memory_zeroed(n, sizeof *f->velocity);
    f->force = s->features.contacts ? calx_memory_zeroed(n, sizeof *f->force) : NULL;
    f->mass = calx_memory_zeroed(n, sizeof *f->mass);
    f->material = calx_memory_zeroed(n, sizeof *f->material);
    f->contacts = calx_memory_zeroed(n, sizeof *f->contacts);
    if (s->scene->particles.carrier)
        f->group = calx_memory_zeroed(n, sizeof *f->group);
    if (s->features.rotation)
        f->spin = calx_memory_zeroed(n, sizeof *f->spin);
    if (s->features.temperature) {
        f->temperature = calx_memory_zeroed(n, sizeof *f->temperature);
        f->heat = calx_memory_zeroed(n, sizeof *f->heat);
    }
    return !f->id || !f->position || !f->radius || !f->velocity || !f->mass || !f->material || !f->contacts ||
           (s->scene->particles.carrier && !f->group) || (s->features.contacts && !f->force) || (s->features.rotation && !f->spin) ||
           (s->features.temperature && (!f->temperature || !f->heat));
}

/* Groups are numbered from 0 in the order of the scene. */
static int32_t group_number(const struct calx_scene *scene, int32_t carrier)
{
    int32_t number = -1;
    for (int32_t w = 0; w <= carrier; w++)
        number += scene->walls[w].carries;
    return number;
}

/* A body that a plate carries has the plate's velocity; its row has the one that the contacts saw. */
static void take_plate(const struct calx_sim *s, size_t i, double velocity[3])
{
    int32_t wall = s->scene->particles.carrier ? s->scene->particles.carrier[i] : -1;
    const struct calx_motion *m = wall < 0 ? NULL : &s->scene->stages[s->stage].motion[wall];
    if (m && m->free)
        velocity[m->free_axis] = s->plates[wall].speed;
}

static void copy_particle(const struct calx_sim *s, int32_t row, struct calx_frame *f)
{
    size_t i = (size_t)s->r.id[row];
    const double *x = calx_row_x(s, row), *v = calx_row_v(s, row), *a = calx_row_a(s, row);
    const struct calx_material *m = &s->scene->materials[s->r.material[row]];
    bool free_body = v[3] > 0.0;
    f->id[i] = (int64_t)i;
    f->radius[i] = x[3];
    f->mass[i] = calx_particle_mass(s->scene, x[3], m->density);
    f->material[i] = s->r.material[row];
    if (f->group)
        f->group[i] = group_number(s->scene, s->scene->particles.carrier[i]);
    for (int k = 0; k < 3; k++) {
        f->position[i][k] = x[k];
        f->velocity[i][k] = v[k];
        if (f->force)
            f->force[i][k] = free_body && s->plan->motion ? f->mass[i] * (a[k] - s->gravity[k]) : 0.0;
        if (f->spin)
            f->spin[i][k] = v[4 + k];
    }
    take_plate(s, i, f->velocity[i]);
    if (f->temperature) {
        f->temperature[i] = v[7];
        f->heat[i] = a[7];
    }
}

struct calx_frame *calx_frame_create(struct calx_sim *s, bool with_contacts)
{
    struct calx_frame *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    f->time = s->time;
    f->step = s->step;
    f->dimension = s->scene->dimension;
    if (allocate(s, f) || calx_frame_walls(s, f)) {
        calx_frame_free(f);
        return NULL;
    }
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            copy_particle(s, row, f);
    if (calx_frame_network(s, f, with_contacts)) {
        calx_frame_free(f);
        return NULL;
    }
    return f;
}

void calx_frame_free(struct calx_frame *f)
{
    if (!f)
        return;
    void *all[] = {f->id, f->position, f->radius, f->velocity, f->spin, f->force, f->temperature, f->heat,
                   f->mass, f->material, f->contacts, f->pair, f->pair_position, f->normal_force,
                   f->tangential_force, f->heat_flow, f->overlap, f->status, f->wall_position, f->wall_cell,
                   f->wall_of_cell, f->wall_velocity, f->wall_temperature, f->wall_force, f->group,
                   f->force_on_wall, f->temperature_of_wall, f->displacement_of_wall, f->velocity_of_wall};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
    free(f);
}

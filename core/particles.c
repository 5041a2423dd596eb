/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Bodies: mass, moment of inertia, heat capacity; and the first row layout, in order of id, before the first rebuild.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

double calx_particle_mass(const struct calx_scene *s, double radius, double density)
{
    double volume = s->bodies == CALX_DISCS ? M_PI * radius * radius * s->thickness
                                            : 4.0 / 3.0 * M_PI * radius * radius * radius;
    return density * volume;
}

double calx_particle_inertia_factor(const struct calx_scene *s)
{
    return s->bodies == CALX_DISCS ? 0.5 : 0.4;
}

static void fill_row(struct calx_sim *s, size_t i)
{
    const struct calx_particles *p = &s->scene->particles;
    const struct calx_material *m = &s->scene->materials[p->material[i]];
    double *x = s->r.x + 4 * i, *v = s->r.v + s->r.stride * i;
    double mass = calx_particle_mass(s->scene, p->radius[i], m->density);
    for (int k = 0; k < 3; k++) {
        x[k] = p->position[i][k];
        v[k] = p->velocity ? p->velocity[i][k] : 0.0;
        if (s->r.stride == 8)
            v[4 + k] = p->spin ? p->spin[i][k] : 0.0;
    }
    x[3] = p->radius[i];
    int carrier = p->carrier ? p->carrier[i] : -1;
    bool held = carrier >= 0 && s->scene->walls[carrier].isothermal;
    s->some_fixed |= carrier >= 0 || (p->fixed && p->fixed[i]);
    v[3] = carrier >= 0 || (p->fixed && p->fixed[i]) ? 0.0 : 1.0 / mass;
    if (s->r.stride == 8)
        v[7] = p->temperature ? p->temperature[i] : 293.15;
    if (s->r.inverse_capacity)
        s->r.inverse_capacity[i] = held ? 0.0 : 1.0 / (mass * m->specific_heat);
    s->r.id[i] = (int64_t)i;
    s->r.material[i] = p->material[i];
}

int calx_particles_create(struct calx_sim *s, struct calx_error *e)
{
    size_t n = s->n = s->scene->particles.count;
    s->block_count = (n + CALX_BLOCK - 1) / CALX_BLOCK;
    s->blocks = calloc(s->block_count + 1, sizeof *s->blocks);
    s->groups = calloc(s->block_count + 1, sizeof *s->groups);
    if (!s->blocks || !s->groups || n > INT32_MAX / 4 || calx_rows_allocate(s, &s->r, n))
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu particles", n);
    calx_rows_clear(s, &s->r);
    for (size_t b = 0; b < s->block_count; b++) {
        s->blocks[b].first = (int32_t)(b * CALX_BLOCK);
        s->blocks[b].own = (int32_t)(n - b * CALX_BLOCK < CALX_BLOCK ? n - b * CALX_BLOCK : CALX_BLOCK);
    }
    s->radius_min = n ? DBL_MAX : 0.0;
    for (size_t i = 0; i < n; i++) {
        fill_row(s, i);
        s->radius_min = fmin(s->radius_min, s->scene->particles.radius[i]);
        s->radius_max = fmax(s->radius_max, s->scene->particles.radius[i]);
    }
    return calx_carried_list(s, e);
}

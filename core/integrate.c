/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Runs the stages of the integrator of motion over the rows of one block, and, between, collects what earlier blocks left on their copies of
 * its particles and turns forces into accelerations: a = F/m + g, angular a = torque/I. A fixed body has 1/m = 0 and
 * does not accelerate.
 */
#include "core/columns.h"
#include "core/timing.h"
#include "core/vector.h"

static struct calx_rows translation_rows(struct calx_sim *s, const struct calx_row_block *b, double **extra)
{
    double dt = s->dt;
    for (size_t k = 0; k < CALX_EXTRA_MAX; k++)
        extra[k] = s->r.extra[k] ? s->r.extra[k] + 4 * (size_t)b->first : NULL;
    return (struct calx_rows){.size = sizeof(struct calx_rows), .n = (size_t)b->own, .stride = s->r.stride,
                              .dt = {dt, dt, s->scene->dimension == 3 ? dt : 0.0, 0.0},
                              .x = calx_row_x(s, b->first), .v = calx_row_v(s, b->first),
                              .a = calx_row_a(s, b->first), .extra = extra};
}

static struct calx_rows rotation_rows(struct calx_sim *s, const struct calx_row_block *b, double **extra)
{
    double dt = s->dt, in_plane = s->scene->dimension == 3 ? dt : 0.0;
    for (size_t k = 0; k < CALX_EXTRA_MAX; k++)
        extra[k] = s->r.extra[CALX_EXTRA_MAX + k] ? s->r.extra[CALX_EXTRA_MAX + k] + 4 * (size_t)b->first
                                                  : NULL;
    return (struct calx_rows){.size = sizeof(struct calx_rows), .n = (size_t)b->own, .stride = s->r.stride,
                              .dt = {in_plane, in_plane, dt, 0.0}, .v = calx_row_v(s, b->first) + 4,
                              .a = calx_row_a(s, b->first) + 4, .extra = extra};
}

static double largest_speed2(const struct calx_sim *s, const struct calx_row_block *b)
{
    double largest = 0.0;
    const double *v = calx_row_v(s, b->first);
    for (size_t i = 0; i < (size_t)b->own; i++, v += s->r.stride) {
        double speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        largest = speed2 > largest ? speed2 : largest;
    }
    return largest;
}

double CALX_ISA(calx_block_before)(struct calx_sim *s, size_t block, size_t stage)
{
    const struct calx_row_block *b = &s->blocks[block];
    const struct calx_motion_integrator *law = s->plan->motion_law;
    struct calx_clock *clock = calx_timing_clock(s);
    double *extra[CALX_EXTRA_MAX];
    calx_timing_restart(clock);
    struct calx_rows rows = translation_rows(s, b, extra);
    if (law->translation[stage].before)
        law->translation[stage].before(s->plan->motion_params, &rows);
    if (s->features.rotation && law->rotation[stage].before) {
        rows = rotation_rows(s, b, extra);
        law->rotation[stage].before(s->plan->motion_params, &rows);
    }
    double speed2 = largest_speed2(s, b);
    calx_timing_lap(clock, CALX_PHASE_INTEGRATE);
    return speed2;
}

static void collect_ghosts(struct calx_sim *s, const struct calx_row_block *b)
{
    for (size_t k = b->collect_first; k < b->collect_first + b->collect_count; k++) {
        double *to = calx_row_a(s, s->collect_to[k]);
        const double *from = calx_row_a(s, s->collect_from[k]);
        for (size_t lane = 0; lane < s->r.stride; lane += 4)
            calx_v4_add(to + lane, calx_v4_load(from + lane));
    }
}

/* Rows of eight: the second half holds torque and heat flow, which stays. */
static double accelerate_full(struct calx_sim *s, const struct calx_row_block *b)
{
    static const calx_v8 linear = {1, 1, 1, 0, 0, 0, 0, 0}, angular = {0, 0, 0, 0, 1, 1, 1, 0},
                         heat = {0, 0, 0, 0, 0, 0, 0, 1};
    const calx_v8 g = {s->gravity[0], s->gravity[1], s->gravity[2], 0, 0, 0, 0, 0};
    double inertia = 1.0 / calx_particle_inertia_factor(s->scene);
    calx_v8 finite = {0};
    for (int32_t i = b->first; i < b->first + b->own; i++) {
        double *a = calx_row_a(s, i), inverse_mass = calx_row_v(s, i)[3], radius = calx_row_x(s, i)[3];
        double inverse_inertia = inertia * inverse_mass / (radius * radius);
        calx_v8 scale = linear * inverse_mass + angular * inverse_inertia + heat;
        calx_v8 result = scale * calx_v8_load(a) + (inverse_mass > 0.0 ? 1.0 : 0.0) * g;
        finite += 0.0 * result;
        calx_v8_store(a, result);
    }
    return ((finite[0] + finite[4]) + (finite[2] + finite[6])) + ((finite[1] + finite[5]) + (finite[3] + finite[7]));
}

static double accelerate_half(struct calx_sim *s, const struct calx_row_block *b)
{
    static const calx_v4 linear = {1, 1, 1, 0};
    const calx_v4 g = {s->gravity[0], s->gravity[1], s->gravity[2], 0};
    calx_v4 finite = {0};
    for (int32_t i = b->first; i < b->first + b->own; i++) {
        double *a = calx_row_a(s, i), inverse_mass = calx_row_v(s, i)[3];
        calx_v4 result = linear * inverse_mass * calx_v4_load(a) + (inverse_mass > 0.0 ? 1.0 : 0.0) * g;
        finite += 0.0 * result;
        calx_v4_store(a, result);
    }
    return (finite[0] + finite[2]) + (finite[1] + finite[3]);
}

static void after(struct calx_sim *s, const struct calx_row_block *b, size_t stage)
{
    const struct calx_motion_integrator *law = s->plan->motion_law;
    double *extra[CALX_EXTRA_MAX];
    struct calx_rows rows = translation_rows(s, b, extra);
    if (law->translation[stage].after)
        law->translation[stage].after(s->plan->motion_params, &rows);
    if (s->features.rotation && law->rotation[stage].after) {
        rows = rotation_rows(s, b, extra);
        law->rotation[stage].after(s->plan->motion_params, &rows);
    }
}

void CALX_ISA(calx_block_finish)(struct calx_sim *s, size_t block, int stage, bool ahead)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct calx_clock *clock = calx_timing_clock(s);
    calx_timing_restart(clock);
    collect_ghosts(s, b);
    s->tallies[block].finite = s->r.stride == 8 ? accelerate_full(s, b) : accelerate_half(s, b);
    if (stage >= 0)
        after(s, b, (size_t)stage);
    calx_timing_lap(clock, CALX_PHASE_INTEGRATE);
    if (ahead)
        s->tallies[block].speed2 = CALX_ISA(calx_block_before)(s, block, 0);
}

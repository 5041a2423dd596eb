/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What follows the forces of one block: collects what earlier blocks left on their copies of its particles, turns forces into
 * accelerations, a = F/m + g, angular a = torque/I, and runs the kernels of the integrators of motion and temperature. All of it goes over
 * a few rows at a time, which stay in the nearest cache from one kernel to the next. A fixed body has 1/m = 0 and does not accelerate.
 */
#include <math.h>
#include <string.h>

#include "core/columns.h"
#include "core/timing.h"
#include "core/vector.h"

enum { AT_A_TIME = 64, COLLECT_AHEAD = 12 }; /* rows */

/* Some rows of a block as the kernels see them: all of them, then, where they begin, a few at a time. */
struct part {
    struct calx_sim *s;
    size_t first, n; /* rows of the layout */
    double *a;       /* their accelerations */
    struct calx_rows translation, rotation;
    double *extra[2 * CALX_EXTRA_MAX];
};

static void part_begin(struct part *p, struct calx_sim *s)
{
    double dt = s->rows_dt, across = s->scene->dimension == 3 ? dt : 0.0; /* z, and spins about x and y */
    p->s = s;
    p->translation = (struct calx_rows){.size = sizeof(struct calx_rows), .stride = s->r.stride,
                                        .dt = {dt, dt, across, 0.0, across, across, dt, 0.0}, .extra = p->extra};
    p->rotation = (struct calx_rows){.size = sizeof(struct calx_rows), .stride = s->r.stride, .dt = {across, across, dt, 0.0},
                                     .extra = p->extra + CALX_EXTRA_MAX};
}

/* The rows of block b from `row` on, counted from its first; a: accelerations of the block. */
static void part_at(struct part *p, const struct calx_row_block *b, size_t row, double *a)
{
    const struct calx_rows_arrays *r = &p->s->r;
    size_t left = (size_t)b->own - row;
    p->first = (size_t)b->first + row;
    p->n = p->translation.n = p->rotation.n = left < AT_A_TIME ? left : AT_A_TIME;
    p->a = a + r->stride * row;
    p->translation.x = r->x + 4 * p->first;
    p->translation.v = r->v + r->stride * p->first;
    p->translation.a = p->a;
    p->rotation.v = p->translation.v + 4;
    p->rotation.a = p->a + 4;
    for (size_t k = 0; k < 2 * CALX_EXTRA_MAX; k++)
        p->extra[k] = r->extra[k] ? r->extra[k] + 4 * p->first : NULL;
}

/* `whole`, if there is one, does what the two others do. */
static void run(struct part *p, size_t stage, const void *params, calx_rows_kernel *whole, calx_rows_kernel *translation,
                calx_rows_kernel *rotation)
{
    p->translation.stage = p->rotation.stage = stage;
    if (whole && p->s->features.rotation) {
        whole(params, &p->translation);
        return;
    }
    if (translation)
        translation(params, &p->translation);
    if (rotation && p->s->features.rotation)
        rotation(params, &p->rotation);
}

static inline double largest_speed2(const struct part *p)
{
    const size_t n = p->n, stride = p->translation.stride;
    const double *v = p->translation.v;
    calx_v8 most = {0};
    double largest = 0.0;
    for (size_t i = 0; i < n; i += 8) {
        calx_v4 row[8];
        calx_v8 c[4];
        for (size_t k = 0; k < 8; k++) /* beyond the end: the last one once more */
            row[k] = calx_v4_load(v + stride * (i + k < n ? i + k : n - 1));
        calx_rows_to_columns(row, c);
        most = calx_v8_max(c[0] * c[0] + c[1] * c[1] + c[2] * c[2], most);
    }
    for (int k = 0; k < 8; k++)
        largest = most[k] > largest ? most[k] : largest;
    return largest;
}

/* The same, and the square of the largest displacement. */
static double run_measured(struct part *p, size_t stage, const void *params, calx_rows_kernel *translation,
                           calx_rows_kernel *rotation)
{
    double start[4 * AT_A_TIME], most = 0.0;
    const double *x = p->translation.x;
    memcpy(start, x, 4 * p->n * sizeof *start);
    run(p, stage, params, NULL, translation, rotation);
    for (size_t i = 0; i < p->n; i++) {
        double d[3] = {x[4 * i] - start[4 * i], x[4 * i + 1] - start[4 * i + 1], x[4 * i + 2] - start[4 * i + 2]};
        most = fmax(most, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return most;
}

/* The square of the largest speed, or displacement over dt. */
static double before(struct part *p, size_t stage)
{
    const struct calx_motion_integrator *law = p->s->plan->motion_law;
    const void *params = p->s->plan->motion_params;
    calx_rows_kernel *move = law->translation[stage].before, *turn = law->rotation[stage].before;
    if (!law->drifts)
        return run_measured(p, stage, params, move, turn) / (p->s->dt * p->s->dt);
    run(p, stage, params, law->whole ? law->whole[stage].before : NULL, move, turn);
    return largest_speed2(p);
}

/* The kernels of two steps in one, where the last stage has that and nothing comes in between. */
static calx_rows_kernel *between(const struct part *p, const struct calx_pass *pass)
{
    const struct calx_motion_integrator *law = p->s->plan->motion_law;
    if (!pass->ahead || pass->stage < 0 || !law->drifts)
        return NULL;
    if (!p->s->features.rotation)
        return law->translation[pass->stage].between;
    return law->whole ? law->whole[pass->stage].between : NULL;
}

/* The square of the largest displacement. */
static double after(struct part *p, size_t stage)
{
    const struct calx_motion_integrator *law = p->s->plan->motion_law;
    const void *params = p->s->plan->motion_params;
    calx_rows_kernel *move = law->translation[stage].after, *turn = law->rotation[stage].after;
    if (!law->drifts && move)
        return run_measured(p, stage, params, move, turn);
    run(p, stage, params, law->whole ? law->whole[stage].after : NULL, move, turn);
    return 0.0;
}

double CALX_ISA(calx_block_before)(struct calx_sim *s, size_t block, size_t stage)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct calx_clock *clock = calx_timing_clock(s);
    struct part p;
    double largest = 0.0;
    calx_timing_restart(clock);
    part_begin(&p, s);
    for (size_t row = 0; row < (size_t)b->own; row += AT_A_TIME) {
        part_at(&p, b, row, calx_row_a(s, b->first));
        double speed2 = before(&p, stage);
        largest = speed2 > largest ? speed2 : largest;
    }
    calx_timing_lap(clock, CALX_PHASE_INTEGRATE);
    return largest;
}

double CALX_ISA(calx_block_kernels)(struct calx_sim *s, size_t block, size_t stage, const void *params,
                                    calx_rows_kernel *translation, calx_rows_kernel *rotation)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct part p;
    double most = 0.0;
    part_begin(&p, s);
    for (size_t row = 0; row < (size_t)b->own; row += AT_A_TIME) {
        part_at(&p, b, row, calx_row_a(s, b->first));
        most = fmax(most, run_measured(&p, stage, params, translation, rotation));
    }
    return most;
}

double CALX_ISA(calx_block_measure)(struct calx_sim *s, size_t block, const void *params, calx_rows_measure *translation,
                                    calx_rows_measure *rotation)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct part p;
    double most = 0.0;
    part_begin(&p, s);
    for (size_t row = 0; row < (size_t)b->own; row += AT_A_TIME) {
        part_at(&p, b, row, calx_row_a(s, b->first));
        double one = translation ? translation(params, &p.translation) : 0.0;
        double other = rotation && s->features.rotation ? rotation(params, &p.rotation) : 0.0;
        most = one > most || isnan(one) ? one : most;
        most = other > most || isnan(other) ? other : most;
        if (isnan(most))
            return most;
    }
    return most;
}

/* Rows of which there are ghosts are at another processor, as are the forces on those: all of them are asked for in time. */
static void collect_ghosts(struct calx_sim *s, const struct calx_row_block *b, double *a)
{
    const size_t end = b->collect_first + b->collect_count;
    for (size_t k = b->collect_first; k < end; k++) {
        size_t ahead = k + COLLECT_AHEAD < end ? k + COLLECT_AHEAD : k;
        __builtin_prefetch(calx_row_a(s, s->collect_from[ahead]));
        __builtin_prefetch(calx_row_v(s, s->collect_to[ahead]), 1);
        __builtin_prefetch(calx_row_x(s, s->collect_to[ahead]), 1);
        double *to = a + s->r.stride * (size_t)(s->collect_to[k] - b->first);
        const double *from = calx_row_a(s, s->collect_from[k]);
        for (size_t lane = 0; lane < s->r.stride; lane += 4)
            calx_v4_add(to + lane, calx_v4_load(from + lane));
    }
}

/* Rows of eight: the second half holds torque and heat flow, which stays. Adds 0 to `finite`, or NaN. */
static inline __attribute__((always_inline)) calx_v8 accelerate_full(const struct part *p, calx_v8 finite, const bool one_size)
{
    static const calx_v8 linear = {1, 1, 1, 0, 0, 0, 0, 0}, angular = {0, 0, 0, 0, 1, 1, 1, 0},
                         heat = {0, 0, 0, 0, 0, 0, 0, 1};
    const struct calx_sim *s = p->s;
    const calx_v8 g = {s->gravity[0], s->gravity[1], s->gravity[2], 0, 0, 0, 0, 0};
    const double *x = s->r.x + 4 * p->first, *v = s->r.v + 8 * p->first;
    const double inertia = 1.0 / calx_particle_inertia_factor(s->scene), same = inertia / (s->radius_max * s->radius_max);
    const size_t n = p->n;
    double *a = p->a;
    for (size_t i = 0; i < n; i++) {
        double inverse_mass = v[8 * i + 3], radius = x[4 * i + 3];
        calx_v8 per_mass = linear + angular * (one_size ? same : inertia / (radius * radius));
        calx_v8 scale = per_mass * inverse_mass + heat;
        calx_v8 result = scale * calx_v8_load(a + 8 * i) + (inverse_mass > 0.0 ? 1.0 : 0.0) * g;
        finite += 0.0 * result;
        calx_v8_store(a + 8 * i, result);
    }
    return finite;
}

static calx_v8 accelerate_half(const struct part *p, calx_v8 finite)
{
    static const calx_v4 linear = {1, 1, 1, 0};
    const struct calx_sim *s = p->s;
    const calx_v4 g = {s->gravity[0], s->gravity[1], s->gravity[2], 0};
    calx_v4 sum = {0};
    for (size_t i = 0; i < p->n; i++) {
        double *a = p->a + 4 * i, inverse_mass = s->r.v[4 * (p->first + i) + 3];
        calx_v4 result = linear * inverse_mass * calx_v4_load(a) + (inverse_mass > 0.0 ? 1.0 : 0.0) * g;
        sum += 0.0 * result;
        calx_v4_store(a, result);
    }
    return finite + calx_v8_join(sum, sum);
}

static calx_v8 accelerate(const struct part *p, calx_v8 finite)
{
    if (p->s->r.stride == 4)
        return accelerate_half(p, finite);
    return p->s->radius_min == p->s->radius_max ? accelerate_full(p, finite, true) : accelerate_full(p, finite, false);
}

/* A step of the staged integrator of temperature, with the heat of dissipation that waited for it. */
static void warm(const struct part *p)
{
    const struct calx_sim *s = p->s;
    const struct calx_plan *plan = s->plan;
    double *store = s->r.heat_store ? s->r.heat_store + p->first : NULL;
    for (size_t i = 0; store && i < p->n; i++) {
        p->a[8 * i + 7] += store[i] / s->heat_dt;
        store[i] = 0.0;
    }
    plan->heat_law->advance(plan->heat_params, p->n, s->heat_dt, s->r.v + 8 * p->first + 7, 8, p->a + 7, 8,
                            s->r.inverse_capacity + p->first);
}

static void store_heat(const struct part *p, double dt)
{
    for (size_t i = 0; i < p->n; i++)
        p->s->r.heat_store[p->first + i] += p->a[8 * i + 7] * dt;
}

void CALX_ISA(calx_block_finish)(struct calx_sim *s, size_t block, const struct calx_pass *pass, double *a)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct calx_clock *clock = calx_timing_clock(s);
    struct part p;
    calx_v8 finite = {0};
    double largest = 0.0, moved2 = 0.0;
    calx_timing_restart(clock);
    collect_ghosts(s, b, a);
    if (b->carried_count)
        calx_carried_take(s, block, pass, a);
    part_begin(&p, s);
    calx_rows_kernel *both = b->carried_count ? NULL : between(&p, pass);
    for (size_t row = 0; row < (size_t)b->own; row += AT_A_TIME) {
        part_at(&p, b, row, a);
        finite = accelerate(&p, finite);
        if (both)
            both(s->plan->motion_params, &p.translation);
        else if (pass->stage >= 0)
            moved2 = fmax(moved2, after(&p, (size_t)pass->stage));
        if (pass->warm)
            warm(&p);
        else if (pass->store)
            store_heat(&p, pass->dt);
        if (b->carried_count)
            calx_carried_settle(s, b, p.first, p.n);
        if (pass->ahead) {
            double speed2 = both ? largest_speed2(&p) : before(&p, s->plan->motion_law->start);
            largest = speed2 > largest ? speed2 : largest;
        }
    }
    s->tallies[block].finite = calx_v8_sum(finite);
    s->tallies[block].speed2 = largest;
    s->tallies[block].moved2 = moved2;
    calx_timing_lap(clock, CALX_PHASE_INTEGRATE);
}

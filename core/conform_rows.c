/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Oscillators for the conformance of integrators of motion, see conform_rows.h: what the engine
 * does in motion.c and global.c, for a few bodies without contacts.
 */
#include "core/conform_rows.h"

#include <math.h>
#include <string.h>

void calx_oscillators_begin(struct calx_oscillators *s, size_t n, size_t stride, double dt,
                            bool spins)
{
    memset(s, 0, sizeof *s);
    s->r = (struct calx_rows){.size = sizeof s->r,
                              .n = n,
                              .stride = stride,
                              .dt = {dt, dt, 0, 0},
                              .x = spins ? NULL : s->x,
                              .v = s->v,
                              .a = s->a,
                              .extra = s->extra_of};
    s->omega = 1;
    s->spins = spins;
    for (size_t k = 0; k < CALX_OSCILLATOR_EXTRA; k++)
        s->extra_of[k] = s->extra[k];
    for (size_t i = 0; i < n; i++) {
        double phase = 0.3 * (double)i, *x = s->x + 4 * i, *v = s->v + i * stride;
        x[0] = cos(phase), x[1] = sin(phase), x[2] = 2, x[3] = 3;
        v[0] = spins ? 0 : -sin(phase), v[1] = spins ? 0 : cos(phase), v[2] = 5, v[3] = 7;
    }
}

void calx_oscillators_accelerate(struct calx_oscillators *s, double t)
{
    double wrong = ++s->evaluations == s->disturb ? 1e-3 : 0;
    for (size_t i = 0; i < s->r.n; i++)
        for (size_t k = 0; k < 2; k++) {
            size_t at = i * s->r.stride + k;
            double pull =
                -s->omega * s->omega * (s->x[4 * i + k] - s->shift) - s->damping * s->v[at];
            s->a[at] = wrong + (s->spins ? cos(t + (s->phase + 0.3 * (double)i)) : pull);
        }
}

static const struct calx_stage *table(const struct calx_oscillators *s, const struct calx_choice *c)
{
    return s->spins ? c->motion.rotation : c->motion.translation;
}

static void stage(struct calx_oscillators *s, const struct calx_choice *c, size_t k, double at)
{
    const struct calx_stage *stages = table(s, c);
    s->r.stage = k;
    if (stages[k].before)
        stages[k].before(c->params, &s->r);
    calx_oscillators_accelerate(s, s->time + at * s->r.dt[0]);
    if (stages[k].after)
        stages[k].after(c->params, &s->r);
}

void calx_oscillators_start(struct calx_oscillators *s, const struct calx_choice *c)
{
    calx_oscillators_accelerate(s, s->time);
    for (size_t k = 0; k < c->motion.start; k++)
        stage(s, c, k, c->motion.translation[k].time);
    if (c->motion.start)
        calx_oscillators_accelerate(s, s->time);
}

/* ---- the host of a global integrator ---- */

static struct calx_rows piece(const struct calx_oscillators *s, double dt, size_t i)
{
    struct calx_rows r = s->r;
    r.dt[0] = r.dt[1] = dt;
    if (!s->pieces)
        return r;
    r.n = 1;
    r.x = r.x ? r.x + 4 * i : NULL;
    r.v += r.stride * i;
    r.a += r.stride * i;
    return r;
}

/* The extra rows of body i, or of all. */
static void set_extra(struct calx_oscillators *s, size_t i)
{
    for (size_t k = 0; k < CALX_OSCILLATOR_EXTRA; k++)
        s->extra_of[k] = s->extra[k] + (s->pieces ? 4 * i : 0);
}

static void each(void *engine, double dt, calx_rows_kernel *translation, calx_rows_kernel *rotation,
                 const void *params)
{
    struct calx_oscillators *s = engine;
    calx_rows_kernel *kernel = s->spins ? rotation : translation;
    for (size_t i = 0; kernel && i < (s->pieces ? s->r.n : 1); i++) {
        struct calx_rows r = piece(s, dt, i);
        set_extra(s, i);
        kernel(params, &r);
    }
    set_extra(s, 0);
}

static double largest(void *engine, double dt,
                      double (*translation)(const void *, const struct calx_rows *),
                      double (*rotation)(const void *, const struct calx_rows *),
                      const void *params)
{
    struct calx_oscillators *s = engine;
    double (*measure)(const void *, const struct calx_rows *) = s->spins ? rotation : translation;
    double most = 0;
    for (size_t i = 0; measure && i < (s->pieces ? s->r.n : 1); i++) {
        struct calx_rows r = piece(s, dt, i);
        set_extra(s, i);
        double value = measure(params, &r);
        most = value > most || isnan(value) ? value : most;
    }
    set_extra(s, 0);
    return most;
}

static int forces(void *engine, const struct calx_evaluation *ask)
{
    struct calx_oscillators *s = engine;
    calx_oscillators_accelerate(s, ask->time);
    if (ask->keep) {
        s->failed |= !(fabs(ask->time - s->kept - ask->elapsed) <= 1e-12 * (1 + fabs(ask->time)));
        s->kept = ask->time;
    }
    return 0;
}

/* Nothing touches here, ever. */
static double change(void *engine, double time)
{
    (void)engine, (void)time;
    return INFINITY;
}

/* Nobody touches anybody: what is asked for in the place of impulses is the pull of the oscillators. */
static int contacts(void *engine, const struct calx_moments *at, struct calx_problem **problem)
{
    struct calx_oscillators *s = engine;
    s->moments = *at;
    s->problem = (struct calx_problem){.size = sizeof s->problem, .dt = s->r.dt[0]};
    *problem = &s->problem;
    return 0;
}

static int impulses(void *engine)
{
    struct calx_oscillators *s = engine;
    calx_oscillators_accelerate(s, s->moments.forces);
    s->kept = s->moments.velocities;
    return 0;
}

static void parallel(void *engine, size_t n, void (*part)(void *context, size_t first, size_t last), void *context)
{
    (void)engine;
    part(context, 0, n);
}

static void drive(struct calx_oscillators *s, const struct calx_choice *c)
{
    char why[256];
    double dt = s->r.dt[0];
    struct calx_motion_host host = {.size = sizeof host,
                                    .engine = s,
                                    .t = s->time,
                                    .dt = dt,
                                    .memory = s->memory,
                                    .each = each,
                                    .largest = largest,
                                    .forces = forces,
                                    .change = change,
                                    .contacts = contacts,
                                    .impulses = impulses,
                                    .parallel = parallel};
    s->kept = s->time;
    s->failed |= c->motion.advance(c->params, &host, why, sizeof why) != 0;
    s->failed |= !(s->kept >= s->time + dt);
}

void calx_oscillators_step(struct calx_oscillators *s, const struct calx_choice *c)
{
    size_t end = c->motion.start + c->motion.stages;
    if (!c->motion.stages)
        drive(s, c);
    for (size_t k = c->motion.start; k < end; k++)
        stage(s, c, k, k + 1 < end ? c->motion.translation[k].time : 1);
    s->time += s->r.dt[0];
}

void calx_oscillators_run(struct calx_oscillators *s, const struct calx_choice *c, size_t steps)
{
    calx_oscillators_start(s, c);
    for (size_t n = 0; n < steps; n++)
        calx_oscillators_step(s, c);
}

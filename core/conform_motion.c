/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance of an integrator of motion: its order, stability limit, reversibility and the
 * moment of its velocities measured on oscillators x'' = -x, for spins on w' = cos t; and the
 * contract of its rows: lanes without a step stay, no row depends on the others, a body may be
 * moved by a period of the domain, nothing is written beyond the range.
 */
#include <math.h>
#include <string.h>

#include "core/conform_parts.h"

enum { BODIES = 7, EXTRA_MAX = 8 };

/* The order is measured between 200 and 400 steps per period, where the next term of the error
 * changes it by less than 0.05. */
static const double ORDER_SLACK = 0.2;
/* The limit is found to 0.1 %; close to it growth needs thousands of steps to show. */
static const double LIMIT_SLACK = 0.02;
/* Velocities are compared with the exact ones at 400 steps per period: the lag is found to dt/2. */
static const double LAG_SLACK = 0.05;
/* 400 steps there and back: round-off of 1e-16 per step. */
static const double BACK = 1e-11;

/* Bodies in rows, as the engine keeps them. */
struct rows {
    struct calx_rows r;
    double x[4 * BODIES + 4], v[8 * BODIES + 8], a[8 * BODIES + 8];
    double extra[EXTRA_MAX][4 * BODIES + 4];
    double *extra_of[EXTRA_MAX];
    double omega;
    double time, phase; /* phase of the first body */
    bool spins;
};

static void rows_begin(struct rows *s, size_t n, size_t stride, double dt, bool spins)
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
    for (size_t k = 0; k < EXTRA_MAX; k++)
        s->extra_of[k] = s->extra[k];
    for (size_t i = 0; i < n; i++) {
        double phase = 0.3 * (double)i;
        s->x[4 * i] = cos(phase), s->x[4 * i + 1] = sin(phase), s->x[4 * i + 2] = 2,
                 s->x[4 * i + 3] = 3;
        double *v = s->v + i * stride;
        v[0] = spins ? 0 : -sin(phase), v[1] = spins ? 0 : cos(phase), v[2] = 5, v[3] = 7;
    }
}

/* The centre of body 0 may have been moved by `shift`. */
static void rows_accelerate(struct rows *s, double shift)
{
    for (size_t i = 0; i < s->r.n; i++)
        for (size_t k = 0; k < 2; k++)
            s->a[i * s->r.stride + k] = s->spins ? cos(s->time + (s->phase + 0.3 * (double)i))
                                                 : -s->omega * s->omega * (s->x[4 * i + k] - shift);
}

static void rows_step(struct rows *s, const struct calx_choice *c, double shift)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    const struct calx_stage *stages = s->spins ? law->rotation : law->translation;
    for (uint32_t k = 0; k < law->stages; k++) {
        if (stages[k].before)
            stages[k].before(c->params, &s->r);
        s->time += s->r.dt[0] / law->stages;
        rows_accelerate(s, shift);
        if (stages[k].after)
            stages[k].after(c->params, &s->r);
    }
}

static void rows_run(struct rows *s, const struct calx_choice *c, size_t steps)
{
    rows_accelerate(s, 0);
    for (size_t n = 0; n < steps; n++)
        rows_step(s, c, 0);
}

/* ---- accuracy ---- */

/* The error of position and velocity after a quarter more than a period, of which nothing is
 * special. */
static double error_after(const struct calx_choice *c, size_t steps, bool spins)
{
    struct rows s;
    double end = 2.5 * M_PI, worst = 0;
    rows_begin(&s, BODIES, 4, end / (double)steps, spins);
    rows_run(&s, c, steps);
    for (size_t i = 0; i < BODIES; i++) {
        double phase = 0.3 * (double)i;
        if (spins)
            worst = fmax(worst, fabs(s.v[4 * i] - (sin(end + phase) - sin(phase))));
        else
            worst =
                fmax(worst, hypot(s.x[4 * i] - cos(end + phase), s.v[4 * i] + sin(end + phase)));
    }
    return worst;
}

static void check_order(const struct calx_choice *c, struct calx_conformance *report, bool spins,
                        const char *name)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    double coarse = error_after(c, 250, spins), fine = error_after(c, 500, spins);
    /* beyond round-off an order cannot be seen */
    double lack = fine < 1e-12 ? 0 : law->order - log2(coarse / fine);
    calx_conform_note(report, name, fmax(lack, 0), ORDER_SLACK, c->where);
}

/* The velocity at a force evaluation, against that of `lag` steps before. Body 0 starts at rest, so
 * look where a is large: t = pi. */
static void check_lag(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    struct rows s;
    size_t steps = 200;
    if (law->stages != 1)
        return;
    rows_begin(&s, 1, 4, M_PI / (double)steps, false);
    rows_run(&s, c, steps - 1);
    if (law->translation->before)
        law->translation->before(c->params, &s.r);
    double lag = -s.v[0] / (1 * s.r.dt[0]); /* v(pi - lag dt) = -sin(pi - lag dt) = -lag dt */
    calx_conform_note(report, "velocities lag as declared", fabs(lag - law->velocity_lag),
                      LAG_SLACK, c->where);
}

/* ---- stability ---- */

static bool is_stable(const struct calx_choice *c, double omega_dt)
{
    struct rows s;
    rows_begin(&s, 1, 4, 1, false);
    s.omega = omega_dt;
    rows_accelerate(&s, 0);
    for (size_t n = 0; n < 4000; n++) {
        rows_step(&s, c, 0);
        if (!(fabs(s.x[0]) < 1e4))
            return false;
    }
    return true;
}

static void check_stability(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    double low = 0.5 * law->stability, high = 2 * law->stability;
    bool bracketed = is_stable(c, low) && !is_stable(c, high);
    for (int k = 0; k < 12; k++) {
        double middle = 0.5 * (low + high);
        if (is_stable(c, middle))
            low = middle;
        else
            high = middle;
    }
    calx_conform_note(report, "stability limit as declared",
                      bracketed ? fabs(low / law->stability - 1) : INFINITY, LIMIT_SLACK, c->where);
}

static void check_reversible(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    struct rows s, start;
    double worst = 0;
    if (!law->reversible)
        return;
    rows_begin(&s, BODIES, 4, 0.05, false);
    start = s;
    rows_run(&s, c, 400);
    memset(s.extra, 0, sizeof s.extra);
    for (size_t i = 0; i < BODIES; i++)
        s.v[4 * i] *= -1;
    rows_run(&s, c, 400);
    for (size_t i = 0; i < BODIES; i++)
        worst = fmax(worst, hypot(s.x[4 * i] - start.x[4 * i], s.v[4 * i] + start.v[4 * i]));
    calx_conform_note(report, "comes back when velocities are turned", worst, BACK, c->where);
}

/* ---- rows ---- */

/* Lanes whose step is 0, and everything beyond the range, keep their bits; extra rows beyond those
 * declared too. */
static void check_lanes(const struct calx_choice *c, struct calx_conformance *report, bool spins)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    struct rows s, start;
    size_t count = 0, extra = spins ? law->extra_rotation : law->extra_translation;
    rows_begin(&s, BODIES, 8, 0.05, spins);
    start = s;
    rows_run(&s, c, 3);
    for (size_t i = 0; i < BODIES; i++)
        for (size_t k = 2; k < 4; k++)
            count += s.x[4 * i + k] != start.x[4 * i + k] || s.v[8 * i + k] != start.v[8 * i + k];
    for (size_t i = 0; i < BODIES; i++)
        for (size_t k = 4; k < 8; k++)
            count += s.v[8 * i + k] != start.v[8 * i + k];
    for (size_t k = 0; k < EXTRA_MAX; k++)
        for (size_t i = k < extra ? 4 * BODIES : 0; i < 4 * BODIES + 4; i++)
            count += s.extra[k][i] != 0;
    for (size_t i = 0; i < 4; i++)
        count += s.x[4 * BODIES + i] != 0 || s.v[8 * BODIES + i] != 0;
    calx_conform_note(report, "lanes without a step and rows of others stay", (double)count, 0,
                      c->where);
}

/* All bodies in one range, and each alone: the same bits. */
static void check_ranges(const struct calx_choice *c, struct calx_conformance *report, bool spins)
{
    struct rows all, one;
    size_t count = 0;
    rows_begin(&all, BODIES, 8, 0.05, spins);
    rows_run(&all, c, 5);
    for (size_t i = 0; i < BODIES; i++) {
        rows_begin(&one, BODIES, 8, 0.05, spins);
        memcpy(one.x, one.x + 4 * i, 4 * sizeof(double));
        memcpy(one.v, one.v + 8 * i, 8 * sizeof(double));
        one.r.n = 1;
        one.phase = 0.3 * (double)i;
        rows_run(&one, c, 5);
        count += memcmp(one.x, all.x + 4 * i, 4 * sizeof(double)) != 0;
        count += memcmp(one.v, all.v + 8 * i, 8 * sizeof(double)) != 0;
    }
    calx_conform_note(report, "same bits in pieces", (double)count, 0, c->where);
}

/* Moved by a period halfway, a body goes on as before. */
static void check_shift(const struct calx_choice *c, struct calx_conformance *report)
{
    struct rows a, b;
    const double period = 8;
    rows_begin(&a, 1, 4, 0.05, false);
    rows_begin(&b, 1, 4, 0.05, false);
    rows_run(&a, c, 40);
    rows_run(&b, c, 20);
    b.x[0] += period;
    b.x[1] += period;
    for (int n = 0; n < 20; n++)
        rows_step(&b, c, period);
    double worst = fmax(fabs(b.x[0] - period - a.x[0]), fabs(b.v[0] - a.v[0]));
    calx_conform_note(report, "may be moved by a period", worst, 1e-13 * 20 * period, c->where);
}

void calx_conform_motion(struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *law = c->plugin->law;
    if (law->stages == 0 || law->extra_translation > EXTRA_MAX || law->extra_rotation > EXTRA_MAX) {
        calx_conform_note(report, "staged, with at most 8 rows of extra state", 1, 0, c->where);
        return;
    }
    check_order(c, report, false, "order of motion as declared");
    check_order(c, report, true, "order of spin as declared");
    check_lag(c, report);
    check_stability(c, report);
    check_reversible(c, report);
    check_shift(c, report);
    for (int spins = 0; spins < 2; spins++) {
        check_lanes(c, report, spins);
        check_ranges(c, report, spins);
    }
}

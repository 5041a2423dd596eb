/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance of an integrator of motion: its order, the moments of its positions and
 * velocities, reversibility, measured on oscillators x'' = -x, for spins on w' = cos t; and the
 * contract of its rows: lanes without a step stay, no row depends on the others, a body may be
 * moved by a period of the domain, nothing is written beyond the range. Stability and long times:
 * conform_stability.c.
 */
#include <math.h>
#include <string.h>

#include "core/conform_rows.h"

enum { BODIES = CALX_OSCILLATORS, EXTRA_MAX = CALX_OSCILLATOR_EXTRA, HALVINGS = 5 };

/* The line through the errors of 50 to 1600 steps per period: the next term changes its slope by
 * less than 0.1. */
static const double ORDER_SLACK = 0.2;
/* Errors of round-off, which no step makes smaller: 1e-16 per step, over 2000 steps. */
static const double ROUND_OFF = 2e-13;
/* Moments are found to the share of the step by which positions and velocities are off: order dt,
 * here 1e-3 to 1.6e-2. */
static const double MOMENT_SLACK = 0.05;
/* 400 steps there and back: round-off of 1e-16 per step. */
static const double BACK = 1e-11;
/* Start stages may cost a few roundings of numbers up to 3. */
static const double START = 2e-15;

/* ---- accuracy ---- */

/* The error of position and velocity after a quarter more than a period, of which nothing is
 * special. */
static double error_after(const struct calx_choice *c, size_t steps, bool spins,
                          size_t *evaluations)
{
    struct calx_oscillators s;
    double end = 2.5 * M_PI, worst = 0;
    calx_oscillators_begin(&s, BODIES, 4, end / (double)steps, spins);
    calx_oscillators_run(&s, c, steps);
    for (size_t i = 0; i < BODIES; i++) {
        double phase = 0.3 * (double)i;
        double error = spins ? fabs(s.v[4 * i] - (sin(end + phase) - sin(phase)))
                             : hypot(s.x[4 * i] - cos(end + phase), s.v[4 * i] + sin(end + phase));
        worst = error > worst || isnan(error) ? error : worst;
    }
    *evaluations = s.evaluations;
    return s.failed ? NAN : worst;
}

/* Slope of the least-squares line through the first n logarithms of errors, one halving apart. */
static double fitted_order(const double *error, size_t n)
{
    double mean_x = 0.5 * (double)(n - 1), mean_y = 0, sxy = 0, sxx = 0;
    for (size_t k = 0; k < n; k++)
        mean_y -= log2(error[k]) / (double)n;
    for (size_t k = 0; k < n; k++) {
        sxy += ((double)k - mean_x) * (-log2(error[k]) - mean_y);
        sxx += ((double)k - mean_x) * ((double)k - mean_x);
    }
    return sxy / sxx;
}

/* Over five halvings, as far as round-off allows. A global integrator chooses sub-steps: its order
 * shows where twice the steps take twice the evaluations, because each is one sub-step. */
static double measured_order(const struct calx_choice *c, bool spins)
{
    double error[HALVINGS + 1], best = 0;
    size_t n = 0, evaluations[HALVINGS + 1], compared = 0;
    for (size_t k = 0; k <= HALVINGS; k++) {
        error[n] = error_after(c, (size_t)64 << k, spins, &evaluations[n]);
        if (isnan(error[n]))
            return NAN;
        n += error[n] > ROUND_OFF;
    }
    for (size_t k = 0; k + 1 < n && !c->motion.stages; k++)
        if (10 * evaluations[k + 1] > 19 * evaluations[k]) {
            best = fmax(best, log2(error[k] / error[k + 1]));
            compared++;
        }
    if (n < 2 || (!c->motion.stages && !compared))
        return INFINITY;
    return c->motion.stages ? fitted_order(error, n) : best;
}

static void check_order(const struct calx_choice *c, struct calx_conformance *report, bool spins,
                        const char *name)
{
    double lack = c->motion.order - measured_order(c, spins);
    calx_conform_note(report, name, isnan(lack) ? NAN : fmax(lack, 0), ORDER_SLACK, c->where);
}

/* The velocity at the last evaluation of a step against the derivative of the positions there: the
 * parabola through three of them gives it at any moment. Body 0 starts at rest, so look where a is
 * large: t = pi. */
static void check_lag(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s;
    size_t steps = 200, last = c->motion.start + c->motion.stages - 1;
    double dt = M_PI / (double)steps, x[3], v[3];
    calx_oscillators_begin(&s, 1, 4, dt, false);
    calx_oscillators_run(&s, c, steps - 1);
    for (size_t k = 0; k < 3; k++) {
        struct calx_oscillators at = s;
        for (size_t q = 0; q < EXTRA_MAX; q++)
            at.extra_of[q] = at.extra[q];
        at.r.x = at.x, at.r.v = at.v, at.r.a = at.a, at.r.extra = at.extra_of;
        for (size_t stage = c->motion.start; stage <= last; stage++) {
            at.r.stage = stage;
            if (c->motion.translation[stage].before)
                c->motion.translation[stage].before(c->params, &at.r);
            if (stage == last)
                break;
            calx_oscillators_accelerate(&at, at.time);
            if (c->motion.translation[stage].after)
                c->motion.translation[stage].after(c->params, &at.r);
        }
        x[k] = at.x[0], v[k] = at.v[0];
        calx_oscillators_step(&s, c);
    }
    double lag = (0.5 * (x[2] - x[0]) - v[1] * dt) / (x[2] - 2 * x[1] + x[0]);
    calx_conform_note(report, "velocities lag as declared", fabs(lag - c->motion.velocity_lag),
                      MOMENT_SLACK, c->where);
}

/* Positions and velocities of trials against the moments that the table gives; and they are at the
 * start again after the stages of the start. */
static void check_moments(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s;
    double dt = 1e-3, worst = 0, back = 0;
    calx_oscillators_begin(&s, BODIES, 4, dt, false);
    calx_oscillators_accelerate(&s, 0);
    struct calx_oscillators start = s;
    for (size_t k = 0; k + 1 < c->motion.start + c->motion.stages; k++) {
        const struct calx_stage *stage = &c->motion.translation[k];
        s.r.stage = k;
        if (k == c->motion.start)
            calx_oscillators_accelerate(&s, 0);
        if (stage->before)
            stage->before(c->params, &s.r);
        for (size_t i = 2; i < 4; i++) { /* neither position nor velocity near 0 */
            double time = (s.x[4 * i] - start.x[4 * i]) / (start.v[4 * i] * dt);
            double ago = time - (s.v[4 * i] - start.v[4 * i]) / (start.a[4 * i] * dt);
            worst = fmax(worst, fmax(fabs(time - stage->time), fabs(ago - stage->lag)));
        }
        calx_oscillators_accelerate(&s, stage->time * dt);
        if (stage->after)
            stage->after(c->params, &s.r);
        for (size_t i = 0; i < 4 * BODIES && k + 1 == c->motion.start; i++)
            back = fmax(back, fmax(fabs(s.x[i] - start.x[i]), fabs(s.v[i] - start.v[i])));
    }
    if (c->motion.stages > 1 || c->motion.start)
        calx_conform_note(report, "trials are at the moments declared", worst, MOMENT_SLACK,
                          c->where);
    if (c->motion.start)
        calx_conform_note(report, "the start moves nobody", back, START, c->where);
}

static void check_reversible(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s, start;
    double worst = 0;
    if (!c->motion.reversible)
        return;
    calx_oscillators_begin(&s, BODIES, 4, 0.05, false);
    start = s;
    calx_oscillators_run(&s, c, 400);
    memset(s.extra, 0, sizeof s.extra);
    for (size_t i = 0; i < BODIES; i++)
        s.v[4 * i] *= -1;
    calx_oscillators_run(&s, c, 400);
    for (size_t i = 0; i < BODIES; i++)
        worst = fmax(worst, hypot(s.x[4 * i] - start.x[4 * i], s.v[4 * i] + start.v[4 * i]));
    calx_conform_note(report, "comes back when velocities are turned", worst, BACK, c->where);
}

/* Each of the evaluations of a step must matter: one that is wrong changes what comes. */
static void check_evaluations(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators right, wrong;
    size_t idle = 0;
    calx_oscillators_begin(&right, 1, 4, 0.05, false);
    calx_oscillators_run(&right, c, 3);
    for (size_t k = 1; k <= c->motion.stages; k++) {
        calx_oscillators_begin(&wrong, 1, 4, 0.05, false);
        wrong.disturb = (c->motion.start ? c->motion.start + 2 : 1) + k;
        calx_oscillators_run(&wrong, c, 3);
        idle += wrong.x[0] == right.x[0];
    }
    calx_conform_note(report, "each evaluation is used", (double)idle, 0, c->where);
}

/* ---- rows ---- */

/* Lanes whose step is 0, and everything beyond the range, keep their bits; extra rows beyond those
 * declared too. */
static void check_lanes(const struct calx_choice *c, struct calx_conformance *report, bool spins)
{
    struct calx_oscillators s, start;
    size_t count = 0, extra = spins ? c->motion.extra_rotation : c->motion.extra_translation;
    calx_oscillators_begin(&s, BODIES, 8, 0.05, spins);
    start = s;
    calx_oscillators_run(&s, c, 3);
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

/* Takes body i of the others as the only one. */
static void take_one(struct calx_oscillators *s, size_t i)
{
    memcpy(s->x, s->x + 4 * i, 4 * sizeof(double));
    memcpy(s->v, s->v + 8 * i, 8 * sizeof(double));
    s->r.n = 1;
    s->phase = 0.3 * (double)i;
}

/* All bodies in one range, and each alone: the same bits. Bodies that choose sub-steps together
 * stay together, in ranges of one. */
static void check_ranges(const struct calx_choice *c, struct calx_conformance *report, bool spins)
{
    struct calx_oscillators all, one;
    size_t count = 0;
    calx_oscillators_begin(&all, BODIES, 8, 0.05, spins);
    calx_oscillators_run(&all, c, 5);
    for (size_t i = 0; i < BODIES; i++) {
        size_t at = c->motion.stages ? 0 : i;
        calx_oscillators_begin(&one, BODIES, 8, 0.05, spins);
        one.pieces = !c->motion.stages;
        if (c->motion.stages)
            take_one(&one, i);
        calx_oscillators_run(&one, c, 5);
        count += memcmp(one.x + 4 * at, all.x + 4 * i, 4 * sizeof(double)) != 0;
        count += memcmp(one.v + 8 * at, all.v + 8 * i, 8 * sizeof(double)) != 0;
    }
    calx_conform_note(report, "same bits in pieces", (double)count, 0, c->where);
}

/* Moved by a period halfway, a body goes on as before. */
static void check_shift(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators a, b;
    const double period = 8;
    calx_oscillators_begin(&a, 1, 4, 0.05, false);
    calx_oscillators_begin(&b, 1, 4, 0.05, false);
    calx_oscillators_run(&a, c, 40);
    calx_oscillators_run(&b, c, 20);
    b.x[0] += period;
    b.x[1] += period;
    b.shift = period;
    for (int n = 0; n < 20; n++)
        calx_oscillators_step(&b, c);
    double worst = fmax(fabs(b.x[0] - period - a.x[0]), fabs(b.v[0] - a.v[0]));
    calx_conform_note(report, "may be moved by a period", worst, 1e-13 * 20 * period, c->where);
}

/* What `drifts` promises: in a step a body goes dt times the velocity that the kernel before
 * leaves, to rounding. */
static void check_drifts(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s;
    double worst = 0, dt = 0.05;
    calx_oscillators_begin(&s, BODIES, 4, dt, false);
    calx_oscillators_run(&s, c, 2);
    struct calx_oscillators before = s;
    c->motion.translation->before(c->params, &s.r);
    struct calx_oscillators moved = s;
    calx_oscillators_accelerate(&s, 3 * dt);
    if (c->motion.translation->after)
        c->motion.translation->after(c->params, &s.r);
    for (size_t i = 0; i < 4 * BODIES; i++) {
        double way = i % 4 < 2 ? dt * moved.v[i] : 0;
        worst = fmax(worst, fmax(fabs(moved.x[i] - before.x[i] - way), fabs(s.x[i] - moved.x[i])));
    }
    calx_conform_note(report, "bodies drift with their velocities as declared", worst, 1e-15,
                      c->where);
}

/* What `resolves_contacts` promises: an evaluation acts as one kick, dt times it, at the moment of
 * its positions. Here the second of four. */
static void check_kick(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s, start;
    double worst = 0, dt = 0.05;
    calx_oscillators_begin(&s, BODIES, 4, dt, false);
    start = s;
    for (int step = 0; step < 4; step++) {
        const struct calx_stage *stage = c->motion.translation;
        if (stage->before)
            stage->before(c->params, &s.r);
        for (size_t i = 0; i < BODIES; i++)
            s.a[4 * i] = step == 1 ? 1 : 0;
        if (stage->after)
            stage->after(c->params, &s.r);
    }
    for (size_t i = 0; i < BODIES; i++) {
        double way = s.x[4 * i] - start.x[4 * i] - 4 * dt * start.v[4 * i];
        worst = fmax(worst, fabs(s.v[4 * i] - start.v[4 * i] - dt));
        worst = fmax(worst, fabs(way - 2 * dt * dt));
    }
    calx_conform_note(report, "an evaluation is one kick at its moment", worst, 1e-14, c->where);
}

static void run_kernel(const struct calx_choice *c, calx_rows_kernel *kernel, const struct calx_rows *rows)
{
    if (kernel)
        kernel(c->params, rows);
}

/* Kernels of whole rows leave the bits that those of translation and rotation leave; they have no extra state, of which there would be two. */
static void check_whole(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *m = &c->motion;
    struct calx_oscillators s[2];
    size_t differ = m->extra_translation + m->extra_rotation, stages = m->start + m->stages;
    for (size_t k = 0; m->whole && k < 2 * stages; k++) {
        for (int whole = 0; whole < 2; whole++) {
            calx_oscillators_begin(&s[whole], BODIES, 8, 0.05, false);
            for (size_t i = 0; i < 8 * BODIES; i++) {
                s[whole].v[i] = sin(1.0 + (double)i);
                s[whole].a[i] = cos(2.0 + (double)i);
            }
        }
        const struct calx_stage *t = &m->translation[k / 2], *r = &m->rotation[k / 2], *w = &m->whole[k / 2];
        struct calx_rows translation = s[0].r, rotation = s[0].r, both = s[1].r;
        rotation.x = NULL;
        rotation.v += 4;
        rotation.a += 4;
        memcpy(both.dt + 4, rotation.dt, 4 * sizeof *both.dt);
        run_kernel(c, k % 2 ? t->after : t->before, &translation);
        run_kernel(c, k % 2 ? r->after : r->before, &rotation);
        run_kernel(c, k % 2 ? w->after : w->before, &both);
        for (size_t i = 0; i < 8 * BODIES; i++)
            differ += s[0].v[i] != s[1].v[i] || s[0].x[i / 2] != s[1].x[i / 2];
    }
    if (m->whole)
        calx_conform_note(report, "whole rows are the same as their halves", (double)differ, 0, c->where);
}

/* A kernel for the end of one step and the start of the next leaves the bits that the two leave. */
static void check_between(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *m = &c->motion;
    const struct calx_stage *tables[2] = {m->translation, m->whole};
    size_t differ = 0, found = 0;
    for (int whole = 0; whole < 2 && m->stages; whole++) {
        const struct calx_stage *first = tables[whole] ? &tables[whole][m->start] : NULL;
        const struct calx_stage *last = first ? first + m->stages - 1 : NULL;
        struct calx_oscillators s[2];
        if (!last || !last->between)
            continue;
        found++;
        for (int at_once = 0; at_once < 2; at_once++) {
            calx_oscillators_begin(&s[at_once], BODIES, 8, 0.05, false);
            for (size_t i = 0; i < 8 * BODIES; i++) {
                s[at_once].v[i] = sin(1.0 + (double)i);
                s[at_once].a[i] = cos(2.0 + (double)i);
            }
            for (size_t k = 4; k < 8 && whole; k++)
                s[at_once].r.dt[k] = s[at_once].r.dt[0];
            s[at_once].r.stage = at_once ? (size_t)(last - tables[whole]) : s[at_once].r.stage;
        }
        run_kernel(c, last->after, &s[0].r);
        run_kernel(c, first->before, &s[0].r);
        run_kernel(c, last->between, &s[1].r);
        for (size_t i = 0; i < 8 * BODIES; i++)
            differ += s[0].v[i] != s[1].v[i] || s[0].x[i / 2] != s[1].x[i / 2];
    }
    if (found)
        calx_conform_note(report, "two steps' kernels in one are the same", (double)differ, 0, c->where);
}

/* The descriptor, which catalogues show, says what the defaults give. */
static void check_descriptor(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *shown = c->plugin->law, *m = &c->motion;
    size_t wrong = (shown->order != m->order) + (shown->stages != m->stages) +
                   (shown->start != m->start) + (shown->reversible != m->reversible) +
                   (shown->symplectic != m->symplectic) + (shown->velocity_lag != m->velocity_lag);
    wrong += !(fabs(shown->stability / m->stability - 1) < 0.01) +
             !(fabs(shown->damping / m->damping - 1) < 0.01);
    if (c->where[0] == 0)
        calx_conform_note(report, "the descriptor is that of the defaults", (double)wrong, 0,
                          c->where);
}

void calx_conform_motion(struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *m = &c->motion;
    if (m->extra_translation > EXTRA_MAX || m->extra_rotation > EXTRA_MAX) {
        calx_conform_note(report, "at most 8 rows of extra state", 1, 0, c->where);
        return;
    }
    check_descriptor(c, report);
    check_order(c, report, false, "order of motion as declared");
    check_order(c, report, true, "order of spin as declared");
    if (m->stages) {
        check_lag(c, report);
        check_moments(c, report);
        check_evaluations(c, report);
    }
    if (m->drifts && m->stages == 1 && !m->start && m->translation->before)
        check_drifts(c, report);
    if (m->resolves_contacts)
        check_kick(c, report);
    check_whole(c, report);
    check_between(c, report);
    check_reversible(c, report);
    check_shift(c, report);
    for (int spins = 0; spins < 2; spins++) {
        check_lanes(c, report, spins);
        check_ranges(c, report, spins);
    }
    calx_conform_stability(c, report);
}

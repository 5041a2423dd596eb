/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Velocity Verlet that is right for FAULT NONE, and in two half steps for TWO, and breaks one rule
 * of the contract for each other. For tests only.
 */
#include <stddef.h>

#include "core/plugin.h"

enum {
    NONE,
    ORDER,
    SPIN,
    LAG,
    LIMIT,
    BACK,
    PERIOD,
    LANES,
    PIECES,
    BEYOND,
    DRIFT,
    DAMPING,
    DAMPED,
    DRIFTS,
    START,
    TWO,
    MOMENT,
    IDLE,
    SHOWN,
    WHOLE,
    KICK,
    RESOLVES,
    BETWEEN
};

enum { HALVES = FAULT == TWO || FAULT == MOMENT ? 2 : 1 };

static void kick(const struct calx_rows *r, double share)
{
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++) {
            double *v = &r->v[i * r->stride + k];
            *v += share / HALVES * r->dt[k] * r->a[i * r->stride + k];
            if (FAULT == BACK && k < 2)
                *v *= 1 - 1e-9;
            if (FAULT == DRIFT && k < 2)
                *v *= 1 - 2e-15;
            if (FAULT == PIECES && k < 2)
                *v *= 1 + 1e-15 * (double)r->n;
        }
}

static void before(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, FAULT == ORDER ? 1 : FAULT == KICK ? 0.5 + 1e-9 : 0.5);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++) {
            r->x[4 * i + k] += r->dt[k] / HALVES * r->v[i * r->stride + k];
            if (FAULT == PERIOD)
                r->x[4 * i + k] -= 1e-12 * r->x[4 * i + k] * (k < 2);
            if (FAULT == LANES && k == 3)
                r->x[4 * i + k] = 0;
        }
    if (FAULT == BEYOND)
        r->x[4 * r->n] = 1;
}

static void after(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, FAULT == ORDER ? 0 : 0.5);
    for (size_t i = 0; i < r->n && FAULT == DRIFTS; i++)
        r->x[4 * i] += 1e-9 * r->dt[0];
}

/* Both half kicks rounded as one. */
static void both(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, 1);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
}

static void spin_before(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, FAULT == SPIN ? 1 : 0.5);
}

static void spin_after(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, FAULT == SPIN ? 0 : 0.5);
}

#if FAULT == 14 /* START */
static void nudge(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n && r->x; i++)
        r->x[4 * i] += 1e-12;
}
#endif

static const struct calx_stage translation[] = {
#if FAULT == 14
    {.after = nudge},
#endif
#if FAULT == 17 /* IDLE: evaluated twice at the same place */
    {.before = before, .time = 1, .lag = 0.5},
    {.after = after, .between = FAULT == BETWEEN ? both : NULL},
#else
    {.before = before, .after = after, .between = FAULT == BETWEEN ? both : NULL, .time = FAULT == MOMENT ? 0.7 : 0.5,
     .lag = 0.25},
#endif
    {.before = before, .after = after}};
static const struct calx_stage rotation[] = {
#if FAULT == 14
    {.after = nudge},
#endif
#if FAULT == 17
    {.before = spin_before, .time = 1},
    {.after = spin_after},
#else
    {.before = spin_before, .after = spin_after},
#endif
    {.before = spin_before, .after = spin_after}};

/* Both halves, the second a little too much. */
static void kick_all(const struct calx_rows *r)
{
    for (size_t i = 0; i < 8 * r->n; i++)
        r->v[i] += 0.5 * r->dt[i % 8] * r->a[i] * (i % 8 == 4 ? 1 + 1e-15 : 1);
}

static void all_before(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_all(r);
    for (size_t i = 0; i < 4 * r->n; i++)
        r->x[i] += r->dt[i % 4] * r->v[i / 4 * 8 + i % 4];
}

static void all_after(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_all(r);
}

static const struct calx_stage whole[] = {{.before = all_before, .after = all_after}};

static int prepare(const struct calx_setup *setup, void *params,
                   struct calx_motion_integrator *actual, char *why, size_t why_size)
{
    (void)setup, (void)params, (void)why, (void)why_size;
    actual->order = FAULT == SHOWN ? 1 : actual->order;
    return 0;
}

static const struct calx_motion_integrator law = {.order = 2,
                                                  .stages = FAULT == IDLE ? 2 : HALVES,
                                                  .reversible = 1,
                                                  .symplectic = 1,
                                                  .drifts = HALVES == 1 && FAULT != IDLE,
                                                  .start = FAULT == START,
                                                  .stability = FAULT == LIMIT ? 2.2 : 2 * HALVES,
                                                  .damping = FAULT == DAMPING  ? 2.2
                                                             : FAULT == DAMPED ? 40
                                                                               : 2 * HALVES,
                                                  .velocity_lag = FAULT == LAG || FAULT == RESOLVES ? 0 : 0.5 / HALVES,
                                                  .resolves_contacts = FAULT == KICK || FAULT == RESOLVES,
                                                  .translation = translation,
                                                  .rotation = rotation,
                                                  .whole = FAULT == WHOLE ? whole : NULL,
                                                  .prepare = prepare};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_MOTION,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "x(n+1) = x(n) + v dt",
                                                    .law = &law};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Velocity Verlet that is right for FAULT NONE and breaks one rule of the contract for each other.
 * For tests only.
 */
#include <stddef.h>

#include "core/plugin.h"

enum { NONE, ORDER, SPIN, LAG, LIMIT, BACK, PERIOD, LANES, PIECES, BEYOND };

static void kick(const struct calx_rows *r, double share)
{
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++) {
            double *v = &r->v[i * r->stride + k];
            *v += share * r->dt[k] * r->a[i * r->stride + k];
            if (FAULT == BACK && k < 2)
                *v *= 1 - 1e-9;
            if (FAULT == PIECES && k < 2)
                *v *= 1 + 1e-15 * (double)r->n;
        }
}

static void before(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r, FAULT == ORDER ? 1 : 0.5);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++) {
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
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

static const struct calx_stage translation[] = {{before, after}},
                               rotation[] = {{spin_before, spin_after}};

static const struct calx_motion_integrator law = {.order = 2,
                                                  .stages = 1,
                                                  .reversible = 1,
                                                  .stability = FAULT == LIMIT ? 2.2 : 2,
                                                  .velocity_lag = FAULT == LAG ? 0 : 0.5,
                                                  .translation = translation,
                                                  .rotation = rotation};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_MOTION,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "x(n+1) = x(n) + v dt",
                                                    .law = &law};

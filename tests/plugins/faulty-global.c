/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Velocity Verlet as a global integrator of two half steps, right for FAULT NONE, that breaks one
 * rule of the contract for each other. For tests only.
 */
#include <stddef.h>

#include "core/plugin.h"

enum { NONE, UNKEPT, ELAPSED, LONGEST };

static void kick(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->v[i * r->stride + k] += 0.5 * r->dt[k] * r->a[i * r->stride + k];
}

static void move(const void *params, const struct calx_rows *r)
{
    kick(params, r);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
}

static int advance(const void *params, const struct calx_motion_host *host, char *why,
                   size_t why_size)
{
    double h = 0.5 * host->dt;
    (void)why, (void)why_size;
    for (int half = 1; half <= 2; half++) {
        struct calx_evaluation end = {.time = half == 1 ? host->t + h : host->t + host->dt,
                                      .lag = 0.5 * h,
                                      .elapsed = FAULT == ELAPSED ? host->dt : h,
                                      .keep = FAULT != UNKEPT || half == 1};
        host->each(host->engine, h, move, kick, params);
        if (host->forces(host->engine, &end))
            return 1;
        host->each(host->engine, h, kick, kick, params);
    }
    return 0;
}

static const struct calx_motion_integrator law = {.order = 2,
                                                  .stability = FAULT == LONGEST ? 5 : 3.9,
                                                  .damping = 3.9,
                                                  .velocity_lag = 0.5,
                                                  .advance = advance};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_MOTION,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "x(n+1) = x(n) + v dt",
                                                    .law = &law};

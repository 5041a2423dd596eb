/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The explicit step of temperature that is right for FAULT NONE and breaks one rule of the contract
 * for each other. For tests only.
 */
#include <stddef.h>

#include "core/plugin.h"

enum { NONE, ORDER, HEAT, REST, LIMIT, ANY_STEP, SOLVER, EXACT };

static void advance(const void *params, size_t n, double dt, double *temperature,
                    size_t temperature_stride, const double *q, size_t q_stride,
                    const double *inverse_capacity)
{
    (void)params;
    for (size_t i = 0; i < n; i++) {
        double *t = &temperature[i * temperature_stride];
        *t += dt * q[i * q_stride] * inverse_capacity[i];
        *t *= FAULT == REST ? 1 + 1e-10 : 1;
        *t += FAULT == HEAT ? 1e-9 * q[i * q_stride] * q[i * q_stride] : 0;
    }
}

static int solve(const void *params, const struct calx_network *net, char *why, size_t why_size)
{
    (void)params, (void)net, (void)why, (void)why_size;
    return 1;
}

static const struct calx_temperature_integrator law = {.order = FAULT == ORDER ? 2 : 1,
                                                       .exact = FAULT == EXACT,
                                                       .unconditional = FAULT == ANY_STEP,
                                                       .stability = FAULT == LIMIT ? 2.2 : 2,
                                                       .advance = FAULT == SOLVER ? NULL : advance,
                                                       .solve = FAULT == SOLVER ? solve : NULL};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX, .kind = CALX_TEMPERATURE,  .name = "faulty", .summary = "for tests",
    .reference = "none",    .equation = "T += dt q/C", .law = &law};

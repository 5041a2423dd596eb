/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator of temperature "heat-euler": the explicit step T += dt q/C, q the net heat flow into
 * the body. Reference: any textbook; Vargas and McCarthy, AIChE Journal 47 (2001) 1052, for grains.
 * First order; stable for lambda dt < 2 with lambda the fastest decay rate of the network, and
 * without new extremes of temperature for dt sum H <= C in each body.
 */
#include "core/plugin.h"

CALX_KERNEL static void warm(size_t n, double dt, double *restrict temperature,
                             size_t temperature_stride, const double *restrict q, size_t q_stride,
                             const double *restrict inverse_capacity)
{
    for (size_t i = 0; i < n; i++)
        temperature[i * temperature_stride] += dt * q[i * q_stride] * inverse_capacity[i];
}

static void advance(const void *params, size_t n, double dt, double *temperature,
                    size_t temperature_stride, const double *q, size_t q_stride,
                    const double *inverse_capacity)
{
    (void)params;
    warm(n, dt, temperature, temperature_stride, q, q_stride, inverse_capacity);
}

static const struct calx_temperature_integrator law = {
    .order = 1, .stability = 2, .advance = advance};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_TEMPERATURE,
    .name = "heat-euler",
    .summary = "explicit, first order",
    .reference = "Vargas and McCarthy, AIChE Journal 47 (2001) 1052",
    .equation = "T(n+1) = T(n) + dt q/C",
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "euler": the explicit step, for comparison with what is better. Reference: Hairer,
 * Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sec. I.7. First order; the
 * energy of an oscillator grows by 1 + (omega dt)^2 in each step, twofold within a period for omega
 * dt = 0.11. As v(n+1) = v(n) + a(x(n)) dt and x(n+1) = x(n) + v(n) dt, velocities are those of
 * half a step after the positions.
 */
#include "core/plugin.h"

CALX_KERNEL static void kick(size_t n, size_t stride, const double *restrict dt, double *restrict v,
                             const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += dt[k] * a[i * stride + k];
}

CALX_KERNEL static void drift(size_t n, size_t stride, const double *restrict dt,
                              double *restrict x, const double *restrict v)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] * v[i * stride + k];
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r->n, r->stride, r->dt, r->v, r->a);
}

static void move(const void *params, const struct calx_rows *r)
{
    drift(r->n, r->stride, r->dt, r->x, r->v);
    turn(params, r);
}

static const struct calx_stage translation[] = {{.before = move}};
static const struct calx_stage rotation[] = {{.before = turn}};

static const struct calx_motion_integrator law = {
    .order = 1,
    .stages = 1,
    .stability = 0.1106,
    .damping = 2,
    .velocity_lag = -0.5,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "euler",
    .summary = "explicit, first order: gains energy, for comparison",
    .reference =
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sec. I.7",
    .equation = "x += v dt;  v += a dt;  a = a(x, v)",
    .law = &law,
};

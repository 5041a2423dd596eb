/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "symplectic-euler": a kick, then a drift with the new velocity. Reference: Hairer,
 * Lubich and Wanner, Geometric Numerical Integration (2006), sec. I.1.2. First order, symplectic,
 * one force evaluation per step, stable for omega dt < 2. Its positions are those of
 * velocity-verlet for a start half a kick earlier: velocities lag them by half a step.
 */
#include "core/plugin.h"

CALX_KERNEL static void kick(size_t n, size_t stride, const double *restrict dt, double *restrict v,
                             const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += dt[k] * a[i * stride + k];
}

CALX_KERNEL static void kick_and_drift(size_t n, size_t stride, const double *restrict dt,
                                       double *restrict x, double *restrict v,
                                       const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double full = v[i * stride + k] + dt[k] * a[i * stride + k];
            v[i * stride + k] = full;
            x[4 * i + k] += dt[k] * full;
        }
}

static void move(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_and_drift(r->n, r->stride, r->dt, r->x, r->v, r->a);
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r->n, r->stride, r->dt, r->v, r->a);
}

static const struct calx_stage translation[] = {{.before = move}};
static const struct calx_stage rotation[] = {{.before = turn}};

static const struct calx_motion_integrator law = {
    .order = 1,
    .stages = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "symplectic-euler",
    .summary = "first order, symplectic, one force evaluation per step",
    .reference = "Hairer, Lubich and Wanner, Geometric Numerical Integration (2006), sec. I.1.2",
    .equation = "v += a dt;  x += v dt;  a = a(x, v)",
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "adams-bashforth-2": y(n+1) = y(n) + dt (3/2 y'(n) - 1/2 y'(n-1)) for positions, y' =
 * v, and velocities, y' = a; the first step is Euler's. Kept per body are v and a of the step
 * before. Reference: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993),
 * sec. III.1. Second order, one force evaluation per step; the energy of an oscillator doubles
 * within a period for omega dt = 0.506; a damper alone is stable for c/m dt <= 1.
 */
#include "core/plugin.h"

/* Euler's step comes first: old = rate of bodies that have no old one, the fourth number of old tells. */
static void begin(size_t n, size_t stride, const double *rate, double *old)
{
    for (size_t i = 0; i < n; i++) {
        if (old[4 * i + 3] > 0)
            continue;
        for (size_t k = 0; k < 3; k++)
            old[4 * i + k] = rate[i * stride + k];
        old[4 * i + 3] = 1;
    }
}

/* y += dt (3/2 rate - 1/2 old), old = rate; lanes without a step stay. */
CALX_KERNEL static void extrapolate(size_t n, size_t stride_y, size_t stride, const double *restrict dt, double *restrict y,
                                    const double *restrict rate, double *restrict old)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double now = rate[i * stride + k], before = old[4 * i + k];
            y[i * stride_y + k] += dt[k] * (1.5 * now - 0.5 * before);
            old[4 * i + k] = dt[k] > 0 ? now : before;
        }
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    begin(r->n, r->stride, r->a, r->extra[0]);
    extrapolate(r->n, r->stride, r->stride, r->dt, r->v, r->a, r->extra[0]);
}

static void move(const void *params, const struct calx_rows *r)
{
    begin(r->n, r->stride, r->v, r->extra[1]);
    extrapolate(r->n, 4, r->stride, r->dt, r->x, r->v, r->extra[1]);
    turn(params, r);
}

static const struct calx_stage translation[] = {{.before = move}};
static const struct calx_stage rotation[] = {{.before = turn}};
static const char *const extra[] = {"old-acceleration", "old-velocity"};

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .stability = 0.5057,
    .damping = 1,
    .constant_step = 1,
    .extra_translation = 2,
    .extra_rotation = 1,
    .extra = extra,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "adams-bashforth-2",
    .summary = "second order from two steps, explicit",
    .reference =
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sec. III.1",
    .equation = "x += dt (3 v(n) - v(n-1))/2;  v += dt (3 a(n) - a(n-1))/2;  a = a(x, v)",
    .law = &law,
};

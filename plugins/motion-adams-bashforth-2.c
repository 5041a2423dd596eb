/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "adams-bashforth-2": y(n+1) = y(n) + dt (3/2 y'(n) - 1/2 y'(n-1)) for positions, y' =
 * v, and velocities, y' = a; the first step is Euler's. Kept per body are v and a of the step
 * before. Reference: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993),
 * sec. III.1. Second order, one force evaluation per step; the energy of an oscillator doubles
 * within a period for omega dt = 0.506; a damper alone is stable for c/m dt <= 1.
 */
#include "core/plugin.h"

/* y += dt (3/2 rate - 1/2 old), old = rate, for one body; the fourth number of old tells whether
 * there is one. */
static inline void extrapolate(const double *restrict dt, double *restrict y,
                               const double *restrict rate, double *restrict old)
{
    double share = old[3] != 0 ? 0.5 : 0;
    for (int k = 0; k < 3; k++) {
        y[k] += dt[k] * ((1 + share) * rate[k] - share * old[k]);
        old[k] = rate[k];
    }
    old[3] = 1;
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        extrapolate(r->dt, r->v + i * r->stride, r->a + i * r->stride, r->extra[0] + 4 * i);
}

static void move(const void *params, const struct calx_rows *r)
{
    for (size_t i = 0; i < r->n; i++)
        extrapolate(r->dt, r->x + 4 * i, r->v + i * r->stride, r->extra[1] + 4 * i);
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

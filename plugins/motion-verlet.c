/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "verlet": Stoermer's rule on positions alone, x(n+1) = 2 x(n) - x(n-1) + a dt^2, for
 * spins on angles. Reference: Verlet, Phys. Rev. 159 (1967) 98; as in the Tiaret thesis, started
 * with x1 = x0 + v0 dt + a0 dt^2/2. Kept per body is the displacement u = x(n) - x(n-1), not
 * x(n-1), so that a body may be moved by a period of the domain. The velocity is the difference
 * u/dt that laws see, and at the end of the step (x(n+1) - x(n-1))/(2 dt) = u/dt + a dt/2. Second
 * order, reversible, one force evaluation per step, stable for omega dt < 2.
 */
#include <stddef.h>

#include "core/plugin.h"

/* One body. The fourth number of u is the step it was made with: when it differs (at the start, or
 * after a change of step) the displacement is begun anew from the velocity. v becomes u/dt. */
static inline void advance(const double *restrict dt, double step, double *restrict v,
                           const double *restrict a, double *restrict u)
{
    int start = u[3] != step;
    for (int k = 0; k < 3; k++) {
        double before = start ? v[k] * dt[k] - 0.5 * a[k] * dt[k] * dt[k] : u[k];
        u[k] = before + a[k] * dt[k] * dt[k];
        v[k] = dt[k] > 0 ? u[k] / dt[k] : v[k];
    }
    u[3] = step;
}

/* The step itself: dt is 0 in lanes that do not move. */
static double longest(const double *dt)
{
    double step = dt[0] > dt[1] ? dt[0] : dt[1];
    return step > dt[2] ? step : dt[2];
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        advance(r->dt, longest(r->dt), r->v + i * r->stride, r->a + i * r->stride,
                r->extra[0] + 4 * i);
}

static void move(const void *params, const struct calx_rows *r)
{
    turn(params, r);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            r->x[4 * i + k] += r->extra[0][4 * i + k];
}

static void finish(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            r->v[i * r->stride + k] += 0.5 * r->dt[k] * r->a[i * r->stride + k];
}

static const struct calx_stage translation[] = {{.before = move, .after = finish}};
static const struct calx_stage rotation[] = {{.before = turn, .after = finish}};
static const char *const extra[] = {"displacement"};

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .reversible = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .extra_translation = 1,
    .extra_rotation = 1,
    .extra = extra,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "verlet",
    .summary = "Stoermer's rule: positions from the two before",
    .reference = "Verlet, Phys. Rev. 159 (1967) 98",
    .equation = "x(n+1) = 2 x(n) - x(n-1) + a dt^2;  x1 = x0 + v0 dt + a0 dt^2/2;  v(n) = (x(n+1) "
                "- x(n-1))/(2 dt)",
    .law = &law,
};

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

/* The displacement that a step began with, from the velocity: of bodies whose u was not made with this step, at the start or after a
 * change of it. The fourth number of u is the step it was made with. */
static void begin(size_t n, size_t stride, double step, const double *dt, const double *v, const double *a, double *u)
{
    for (size_t i = 0; i < n; i++) {
        if (u[4 * i + 3] == step)
            continue;
        for (size_t k = 0; k < 3; k++)
            u[4 * i + k] = v[i * stride + k] * dt[k] - 0.5 * a[i * stride + k] * dt[k] * dt[k];
        u[4 * i + 3] = step;
    }
}

/* u goes on, v becomes u/dt; lanes without a step stay. */
CALX_KERNEL static void advance(size_t n, size_t stride, const double *restrict dt, double *restrict v, const double *restrict a,
                                double *restrict u)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double next = u[4 * i + k] + a[i * stride + k] * dt[k] * dt[k];
            v[i * stride + k] = dt[k] > 0 ? next / dt[k] : v[i * stride + k];
            u[4 * i + k] = next;
        }
}

CALX_KERNEL static void go(size_t n, const double *restrict dt, double *restrict x, const double *restrict u)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] > 0 ? u[4 * i + k] : 0;
}

CALX_KERNEL static void half_kick(size_t n, size_t stride, const double *restrict dt, double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += 0.5 * dt[k] * a[i * stride + k];
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
    begin(r->n, r->stride, longest(r->dt), r->dt, r->v, r->a, r->extra[0]);
    advance(r->n, r->stride, r->dt, r->v, r->a, r->extra[0]);
}

static void move(const void *params, const struct calx_rows *r)
{
    turn(params, r);
    go(r->n, r->dt, r->x, r->extra[0]);
}

static void finish(const void *params, const struct calx_rows *r)
{
    (void)params;
    half_kick(r->n, r->stride, r->dt, r->v, r->a);
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

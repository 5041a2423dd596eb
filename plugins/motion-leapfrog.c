/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "leapfrog": velocities u live at half steps, u(n+1/2) = u(n-1/2) + a(n) dt, positions
 * at whole ones, x(n+1) = x(n) + u(n+1/2) dt; started with u(-1/2) = v(0) - a(0) dt/2. Reference:
 * Hockney and Eastwood, Computer Simulation Using Particles (1988), sec. 4-5; the scheme of Cundall
 * and Strack, Geotechnique 29 (1979) 47. Second order, symplectic, reversible, one force evaluation
 * per step, stable for omega dt < 2. Laws see u; at the end of a step v = u + a dt/2. The
 * trajectory is that of velocity-verlet up to rounding: u is carried on, not put together anew in
 * each step.
 */
#include "core/plugin.h"

/* u(-1/2) of bodies that have none: the fourth number of u tells. */
static void begin(size_t n, size_t stride, const double *dt, const double *v, const double *a, double *u)
{
    for (size_t i = 0; i < n; i++) {
        if (u[4 * i + 3] > 0)
            continue;
        for (size_t k = 0; k < 3; k++)
            u[4 * i + k] = v[i * stride + k] - 0.5 * dt[k] * a[i * stride + k];
        u[4 * i + 3] = 1;
    }
}

/* u goes on by a kick and becomes v; lanes without a step stay. */
CALX_KERNEL static void kick(size_t n, size_t stride, const double *restrict dt, double *restrict v, const double *restrict a,
                             double *restrict u)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double next = u[4 * i + k] + dt[k] * a[i * stride + k];
            v[i * stride + k] = dt[k] > 0 ? next : v[i * stride + k];
            u[4 * i + k] = next;
        }
}

CALX_KERNEL static void drift(size_t n, size_t stride, const double *restrict dt, double *restrict x, const double *restrict v)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] * v[i * stride + k];
}

CALX_KERNEL static void half_kick(size_t n, size_t stride, const double *restrict dt, double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += 0.5 * dt[k] * a[i * stride + k];
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    begin(r->n, r->stride, r->dt, r->v, r->a, r->extra[0]);
    kick(r->n, r->stride, r->dt, r->v, r->a, r->extra[0]);
}

static void move(const void *params, const struct calx_rows *r)
{
    turn(params, r);
    drift(r->n, r->stride, r->dt, r->x, r->v);
}

static void finish(const void *params, const struct calx_rows *r)
{
    (void)params;
    half_kick(r->n, r->stride, r->dt, r->v, r->a);
}

static const struct calx_stage translation[] = {{.before = move, .after = finish}};
static const struct calx_stage rotation[] = {{.before = turn, .after = finish}};
static const char *const extra[] = {"half-step-velocity"};

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .reversible = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .constant_step = 1,
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
    .name = "leapfrog",
    .summary = "velocities at half steps, symplectic",
    .reference = "Hockney and Eastwood, Computer Simulation Using Particles (1988), sec. 4-5",
    .equation =
        "u(n+1/2) = u(n-1/2) + a(n) dt;  x(n+1) = x(n) + u(n+1/2) dt;  u(-1/2) = v(0) - a(0) "
        "dt/2;  v(n) = u(n-1/2) + a(n) dt/2",
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "contact-exact": the kicks and drifts of velocity-verlet (Swope et al., J. Chem. Phys. 76 (1982) 637),
 * with contacts that begin or end inside a step resolved by the engine (core/onset.c): there the sum of kicks is
 * corrected to the integral of a force that sets in as a power of time, by Navot, J. Math. and Phys. 40 (1961) 271.
 * Damping takes the velocity at the moment of the positions. Second order through collisions, damped or not, where
 * the jump of the force leaves other schemes at first; one force evaluation per step.
 */
#include "core/plugin.h"

CALX_KERNEL static void kick(size_t n, size_t stride, const double *restrict dt, double *restrict v,
                             const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += 0.5 * dt[k] * a[i * stride + k];
}

CALX_KERNEL static void kick_and_drift(size_t n, size_t stride, const double *restrict dt,
                                       double *restrict x, double *restrict v,
                                       const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double half = v[i * stride + k] + 0.5 * dt[k] * a[i * stride + k];
            v[i * stride + k] = half;
            x[4 * i + k] += dt[k] * half;
        }
}

/* Rows of eight: translation and spin. */
CALX_KERNEL static void kick_whole(size_t n, const double *restrict dt, double *restrict v,
                                   const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 8; k++)
            v[8 * i + k] += 0.5 * dt[k] * a[8 * i + k];
}

CALX_KERNEL static void drift(size_t n, size_t stride, const double *restrict dt,
                              double *restrict x, const double *restrict v)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] * v[i * stride + k];
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

static void move_whole(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_whole(r->n, r->dt, r->v, r->a);
    drift(r->n, r->stride, r->dt, r->x, r->v);
}

static void turn_whole(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_whole(r->n, r->dt, r->v, r->a);
}

static const struct calx_stage translation[] = {{.before = move, .after = turn}};
static const struct calx_stage rotation[] = {{.before = turn, .after = turn}};
static const struct calx_stage whole[] = {{.before = move_whole, .after = turn_whole}};

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .resolves_contacts = 1,
    .translation = translation,
    .rotation = rotation,
    .whole = whole,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "contact-exact",
    .summary = "velocity Verlet with onset and end of contacts resolved inside the step",
    .reference = "Swope, Andersen, Berens and Wilson, J. Chem. Phys. 76 (1982) 637; Navot, J. Math. and Phys. 40 (1961) 271",
    .equation = "v += a dt/2;  x += v dt;  a = a(x, v);  v += a dt/2;\n"
                "at onset and end of a contact dt sum F(t_k) is corrected to the integral of F for F ~ t^p, p = 0, 1/4, 1, 3/2",
    .law = &law,
};

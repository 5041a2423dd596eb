/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "yoshida": three steps of velocity-verlet of lengths w1 dt, w0 dt, w1 dt with w1 =
 * 1/(2 - 2^(1/3)) and w0 = 1 - 2 w1 < 0. Reference: Yoshida, Phys. Lett. A 150 (1990) 262. Fourth
 * order, symplectic and reversible for forces that do not use velocities, second order with
 * damping; three force evaluations per step, two of them trials beyond the end of the step and
 * before its start. Stable for omega dt < 1.573.
 */
#include "core/plugin.h"

#define W1 1.3512071919596578
#define W0 (1 - 2 * W1)

static const double part[] = {W1, W0, W1};

CALX_KERNEL static void kick(size_t n, size_t stride, double share, const double *restrict dt,
                             double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += 0.5 * share * dt[k] * a[i * stride + k];
}

CALX_KERNEL static void drift(size_t n, size_t stride, double share, const double *restrict dt,
                              double *restrict x, const double *restrict v)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += share * dt[k] * v[i * stride + k];
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r->n, r->stride, part[r->stage], r->dt, r->v, r->a);
}

static void move(const void *params, const struct calx_rows *r)
{
    turn(params, r);
    drift(r->n, r->stride, part[r->stage], r->dt, r->x, r->v);
}

static const struct calx_stage translation[] = {
    {.before = move, .after = turn, .time = W1, .lag = 0.5 * W1},
    {.before = move, .after = turn, .time = W1 + W0, .lag = 0.5 * W0},
    {.before = move, .after = turn}};
static const struct calx_stage rotation[] = {{.before = turn, .after = turn},
                                             {.before = turn, .after = turn},
                                             {.before = turn, .after = turn}};

static const struct calx_motion_integrator law = {
    .order = 4,
    .stages = 3,
    .reversible = 1,
    .symplectic = 1,
    .stability = 1.573,
    .damping = 1.239,
    .velocity_lag = 0.5 * W1,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "yoshida",
    .summary = "fourth order, symplectic, three force evaluations per step",
    .reference = "Yoshida, Phys. Lett. A 150 (1990) 262",
    .equation = "S(w1 dt) S(w0 dt) S(w1 dt), S a step of velocity-verlet;  w1 = 1/(2 - 2^(1/3)), "
                "w0 = 1 - 2 w1",
    .law = &law,
};

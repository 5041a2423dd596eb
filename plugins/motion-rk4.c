/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "rk4": the classical Runge-Kutta scheme for x' = v, v' = a(x, v, t). Reference:
 * Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sec. II.1. Fourth
 * order, four force evaluations per step, of which the last, at the end of the step, is the first
 * of the next; stable for omega dt < 2.828, c/m dt < 2.785. Not symplectic. Kept per body during
 * the step: v(t), the displacement since t (a body may be moved by a period of the domain), sums of
 * v and of a.
 */
#include "core/plugin.h"

enum { START, ACCELERATIONS, DISPLACEMENT, VELOCITIES }; /* of spins the first two */

/* Of the derivatives k1 .. k4: weight in the sum, and how far along them the next trial is. */
static const double weight[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6}, reach[] = {1. / 2, 1. / 2, 1, 0};

/* v and a are the derivatives number `stage`: adds them, and goes to the next trial or the end; first positions, by the velocities that there
 * are, then these. Lanes without a step stay. */
CALX_KERNEL static void gain(size_t n, size_t stride, size_t stage, const double *restrict dt, double *restrict v,
                             const double *restrict a, double *restrict start, double *restrict accelerations)
{
    double first = stage == 0 ? 0 : 1, last = stage == 3 ? 1 : 0, share = weight[stage], far = reach[stage];
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double now = v[i * stride + k], began = first > 0 ? start[4 * i + k] : now;
            double sum = first * accelerations[4 * i + k] + share * a[i * stride + k];
            double next = began + dt[k] * (last * sum + far * a[i * stride + k]);
            v[i * stride + k] = dt[k] > 0 ? next : now;
            start[4 * i + k] = began;
            accelerations[4 * i + k] = sum;
        }
}

CALX_KERNEL static void go(size_t n, size_t stride, size_t stage, const double *restrict dt, double *restrict x,
                           const double *restrict v, double *restrict displacement, double *restrict velocities)
{
    double first = stage == 0 ? 0 : 1, last = stage == 3 ? 1 : 0, share = weight[stage], far = reach[stage];
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double sum = first * velocities[4 * i + k] + share * v[i * stride + k];
            double way = dt[k] * (last * sum + far * v[i * stride + k]);
            x[4 * i + k] += way - first * displacement[4 * i + k];
            displacement[4 * i + k] = way;
            velocities[4 * i + k] = sum;
        }
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    gain(r->n, r->stride, r->stage, r->dt, r->v, r->a, r->extra[START], r->extra[ACCELERATIONS]);
}

static void move(const void *params, const struct calx_rows *r)
{
    go(r->n, r->stride, r->stage, r->dt, r->x, r->v, r->extra[DISPLACEMENT], r->extra[VELOCITIES]);
    turn(params, r);
}

#define STAGES(kernel)                                                                                                  \
    {                                                                                                                  \
        {.before = kernel, .time = 0.5}, {.before = kernel, .time = 0.5}, {.before = kernel, .time = 1}, {.before = kernel, .time = 1}  \
    }
static const struct calx_stage translation[] = STAGES(move), rotation[] = STAGES(turn);
static const char *const extra[] = {"start-velocity", "accelerations", "displacement",
                                    "velocities"};

static const struct calx_motion_integrator law = {
    .order = 4,
    .stages = 4,
    .stability = 2.828,
    .damping = 2.785,
    .extra_translation = 4,
    .extra_rotation = 2,
    .extra = extra,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "rk4",
    .summary = "the classical Runge-Kutta scheme, fourth order, four force evaluations per step",
    .reference =
        "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sec. II.1",
    .equation =
        "y = (x, v), y' = f(y, t): y += dt (k1 + 2 k2 + 2 k3 + k4)/6;  k1 = f(y), k2 = f(y + dt "
        "k1/2),\n"
        "k3 = f(y + dt k2/2), k4 = f(y + dt k3)",
    .law = &law,
};

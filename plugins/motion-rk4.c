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

enum { START, DISPLACEMENT, VELOCITIES, ACCELERATIONS };

/* Of the derivatives k1 .. k4: weight in the sum, and how far along them the next trial is. */
static const double weight[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6}, reach[] = {1. / 2, 1. / 2, 1, 0};

/* v and a are the derivatives number `stage`: adds them, and goes to the next trial or the end. */
static inline void go(const struct calx_rows *r, size_t i, size_t k)
{
    size_t at = 4 * i + k;
    double dt = r->dt[k], v = r->v[i * r->stride + k], a = r->a[i * r->stride + k];
    double first = r->stage == 0 ? 0 : 1, last = r->stage == 3 ? 1 : 0;
    double start = r->stage == 0 ? v : r->extra[START][at];
    double sum_v = first * r->extra[VELOCITIES][at] + weight[r->stage] * v;
    double sum_a = first * r->extra[ACCELERATIONS][at] + weight[r->stage] * a;
    double way = dt * (last * sum_v + reach[r->stage] * v);
    if (r->x)
        r->x[at] += way - first * r->extra[DISPLACEMENT][at];
    r->v[i * r->stride + k] = start + dt * (last * sum_a + reach[r->stage] * a);
    r->extra[START][at] = start;
    r->extra[DISPLACEMENT][at] = way;
    r->extra[VELOCITIES][at] = sum_v;
    r->extra[ACCELERATIONS][at] = sum_a;
}

static void before(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            if (r->dt[k] > 0)
                go(r, i, k);
}

static const struct calx_stage stages[] = {{.before = before, .time = 0.5},
                                           {.before = before, .time = 0.5},
                                           {.before = before, .time = 1},
                                           {.before = before, .time = 1}};
static const char *const extra[] = {"start-velocity", "displacement", "velocities",
                                    "accelerations"};

static const struct calx_motion_integrator law = {
    .order = 4,
    .stages = 4,
    .stability = 2.828,
    .damping = 2.785,
    .extra_translation = 4,
    .extra_rotation = 4,
    .extra = extra,
    .translation = stages,
    .rotation = stages,
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

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "newmark": x(n+1) = x + v dt + dt^2 ((1/2 - beta) a(n) + beta a(n+1)), v(n+1) = v + dt
 * ((1 - gamma) a(n) + gamma a(n+1)), with a(n+1) found by a fixed number of evaluations: predicted
 * as a(n), corrected after each. References: Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; the
 * correctors: Hughes, The Finite Element Method (1987), sec. 9.1. Second order for gamma = 1/2,
 * else first; beta = 0 with gamma = 1/2 is velocity-verlet whose laws see the velocity at the end
 * of the step. As the equations are not solved to the end, no step is too long to be unstable: the
 * limits are found from the map of one step of an oscillator, and of a damper alone.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/plugin.h"

enum { EVALUATIONS_MAX = 4 };

struct newmark {
    double beta, gamma, evaluations;
};

static const struct calx_parameter parameters[] = {
    {.name = "beta",
     .symbol = "beta",
     .unit = "1",
     .doc = "Share of the new acceleration in the position; 0: explicit.",
     .initial = 0,
     .min = 0,
     .max = 0.5,
     .scope = CALX_RUN,
     .offset = offsetof(struct newmark, beta)},
    {.name = "gamma",
     .symbol = "gamma",
     .unit = "1",
     .doc = "Share of the new acceleration in the velocity; above 1/2 fast modes are damped.",
     .initial = 0.5,
     .min = 0,
     .max = 1,
     .scope = CALX_RUN,
     .offset = offsetof(struct newmark, gamma)},
    {.name = "evaluations",
     .symbol = "m",
     .unit = "1",
     .doc = "Force evaluations per step, each followed by a correction.",
     .initial = 0,
     .min = 0,
     .max = EVALUATIONS_MAX - 1,
     .flags = CALX_CHOICE,
     .scope = CALX_RUN,
     .offset = offsetof(struct newmark, evaluations),
     .choices = "1|2|3|4"},
};

/* ---- the kernels ---- */

/* Lanes without a step stay: whatever their acceleration is, it is guessed right from then on. */
CALX_KERNEL static void predict_place(size_t n, size_t stride, const double *restrict dt, double *restrict x,
                                      const double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] * (v[i * stride + k] + 0.5 * dt[k] * a[i * stride + k]);
}

CALX_KERNEL static void predict(size_t n, size_t stride, const double *restrict dt, double *restrict v, const double *restrict a,
                                double *restrict guess)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            v[i * stride + k] += dt[k] * a[i * stride + k];
            guess[4 * i + k] = a[i * stride + k];
        }
}

CALX_KERNEL static void correct_place(size_t n, size_t stride, double beta, const double *restrict dt, double *restrict x,
                                      const double *restrict a, const double *restrict guess)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += beta * dt[k] * dt[k] * (a[i * stride + k] - guess[4 * i + k]);
}

CALX_KERNEL static void correct(size_t n, size_t stride, double gamma, const double *restrict dt, double *restrict v,
                                const double *restrict a, double *restrict guess)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            v[i * stride + k] += gamma * dt[k] * (a[i * stride + k] - guess[4 * i + k]);
            guess[4 * i + k] = a[i * stride + k];
        }
}

static void before(const void *params, const struct calx_rows *r)
{
    (void)params;
    if (r->stage > 0)
        return;
    if (r->x)
        predict_place(r->n, r->stride, r->dt, r->x, r->v, r->a);
    predict(r->n, r->stride, r->dt, r->v, r->a, r->extra[0]);
}

static void after(const void *params, const struct calx_rows *r)
{
    const struct newmark *p = params;
    if (r->x && p->beta > 0)
        correct_place(r->n, r->stride, p->beta, r->dt, r->x, r->a, r->extra[0]);
    correct(r->n, r->stride, p->gamma, r->dt, r->v, r->a, r->extra[0]);
}

static const struct calx_stage stages[EVALUATIONS_MAX] = {
    {.before = before, .after = after, .time = 1},
    {.before = before, .after = after, .time = 1},
    {.before = before, .after = after, .time = 1},
    {.before = before, .after = after, .time = 1}};

/* ---- limits ---- */

/* One step of x'' = -stiffness x - damping v of dt = 1; y = {x, v, a}. */
static void step(const struct newmark *p, double stiffness, double damping, double y[3])
{
    double guess = y[2];
    y[0] += y[1] + 0.5 * y[2];
    y[1] += y[2];
    for (int k = 0; k <= (int)p->evaluations; k++) {
        double a = -stiffness * y[0] - damping * y[1];
        y[0] += p->beta * (a - guess);
        y[1] += p->gamma * (a - guess);
        guess = a;
    }
    y[2] = guess;
}

/* Logarithm of the growth per step: of the size of the step's matrix to the power 2^14. Rows and
 * columns from `first` on. */
static double growth(const struct newmark *p, double stiffness, double damping, int first)
{
    enum { SQUARES = 14 };
    double m[3][3] = {{0}}, log_size = 0;
    for (int j = first; j < 3; j++) {
        double y[3] = {j == 0, j == 1, j == 2};
        step(p, stiffness, damping, y);
        for (int i = first; i < 3; i++)
            m[i][j] = y[i];
    }
    for (int n = 0; n < SQUARES; n++) {
        double square[3][3] = {{0}}, size = 1e-300;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                for (int k = 0; k < 3; k++)
                    square[i][j] += m[i][k] * m[k][j];
                size = fmax(size, fabs(square[i][j]));
            }
        for (int i = 0; i < 9; i++)
            m[i / 3][i % 3] = square[i / 3][i % 3] / size;
        log_size = 2 * log_size + log(size);
    }
    return log_size / (1 << SQUARES);
}

/* As core/plugin.h defines the limits: the energy less than doubles in a period, the damper brings
 * to rest. A matrix that does not grow has powers of at most some 1e4 elements: 1e-3 per step. */
static int is_stable(const struct newmark *p, double value, int damping)
{
    double bound = damping ? 1e-3 : value * log(2) / (4 * M_PI);
    return growth(p, damping ? 0 : value * value, damping ? value : 0, damping) <= bound;
}

/* The end of the interval from 0 on in which it is stable; 0 if there is none. */
static double limit(const struct newmark *p, int damping)
{
    const double stride = 0.02, most = 20;
    double low = 0, high = stride;
    while (high < most && is_stable(p, high, damping)) {
        low = high;
        high += stride;
    }
    for (int k = 0; k < 20; k++) {
        double middle = 0.5 * (low + high);
        if (is_stable(p, middle, damping))
            low = middle;
        else
            high = middle;
    }
    return low;
}

static int prepare(const struct calx_setup *setup, void *params, struct calx_motion_integrator *law,
                   char *why, size_t why_size)
{
    const struct newmark *p = params;
    const char *text =
        p->gamma < 0.5 ? "gamma below 1/2 makes every oscillation grow: give 0.5 (second "
                         "order) or more (damps fast modes)"
        : p->beta == 0 && p->evaluations > 0
            ? "with beta = 0 positions do not change after the first evaluation: give "
              "evaluations=\"1\", or beta"
            : NULL;
    (void)setup;
    if (text) {
        snprintf(why, why_size, "%s", text);
        return 1;
    }
    law->order = p->gamma == 0.5 ? 2 : 1;
    law->stages = (uint32_t)p->evaluations + 1;
    law->reversible = law->symplectic = p->gamma == 0.5 && p->beta == 0;
    law->stability = limit(p, 0);
    law->damping = limit(p, 1);
    return 0;
}

static const char *const extra[] = {"guess"};

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .reversible = 1,
    .symplectic = 1,
    .stability = 2,
    .damping = 1,
    .extra_translation = 1,
    .extra_rotation = 1,
    .extra = extra,
    .translation = stages,
    .rotation = stages,
    .prepare = prepare,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "newmark",
    .summary = "Newmark's scheme with a fixed number of corrections",
    .reference = "Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; Hughes, The Finite Element Method "
                 "(1987), sec. 9.1",
    .equation = "x(n+1) = x + v dt + dt^2 ((1/2 - beta) a(n) + beta a');  v(n+1) = v + dt ((1 - "
                "gamma) a(n) "
                "+ gamma a');\n"
                "a' = a(n), then m times a' = a(x(n+1), v(n+1))",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct newmark),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "cash-karp": an embedded Runge-Kutta pair of orders 5 and 4 that cuts the step into
 * sub-steps of its own, so that the error of each, the difference of the two, stays below a
 * tolerance for every body: short ones where contacts begin and end, one in free flight. Reference:
 * Cash and Karp, ACM Trans. Math. Softw. 16 (1990) 201; control: Hairer, Norsett and Wanner,
 * Solving Ordinary Differential Equations I (1993), sec. II.4. Each sub-step takes five trials and,
 * once it is accepted, the evaluation at its end, which is the first of the next. Positions by the
 * coefficients' product with themselves, so that accelerations and one velocity are all that is
 * kept. The time step is the longest sub-step, and all bodies have the same.
 */
#include <math.h>
#include <stdio.h>

#include "core/plugin.h"

enum { STAGES = 6 };
enum { START, DISPLACEMENT, FIRST, ROWS = FIRST + STAGES - 1 }; /* rows of extra state */

/* Where the stages are, and how they follow from those before; the last rows are the results of
 * order 5 and 4. */
static const double node[STAGES] = {0, 1. / 5, 3. / 10, 3. / 5, 1, 7. / 8};
static const double share[STAGES + 2][STAGES] = {
    {0},
    {1. / 5},
    {3. / 40, 9. / 40},
    {3. / 10, -9. / 10, 6. / 5},
    {-11. / 54, 5. / 2, -70. / 27, 35. / 27},
    {1631. / 55296, 175. / 512, 575. / 13824, 44275. / 110592, 253. / 4096},
    {37. / 378, 0, 250. / 621, 125. / 594, 0, 512. / 1771},
    {2825. / 27648, 0, 18575. / 48384, 13525. / 55296, 277. / 14336, 1. / 4}};

struct cash_karp {
    double tolerance;
    double twice[STAGES + 2][STAGES]; /* share times share: of accelerations in positions */
};

static const struct calx_parameter parameters[] = {
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Error of a sub-step, in the position and in the velocity times the time step, "
            "relative to the radius; for spins in "
            "the angle.",
     .initial = 1e-8,
     .min = 1e-13,
     .max = 1e-3,
     .scope = CALX_RUN,
     .offset = offsetof(struct cash_karp, tolerance)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_motion_integrator *law,
                   char *why, size_t why_size)
{
    struct cash_karp *p = params;
    (void)setup, (void)law, (void)why, (void)why_size;
    for (size_t s = 0; s < STAGES + 2; s++)
        for (size_t j = 0; j < STAGES; j++) {
            p->twice[s][j] = 0;
            for (size_t l = 0; l < STAGES; l++)
                p->twice[s][j] += share[s][l] * share[l][j];
        }
    return 0;
}

/* ---- kernels ---- */

/* What they are called with: the stage to go to, STAGES for the end; the longest step. */
struct task {
    const struct cash_karp *p;
    size_t stage;
    double dt;
};

static void begin(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++) {
            r->extra[START][4 * i + k] = r->v[i * r->stride + k];
            r->extra[DISPLACEMENT][4 * i + k] = 0;
            r->extra[FIRST][4 * i + k] = r->a[i * r->stride + k];
        }
}

/* The acceleration of stage j, of which the last is still where the engine left it. */
static inline double acceleration(const struct calx_rows *r, size_t j, size_t i, size_t k)
{
    return j + 1 < STAGES ? r->extra[FIRST + j][4 * i + k] : r->a[i * r->stride + k];
}

/* Keeps the acceleration of the stage before, unless it is the first, and goes to the stage. */
static void go(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    size_t s = t->stage;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++) {
            double h = r->dt[k], gain = 0, way = 0, start = r->extra[START][4 * i + k];
            if (s > 1 && s < STAGES)
                r->extra[FIRST + s - 1][4 * i + k] = r->a[i * r->stride + k];
            for (size_t j = 0; j < s; j++) {
                double a = acceleration(r, j, i, k);
                gain += share[s][j] * a;
                way += t->p->twice[s][j] * a;
            }
            way = h * ((s < STAGES ? node[s] : 1) * start + h * way);
            if (r->x)
                r->x[4 * i + k] += way - r->extra[DISPLACEMENT][4 * i + k];
            r->extra[DISPLACEMENT][4 * i + k] = way;
            r->v[i * r->stride + k] = start + h * gain;
        }
}

/* The largest error of a body, in units of the tolerance. */
static double error(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    double most = 0;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++) {
            double gain = 0, way = 0, h = r->dt[k], scale = r->x ? r->x[4 * i + 3] : 1;
            for (size_t j = 0; j < STAGES; j++) {
                double a = acceleration(r, j, i, k);
                gain += (share[STAGES][j] - share[STAGES + 1][j]) * a;
                way += (t->p->twice[STAGES][j] - t->p->twice[STAGES + 1][j]) * a;
            }
            double off = fmax(fabs(h * t->dt * gain), r->x ? fabs(h * h * way) : 0) /
                         (t->p->tolerance * scale);
            most = off > most || isnan(off) ? off : most;
        }
    return most;
}

/* ---- the step ---- */

/* Goes to the stage and evaluates there, from the sub-step's start at t. */
static int visit(const struct calx_motion_host *host, struct task *task, size_t stage, double t,
                 double h, double end)
{
    int last = stage == STAGES;
    struct calx_evaluation ask = {.time = last ? end : t + node[stage] * h,
                                  .elapsed = last ? h : node[stage] * h,
                                  .keep = last ? 1 : 0};
    task->stage = stage;
    host->each(host->engine, h, go, go, task);
    return host->forces(host->engine, &ask);
}

/* The length that brings the error to 0.6 of the tolerance, within a factor of five. */
static double next_length(double h, double off)
{
    double factor = off > 0 ? 0.9 * pow(off, -0.2) : 5;
    return h * fmin(fmax(factor, 0.2), 5);
}

static int advance(const void *params, const struct calx_motion_host *host, char *why,
                   size_t why_size)
{
    struct task task = {.p = params, .dt = host->dt};
    double end = host->t + host->dt, t = host->t,
           next = host->memory[0] > 0 ? host->memory[0] : host->dt;
    host->each(host->engine, host->dt, begin, begin, NULL);
    while (t < end) {
        double left = end - t, h = next >= left ? left : 2 * next > left ? 0.5 * left : next;
        for (size_t stage = 1; stage < STAGES; stage++)
            if (visit(host, &task, stage, t, h, end))
                return 1;
        double off = host->largest(host->engine, h, error, error, &task),
               wish = next_length(h, off);
        if (!(off <= 1)) {
            next = wish;
            if (next > 1e-12 * host->dt)
                continue;
            snprintf(why, why_size,
                     "its sub-steps of %g s still miss the tolerance %g: give a larger one, in "
                     "units of the radius",
                     h, task.p->tolerance);
            return 1;
        }
        double then = h < left ? t + h : end;
        if (visit(host, &task, STAGES, t, h, then))
            return 1;
        next = h < next ? fmax(next, wish) : wish; /* a step cut short to end in time says little */
        next = fmin(next, host->dt);
        t = then;
        if (t < end)
            host->each(host->engine, host->dt, begin, begin, NULL);
    }
    host->memory[0] = next;
    return 0;
}

static const char *const extra[] = {"start-velocity", "displacement",   "acceleration-1",
                                    "acceleration-2", "acceleration-3", "acceleration-4",
                                    "acceleration-5"};

static const struct calx_motion_integrator law = {
    .order = 5,
    .stability = 3.14, /* half a contact: no sub-step passes over one unseen */
    .damping = 10,
    .extra_translation = ROWS,
    .extra_rotation = ROWS,
    .extra = extra,
    .prepare = prepare,
    .advance = advance,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "cash-karp",
    .summary = "adaptive Runge-Kutta pair of orders 5 and 4, error kept below a tolerance",
    .reference = "Cash and Karp, ACM Trans. Math. Softw. 16 (1990) 201",
    .equation = "k_s = f(y + h sum_j a_sj k_j);  y += h sum b_s k_s;  error = h sum (b_s - b*_s) "
                "k_s < tol;\n"
                "h -> 0.9 h (tol/error)^(1/5)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct cash_karp),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "gear": predictor-corrector of order 3, 4 or 5 for second-order equations, in scaled
 * derivatives r_m = x^(m) dt^m/m! (Nordsieck's form). The predictor is their Taylor series, the
 * corrector adds alpha_m times D = a dt^2/2 - r_2 with one force evaluation. References: Gear,
 * Numerical Initial Value Problems in Ordinary Differential Equations (1971); Allen and Tildesley,
 * Computer Simulation of Liquids (1987), app. E, whose alpha_0 for forces that depend on velocities
 * is taken when a law says that its forces do. The derivatives that the first step needs are found
 * in stages of the start: accelerations at dt .. (q - 1) dt on the Taylor series so far, twice,
 * each time bringing its polynomial, one degree higher than the steps keep, to the acceleration
 * found: so exact derivatives would give errors 1 % different. Not symplectic: energy drifts. Spins
 * have the corrector of the velocities.
 */
#include "core/plugin.h"

enum { LEAST = 3, MOST = 5, NODES = MOST - 1, SWEEPS = 2 };

/* Correctors of order 3, 4, 5 (the work that calx follows prints 19/12 for 19/90), and limits on
 * omega dt and c/m dt as core/plugin.h defines them, measured by the conformance suite. */
static const struct {
    double alpha[MOST + 1], alpha_0_velocity;
    double stability[2], damping; /* without and with alpha_0_velocity */
} tables[] = {
    {{1. / 6, 5. / 6, 1, 1. / 3}, 1. / 6, {1.455, 1.455}, 0.545},
    {{19. / 120, 3. / 4, 1, 1. / 2, 1. / 12}, 19. / 90, {1.148, 1.1}, 0.2993},
    {{3. / 20, 251. / 360, 1, 11. / 18, 1. / 6, 1. / 60}, 3. / 16, {0.875, 0.832}, 0.1629},
};

struct gear {
    double order; /* from the table: index of the choice */
    size_t q;
    double alpha[MOST + 1];
    double basis[NODES * SWEEPS][NODES + 1]; /* polynomials in t/dt, 1 at the node of the stage */
};

static const struct calx_parameter parameters[] = {
    {.name = "order",
     .symbol = "q",
     .unit = "1",
     .doc = "Highest derivative that is kept, and the order of the error.",
     .initial = MOST - LEAST,
     .min = 0,
     .max = MOST - LEAST,
     .flags = CALX_CHOICE,
     .scope = CALX_RUN,
     .offset = offsetof(struct gear, order),
     .choices = "3|4|5"},
};

/* ---- a step ---- */

/* Row m of extra state holds r_(m+2); rows that an order does not keep are NULL, and left alone as q is a constant wherever these are
 * inlined. Lanes without a step have derivatives of 0, which change nothing; inverse: 1/dt, 0 there. Positions go first, by what the
 * others are then. */
#define ALWAYS static inline __attribute__((always_inline))

ALWAYS void predict_place(size_t q, size_t n, size_t stride, const double *restrict dt, double *restrict x, const double *restrict v,
                          const double *restrict r2, const double *restrict r3, const double *restrict r4, const double *restrict r5)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            size_t at = 4 * i + k;
            x[at] += v[i * stride + k] * dt[k] + r2[at] + r3[at] + (q > 3 ? r4[at] : 0) + (q > 4 ? r5[at] : 0);
        }
}

ALWAYS void predict_rest(size_t q, size_t n, size_t stride, const double *restrict inverse, double *restrict v, double *restrict r2,
                         double *restrict r3, double *restrict r4, double *restrict r5)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            size_t at = 4 * i + k;
            double d2 = r2[at], d3 = r3[at], d4 = q > 3 ? r4[at] : 0, d5 = q > 4 ? r5[at] : 0;
            v[i * stride + k] += (2 * d2 + 3 * d3 + 4 * d4 + 5 * d5) * inverse[k];
            r2[at] = d2 + 3 * d3 + 6 * d4 + 10 * d5;
            r3[at] = d3 + 4 * d4 + 10 * d5;
            if (q > 3)
                r4[at] = d4 + 5 * d5;
        }
}

ALWAYS void correct_rest(size_t q, size_t n, size_t stride, const double *restrict alpha, const double *restrict dt,
                         const double *restrict inverse, double *restrict v, const double *restrict a, double *restrict r2,
                         double *restrict r3, double *restrict r4, double *restrict r5)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            size_t at = 4 * i + k;
            double off = 0.5 * dt[k] * dt[k] * a[i * stride + k] - r2[at];
            v[i * stride + k] += alpha[1] * off * inverse[k];
            r2[at] += alpha[2] * off;
            r3[at] += alpha[3] * off;
            if (q > 3)
                r4[at] += alpha[4] * off;
            if (q > 4)
                r5[at] += alpha[5] * off;
        }
}

CALX_KERNEL static void correct_place(size_t n, size_t stride, double alpha, const double *restrict dt, double *restrict x,
                                      const double *restrict a, const double *restrict r2)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += alpha * (0.5 * dt[k] * dt[k] * a[i * stride + k] - r2[4 * i + k]);
}

/* The kernels of one order. */
#define KERNELS(q)                                                                                                                     \
    CALX_KERNEL static void predict_place_##q(size_t n, size_t stride, const double *restrict dt, double *restrict x,                  \
                                              const double *restrict v, const double *restrict r2, const double *restrict r3,         \
                                              const double *restrict r4, const double *restrict r5)                                   \
    {                                                                                                                                  \
        predict_place(q, n, stride, dt, x, v, r2, r3, r4, r5);                                                                         \
    }                                                                                                                                  \
    CALX_KERNEL static void predict_rest_##q(size_t n, size_t stride, const double *restrict inverse, double *restrict v,              \
                                             double *restrict r2, double *restrict r3, double *restrict r4, double *restrict r5)       \
    {                                                                                                                                  \
        predict_rest(q, n, stride, inverse, v, r2, r3, r4, r5);                                                                        \
    }                                                                                                                                  \
    CALX_KERNEL static void correct_rest_##q(size_t n, size_t stride, const double *restrict alpha, const double *restrict dt,         \
                                             const double *restrict inverse, double *restrict v, const double *restrict a,            \
                                             double *restrict r2, double *restrict r3, double *restrict r4, double *restrict r5)       \
    {                                                                                                                                  \
        correct_rest(q, n, stride, alpha, dt, inverse, v, a, r2, r3, r4, r5);                                                          \
    }
KERNELS(3)
KERNELS(4)
KERNELS(5)

static const struct {
    void (*predict_place)(size_t, size_t, const double *, double *, const double *, const double *, const double *, const double *,
                          const double *);
    void (*predict_rest)(size_t, size_t, const double *, double *, double *, double *, double *, double *);
    void (*correct_rest)(size_t, size_t, const double *, const double *, const double *, double *, const double *, double *, double *,
                         double *, double *);
} kernels[] = {{predict_place_3, predict_rest_3, correct_rest_3},
               {predict_place_4, predict_rest_4, correct_rest_4},
               {predict_place_5, predict_rest_5, correct_rest_5}};

/* Rows of derivatives up to the order; NULL for those that it does not keep. */
struct derivatives {
    double *r[4], inverse[4];
};

static struct derivatives derivatives_of(const struct gear *p, const struct calx_rows *r)
{
    struct derivatives d = {{NULL}, {0}};
    for (size_t m = 2; m <= p->q; m++)
        d.r[m - 2] = r->extra[m - 2];
    for (size_t k = 0; k < 4; k++)
        d.inverse[k] = r->dt[k] > 0 ? 1 / r->dt[k] : 0;
    return d;
}

static void before(const void *params, const struct calx_rows *r)
{
    const struct gear *p = params;
    const struct derivatives d = derivatives_of(p, r);
    if (r->x)
        kernels[p->q - LEAST].predict_place(r->n, r->stride, r->dt, r->x, r->v, d.r[0], d.r[1], d.r[2], d.r[3]);
    kernels[p->q - LEAST].predict_rest(r->n, r->stride, d.inverse, r->v, d.r[0], d.r[1], d.r[2], d.r[3]);
}

static void after(const void *params, const struct calx_rows *r)
{
    const struct gear *p = params;
    const struct derivatives d = derivatives_of(p, r);
    if (r->x)
        correct_place(r->n, r->stride, p->alpha[0], r->dt, r->x, r->a, d.r[0]);
    kernels[p->q - LEAST].correct_rest(r->n, r->stride, p->alpha, r->dt, d.inverse, r->v, r->a, d.r[0], d.r[1], d.r[2], d.r[3]);
}

/* ---- the start ---- */

static size_t nodes(const struct gear *p)
{
    return p->q - 1;
}

/* sign = 1: along the Taylor series to s steps after the start; -1: back. */
static inline void travel(const struct gear *p, const struct calx_rows *r, size_t i, size_t k,
                          double s, double sign)
{
    double dt = r->dt[k], gain = 0, way = 0, power = s;
    for (size_t m = 2; m <= p->q + 1; m++, power *= s) {
        double d = r->extra[m - 2][4 * i + k];
        gain += (double)m * d * power / dt;
        way += d * power * s;
    }
    double *v = &r->v[i * r->stride + k], slow = sign > 0 ? *v : *v - gain;
    if (r->x)
        r->x[4 * i + k] += sign * (slow * dt * s + way);
    *v = sign > 0 ? *v + gain : slow;
}

static void go(const void *params, const struct calx_rows *r)
{
    const struct gear *p = params;
    double s = (double)(r->stage % nodes(p) + 1);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++) {
            if (r->stage == 0 && r->dt[k] > 0)
                r->extra[0][4 * i + k] = 0.5 * r->dt[k] * r->dt[k] * r->a[i * r->stride + k];
            if (r->dt[k] > 0)
                travel(p, r, i, k, s, 1);
        }
}

/* The polynomial of a, r_2 .. r_q, takes up the difference at this node and stays what it is at the
 * others. */
static inline void take_up(const struct gear *p, const struct calx_rows *r, size_t i, size_t k,
                           double s)
{
    double dt = r->dt[k], off = dt * dt * r->a[i * r->stride + k], power = 1;
    for (size_t m = 2; m <= p->q + 1; m++, power *= s)
        off -= (double)(m * (m - 1)) * r->extra[m - 2][4 * i + k] * power;
    for (size_t m = 2; m <= p->q + 1; m++)
        r->extra[m - 2][4 * i + k] += off * p->basis[r->stage][m - 2] / (double)(m * (m - 1));
}

static void come_back(const void *params, const struct calx_rows *r)
{
    const struct gear *p = params;
    double s = (double)(r->stage % nodes(p) + 1);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            if (r->dt[k] > 0) {
                travel(p, r, i, k, s, -1);
                take_up(p, r, i, k, s);
            }
}

/* product over the nodes q in [0, last], q != node, of (s - q)/(node - q): coefficients of powers
 * of s */
static void fill_basis(size_t node, size_t last, double *c)
{
    for (size_t m = 0; m <= NODES; m++)
        c[m] = m == 0;
    for (size_t q = 0; q <= last; q++) {
        double scale = (double)node - (double)q;
        for (size_t m = NODES + 1; m-- > 0 && q != node;)
            c[m] = ((m > 0 ? c[m - 1] : 0) - (double)q * c[m]) / scale;
    }
}

#define GO(node)                                                                                   \
    {                                                                                              \
        .before = go, .after = come_back, .time = node                                             \
    }
#define STEP                                                                                       \
    {                                                                                              \
        .before = before, .after = after                                                           \
    }
static const struct calx_stage stages[][NODES * SWEEPS + 1] = {
    {GO(1), GO(2), GO(1), GO(2), STEP},
    {GO(1), GO(2), GO(3), GO(1), GO(2), GO(3), STEP},
    {GO(1), GO(2), GO(3), GO(4), GO(1), GO(2), GO(3), GO(4), STEP}};
static const char *const extra[] = {"second-derivative", "third-derivative", "fourth-derivative",
                                    "fifth-derivative", "sixth-derivative"};

static int prepare(const struct calx_setup *setup, void *params, struct calx_motion_integrator *law,
                   char *why, size_t why_size)
{
    struct gear *p = params;
    size_t row = (size_t)p->order;
    (void)why, (void)why_size;
    p->q = LEAST + row;
    for (size_t m = 0; m <= MOST; m++)
        p->alpha[m] = tables[row].alpha[m];
    if (setup->uses_velocity)
        p->alpha[0] = tables[row].alpha_0_velocity;
    for (size_t k = 0; k < SWEEPS * nodes(p); k++) /* the first sweep has no nodes beyond yet */
        fill_basis(k % nodes(p) + 1, k < nodes(p) ? k + 1 : nodes(p), p->basis[k]);
    law->order = (uint32_t)p->q;
    law->stability = tables[row].stability[setup->uses_velocity];
    law->damping = tables[row].damping;
    law->start = (uint32_t)(SWEEPS * nodes(p));
    law->extra_translation = law->extra_rotation = (uint32_t)p->q;
    law->translation = law->rotation = stages[row];
    return 0;
}

static const struct calx_motion_integrator law = {
    .order = MOST,
    .stages = 1,
    .start = SWEEPS * NODES,
    .stability = 0.875,
    .damping = 0.1629,
    .constant_step = 1,
    .extra_translation = MOST,
    .extra_rotation = MOST,
    .extra = extra,
    .translation = stages[MOST - LEAST],
    .rotation = stages[MOST - LEAST],
    .prepare = prepare,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "gear",
    .summary = "predictor-corrector of order 3, 4 or 5, one force evaluation per step",
    .reference =
        "Gear, Numerical Initial Value Problems in Ordinary Differential Equations (1971); "
        "Allen and Tildesley, Computer Simulation of Liquids (1987), app. E",
    .equation =
        "r_m = x^(m) dt^m/m!;  r_m += sum_(j>m) C(j, m) r_j;  a = a(x, v);  r_m += alpha_m (a "
        "dt^2/2 - r_2)\n"
        "q=3: 1/6 5/6 1 1/3;  q=4: 19/120 3/4 1 1/2 1/12;  q=5: 3/20 251/360 1 11/18 1/6 1/60;\n"
        "alpha_0 = 19/90 (q=4), 3/16 (q=5) if forces depend on velocities",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct gear),
    .law = &law,
};

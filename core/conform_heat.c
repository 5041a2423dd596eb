/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance of conductances (the same seen from both bodies, not negative, none without
 * overlap) and of integrators of temperature: order against a reference with small steps, heat kept
 * to round-off, stability limit, equilibrium undisturbed. The network is a chain of unlike bodies
 * with a source, and a wall at one end.
 */
#include <math.h>
#include <string.h>

#include "core/conform_parts.h"

enum { SEED = 14142, BODIES = 6, EDGES = BODIES - 1 };

static const double ROUND_OFF = 1e-13;
/* The line through the errors of 32 to 1024 steps: the next term changes its slope by less than 0.1. */
static const double ORDER_SLACK = 0.2;
/* Of temperatures of 300 K, 1e-16 of them in each of up to 1000 steps; the reference's own error. */
static const double FLOOR = 1e-10;
/* A tolerance of 1e-10 of changes of up to 100 K. */
static const double EXACT = 1e-8;
static const double LIMIT_SLACK = 0.02;

/* ---- conductances ---- */

/* The other way round: materials, curvatures and temperatures exchanged, the normal turned. */
static double asymmetry(struct calx_choice *c)
{
    struct calx_trial a, b;
    double worst = 0;
    calx_trial_fill(&a, c, CALX_BATCH, SEED);
    b = a;
    calx_trial_exchange(&b);
    calx_trial_evaluate(&a, c);
    if (calx_choice_exchange(c))
        return INFINITY;
    calx_trial_evaluate(&b, c);
    for (size_t i = 0; i < a.n; i++) {
        double h = a.column[CALX_COL_CONDUCTANCE][i];
        worst = fmax(worst, fabs(b.column[CALX_COL_CONDUCTANCE][i] - h) / (h + 1e-300));
    }
    return calx_choice_exchange(c) ? INFINITY : worst;
}

void calx_conform_conductance(struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial t;
    size_t negative = 0, apart = 0, none = 0;
    calx_trial_check_batches(c, report);
    calx_trial_check_finite(c, report);
    calx_trial_fill(&t, c, CALX_BATCH, SEED);
    calx_trial_evaluate(&t, c);
    for (size_t i = 0; i < t.n; i++) {
        double h = t.column[CALX_COL_CONDUCTANCE][i];
        bool touch = t.column[CALX_COL_OVERLAP][i] > -c->demand.gap;
        negative += !(h >= 0);
        apart += !touch && h != 0;
        none += touch && h == 0;
    }
    calx_conform_note(report, "no conductance without overlap", (double)apart, 0, c->where);
    calx_conform_note(report, "conductance is not negative", (double)negative, 0, c->where);
    calx_conform_note(report, "contacts conduct", (double)none, 0, c->where);
    calx_conform_note(report, "the same from both bodies", asymmetry(c), ROUND_OFF, c->where);
}

/* ---- integrators of temperature ---- */

struct chain {
    struct calx_network net;
    double temperature[BODIES], capacity[BODIES], source[BODIES], conductance[EDGES];
    int32_t from[EDGES], to[EDGES], boundary[1];
    double boundary_conductance[1], boundary_temperature[1], boundary_heat[1];
    double wall_heat; /* J, sum since the start */
};

static void chain_begin(struct chain *c, double dt, bool unlike)
{
    memset(c, 0, sizeof *c);
    for (int i = 0; i < BODIES; i++) {
        c->temperature[i] = 300 + (unlike ? 40 * cos(2.0 * i) : 0);
        c->capacity[i] = unlike ? 1 + 0.3 * i : 1;
        c->source[i] = unlike && i == 2 ? 5 : 0;
    }
    for (int e = 0; e < EDGES; e++) {
        c->from[e] = e, c->to[e] = e + 1;
        c->conductance[e] = unlike ? 1 + 0.5 * sin(3.0 * e) : 1;
    }
    c->boundary_conductance[0] = 0.7;
    c->boundary_temperature[0] = unlike ? 350 : 300;
    c->net = (struct calx_network){.size = sizeof c->net,
                                   .n = BODIES,
                                   .dt = dt,
                                   .temperature = c->temperature,
                                   .capacity = c->capacity,
                                   .source = c->source,
                                   .edges = EDGES,
                                   .edge = {c->from, c->to},
                                   .edge_conductance = c->conductance,
                                   .boundaries = unlike,
                                   .boundary = c->boundary,
                                   .boundary_conductance = c->boundary_conductance,
                                   .boundary_temperature = c->boundary_temperature,
                                   .boundary_heat = c->boundary_heat};
}

static void chain_flow(const struct chain *c, const double *t, double *q)
{
    memcpy(q, c->source, sizeof c->source);
    for (int e = 0; e < EDGES; e++) {
        double flow = c->conductance[e] * (t[e + 1] - t[e]);
        q[e] += flow;
        q[e + 1] -= flow;
    }
    for (size_t b = 0; b < c->net.boundaries; b++)
        q[0] += c->boundary_conductance[0] * (c->boundary_temperature[0] - t[0]);
}

/* One step with the plugin; false if its solver failed. */
static bool chain_step(struct chain *c, const struct calx_choice *choice, size_t stride)
{
    const struct calx_temperature_integrator *law = choice->plugin->law;
    char why[256];
    if (law->solve) {
        bool ok = law->solve(choice->params, &c->net, why, sizeof why) == 0;
        c->wall_heat += c->net.boundaries ? c->boundary_heat[0] : 0;
        return ok;
    }
    double q[BODIES], inverse[BODIES], t[4 * BODIES] = {0}, rows[4 * BODIES] = {0};
    chain_flow(c, c->temperature, q);
    for (size_t b = 0; b < c->net.boundaries; b++)
        c->wall_heat += c->net.dt * c->boundary_conductance[0] *
                        (c->boundary_temperature[0] - c->temperature[0]);
    for (size_t i = 0; i < BODIES; i++)
        t[stride * i] = c->temperature[i], rows[stride * i] = q[i], inverse[i] = 1 / c->capacity[i];
    law->advance(choice->params, BODIES, c->net.dt, t, stride, rows, stride, inverse);
    for (size_t i = 0; i < BODIES; i++)
        c->temperature[i] = t[stride * i];
    return true;
}

static double chain_heat(const struct chain *c)
{
    double heat = 0;
    for (int i = 0; i < BODIES; i++)
        heat += c->capacity[i] * c->temperature[i];
    return heat;
}

/* The classical Runge-Kutta scheme with 4096 steps: error below 1e-13. */
static void chain_reference(struct chain *c, double end)
{
    double q[BODIES], t[BODIES], sum[BODIES], dt = end / 4096;
    for (int n = 0; n < 4096; n++) {
        static const double shares[] = {0, 0.5, 0.5, 1}, weights[] = {1, 2, 2, 1};
        memset(q, 0, sizeof q);
        memset(sum, 0, sizeof sum);
        for (int s = 0; s < 4; s++) {
            for (int i = 0; i < BODIES; i++)
                t[i] = c->temperature[i] + shares[s] * dt * q[i] / c->capacity[i];
            chain_flow(c, t, q);
            for (int i = 0; i < BODIES; i++)
                sum[i] += weights[s] / 6 * q[i];
        }
        for (int i = 0; i < BODIES; i++)
            c->temperature[i] += dt * sum[i] / c->capacity[i];
    }
}

/* The largest error at t = 1 s. */
static double error_after(const struct calx_choice *choice, size_t steps)
{
    struct chain c, exact;
    double worst = 0;
    chain_begin(&c, 1.0 / (double)steps, true);
    chain_begin(&exact, 1, true);
    chain_reference(&exact, 1);
    for (size_t n = 0; n < steps; n++)
        if (!chain_step(&c, choice, 1))
            return NAN;
    for (int i = 0; i < BODIES; i++)
        worst = fmax(worst, fabs(c.temperature[i] - exact.temperature[i]));
    return worst;
}

static void check_order(const struct calx_choice *choice, struct calx_conformance *report)
{
    enum { HALVINGS = 5 };
    const struct calx_temperature_integrator *law = choice->plugin->law;
    double error[HALVINGS + 1], sxy = 0, sxx = 0;
    size_t n = 0;
    for (size_t k = 0; k <= HALVINGS; k++) {
        error[n] = error_after(choice, (size_t)32 << k);
        n += !(error[n] <= FLOOR); /* beyond, an order cannot be seen */
    }
    for (size_t k = 0; k < n; k++) {
        double x = (double)k - 0.5 * (double)(n - 1);
        sxy -= x * log2(error[k]);
        sxx += x * x;
    }
    double lack = n < 2 ? 0 : law->order - sxy / sxx;
    calx_conform_note(report, "order as declared", isnan(lack) ? NAN : fmax(lack, 0), ORDER_SLACK,
                      choice->where);
}

/* One step over the time in which bodies come near to equilibrium, and one of a hundredth of it. */
static void check_exact(const struct calx_choice *choice, struct calx_conformance *report)
{
    const struct calx_temperature_integrator *law = choice->plugin->law;
    if (law->exact)
        calx_conform_note(report, "exact while the network stays",
                          fmax(error_after(choice, 1), error_after(choice, 100)), EXACT,
                          choice->where);
}

static void check_heat(const struct calx_choice *choice, struct calx_conformance *report)
{
    struct chain c;
    double worst = 0;
    chain_begin(&c, 0.1, true);
    double start = chain_heat(&c), given = 0;
    for (int n = 0; n < 50; n++) {
        bool ok = chain_step(&c, choice, n % 2 ? 4 : 1);
        given += c.net.dt * c.source[2];
        double lost = fabs(chain_heat(&c) - start - given - c.wall_heat) / start;
        worst = ok ? fmax(worst, lost) : INFINITY;
    }
    calx_conform_note(report, "heat is kept", worst, ROUND_OFF, choice->where);
}

static void check_rest(const struct calx_choice *choice, struct calx_conformance *report)
{
    struct chain c;
    double worst = 0;
    chain_begin(&c, 0.1, false);
    for (int n = 0; n < 10; n++)
        worst = chain_step(&c, choice, 1) ? worst : INFINITY;
    for (int i = 0; i < BODIES; i++)
        worst = fmax(worst, fabs(c.temperature[i] - 300) / 300);
    calx_conform_note(report, "equilibrium stays", worst, ROUND_OFF, choice->where);
}

/* Whether the fastest mode of the chain of equal bodies does not grow in 400 steps. */
static bool is_stable(const struct calx_choice *choice, double lambda_dt)
{
    struct chain c;
    double lambda = 4 * pow(sin(EDGES * M_PI / (2 * BODIES)), 2); /* C = H = 1, insulated */
    chain_begin(&c, lambda_dt / lambda, false);
    for (int i = 0; i < BODIES; i++)
        c.temperature[i] += cos(EDGES * M_PI * (i + 0.5) / BODIES);
    double start = fabs(c.temperature[0] - 300);
    for (int n = 0; n < 400; n++)
        if (!chain_step(&c, choice, 1) || !(fabs(c.temperature[0] - 300) < 10 * start))
            return false;
    return fabs(c.temperature[0] - 300) < 2 * start;
}

static void check_stability(const struct calx_choice *choice, struct calx_conformance *report)
{
    const struct calx_temperature_integrator *law = choice->plugin->law;
    double low = 0.5 * law->stability, high = 2 * law->stability;
    if (law->unconditional) {
        size_t count = !is_stable(choice, 3) + !is_stable(choice, 1e2) + !is_stable(choice, 1e4) +
                       !is_stable(choice, 1e8);
        calx_conform_note(report, "stable for any step", (double)count, 0, choice->where);
        return;
    }
    bool bracketed = is_stable(choice, low) && !is_stable(choice, high);
    for (int k = 0; k < 12; k++) {
        double middle = 0.5 * (low + high);
        if (is_stable(choice, middle))
            low = middle;
        else
            high = middle;
    }
    calx_conform_note(report, "stability limit as declared",
                      bracketed ? fabs(low / law->stability - 1) : INFINITY, LIMIT_SLACK,
                      choice->where);
}

void calx_conform_temperature(struct calx_choice *c, struct calx_conformance *report)
{
    if (c->where[0] == 0 || strcmp(c->where, "discs") == 0) { /* declared for the defaults */
        check_order(c, report);
        check_exact(c, report);
    }
    check_heat(c, report);
    check_rest(c, report);
    check_stability(c, report);
}

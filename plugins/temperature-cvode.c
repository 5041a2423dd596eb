/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator of temperature "cvode": backward differentiation formulas of order 1 to 5 by the CVODE solver of SUNDIALS, which chooses
 * order and sub-steps of its own so that the error stays below a tolerance, however stiff the network is. Its linear systems are
 * solved by GMRES with the diagonal as preconditioner. References: Cohen and Hindmarsh, Computers in Physics 10 (1996) 138; Hindmarsh et
 * al., ACM Trans. Math. Softw. 31 (2005) 363.
 * The vector: temperatures less their mean at the start, which keeps the digits of small differences, then the heat that each
 * wall contact has given. A shift by what the solver leaves keeps the sum of heat to round-off.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include "core/plugin.h"

enum { VECTORS = 60, STEPS = 1000000 };

struct cvode {
    double tolerance;
};

static const struct calx_parameter parameters[] = {
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Error of the temperatures in a sub-step, relative to the range of those of bodies and walls.",
     .initial = 1e-15,
     .min = 1e-15,
     .max = 1e-2,
     .scope = CALX_RUN,
     .offset = offsetof(struct cvode, tolerance)},
};

/* ---- the network ---- */

struct problem {
    const struct calx_network *net;
    double mean;      /* K: temperatures are those above it */
    double *rate;     /* 1/s, sum of conductances over capacity, of each body */
};

/* rate = C^-1 (given + sum H (t_j - t_i)), and the heat flows from walls; walls and sources count by `full`: 1, or 0 for differences. */
static void flow(const struct problem *p, double full, const double *t, double *rate)
{
    const struct calx_network *net = p->net;
    for (size_t i = 0; i < net->n; i++)
        rate[i] = full * net->source[i];
    for (size_t e = 0; e < net->edges; e++) {
        int32_t i = net->edge[0][e], j = net->edge[1][e];
        double q = net->edge_conductance[e] * (t[j] - t[i]);
        rate[i] += q;
        rate[j] -= q;
    }
    for (size_t b = 0; b < net->boundaries; b++) {
        int32_t i = net->boundary[b];
        double q = net->boundary_conductance[b] * (full * (net->boundary_temperature[b] - p->mean) - t[i]);
        rate[i] += q;
        rate[net->n + b] = q;
    }
    for (size_t i = 0; i < net->n; i++)
        rate[i] /= net->capacity[i];
}

static int rates(sunrealtype t, N_Vector y, N_Vector rate, void *user)
{
    (void)t;
    flow(user, 1, N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
    return 0;
}

static int jacobian_times(N_Vector v, N_Vector out, sunrealtype t, N_Vector y, N_Vector rate, void *user, N_Vector room)
{
    (void)t, (void)y, (void)rate, (void)room;
    flow(user, 0, N_VGetArrayPointer(v), N_VGetArrayPointer(out));
    return 0;
}

static int precondition(sunrealtype t, N_Vector y, N_Vector rate, N_Vector r, N_Vector z, sunrealtype gamma, sunrealtype delta,
                        int side, void *user)
{
    const struct problem *p = user;
    const double *from = N_VGetArrayPointer(r);
    double *to = N_VGetArrayPointer(z);
    (void)t, (void)y, (void)rate, (void)delta, (void)side;
    for (size_t i = 0; i < p->net->n; i++)
        to[i] = from[i] / (1 + gamma * p->rate[i]);
    for (size_t i = p->net->n; i < p->net->n + p->net->boundaries; i++)
        to[i] = from[i];
    return 0;
}

static void fill_problem(struct problem *p)
{
    const struct calx_network *net = p->net;
    double heat = 0, capacity = 0;
    for (size_t i = 0; i < net->n; i++) {
        heat += net->capacity[i] * net->temperature[i];
        capacity += net->capacity[i];
        p->rate[i] = 0;
    }
    p->mean = heat / capacity;
    for (size_t e = 0; e < net->edges; e++)
        for (int k = 0; k < 2; k++)
            p->rate[net->edge[k][e]] += net->edge_conductance[e];
    for (size_t b = 0; b < net->boundaries; b++)
        p->rate[net->boundary[b]] += net->boundary_conductance[b];
    for (size_t i = 0; i < net->n; i++)
        p->rate[i] /= net->capacity[i];
}

/* The range of temperatures that the step can lead to, K. */
static double range_of(const struct calx_network *net)
{
    double low = INFINITY, high = -INFINITY, warming = 0;
    for (size_t i = 0; i < net->n; i++) {
        low = fmin(low, net->temperature[i]);
        high = fmax(high, net->temperature[i]);
        warming = fmax(warming, fabs(net->source[i]) * net->dt / net->capacity[i]);
    }
    for (size_t b = 0; b < net->boundaries; b++) {
        low = fmin(low, net->boundary_temperature[b]);
        high = fmax(high, net->boundary_temperature[b]);
    }
    return high - low + warming;
}

/* ---- a step ---- */

struct solver {
    SUNContext context;
    N_Vector y, tolerances;
    SUNLinearSolver linear;
    void *cvode;
};

static void close_solver(struct solver *s)
{
    if (s->cvode)
        CVodeFree(&s->cvode);
    if (s->linear)
        SUNLinSolFree(s->linear);
    N_VDestroy(s->y);
    N_VDestroy(s->tolerances);
    if (s->context)
        SUNContext_Free(&s->context);
}

static void fill_vectors(const struct problem *p, double tolerance, double *y, double *tolerances)
{
    const struct calx_network *net = p->net;
    double most = tolerance * range_of(net);
    for (size_t i = 0; i < net->n; i++) {
        y[i] = net->temperature[i] - p->mean;
        tolerances[i] = most;
    }
    for (size_t b = 0; b < net->boundaries; b++) {
        y[net->n + b] = 0;
        tolerances[net->n + b] = most * (net->capacity[net->boundary[b]] + net->boundary_conductance[b] * net->dt);
    }
}

static int open_solver(struct solver *s, struct problem *p, double tolerance)
{
    size_t size = p->net->n + p->net->boundaries;
    if (SUNContext_Create(NULL, &s->context))
        return 1;
    s->y = N_VNew_Serial((sunindextype)size, s->context);
    s->tolerances = N_VNew_Serial((sunindextype)size, s->context);
    if (!s->y || !s->tolerances)
        return 1;
    fill_vectors(p, tolerance, N_VGetArrayPointer(s->y), N_VGetArrayPointer(s->tolerances));
    s->linear = SUNLinSol_SPGMR(s->y, SUN_PREC_LEFT, VECTORS, s->context);
    s->cvode = CVodeCreate(CV_BDF, s->context);
    return !s->linear || !s->cvode || CVodeInit(s->cvode, rates, 0, s->y) || CVodeSetErrFile(s->cvode, NULL) ||
           CVodeSetUserData(s->cvode, p) || CVodeSVtolerances(s->cvode, 0, s->tolerances) ||
           CVodeSetLinearSolver(s->cvode, s->linear, NULL) || CVodeSetJacTimes(s->cvode, NULL, jacobian_times) ||
           CVodeSetPreconditioner(s->cvode, NULL, precondition) || CVodeSetMaxNumSteps(s->cvode, STEPS) ||
           CVodeSetStopTime(s->cvode, p->net->dt);
}

/* Books the heat from the walls, and adds the changes with the shift that makes the heat of the bodies what sources and walls gave. */
static void finish(const struct problem *p, const double *y)
{
    const struct calx_network *net = p->net;
    double given = 0, taken = 0, capacity = 0;
    for (size_t b = 0; b < net->boundaries; b++) {
        net->boundary_heat[b] = y[net->n + b];
        given += y[net->n + b];
    }
    for (size_t i = 0; i < net->n; i++) {
        given += net->dt * net->source[i];
        taken += net->capacity[i] * (y[i] - (net->temperature[i] - p->mean));
        capacity += net->capacity[i];
    }
    for (size_t i = 0; i < net->n; i++)
        net->temperature[i] += y[i] - (net->temperature[i] - p->mean) + (given - taken) / capacity;
}

static int run(struct problem *p, double tolerance, char *why, size_t why_size)
{
    struct solver s = {0};
    double t;
    fill_problem(p);
    int failed = open_solver(&s, p, tolerance);
    if (failed)
        snprintf(why, why_size, "no memory for the temperatures of %zu bodies", p->net->n);
    int flag = failed ? 0 : CVode(s.cvode, p->net->dt, s.y, &t, CV_NORMAL);
    if (flag < 0) {
        char *name = CVodeGetReturnFlagName(flag);
        snprintf(why, why_size, "%s for %zu temperatures with the tolerance %g: give a larger one", name, p->net->n, tolerance);
        free(name);
        failed = 1;
    }
    if (!failed)
        finish(p, N_VGetArrayPointer(s.y));
    close_solver(&s);
    return failed;
}

static int solve(const void *params, const struct calx_network *net, char *why, size_t why_size)
{
    const struct cvode *c = params;
    struct problem p = {.net = net};
    if (net->n == 0)
        return 0;
    if (!(range_of(net) > 0)) { /* nothing to exchange */
        for (size_t b = 0; b < net->boundaries; b++)
            net->boundary_heat[b] = 0;
        return 0;
    }
    p.rate = malloc(net->n * sizeof *p.rate);
    if (!p.rate) {
        snprintf(why, why_size, "no memory for the temperatures of %zu bodies", net->n);
        return 1;
    }
    int failed = run(&p, c->tolerance, why, why_size);
    free(p.rate);
    return failed;
}

static const struct calx_temperature_integrator law = {
    .order = 2,
    .exact = 1,
    .unconditional = 1,
    .solve = solve,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_TEMPERATURE,
    .name = "cvode",
    .summary = "implicit, orders 1 to 5 and sub-steps chosen by error, for stiff networks (SUNDIALS)",
    .reference = "Cohen and Hindmarsh, Computers in Physics 10 (1996) 138; Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363",
    .equation = "C dT/dt = q(T) by sum_k alpha_k T(n-k) = h beta q(T(n))/C, k = 0 to 5, error < tol;  q_i = source_i + sum_j H_ij (T_j - T_i)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct cvode),
    .law = &law,
};

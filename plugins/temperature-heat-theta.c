/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator of temperature "heat-theta": C dT/dt = theta q(T + dT) + (1 - theta) q(T), q the net
 * heat flow into each body. The step solves (C/dt + theta L) dT = q(T), L the matrix of
 * conductances, without storing it: conjugate gradients with the diagonal as preconditioner
 * (Hestenes and Stiefel, J. Res. NBS 49 (1952) 409), sums in a fixed order, so that runs repeat bit
 * by bit. Second order for theta = 1/2, first otherwise. New extremes of temperature cannot appear
 * while dt (1 - theta) sum H <= C in each body (the explicit part then has no negative weights, and
 * the implicit matrix is an M-matrix): with monotone, theta is raised to that bound when the step
 * is longer. A shift by the solver's residual keeps the sum of heat to round-off.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/plugin.h"

struct theta {
    double theta, tolerance, monotone;
};

static const struct calx_parameter parameters[] = {
    {.name = "theta",
     .symbol = "theta",
     .unit = "1",
     .doc = "0: explicit, 0.5: second order, 1: implicit.",
     .initial = 0.5,
     .min = 0,
     .max = 1,
     .scope = CALX_RUN,
     .offset = offsetof(struct theta, theta)},
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Residual of the solver relative to the heat flows.",
     .initial = 1e-12,
     .min = 1e-15,
     .max = 1e-2,
     .scope = CALX_RUN,
     .offset = offsetof(struct theta, tolerance)},
    {.name = "monotone",
     .symbol = "monotone",
     .unit = "1",
     .doc = "Raise theta in steps so long that temperatures would overshoot.",
     .initial = 1,
     .min = 0,
     .max = 1,
     .flags = CALX_SWITCH,
     .scope = CALX_RUN,
     .offset = offsetof(struct theta, monotone)},
};

static int prepare(const struct calx_setup *setup, void *params, char *why, size_t why_size)
{
    const struct theta *p = params;
    (void)setup;
    if (p->theta < 0.5 && p->monotone == 0) {
        snprintf(why, why_size,
                 "theta below 0.5 is unstable in long steps: give monotone=\"yes\" or theta of at "
                 "least 0.5");
        return 1;
    }
    return 0;
}

/* out += sign * L t: heat that leaves each body (sign 1) if t are temperatures above those of the
 * walls. */
static void add_outflow(const struct calx_network *net, double sign, const double *t, double *out)
{
    for (size_t e = 0; e < net->edges; e++) {
        int32_t i = net->edge[0][e], j = net->edge[1][e];
        double q = sign * net->edge_conductance[e] * (t[i] - t[j]);
        out[i] += q;
        out[j] -= q;
    }
    for (size_t b = 0; b < net->boundaries; b++)
        out[net->boundary[b]] += sign * net->boundary_conductance[b] * t[net->boundary[b]];
}

static void apply(const struct calx_network *net, double theta, const double *t, double *out)
{
    for (size_t i = 0; i < net->n; i++)
        out[i] = net->capacity[i] / net->dt * t[i];
    add_outflow(net, theta, t, out);
}

/* The heat flow into each body at its present temperature. */
static void fill_inflow(const struct calx_network *net, double *q)
{
    for (size_t i = 0; i < net->n; i++)
        q[i] = net->source[i];
    add_outflow(net, -1, net->temperature, q);
    for (size_t b = 0; b < net->boundaries; b++)
        q[net->boundary[b]] += net->boundary_conductance[b] * net->boundary_temperature[b];
}

/* The sum of conductances of each body. */
static void fill_sums(const struct calx_network *net, double *sum)
{
    for (size_t i = 0; i < net->n; i++)
        sum[i] = 0;
    for (size_t e = 0; e < net->edges; e++) {
        sum[net->edge[0][e]] += net->edge_conductance[e];
        sum[net->edge[1][e]] += net->edge_conductance[e];
    }
    for (size_t b = 0; b < net->boundaries; b++)
        sum[net->boundary[b]] += net->boundary_conductance[b];
}

/* theta, or the least that lets no temperature overshoot. */
static double choose_theta(const struct theta *p, const struct calx_network *net, const double *sum)
{
    double fastest = 0; /* 1/s */
    for (size_t i = 0; i < net->n; i++)
        fastest = fmax(fastest, sum[i] / net->capacity[i]);
    double least = fastest * net->dt > 1 ? 1 - 1 / (fastest * net->dt) : 0;
    return p->monotone > 0 ? fmax(p->theta, least) : p->theta;
}

static double dot(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Solves (C/dt + theta L) x = r, from x = 0; work: 3 n numbers. r becomes the residual. Returns 0,
 * or 1 if it does not converge. */
static int solve_cg(const struct calx_network *net, double theta, double tolerance,
                    const double *sum, double *x, double *r, double *work)
{
    size_t n = net->n, most = 10 * n + 100;
    double *z = work, *p = z + n, *ap = p + n, rz = 0;
    for (size_t i = 0; i < n; i++) {
        x[i] = 0;
        p[i] = z[i] = r[i] / (net->capacity[i] / net->dt + theta * sum[i]);
    }
    rz = dot(n, r, z);
    double stop = tolerance * tolerance * rz;
    for (size_t k = 0; k < most && rz > stop; k++) {
        apply(net, theta, p, ap);
        double alpha = rz / dot(n, p, ap), before = rz;
        for (size_t i = 0; i < n; i++) {
            x[i] += alpha * p[i];
            r[i] -= alpha * ap[i];
            z[i] = r[i] / (net->capacity[i] / net->dt + theta * sum[i]);
        }
        rz = dot(n, r, z);
        for (size_t i = 0; i < n; i++)
            p[i] = z[i] + rz / before * p[i];
    }
    return !(rz <= stop);
}

/* Books the heat from the walls, and adds dT with the shift that makes the heat of the bodies what
 * sources and walls gave. */
static void finish(const struct calx_network *net, double theta, const double *change)
{
    double given = 0, taken = 0, capacity = 0;
    for (size_t b = 0; b < net->boundaries; b++) {
        int32_t i = net->boundary[b];
        double t = net->temperature[i] + theta * change[i];
        net->boundary_heat[b] =
            net->dt * net->boundary_conductance[b] * (net->boundary_temperature[b] - t);
        given += net->boundary_heat[b];
    }
    for (size_t i = 0; i < net->n; i++) {
        given += net->dt * net->source[i];
        taken += net->capacity[i] * change[i];
        capacity += net->capacity[i];
    }
    double shift = (given - taken) / capacity;
    for (size_t i = 0; i < net->n; i++)
        net->temperature[i] += change[i] + shift;
}

static int solve(const void *params, const struct calx_network *net, char *why, size_t why_size)
{
    const struct theta *p = params;
    size_t n = net->n;
    if (n == 0)
        return 0;
    double *memory = malloc(6 * n * sizeof *memory);
    if (!memory) {
        snprintf(why, why_size, "no memory for the temperatures of %zu bodies", n);
        return 1;
    }
    double *sum = memory, *change = sum + n, *residual = change + n;
    fill_sums(net, sum);
    fill_inflow(net, residual);
    double theta = choose_theta(p, net, sum);
    int failed = solve_cg(net, theta, p->tolerance, sum, change, residual, residual + n);
    if (failed)
        snprintf(why, why_size,
                 "conjugate gradients for %zu temperatures did not reach the tolerance %g", n,
                 p->tolerance);
    else
        finish(net, theta, change);
    free(memory);
    return failed;
}

static const struct calx_temperature_integrator law = {
    .order = 2,
    .unconditional = 1,
    .prepare = prepare,
    .solve = solve,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_TEMPERATURE,
    .name = "heat-theta",
    .summary = "implicit for theta > 0, stable for any step",
    .reference = "Crank and Nicolson, Proc. Camb. Phil. Soc. 43 (1947) 50; Hestenes and Stiefel, "
                 "J. Res. NBS 49 (1952) 409",
    .equation = "(C/dt + theta L) dT = q(T), q_i = source_i + sum_j H_ij (T_j - T_i);  T += dT",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct theta),
    .law = &law,
};

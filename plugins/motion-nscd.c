/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "nscd": non-smooth contact dynamics. Bodies are rigid; contacts are found where bodies are after a drift of (1 - theta) h, the
 * impulses of the step follow from conditions on the velocities at its end, and a drift of theta h with those ends it.
 * Reference: Moreau, in Nonsmooth Mechanics and Applications (1988); Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235; the step as in
 * Renouf et al. The conditions are solved by nscd-solve.c.
 */
#include <stdio.h>

#include "plugins/nscd.h"

static const struct calx_parameter parameters[] = {
    {.name = "theta",
     .symbol = "theta",
     .unit = "1",
     .doc = "Weight of the end of the step: 1/2 keeps the energy of free flight.",
     .initial = 0.5,
     .min = 0.5,
     .max = 1,
     .offset = offsetof(struct nscd, theta)},
    {.name = "solver",
     .symbol = "solver",
     .unit = "1",
     .doc = "Gauss-Seidel sweeps, or accelerated projected gradient descent: better for tall columns and heavy bodies on light ones.",
     .max = 1,
     .flags = CALX_CHOICE,
     .offset = offsetof(struct nscd, solver),
     .choices = "nsgs|apgd"},
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Largest residual of the solution: of the natural map of De Saxce, relative to the impulses.",
     .initial = 1e-4,
     .min = 1e-14,
     .max = 0.1,
     .offset = offsetof(struct nscd, tolerance)},
    {.name = "accuracy",
     .symbol = "acc",
     .unit = "1",
     .doc = "Largest residual relative to the impulses that would stop the bodies as they approach freely: it decides where impulses build up "
            "slowly, as under a heavy body on a light one.",
     .initial = 5e-4,
     .min = 1e-14,
     .max = 1e9,
     .offset = offsetof(struct nscd, accuracy)},
    {.name = "sweeps",
     .symbol = "N",
     .unit = "1",
     .doc = "Most sweeps, or iterations, over the contacts in a step.",
     .initial = 1e5,
     .min = 1,
     .max = 1e9,
     .offset = offsetof(struct nscd, sweeps)},
    {.name = "unsolved",
     .symbol = "unsolved",
     .unit = "1",
     .doc = "What happens when they do not suffice: the run stops, or goes on with what there is.",
     .max = 1,
     .flags = CALX_CHOICE,
     .offset = offsetof(struct nscd, unsolved),
     .choices = "stop|go-on"},
    {.name = "relaxation",
     .symbol = "omega",
     .unit = "1",
     .doc = "Of sweeps: each contact goes so far towards its solution; above 1 a column takes fewer.",
     .initial = 1,
     .min = 0,
     .max = 2,
     .flags = CALX_OPEN_MIN | CALX_OPEN_MAX,
     .offset = offsetof(struct nscd, relaxation)},
    {.name = "order",
     .symbol = "order",
     .unit = "1",
     .doc = "The order of contacts in a sweep: as they are found, from the bottom, or by colours, which several threads share.",
     .max = 2,
     .flags = CALX_CHOICE,
     .offset = offsetof(struct nscd, order),
     .choices = "listed|bottom-up|coloured"},
    {.name = "chains",
     .symbol = "chains",
     .unit = "1",
     .doc = "Whether sweeps first solve chains of contacts, as in columns, for all their normal impulses at once.",
     .max = 1,
     .flags = CALX_SWITCH,
     .offset = offsetof(struct nscd, chains)},
    {.name = "warm-start",
     .symbol = "warm",
     .unit = "1",
     .doc = "Whether the solution starts from the impulses of the last step.",
     .initial = 1,
     .max = 1,
     .flags = CALX_SWITCH,
     .offset = offsetof(struct nscd, warm)},
    {.name = "reach",
     .symbol = "d",
     .unit = "1",
     .doc = "Gap from which contacts are looked for, in units of the smallest radius: more than bodies approach in a step.",
     .initial = 0.1,
     .min = 0,
     .max = 10,
     .offset = offsetof(struct nscd, reach)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_motion_integrator *law, char *why, size_t why_size)
{
    const struct nscd *p = params;
    (void)setup, (void)why, (void)why_size;
    law->order = p->theta > 0.5 ? 1 : 2;
    law->reversible = !(p->theta > 0.5);
    law->reach = p->reach;
    return 0;
}

/* ---- kernels ---- */

static void drift(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
}

static void kick(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->v[i * r->stride + k] += r->dt[k] * r->a[i * r->stride + k];
}

/* ---- the step ---- */

static int advance(const void *params, const struct calx_motion_host *host, char *why, size_t why_size)
{
    const struct nscd *p = params;
    double h = host->dt, first = (1 - p->theta) * h;
    struct calx_moments at = {.positions = host->t + first, .forces = host->t + p->theta * h, .velocities = host->t + h};
    struct calx_problem *problem;
    host->each(host->engine, first, drift, NULL, NULL);
    if (host->contacts(host->engine, &at, &problem) || nscd_solve(p, host, problem, why, why_size) || host->impulses(host->engine))
        return 1;
    host->each(host->engine, h, kick, kick, NULL);
    host->each(host->engine, p->theta * h, drift, NULL, NULL);
    return 0;
}

static const struct calx_motion_integrator law = {
    .order = 2, /* of free flight; 1 through impacts */
    .reversible = 1,
    .symplectic = 1,
    .solves_impulses = 1,
    .stability = 2,
    .damping = 2,
    .reach = 0.1,
    .prepare = prepare,
    .advance = advance,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "nscd",
    .summary = "rigid bodies: impulses that fulfil the conditions of all contacts at once",
    .reference = "Moreau (1988); Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235; Renouf et al.",
    .equation = "x* = x + (1 - theta) h v;  v+ = v + h g(t + theta h) + M^-1 H r;  x+ = x* + theta h v+;\n"
                "r and H^T v+ fulfil the laws of all contacts with gap(x*) <= reach: Gauss-Seidel over the contacts, or accelerated projected gradients",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct nscd),
    .law = &law,
};

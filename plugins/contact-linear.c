/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "linear": a spring and a dashpot along the normal, fn = k d - c vn.
 * Reference: Cundall and Strack, Geotechnique 29 (1979) 47. The damping c comes from one of four
 * numbers: a restitution coefficient, c = 2 b sqrt(k m*), b = -ln e/sqrt(pi^2 + ln^2 e) (Schwager
 * and Poeschel, Granular Matter 9 (2007) 465); c itself; a rate, c = gamma m* (as in LAMMPS); or a
 * drag C on the relative velocity, normal and tangential, which against a wall at rest is the drag
 * -C v of the Tiaret thesis, and between two bodies keeps their momentum, which a drag on each of
 * them would not.
 */
#include <math.h>
#include <stdio.h>

#include "core/plugin.h"

struct linear {
    double stiffness, restitution, damping, damping_rate, drag, clip; /* from the table */
    double root, constant, rate; /* c = root sqrt(m*) + constant + rate m* */
    double floor;                /* N, the least normal force */
};

static const struct calx_parameter parameters[] = {
    {.name = "stiffness",
     .symbol = "k",
     .unit = "N/m",
     .doc = "Stiffness of the normal spring.",
     .min = 1e-9,
     .max = 1e15,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, stiffness)},
    {.name = "restitution",
     .symbol = "e",
     .unit = "1",
     .doc = "Ratio of speeds after and before a head-on impact; 0 means critical damping.",
     .min = 0,
     .max = 1,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, restitution)},
    {.name = "damping",
     .symbol = "c",
     .unit = "N s/m",
     .doc = "Damping coefficient of the normal dashpot.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, damping)},
    {.name = "damping-rate",
     .symbol = "gamma_n",
     .unit = "1/s",
     .doc = "Damping per effective mass: c = gamma_n m*.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, damping_rate)},
    {.name = "drag",
     .symbol = "C",
     .unit = "N s/m",
     .doc = "Drag -C (v_i - v_j) while in touch, along the normal and across it.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, drag)},
    {.name = "clip",
     .symbol = "clip",
     .unit = "1",
     .doc = "The normal force never attracts; with restitution the damping is chosen so that e "
            "still comes out.",
     .min = 0,
     .max = 1,
     .flags = CALX_SWITCH,
     .scope = CALX_PAIR,
     .offset = offsetof(struct linear, clip)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct linear *p = params;
    (void)setup;
    if (!isnan(p->restitution) + !isnan(p->damping) + !isnan(p->damping_rate) + !isnan(p->drag) >
        1) {
        snprintf(
            why, why_size,
            "restitution, damping, damping-rate and drag exclude each other: give at most one");
        return 1;
    }
    int drag = p->drag > 0;
    p->root = isnan(p->restitution)
                  ? 0
                  : 2 * calx_damping_ratio(p->restitution, p->clip > 0) * sqrt(p->stiffness);
    p->constant = p->damping > 0 ? p->damping : drag ? p->drag : 0;
    p->rate = p->damping_rate > 0 ? p->damping_rate : 0;
    p->floor = p->clip > 0 ? 0 : -INFINITY;
    int damped = p->root > 0 || p->constant > 0 || p->rate > 0;
    demand->needs = (drag ? CALX_NEEDS_TANGENT : 0) | (damped ? CALX_USES_VELOCITY : 0);
    demand->history_vectors = drag;
    demand->history_scalars = damped;
    return 0;
}

static inline double damping(const struct linear *p, double mass)
{
    return p->root * sqrt(mass) + p->constant + p->rate * mass;
}

CALX_KERNEL static void push_elastic(size_t n, double k, const double *restrict overlap,
                                     double *restrict fn)
{
    for (size_t c = 0; c < n; c++)
        fn[c] += overlap[c] > 0 ? k * overlap[c] : 0;
}

/* old: the dissipative force of the evaluation before, for the trapezoid. */
CALX_KERNEL static void push_damped(size_t n, struct linear p, double dt,
                                    const double *restrict overlap, const double *restrict vn,
                                    const double *restrict mass, double *restrict fn,
                                    double *restrict work, double *restrict old)
{
    for (size_t c = 0; c < n; c++) {
        double spring = p.stiffness * overlap[c];
        double f = spring - damping(&p, mass[c]) * vn[c];
        f = f < p.floor ? p.floor : f;
        f = overlap[c] > 0 ? f : 0;
        double lost = overlap[c] > 0 ? f - spring : 0;
        fn[c] += f;
        work[c] -= 0.5 * (old[c] + lost) * vn[c] * dt;
        old[c] = lost;
    }
}

/* One component of the tangential drag. */
CALX_KERNEL static void drag_along(size_t n, double drag, double dt, const double *restrict overlap,
                                   const double *restrict vt, double *restrict ft,
                                   double *restrict work, double *restrict old)
{
    for (size_t c = 0; c < n; c++) {
        double f = overlap[c] > 0 ? -drag * vt[c] : 0;
        ft[c] += f;
        work[c] -= 0.5 * (old[c] + f) * vt[c] * dt;
        old[c] = f;
    }
}

static void force(const void *params, const struct calx_contacts *b)
{
    const struct linear *p = params;
    size_t n = calx_padded(b->n), vectors = p->drag > 0;
    if (p->root > 0 || p->constant > 0 || p->rate > 0)
        push_damped(n, *p, b->dt, b->overlap, b->vn, b->mass, b->fn, b->work,
                    b->history[3 * vectors]);
    else
        push_elastic(n, p->stiffness, b->overlap, b->fn);
    for (size_t k = 0; k < 3 * vectors; k++)
        drag_along(n, p->drag, b->dt, b->overlap, b->vt[k], b->ft[k], b->work, b->history[k]);
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct linear *p = params;
    for (size_t c = 0; c < b->n; c++) {
        if (b->overlap[c] <= 0)
            continue;
        if (r->energy)
            r->energy[c] += 0.5 * p->stiffness * b->overlap[c] * b->overlap[c];
        if (r->stiffness[0])
            r->stiffness[0][c] += p->stiffness;
        if (r->damping[0])
            r->damping[0][c] += damping(p, b->mass[c]);
        if (r->damping[1] && p->drag > 0)
            r->damping[1][c] += p->drag;
    }
}

static const char *const history[] = {"drag", "damping-force"};

static const struct calx_contact_law law = {
    .provides = CALX_NORMAL,
    .demand = {.needs = CALX_NEEDS_TANGENT | CALX_USES_VELOCITY, .history_vectors = 1, .history_scalars = 1},
    .history = history,
    .prepare = prepare,
    .force = force,
    .response = response,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "linear",
    .summary = "spring and dashpot along the normal",
    .reference =
        "Cundall and Strack, Geotechnique 29 (1979) 47; damping: Schwager and Poeschel, Granular "
        "Matter 9 (2007) 465",
    .equation = "fn = k d - c vn;  c = 2 b sqrt(k m*), b = -ln e/sqrt(pi^2 + ln^2 e), or c, or "
                "gamma_n m*, or C;\n"
                "with C also ft = -C vt;  clip: fn = max(0, k d - c vn)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct linear),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "hertz": elastic spheres, fn = (4/3) E* sqrt(R*) d^(3/2) - c vn.
 * Reference: Johnson, Contact Mechanics (1985), ch. 4; damping by restitution: Tsuji, Tanaka and
 * Ishida, Powder Technology 71 (1992) 239, c = 2 sqrt(5/6) b sqrt(S m*) with S = 2 E* sqrt(R* d)
 * and b = -ln e/sqrt(pi^2 + ln^2 e), which gives e at any speed; or a constant c. The normal force
 * may attract at the end of an impact unless clip is on.
 */
#include <math.h>
#include <stdio.h>

#include "core/plugin.h"

struct hertz {
    double young[2], poisson[2], restitution, damping, clip; /* from the table */
    double modulus;                                          /* Pa, E* */
    double root, constant;                                   /* c = root sqrt(S m*) + constant */
    double floor;                                            /* N, the least normal force */
};

static const struct calx_parameter parameters[] = {
    {.name = "young",
     .symbol = "E",
     .unit = "Pa",
     .doc = "Young's modulus of the material.",
     .min = 1,
     .max = 1e20,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct hertz, young)},
    {.name = "poisson",
     .symbol = "nu",
     .unit = "1",
     .doc = "Poisson's ratio of the material.",
     .min = -0.99,
     .max = 0.5,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct hertz, poisson)},
    {.name = "restitution",
     .symbol = "e",
     .unit = "1",
     .doc = "Ratio of speeds after and before a head-on impact; 0 means critical damping.",
     .min = 0,
     .max = 1,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct hertz, restitution)},
    {.name = "damping",
     .symbol = "c",
     .unit = "N s/m",
     .doc = "Damping coefficient of the normal dashpot.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct hertz, damping)},
    {.name = "clip",
     .symbol = "clip",
     .unit = "1",
     .doc = "The normal force never attracts; with restitution the damping is chosen so that e "
            "still comes out.",
     .min = 0,
     .max = 1,
     .flags = CALX_SWITCH,
     .scope = CALX_PAIR,
     .offset = offsetof(struct hertz, clip)},
};

static int damped(const struct hertz *p)
{
    return p->root > 0 || p->constant > 0;
}

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct hertz *p = params;
    if (setup->bodies == CALX_DISCS) {
        snprintf(
            why, why_size,
            "discs touch along a line, where overlap does not determine the force: use linear");
        return 1;
    }
    if (!isnan(p->restitution) && !isnan(p->damping)) {
        snprintf(why, why_size, "restitution and damping exclude each other: give at most one");
        return 1;
    }
    p->modulus = calx_effective_modulus(p->young, p->poisson);
    p->root = isnan(p->restitution)
                  ? 0
                  : 2 * sqrt(5.0 / 6.0) * calx_damping_ratio(p->restitution, p->clip > 0);
    p->constant = p->damping > 0 ? p->damping : 0;
    p->floor = p->clip > 0 ? 0 : -INFINITY;
    demand->needs = CALX_NEEDS_CURVATURE | (damped(p) ? CALX_USES_VELOCITY : 0);
    demand->history_scalars = damped(p);
    return 0;
}

/* S = d fn/d overlap = 2 E* sqrt(R* d), with 1/R* the sum of the curvatures. */
static inline double stiffness(const struct hertz *p, double d, double k1, double k2)
{
    return d > 0 ? 2 * p->modulus * sqrt(d / (k1 + k2)) : 0;
}

static inline double damping(const struct hertz *p, double s, double mass)
{
    return p->constant + p->root * sqrt(s * mass);
}

CALX_KERNEL static void push_elastic(size_t n, struct hertz p, const double *restrict overlap,
                                     const double *restrict k1, const double *restrict k2,
                                     double *restrict fn)
{
    for (size_t c = 0; c < n; c++)
        fn[c] += 2.0 / 3.0 * stiffness(&p, overlap[c], k1[c], k2[c]) * overlap[c];
}

/* old: the dissipative force of the evaluation before, for the trapezoid. */
CALX_KERNEL static void push_damped(size_t n, struct hertz p, double dt,
                                    const double *restrict overlap, const double *restrict vn,
                                    const double *restrict mass, const double *restrict k1,
                                    const double *restrict k2, double *restrict fn,
                                    double *restrict work, double *restrict old)
{
    for (size_t c = 0; c < n; c++) {
        double s = stiffness(&p, overlap[c], k1[c], k2[c]);
        double spring = 2.0 / 3.0 * s * overlap[c];
        double f = spring - damping(&p, s, mass[c]) * vn[c];
        f = f < p.floor ? p.floor : f;
        f = overlap[c] > 0 ? f : 0;
        double lost = f - spring;
        fn[c] += f;
        work[c] -= 0.5 * (old[c] + lost) * vn[c] * dt;
        old[c] = lost;
    }
}

static void force(const void *params, const struct calx_contacts *b)
{
    const struct hertz *p = params;
    size_t n = calx_padded(b->n);
    if (damped(p))
        push_damped(n, *p, b->dt, b->overlap, b->vn, b->mass, b->curvature[0],
                    b->curvature[1], b->fn, b->work, b->history[0]);
    else
        push_elastic(n, *p, b->overlap, b->curvature[0], b->curvature[1], b->fn);
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct hertz *p = params;
    for (size_t c = 0; c < b->n; c++) {
        double d = b->overlap[c], s = stiffness(p, d, b->curvature[0][c], b->curvature[1][c]);
        if (d <= 0)
            continue;
        if (r->energy)
            r->energy[c] += 4.0 / 15.0 * s * d * d;
        if (r->stiffness[0])
            r->stiffness[0][c] += s;
        if (r->damping[0])
            r->damping[0][c] += damping(p, s, b->mass[c]);
    }
}

static const char *const history[] = {"damping-force"};

static const struct calx_contact_law law = {
    .provides = CALX_NORMAL,
    .demand = {.needs = CALX_NEEDS_CURVATURE | CALX_USES_VELOCITY, .history_scalars = 1},
    .history = history,
    .prepare = prepare,
    .force = force,
    .response = response,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "hertz",
    .summary = "elastic spheres, with damping by restitution",
    .reference = "Johnson, Contact Mechanics (1985), ch. 4; Tsuji, Tanaka and Ishida, Powder "
                 "Technology 71 (1992) 239",
    .equation =
        "fn = (4/3) E* sqrt(R*) d^(3/2) - c vn;  1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2;\n"
        "c = 2 sqrt(5/6) b sqrt(S m*), S = 2 E* sqrt(R* d), b = -ln e/sqrt(pi^2 + ln^2 e), or c;\n"
        "clip: fn = max(0, ...)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct hertz),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "cohesion-thermal": the pull of "cohesive", from adhesion energies of the two bodies that change with their temperatures,
 * eta(T) = eta_0 + eta_1 tanh((T_tr - T)/T_w). Between equal bodies gamma = eta/R. The paper gives the numbers of eta and uses them as gamma in
 * newtons: its 0.075 + 0.05 tanh((800 - T)/10) are eta_0 = 0.075 N R and eta_1 = 0.05 N R here. A flat wall has no such adhesion (R infinite).
 * Reference: Renouf et al.
 */
#include <math.h>
#include <stdio.h>

#include "core/plugin.h"

struct thermal {
    double energy[2], change[2], middle[2], width[2], reach; /* from the table */
};

static const struct calx_parameter parameters[] = {
    {.name = "adhesion",
     .symbol = "eta_0",
     .unit = "J",
     .doc = "Adhesion energy at the transition temperature; eta_0/R is the pull between equal bodies.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct thermal, energy)},
    {.name = "adhesion-change",
     .symbol = "eta_1",
     .unit = "J",
     .doc = "What a cold body has more than that, and a hot one less; not more than the adhesion itself.",
     .min = -1e12,
     .max = 1e12,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct thermal, change)},
    {.name = "transition-temperature",
     .symbol = "T_tr",
     .unit = "K",
     .doc = "Temperature at which adhesion changes.",
     .initial = 293.15,
     .min = 0,
     .max = 1e6,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct thermal, middle)},
    {.name = "transition-width",
     .symbol = "T_w",
     .unit = "K",
     .doc = "Difference of temperature over which it does.",
     .initial = 10,
     .min = 1e-6,
     .max = 1e6,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct thermal, width)},
    {.name = "distance",
     .symbol = "d_w",
     .unit = "m",
     .doc = "Largest gap at which bodies attract each other.",
     .min = 0,
     .max = 1e3,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct thermal, reach)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand, char *why, size_t why_size)
{
    const struct thermal *p = params;
    (void)setup;
    for (int k = 0; k < 2; k++)
        if (fabs(p->change[k]) > p->energy[k]) {
            snprintf(why, why_size, "adhesion-change %g J is more than the adhesion %g J: the pull would become a push", p->change[k],
                     p->energy[k]);
            return 1;
        }
    demand->gap = p->reach;
    return 0;
}

static double adhesion(const struct thermal *p, int body, double temperature)
{
    return p->energy[body] + p->change[body] * tanh((p->middle[body] - temperature) / p->width[body]);
}

/* 2 eta_i eta_j/(eta_i R_j + eta_j R_i), with curvatures. */
static void condition(const void *params, const struct calx_contacts *b, const struct calx_condition *c)
{
    const struct thermal *p = params;
    for (size_t k = 0; k < b->n; k++) {
        double pull[2];
        for (int body = 0; body < 2; body++)
            pull[body] = adhesion(p, body, b->temperature[body][k]) * b->curvature[body][k];
        c->pull[k] += pull[0] + pull[1] > 0 ? 2 * pull[0] * pull[1] / (pull[0] + pull[1]) : 0;
        c->reach[k] = p->reach;
    }
}

static const struct calx_contact_law law = {
    .provides = CALX_COHESION,
    .depends = CALX_NORMAL,
    .nonsmooth = 1,
    .demand = {.needs = CALX_NEEDS_TEMPERATURE | CALX_NEEDS_CURVATURE},
    .prepare = prepare,
    .condition = condition,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "cohesion-thermal",
    .summary = "pull from adhesion energies that depend on temperature (non-smooth)",
    .reference = "Renouf et al.",
    .equation = "r_n >= -gamma h while gap <= d_w, gamma = 2 eta_i eta_j/(eta_i R_j + eta_j R_i);\n"
                "eta = eta_0 + eta_1 tanh((T_tr - T)/T_w)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct thermal),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductance "overlap": heat flows through the circle in which two spheres intersect, H = 2 k r_c.
 * Reference: Batchelor and O'Brien, Proc. R. Soc. Lond. A 355 (1977) 313 (H = 2 k a), with the
 * radius of the circle as in the Tiaret thesis: r_c^2 = R1^2 - ((R1^2 - R2^2 + L^2)/(2 L))^2. With
 * L = R1 + R2 - d and the curvatures K = 1/R this is the form below, which holds for a wall (K = 0)
 * too: r_c^2 = d (2 R - d). Unlike materials: k = 2 k1 k2/(k1 + k2).
 */
#include <math.h>
#include <stdio.h>

#include "core/plugin.h"

struct overlap {
    double conductivity[2];
    double twice; /* W/(m K), 2 k */
};

static const struct calx_parameter parameters[] = {
    {.name = "conductivity",
     .symbol = "k",
     .unit = "W/(m K)",
     .doc = "Thermal conductivity of the material.",
     .min = 0,
     .max = 1e6,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct overlap, conductivity)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct overlap *p = params;
    (void)demand;
    if (setup->bodies == CALX_DISCS) {
        snprintf(why, why_size,
                 "the circle of two spheres has no counterpart for discs: use hertz or constant");
        return 1;
    }
    p->twice = 2 * calx_pair_conductivity(p->conductivity);
    return 0;
}

CALX_KERNEL static void conduct(size_t n, double twice, const double *restrict overlap,
                                const double *restrict k1, const double *restrict k2,
                                double *restrict conductance)
{
    for (size_t c = 0; c < n; c++) {
        double d = overlap[c] > 0 ? overlap[c] : 0;
        double product = k1[c] * k2[c], sum = k1[c] + k2[c];
        double upper = d * (2 - k1[c] * d) * (2 - k2[c] * d) * (2 * sum - d * product);
        double lower = sum - d * product;
        double r2 =
            upper > 0 ? upper / (4 * lower * lower) : 0; /* 0: one sphere is inside the other */
        conductance[c] = twice * sqrt(r2);
    }
}

static void conductance(const void *params, const struct calx_contacts *b, double *h)
{
    const struct overlap *p = params;
    conduct(calx_padded(b->n), p->twice, b->overlap, b->curvature[0], b->curvature[1], h);
}

static const struct calx_conductance_law law = {
    .demand = {.needs = CALX_NEEDS_CURVATURE},
    .prepare = prepare,
    .conductance = conductance,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONDUCTANCE,
    .name = "overlap",
    .summary = "conduction through the circle in which two spheres intersect",
    .reference = "Batchelor and O'Brien, Proc. R. Soc. Lond. A 355 (1977) 313",
    .equation = "H = 2 k r_c;  r_c^2 = R1^2 - ((R1^2 - R2^2 + L^2)/(2 L))^2, L = R1 + R2 - d;  k = "
                "2 k1 k2/(k1 + k2)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct overlap),
    .law = &law,
};

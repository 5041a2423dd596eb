/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductance "overlap-area", for the comparison with LIGGGHTS only: H = 4 k1 k2/(k1 + k2) sqrt(A),
 * A the area of the circle in which two spheres intersect. It is sqrt(pi) times that of "overlap",
 * whose length of contact is the radius of that circle. Reference: Chaudhuri, Muzzio and Tomassone,
 * Chem. Eng. Sci. 61 (2006) 6348, as LIGGGHTS 3.8 has it.
 */
#include <math.h>

#include "core/plugin.h"

struct area {
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
     .offset = offsetof(struct area, conductivity)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct area *p = params;
    (void)setup, (void)demand, (void)why, (void)why_size;
    p->twice = 2 * calx_pair_conductivity(p->conductivity);
    return 0;
}

/* With L = R1 + R2 - d: A = pi/4 (4 R1^2 - ((L^2 + R1^2 - R2^2)/L)^2), and K = 1/R to hold for a
 * wall too. */
CALX_KERNEL static void conduct(size_t n, double twice, const double *restrict overlap,
                                const double *restrict k1, const double *restrict k2,
                                double *restrict conductance)
{
    const double pi = 3.14159265358979323846;
    for (size_t c = 0; c < n; c++) {
        double d = overlap[c] > 0 ? overlap[c] : 0;
        double sum = k1[c] + k2[c], length = sum - d * k1[c] * k2[c]; /* L K1 K2 */
        double heron = d * (2 - k1[c] * d) * (2 - k2[c] * d) * (sum + length);
        double area = heron > 0 ? pi * heron / (4 * length * length) : 0;
        conductance[c] = twice * sqrt(area);
    }
}

static void conductance(const void *params, const struct calx_contacts *b, double *h)
{
    const struct area *p = params;
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
    .name = "overlap-area",
    .summary = "conduction through the root of the area in which two spheres intersect",
    .reference = "Chaudhuri, Muzzio and Tomassone, Chem. Eng. Sci. 61 (2006) 6348",
    .equation = "H = 4 k1 k2/(k1 + k2) sqrt(A);  A = pi (R1^2 - ((R1^2 - R2^2 + L^2)/(2 L))^2), L "
                "= R1 + R2 - d",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct area),
    .law = &law,
};

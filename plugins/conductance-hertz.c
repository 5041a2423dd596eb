/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductance "hertz": heat flows through the area that the normal force presses flat.
 * Spheres: H = 2 k a, a = (3 fn R* / (4 E*))^(1/3); Batchelor and O'Brien, Proc. R. Soc. Lond. A
 * 355 (1977) 313. Discs of length L: H = 2 k sqrt(2 b L), b^2 = 4 fn R* / (pi L E*); Yovanovich as
 * used by Renouf et al. The stiffness of the contact law may be chosen at will: only its force
 * matters here.
 */
#include <math.h>

#include "core/plugin.h"

struct hertz {
    double conductivity[2], young[2], poisson[2]; /* from the table */
    double discs;                                 /* 1 or 0 */
    double scale;                                 /* H = 2 k (scale fn R*)^(1/3), or ^(1/4) */
    double twice;                                 /* W/(m K), 2 k */
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
     .offset = offsetof(struct hertz, conductivity)},
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
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct hertz *p = params;
    double modulus = calx_effective_modulus(p->young, p->poisson), length = setup->thickness;
    (void)demand, (void)why, (void)why_size;
    p->discs = setup->bodies == CALX_DISCS;
    /* (2 b L)^2 = 4 L^2 b^2 = 16 fn R* L/(pi E*) */
    p->scale = p->discs > 0 ? 16 * length / (M_PI * modulus) : 3 / (4 * modulus);
    p->twice = 2 * calx_pair_conductivity(p->conductivity);
    return 0;
}

static void conductance(const void *params, const struct calx_contacts *b, double *restrict h)
{
    const struct hertz *p = params;
    for (size_t c = 0; c < b->n; c++) {
        double fn = b->overlap[c] > 0 && b->fn[c] > 0 ? b->fn[c] : 0;
        double pressed = p->scale * fn / (b->curvature[0][c] + b->curvature[1][c]);
        h[c] = p->twice * (p->discs > 0 ? sqrt(sqrt(pressed)) : cbrt(pressed));
    }
}

static const struct calx_conductance_law law = {
    .demand = {.needs = CALX_NEEDS_NORMAL_FORCE | CALX_NEEDS_CURVATURE},
    .prepare = prepare,
    .conductance = conductance,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONDUCTANCE,
    .name = "hertz",
    .summary = "conduction through the area that the normal force presses flat",
    .reference = "Batchelor and O'Brien, Proc. R. Soc. Lond. A 355 (1977) 313; discs: Yovanovich "
                 "as used by Renouf et al.",
    .equation = "spheres: H = 2 k a, a = (3 fn R*/(4 E*))^(1/3);\n"
                "discs: H = 2 k sqrt(2 b L), b^2 = 4 fn R*/(pi L E*);  k = 2 k1 k2/(k1 + k2)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct hertz),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductance "hertz": heat flows through the area that the normal force presses flat.
 * Spheres: H = 2 k a, a = (3 fn R* / (4 E*))^(1/3); Batchelor and O'Brien, Proc. R. Soc. Lond. A
 * 355 (1977) 313. Discs of length L: H = 2 k sqrt(2 b L), b^2 = 4 fn R* / (pi L E*); Yovanovich as
 * used by Renouf et al. The stiffness of the contact law may be chosen at will: only its force
 * matters here.
 */
#include <math.h>
#include <string.h>

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

/* The cube root of v >= 0, in operations that vectorise. A third of the exponent and of the first bits after it, as one number, is
 * right within 5 %; each of Halley's steps leaves less than the cube of the error: 1e-4, 1e-12, rounding. */
static inline double cube_root(double v)
{
    const uint64_t middle = (uint64_t)((2.0 / 3.0 * 1023 - 0.0331) * (1 << 20));
    uint64_t bits;
    double root;
    memcpy(&bits, &v, sizeof bits);
    bits = (((bits >> 32) * 0x55555556u >> 32) + middle) << 32;
    memcpy(&root, &bits, sizeof root);
    for (int turn = 0; turn < 3; turn++) {
        double cube = root * root * root;
        root *= (cube + 2 * v) / (2 * cube + v);
    }
    return v > 0 ? root : 0;
}

/* `discs` is known when this is compiled. */
static inline __attribute__((always_inline)) void press(const int discs, size_t n, const struct hertz *p,
                                                        const double *restrict overlap, const double *restrict normal_force,
                                                        const double *restrict k1, const double *restrict k2,
                                                        double *restrict h)
{
    const double scale = p->scale, twice = p->twice;
    for (size_t c = 0; c < n; c++) {
        double fn = overlap[c] > 0 && normal_force[c] > 0 ? normal_force[c] : 0;
        double pressed = scale * fn / (k1[c] + k2[c]);
        h[c] = twice * (discs ? sqrt(sqrt(pressed)) : cube_root(pressed));
    }
}

CALX_KERNEL static void press_spheres(size_t n, const struct hertz *p, const double *restrict overlap,
                                      const double *restrict fn, const double *restrict k1,
                                      const double *restrict k2, double *restrict h)
{
    press(0, n, p, overlap, fn, k1, k2, h);
}

CALX_KERNEL static void press_discs(size_t n, const struct hertz *p, const double *restrict overlap,
                                    const double *restrict fn, const double *restrict k1,
                                    const double *restrict k2, double *restrict h)
{
    press(1, n, p, overlap, fn, k1, k2, h);
}

static void conductance(const void *params, const struct calx_contacts *b, double *restrict h)
{
    const struct hertz *p = params;
    (p->discs > 0 ? press_discs : press_spheres)(calx_padded(b->n), p, b->overlap, b->fn, b->curvature[0], b->curvature[1],
                                                 h);
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

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Elastic materials and the duration of an impact, for the tests that let bodies collide.
 */
#ifndef CALX_TESTS_IMPACTS_H
#define CALX_TESTS_IMPACTS_H

#include <math.h>

#include "tests/scenes.h"

#define DEGREE (M_PI / 180.0)

struct material {
    double young, poisson, density;
};

static const struct material GLASS = {4.8e10, 0.20, 2800}, LIMESTONE = {2.0e10, 0.25, 2500},
                             AL = {7.0e10, 0.30, 2699}, MG = {4.0e10, 0.35, 1800},
                             OXIDE = {3.8e11, 0.23, 4000}, IRON = {1.0e11, 0.25, 7000},
                             AL7 = {7.0e10, 0.33, 2700}, RIGID = {1e20, 0.3, 1.0};

static inline void set_material(struct calx_scene *s, int m, const struct material *material)
{
    s->materials[m].density = material->density;
    scene_material_value(s, m, "young", material->young);
    scene_material_value(s, m, "poisson", material->poisson);
}

/* 2.868266 (m*^2/(R* E*^2 v))^(1/5): the duration of an elastic impact, to choose the step. */
static inline double hertz_duration(double modulus, double mass, double radius, double v)
{
    return 2.868266 * pow(mass * mass / (radius * modulus * modulus * v), 0.2);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Times by which steps are often chosen. Rayleigh: a surface wave goes half around the grain, pi R sqrt(rho/G)/(0.1631 nu + 0.8766)
 * (Thornton and Randall, Micromechanics of Granular Materials (1988) 133). Hertz: an elastic impact lasts 2.868266 (m*^2/(R* E*^2
 * v))^(1/5) (Johnson, Contact Mechanics (1985), section 11.4).
 */
#include "core/collision_times.h"

#include <math.h>
#include <stdlib.h>

#include "core/state.h"

struct kind {
    double radius, mass, young, poisson; /* radius 0: walls only */
};

static struct kind kind_of(const struct calx_scene *scene, size_t m)
{
    struct kind k = {INFINITY, INFINITY, calx_scene_material_value(scene, m, "young"),
                     calx_scene_material_value(scene, m, "poisson")};
    for (size_t i = 0; i < scene->particles.count; i++)
        if ((size_t)scene->particles.material[i] == m)
            k.radius = fmin(k.radius, scene->particles.radius[i]);
    if (isfinite(k.radius))
        k.mass = calx_particle_mass(scene, k.radius, scene->materials[m].density);
    return k;
}

static double rayleigh(const struct calx_scene *scene, const struct kind *k, size_t m)
{
    double shear = k->young / (2.0 * (1.0 + k->poisson));
    return M_PI * k->radius * sqrt(scene->materials[m].density / shear) / (0.1631 * k->poisson + 0.8766);
}

static double hertz(const struct kind *a, const struct kind *b, double speed)
{
    double modulus = calx_effective_modulus((const double[2]){a->young, b->young}, (const double[2]){a->poisson, b->poisson});
    double mass = 1.0 / (1.0 / a->mass + 1.0 / b->mass), radius = 1.0 / (1.0 / a->radius + 1.0 / b->radius);
    return 2.868266 * pow(mass * mass / (radius * modulus * modulus * speed), 0.2);
}

struct calx_collision_times calx_collision_times_find(const struct calx_scene *scene, double speed)
{
    struct calx_collision_times t = {INFINITY, INFINITY, -1, {-1, -1}};
    for (size_t i = 0; i < scene->material_count; i++) {
        struct kind a = kind_of(scene, i);
        double wave = rayleigh(scene, &a, i);
        if (!isfinite(a.radius) || isnan(wave))
            continue;
        if (wave < t.rayleigh) {
            t.rayleigh = wave;
            t.rayleigh_material = (int)i;
        }
        for (size_t j = 0; j < scene->material_count; j++) {
            struct kind b = kind_of(scene, j);
            double impact = speed > 0.0 ? hertz(&a, &b, speed) : INFINITY;
            if (impact < t.hertz) {
                t.hertz = impact;
                t.hertz_material[0] = (int)i;
                t.hertz_material[1] = (int)j;
            }
        }
    }
    return t;
}

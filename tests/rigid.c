/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Scenes of rigid bodies: see rigid.h.
 */
#include <math.h>

#include "tests/rigid.h"

void rigid_models(struct calx_scene *s, double friction, double restitution, double turning, double dt,
                  const struct given *solver)
{
    scene_model(s, CALX_CONTACT, "signorini-coulomb",
                (struct given[]){{"friction", friction}, {"restitution", restitution}, {"turning", turning}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "nscd", solver);
    s->models[0].dt = dt;
}

int rigid_floor(struct calx_scene *s)
{
    int wall = scene_wall(s, "floor", 0);
    scene_plane(s, wall, (double[3]){0, 0, 0}, s->dimension == 2 ? (double[3]){0, 1, 0} : (double[3]){0, 0, 1});
    return wall;
}

double rigid_weight(const struct run *r, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += G * run_mass(r, (int64_t)i);
    return sum;
}

struct calx_scene *rigid_column(size_t n, double top, double dt, const struct given *solver)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, n);
    scene_material(s, "top", top, 1000.0);
    for (size_t i = 0; i < n; i++)
        scene_put(s, i, 0.0, 0.0, RADIUS * (2.0 * (double)i + 1.0), RADIUS);
    s->particles.material[n - 1] = 1;
    scene_gravity(s, 0.0, 0.0, -G);
    rigid_floor(s);
    rigid_models(s, 0.0, 0.0, 1.0, dt, solver);
    return s;
}

double rigid_worst_force(const struct run *r, size_t n)
{
    struct calx_frame *f = calx_frame_create(r->sim, true);
    double worst = 0.0, weight = rigid_weight(r, n);
    size_t found = 0;
    ck_assert_ptr_nonnull(f);
    for (size_t k = 0; k < f->contact_count; k++) {
        double above = 0.0;
        int64_t lower = f->pair[k][1] < 0 ? -1 : f->pair[k][0] < f->pair[k][1] ? f->pair[k][0] : f->pair[k][1];
        for (int64_t i = lower + 1; i < (int64_t)n; i++)
            above += G * run_mass(r, i);
        worst = fmax(worst, fabs(f->normal_force[k] - above) / weight);
        found++;
    }
    calx_frame_free(f);
    return found == n ? worst : 1.0; /* a contact without any force is not there */
}

struct calx_scene *rigid_incline(uint32_t bodies, double slope_, double friction, double turning, double dt)
{
    struct calx_scene *s = scene_create(bodies == CALX_DISCS ? 2 : 3, bodies, 1);
    double a = atan(slope_);
    if (bodies == CALX_DISCS) {
        scene_put(s, 0, 0.0, RADIUS, 0.0, RADIUS);
        scene_gravity(s, G * sin(a), -G * cos(a), 0.0);
    } else {
        scene_put(s, 0, 0.0, 0.0, RADIUS, RADIUS);
        scene_gravity(s, G * sin(a), 0.0, -G * cos(a));
    }
    rigid_floor(s);
    rigid_models(s, friction, 0.0, turning, dt, NULL);
    return s;
}

struct calx_scene *rigid_pile(double friction, double restitution, double gravity, const struct given *solver)
{
    enum { EDGE = 5, N = EDGE * EDGE * EDGE };
    struct calx_scene *s = scene_create(3, CALX_SPHERES, N);
    struct calx_random random;
    calx_random_seed(&random, 3);
    for (size_t i = 0; i < N; i++) {
        const size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double x[3], v[3];
        for (int k = 0; k < 3; k++) {
            x[k] = RADIUS * (2.1 * (double)at[k] + 1.1 + 0.05 * calx_random_uniform(&random));
            v[k] = 0.4 * (calx_random_uniform(&random) - 0.5);
        }
        scene_put(s, i, x[0], x[1], x[2], RADIUS * (0.8 + 0.1 * (double)(i % 3)));
        scene_move(s, i, v[0], v[1], v[2]);
    }
    scene_gravity(s, 0.0, 0.0, -gravity);
    rigid_models(s, friction, restitution, 1.0, 5e-4, solver);
    return s;
}

void rigid_box(struct calx_scene *s, double size)
{
    int box = scene_wall(s, "box", 0);
    for (int k = 0; k < 2; k++)
        for (int side = 0; side < 2; side++) {
            double a[3] = {0}, n[3] = {0};
            a[k] = side * size;
            n[k] = side ? -1.0 : 1.0;
            scene_plane(s, box, a, n);
        }
}

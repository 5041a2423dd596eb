/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Scenes built in code, for the tests of the engine: the calls below stand for the elements of a
 * case file. A failed call fails the test that makes it.
 */
#ifndef CALX_TESTS_SCENES_H
#define CALX_TESTS_SCENES_H

#include <check.h>

#include "core/random.h"
#include "core/state.h"

/* One scene with the simulation made from it. Free with run_free(). */
struct run {
    struct calx_scene *scene;
    struct calx_registry *registry;
    struct calx_sim *sim;
};

/* A number of a material or a model, in SI. Lists end with a NULL name. */
struct given {
    const char *name;
    double value;
};

/* A scene of one endless stage with `particles` grains at rest (their rows zero, their radius 1) of
 * one material "grain" of density 1000 kg/m3 and specific heat 1000 J/(kg K), and one set of models
 * without any. Discs have a thickness of 1 m. */
struct calx_scene *scene_create(uint32_t dimension, uint32_t bodies, size_t particles);

/* Adds a material; returns its index. */
int scene_material(struct calx_scene *, const char *name, double density, double specific_heat);
/* Adds a number to material m. */
void scene_material_value(struct calx_scene *, int m, const char *name, double value);
/* Adds a plugin with these numbers to the first set of models. */
void scene_model(struct calx_scene *, enum calx_kind, const char *plugin, const struct given *);
/* Like scene_model() with one number, or none if name is NULL. */
void scene_model1(struct calx_scene *, enum calx_kind, const char *plugin, const char *name,
                  double value);

/* Linear spring (restitution NaN: undamped) and, if friction >= 0, coulomb of stiffness 2/7 of it;
 * velocity Verlet with dt. */
void scene_linear(struct calx_scene *, double stiffness, double restitution, double friction,
                  double dt);
/* The same with another integrator of motion. */
void scene_linear_by(struct calx_scene *, const char *integrator, double stiffness,
                     double restitution, double friction, double dt);

void scene_put(struct calx_scene *, size_t i, double x, double y, double z, double radius);
void scene_move(struct calx_scene *, size_t i, double vx, double vy, double vz);
void scene_spin(struct calx_scene *, size_t i, double wx, double wy, double wz);
void scene_warm(struct calx_scene *, size_t i, double temperature);
void scene_fix(struct calx_scene *, size_t i);
void scene_gravity(struct calx_scene *, double gx, double gy, double gz);
/* Extent along axis k; kind 'p' periodic, 'b' bounded. */
void scene_extent(struct calx_scene *, int k, double low, double high, char kind);

/* Adds an insulated wall without primitives, at rest; returns its index. */
int scene_wall(struct calx_scene *, const char *name, int material);
/* Adds primitives to a wall. */
void scene_segment(struct calx_scene *, int wall, double ax, double ay, double bx, double by,
                   int32_t surface);
void scene_plane(struct calx_scene *, int wall, const double a[3], const double n[3]);
struct calx_primitive *scene_primitive(struct calx_scene *, int wall, struct calx_primitive);
/* Adds a rigid group, insulated and at rest; returns the index of the wall that it is. */
int scene_group(struct calx_scene *, const char *name);
/* Makes grain i a body of it. */
void scene_carry(struct calx_scene *, size_t i, int group);
/* Gives a wall a temperature. */
void scene_wall_temperature(struct calx_scene *, int wall, double temperature);
/* The motion of a wall in stage s, to be filled in. */
struct calx_motion *scene_motion(struct calx_scene *, size_t stage, int wall);
/* Adds a copy of the last stage; returns its index. */
size_t scene_stage(struct calx_scene *);
/* Gives the stage models of its own, at first those of the first set; returns them. */
struct calx_models *scene_models_anew(struct calx_scene *, size_t stage);

/* Makes the simulation; the run owns the scene. */
struct run run_start(struct calx_scene *, int threads);
/* The same for a scene that must be refused: *e says why. */
void run_refused(struct calx_scene *, struct calx_error *e);
/* A second simulation of the same scene, without the scene: free it with run_free() first. */
struct run run_again(const struct run *, int threads);
void run_steps(const struct run *, size_t steps);
void run_free(struct run *);

/* Rows of grain `id` now: {x, y, z, R} and {vx, vy, vz, 1/m, wx, wy, wz, T}. */
const double *run_x(const struct run *, int64_t id);
const double *run_v(const struct run *, int64_t id);
/* Mass of a grain, kg. */
double run_mass(const struct run *, int64_t id);

/* Slope of the least-squares line of log y over log x. */
double slope(size_t n, const double *x, const double *y);

/* Runs the suite `name` of the functions in the list; returns what main() returns. */
int run_tests(const char *name, size_t n, const TTest *const *tests);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Moving walls: poses and speeds against closed forms, functions of time, a wall that comes upon
 * grains, a grain that rolls in a turning drum.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double STIFFNESS = 1e5, RADIUS = 0.1;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- moving walls ---- */

/* A scene of one far grain and one wall of a plane, a segment or a cylinder with the motion to be
 * set. */
static struct calx_scene *moving_scene(double dt)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_linear(s, STIFFNESS, NAN, -1.0, dt);
    scene_put(s, 0, 0.0, 0.0, 6.0, RADIUS);
    int w = scene_wall(s, "mover", 0);
    scene_primitive(s, w,
                    (struct calx_primitive){
                        .shape = CALX_CYLINDER, .a = {1, 2, 3}, .n = {0, 0.6, 0.8}, .radius = 0.5});
    return s;
}

/* Rodrigues: p turned by `angle` about the axis u through c. */
static void turned(const double p[3], const double c[3], const double u[3], double angle,
                   double out[3])
{
    double d[3] = {p[0] - c[0], p[1] - c[1], p[2] - c[2]}, along = dot(d, u);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = c[k] + d[k] * cos(angle) + (u[a] * d[b] - u[b] * d[a]) * sin(angle) +
                 u[k] * along * (1.0 - cos(angle));
    }
}

static void near_point(const double *got, const double *expected, double tolerance,
                       const char *what)
{
    for (int k = 0; k < 3; k++)
        ck_assert_msg(fabs(got[k] - expected[k]) < tolerance,
                      "%s: component %d is %.15g instead of %.15g", what, k, got[k], expected[k]);
}

static const double MOVING_STEP = 1e-3;
enum { MOVING_STEPS = 700 };
static const double ROUNDING = 1e-13; /* of coordinates of a few metres */

/* Velocity, turning and shaking together, over two stages of different motion. */
START_TEST(poses_are_closed_forms)
{
    const double u[3] = {2.0 / 3, 1.0 / 3, 2.0 / 3}, about[3] = {0.5, -0.5, 0.25},
                 a0[3] = {1, 2, 3}, n0[3] = {0, 0.6, 0.8}, zero[3] = {0};
    struct calx_scene *s = moving_scene(MOVING_STEP);
    struct calx_motion *m = scene_motion(s, 0, 0);
    m->velocity[0].value = 0.7;
    m->velocity[2].value = -0.2;
    m->rate.value = 1.5;
    memcpy(m->about, about, sizeof about);
    memcpy(m->axis, u, sizeof u);
    m->amplitude[1] = 0.3;
    m->frequency = 2.0;
    m->phase = 0.4;
    s->stages[0].duration = MOVING_STEPS * MOVING_STEP;
    size_t second = scene_stage(s);
    memset(&s->stages[second].motion[0], 0, sizeof s->stages[second].motion[0]);
    struct calx_motion *m2 = scene_motion(s, second, 0);
    m2->rate.value = -3.0;
    s->stages[second].duration = INFINITY;
    struct run r = run_start(s, 1);
    run_steps(&r, MOVING_STEPS - 1);
    double t = (MOVING_STEPS - 1) * MOVING_STEP, w = 4.0 * M_PI, expected[3], v[3], got[3];
    double shift[3] = {0.7 * t, 0.3 * (sin(w * t + 0.4) - sin(0.4)), -0.2 * t},
           speed[3] = {0.7, 0.3 * w * cos(w * t + 0.4), -0.2};
    turned(a0, about, u, 1.5 * t, expected);
    for (int k = 0; k < 3; k++)
        expected[k] += shift[k];
    near_point(r.sim->posed[0].p.a, expected, ROUNDING, "a point");
    calx_walls_velocity(r.sim, 0, expected, got);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        v[k] = speed[k] + 1.5 * (u[a] * (expected[b] - about[b] - shift[b]) -
                                 u[b] * (expected[a] - about[a] - shift[a]));
    }
    near_point(got, v, 10.0 * ROUNDING, "its velocity");
    turned(n0, zero, u, 1.5 * t, expected);
    near_point(r.sim->posed[0].p.n, expected, ROUNDING, "an axis");
    run_steps(&r, 1); /* the stage ends; the next turns what it finds about z through the origin */
    double found[3], z[3] = {0, 0, 1};
    ck_assert_int_eq(calx_sim_stage(r.sim), 1);
    memcpy(found, r.sim->posed[0].p.a, sizeof found);
    run_steps(&r, 200);
    turned(found, zero, z, -3.0 * 200 * MOVING_STEP, expected);
    near_point(r.sim->posed[0].p.a, expected, ROUNDING, "a point in the second stage");
    run_free(&r);
}
END_TEST

static double swinging(const void *context, double t, const double x[3])
{
    (void)x;
    return *(const double *)context * cos(3.0 * t);
}

static double swung(const void *context, double t, const double x[3])
{
    (void)x;
    return *(const double *)context * sin(3.0 * t) + 5.0;
}

/* A velocity and a rate that are functions are integrated by the midpoint rule, h^2/24 times the
 * largest second derivative times the time; a displacement is taken as it is, its speed by central
 * differences over 1e-6 t: rounding/1e-6. */
START_TEST(functions_move_walls)
{
    static const double size = 0.8;
    const double t = MOVING_STEPS * MOVING_STEP,
                 midpoint = pow(MOVING_STEP, 2) / 24.0 * 9.0 * 0.8 * 0.7,
                 difference = 5.0 * 2.3e-16 / 0.7e-6 * 2.0;
    const double a0[3] = {1, 2, 3}, zero[3] = {0}, z[3] = {0, 0, 1};
    double expected[3], got[3];
    struct calx_scene *s = moving_scene(MOVING_STEP);
    scene_motion(s, 0, 0)->velocity[0] = (struct calx_function){swinging, &size, 0.0};
    struct run r = run_start(s, 1);
    run_steps(&r, MOVING_STEPS);
    near_point(r.sim->posed[0].p.a, (double[3]){1 + size / 3.0 * sin(3.0 * t), 2, 3}, midpoint,
               "velocity of t");
    calx_walls_velocity(r.sim, 0, a0, got);
    near_point(got, (double[3]){size * cos(3.0 * t), 0, 0}, ROUNDING, "its value");
    run_free(&r);
    s = moving_scene(MOVING_STEP);
    scene_motion(s, 0, 0)->rate = (struct calx_function){swinging, &size, 0.0};
    r = run_start(s, 1);
    run_steps(&r, MOVING_STEPS);
    turned(a0, zero, z, size / 3.0 * sin(3.0 * t), expected);
    near_point(r.sim->posed[0].p.a, expected, sqrt(5.0) * midpoint, "rate of t");
    run_free(&r);
    s = moving_scene(MOVING_STEP);
    scene_motion(s, 0, 0)->has_displacement = true;
    s->stages[0].motion[0].displacement[1] = (struct calx_function){swung, &size, 0.0};
    r = run_start(s, 1);
    run_steps(&r, MOVING_STEPS);
    near_point(r.sim->posed[0].p.a, (double[3]){1, 2 + size * sin(3.0 * t), 3}, ROUNDING,
               "displacement of t");
    calx_walls_velocity(r.sim, 0, a0, got);
    near_point(got, (double[3]){0, 3.0 * size * cos(3.0 * t), 0}, difference, "its speed");
    run_free(&r);
}
END_TEST

/* A grain between a wall that comes from afar and the neighbour list that was made before: it must
 * be met, not passed. */
START_TEST(a_wall_that_comes_is_met)
{
    const double speed = 2.0;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, STIFFNESS, NAN, -1.0, 1e-4);
    scene_put(s, 0, 0.0, 0.0, 0.0, RADIUS);
    scene_put(s, 1, 0.0, 0.0, 1.0, RADIUS);
    int w = scene_wall(s, "piston", 0);
    scene_plane(s, w, (double[3]){0, -1, 0}, (double[3]){0, 1, 0});
    scene_motion(s, 0, w)->velocity[1].value = speed;
    struct run r = run_start(s, 1);
    run_steps(&r, 6000);
    for (int64_t i = 0; i < 2; i++) /* elastic: twice the speed of the wall, to (pi/n)^2/4 with n =
                                       65 steps per contact */
        ck_assert_double_eq_tol(run_v(&r, i)[1] / (2.0 * speed), 1.0, 0.25 * pow(M_PI / 64.0, 2));
    run_free(&r);
}
END_TEST

/* A thin wall and a grain that meet at any speed: the grain stays on its side, or the run stops and
 * says why. Never does one pass the other unseen. */
START_TEST(nothing_passes_a_thin_wall)
{
    static const double radii[] = {0.05, 0.3, 0.49, 0.6, 0.9, 2.1, 3.7, 10.0, 1000.0};
    for (size_t k = 0; k < sizeof radii / sizeof *radii; k++)
        for (int wall_moves = 0; wall_moves < 2; wall_moves++)
            for (int phase = 0; phase < 8; phase++) {
                const double dt = 1e-4, speed = radii[k] * RADIUS / dt;
                struct calx_error e = {0};
                struct calx_scene *s = scene_create(2, CALX_SPHERES, 1);
                double mass = calx_particle_mass(s, RADIUS, 1000.0);
                scene_linear(s, mass * pow(0.5 / dt, 2), NAN, -1.0, dt);
                s->models[0].forced = true; /* a contact lasts 2 pi steps */
                scene_put(s, 0, 0.0, 3.1 * RADIUS + 0.125 * phase * speed * dt, 0.0, RADIUS);
                int w = scene_wall(s, "blade", 0);
                scene_segment(s, w, -1.0, 0.0, 1.0, 0.0, 0);
                if (wall_moves)
                    scene_motion(s, 0, w)->velocity[1].value = speed;
                else
                    scene_move(s, 0, 0.0, -speed, 0.0);
                struct run r = run_start(s, 1);
                int code = 0;
                for (size_t n = 0; n < 200 && !code; n++)
                    code = calx_sim_step(r.sim, &e);
                if (code)
                    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
                else
                    ck_assert_msg(run_x(&r, 0)[1] > r.sim->posed[0].p.a[1],
                                  "%g radii a step, wall moves: %d: passed", radii[k], wall_moves);
                ck_assert(code || radii[k] < 0.5);
                ck_assert(!code || radii[k] > 0.1);
                run_free(&r);
            }
}
END_TEST

/* A rough drum turns; a grain that rolls at its bottom without slip stays: no force along the wall,
 * no work. */
START_TEST(a_grain_rolls_in_a_drum)
{
    const double drum = 0.5, rate = 2.0, g = 9.81, dt = 5e-5;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    double mass = calx_particle_mass(s, RADIUS, 1000.0), depth = mass * g / STIFFNESS,
           lever = RADIUS - 0.5 * depth;
    scene_linear(s, STIFFNESS, NAN, 2.0, dt);
    scene_put(s, 0, 0.0, -(drum - RADIUS + depth), 0.0, RADIUS);
    scene_spin(s, 0, 0.0, 0.0, rate * drum / lever);
    scene_gravity(s, 0.0, -g, 0.0);
    int w = scene_wall(s, "drum", 0);
    scene_primitive(s, w,
                    (struct calx_primitive){
                        .shape = CALX_CYLINDER, .inside = true, .n = {0, 0, 1}, .radius = drum});
    scene_motion(s, 0, w)->rate.value = rate;
    struct run r = run_start(s, 1);
    run_steps(&r, 20000);
    const double *v = run_v(&r, 0);
    double slip = rate * drum - lever * v[6];
    /* rounding of 20000 steps, relative to the speed of the wall */
    ck_assert_double_lt(fabs(slip), 20000 * 2.3e-16 * rate * drum);
    ck_assert_double_lt(fabs(v[0]) + fabs(run_x(&r, 0)[0]), 20000 * 2.3e-16 * rate * drum);
    ck_assert_double_lt(fabs(calx_sim_ledger(r.sim).wall_work), 1e-10 * mass * g * drum);
    ck_assert_double_lt(calx_sim_ledger(r.sim).dissipated, 1e-10 * mass * g * drum);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {poses_are_closed_forms, functions_move_walls, a_wall_that_comes_is_met,
                            nothing_passes_a_thin_wall, a_grain_rolls_in_a_drum};
    return run_tests("wall motion", sizeof tests / sizeof *tests, tests);
}

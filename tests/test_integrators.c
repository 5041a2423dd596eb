/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrators of motion through the whole engine. A grain that never leaves a springy floor is an
 * oscillator: its error after a period and its energy after a hundred, and under a floor and a
 * gravity that change with time. A grain that bounces: error of the restitution against steps per
 * contact, whose order is that of the force at onset and end, not of the scheme (Tuley et al.,
 * Powder Technology 2010; Danby et al., Comput. Chem. Eng. 58 (2013) 211).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/impacts.h"

static const struct given NONE[] = {{NULL, 0.0}}, GEAR3[] = {{"order", 0.0}, {NULL, 0.0}},
                          GEAR4[] = {{"order", 1.0}, {NULL, 0.0}},
                          TRAPEZOID[] = {{"beta", 0.25}, {"evaluations", 1.0}, {NULL, 0.0}},
                          DISSIPATIVE[] = {{"gamma", 0.6}, {NULL, 0.0}};

/* ---- the oscillator ---- */

/* Frequency 1 rad/s about a height where the floor carries the weight; amplitude half of that
 * overlap. */
static const double REST = 0.1, AMPLITUDE = 0.05, DENSITY = 1000.0;

static double oscillator_mass(void)
{
    return 4.0 / 3.0 * M_PI * DENSITY;
}

/* `velocity`: a damper so weak that it does nothing, but forces use velocities. */
static struct calx_scene *oscillator(const char *integrator, const struct given *given,
                                     bool velocity, double dt)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", oscillator_mass()},
                                 {velocity ? "damping" : NULL, 1e-12},
                                 {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrator, given);
    s->models[0].dt = dt;
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    scene_gravity(s, 0.0, -REST, 0.0);
    scene_put(s, 0, 0.0, 1.0 - REST + AMPLITUDE, 0.0, 1.0);
    return s;
}

/* Error of position and velocity in units of the amplitude, and energy relative to the start. */
static double oscillate(const char *integrator, const struct given *given, bool velocity,
                        size_t steps, size_t periods, double *energy)
{
    struct calx_scene *s = oscillator(integrator, given, velocity, 2.0 * M_PI / (double)steps);
    s->models[0].forced = true; /* half a period may have fewer than ten steps */
    struct run r = run_start(s, 1);
    run_steps(&r, steps * periods);
    double x = (run_x(&r, 0)[1] - (1.0 - REST)) / AMPLITUDE, v = run_v(&r, 0)[1] / AMPLITUDE;
    *energy = x * x + v * v - 1.0;
    run_free(&r);
    return hypot(x - 1.0, v);
}

/* Errors at 50 steps per period and energies after 100 periods of the design, two digits: a tenth
 * either way. (Its energies of gear, 2.2e-5 and -1.5e-4, are those after 50 periods: iterating the
 * scheme by hand gives them there, and twice as much here.) NAN: none given. Order: fitted over 50
 * to 800 steps. */
static const struct {
    const char *integrator;
    const struct given *given;
    bool velocity;
    double error, energy, order;
} oscillators[] = {
    {"velocity-verlet", NONE, false, 4.13e-3, -6.4e-4, 2.0},
    {"verlet", NONE, false, 4.13e-3, -6.4e-4, 2.0},
    {"leapfrog", NONE, false, 4.13e-3, -6.4e-4, 2.0},
    {"symplectic-euler", NONE, false, NAN, NAN, 1.0},
    {"adams-bashforth-2", NONE, false, NAN, NAN, 2.0},
    {"newmark", NONE, false, 4.13e-3, -6.4e-4, 2.0},
    {"contact-exact", NONE, false, 4.13e-3, -6.4e-4, 2.0},
    {"newmark", TRAPEZOID, false, NAN, NAN, 2.0},
    {"newmark", DISSIPATIVE, false, NAN, NAN, 1.0},
    {"rk4", NONE, false, NAN, NAN, 4.0},
    {"yoshida", NONE, false, NAN, NAN, 4.0},
    {"gear", GEAR3, false, NAN, NAN, 3.0},
    {"gear", GEAR4, false, NAN, NAN, 4.0},
    {"gear", NONE, false, 1.4e-6, 4.47e-5, 5.2},
    {"gear", NONE, true, 2.4e-6, -3.05e-4, 5.1},
};

START_TEST(oscillator_errors_and_orders)
{
    const size_t k = (size_t)_i;
    double steps[5], errors[5], energy, ignored;
    for (size_t q = 0; q < 5; q++) {
        steps[q] = (double)(50 << q);
        errors[q] = oscillate(oscillators[k].integrator, oscillators[k].given,
                              oscillators[k].velocity, (size_t)50 << q, 1, &ignored);
    }
    /* below 1e-12 round-off of coordinates 20 amplitudes long takes part */
    size_t above = 5;
    while (above > 2 && errors[above - 1] < 1e-12)
        above--;
    double order = -slope(above, steps, errors);
    oscillate(oscillators[k].integrator, oscillators[k].given, oscillators[k].velocity, 50, 100,
              &energy);
    ck_assert_msg(fabs(order - oscillators[k].order) < 0.2 || order > oscillators[k].order,
                  "%s: order %.3f instead of %g", oscillators[k].integrator, order,
                  oscillators[k].order);
    if (isnan(oscillators[k].error))
        return;
    ck_assert_msg(fabs(errors[0] / oscillators[k].error - 1.0) < 0.1,
                  "%s: error %.3g instead of %g", oscillators[k].integrator, errors[0],
                  oscillators[k].error);
    ck_assert_msg(fabs(energy / oscillators[k].energy - 1.0) < 0.1,
                  "%s: energy %+.3g instead of %+g", oscillators[k].integrator, energy,
                  oscillators[k].energy);
}
END_TEST

/* ---- a floor and a gravity that move ---- */

static double swing(const void *context, double t, const double at[3])
{
    (void)at;
    return *(const double *)context * sin(0.5 * t);
}

/* Up and down x'' = -x + Y sin(t/2), Y sin(t/2) the floor: x = (4/3) Y (sin(t/2) - sin(t)/2) from
 * rest. Along the floor a gravity x'' = G sin(t/2): x = G (2 t - 4 sin(t/2)). The orders need walls
 * and gravity at the moment of each evaluation. */
static double swung(const char *integrator, const struct given *given, size_t steps)
{
    static double gravity = 0.02;
    const double floor_ = 0.03, end = 5.0;
    struct calx_scene *s = oscillator(integrator, given, false, end / (double)steps);
    scene_put(s, 0, 0.0, 1.0 - REST, 0.0, 1.0);
    struct calx_motion *m = scene_motion(s, 0, 0);
    m->amplitude[1] = floor_;
    m->frequency = 0.25 / M_PI;
    s->stages[0].gravity[0] = (struct calx_function){.eval = swing, .context = &gravity};
    struct run r = run_start(s, 1);
    run_steps(&r, steps);
    double y = run_x(&r, 0)[1] - (1.0 - REST), v = run_v(&r, 0)[1], x = run_x(&r, 0)[0];
    double exact = 4.0 / 3.0 * floor_ * (sin(0.5 * end) - 0.5 * sin(end));
    double speed = 4.0 / 3.0 * floor_ * 0.5 * (cos(0.5 * end) - cos(end));
    double fall = gravity * (2.0 * end - 4.0 * sin(0.5 * end)); /* x'' = g(t) along the floor */
    run_free(&r);
    return fmax(hypot(y - exact, v - speed) / floor_, fabs(x - fall) / gravity);
}

static const struct {
    const char *integrator;
    const struct given *given;
    double order;
} driven[] = {
    {"velocity-verlet", NONE, 2.0},
    {"leapfrog", NONE, 2.0},
    {"symplectic-euler", NONE, 1.0},
    {"euler", NONE, 1.0},
    {"adams-bashforth-2", NONE, 2.0},
    {"gear", GEAR3, 3.0},
    {"gear", GEAR4, 4.0},
    {"gear", NONE, 5.0},
    {"rk4", NONE, 4.0},
    {"yoshida", NONE, 4.0},
    {"newmark", NONE, 2.0},
    {"contact-exact", NONE, 2.0},
    {"newmark", TRAPEZOID, 2.0},
};

START_TEST(floors_and_gravity_at_the_right_moment)
{
    double steps[4], errors[4];
    for (size_t q = 0; q < 4; q++) {
        steps[q] = (double)(60 << q);
        errors[q] = swung(driven[_i].integrator, driven[_i].given, (size_t)60 << q);
    }
    double order = -slope(4, steps, errors);
    ck_assert_msg(order > driven[_i].order - 0.2, "%s: order %.3f instead of %g (%g .. %g)",
                  driven[_i].integrator, order, driven[_i].order, errors[0], errors[3]);
}
END_TEST

/* ---- collisions ---- */

/* Steps in flight before the earliest onset: gear looks four steps ahead when it starts. */
enum { START = 8 };
enum { PHASES = 40, FRACTIONS = 7, LADDER = 4 };
static const double LADDER_STEPS[LADDER] = {20, 50, 80, 320}, RADIUS = 0.01, STIFFNESS = 1e6;

/* Grains side by side that fall without weight onto a floor, each a fortieth of a step later. */
static struct calx_scene *shower(const char *integrator, const struct given *given, bool velocity,
                                 bool hertz, double e, double steps)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, PHASES);
    double volume = 4.0 / 3.0 * M_PI * pow(RADIUS, 3.0), duration, l = log(e);
    const char *damping = e < 1.0 ? "restitution" : velocity ? "damping" : NULL;
    double value = e < 1.0 ? e : 1e-12;
    int wall = 0;
    if (hertz) {
        double young[2] = {GLASS.young, RIGID.young}, poisson[2] = {GLASS.poisson, RIGID.poisson};
        set_material(s, 0, &GLASS);
        wall = scene_material(s, "wall", 1.0, 1.0);
        set_material(s, wall, &RIGID);
        scene_model1(s, CALX_CONTACT, "hertz", damping, value);
        duration = hertz_duration(calx_effective_modulus(young, poisson), volume * GLASS.density,
                                  RADIUS, 1.0);
    } else {
        double w0 = sqrt(STIFFNESS / (volume * DENSITY));
        scene_model(s, CALX_CONTACT, "linear",
                    (struct given[]){{"stiffness", STIFFNESS}, {damping, value}, {NULL, 0.0}});
        duration = hypot(M_PI, l) / w0; /* pi/(w0 sqrt(1 - b^2)) */
    }
    scene_model(s, CALX_MOTION, integrator, given);
    double dt = s->models[0].dt = duration / steps;
    scene_plane(s, scene_wall(s, "floor", wall), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    for (size_t i = 0; i < PHASES; i++) {
        scene_put(s, i, 3.0 * RADIUS * (double)i,
                  RADIUS + dt * (START + ((double)i + 0.5) / PHASES), 0.0, RADIUS);
        scene_move(s, i, 0.0, -1.0, 0.0);
    }
    return s;
}

/* rms of the error of restitution over phases, and fractions of a step in the duration. */
static double restitution_error(const char *integrator, const struct given *given, bool velocity,
                                bool hertz, double e, double steps)
{
    double sum = 0.0;
    for (size_t f = 0; f < FRACTIONS; f++) {
        struct run r = run_start(
            shower(integrator, given, velocity, hertz, e, steps + (double)f / FRACTIONS), 1);
        run_steps(&r, (size_t)(1.5 * steps) +
                          2 * START); /* a damped Hertz contact lasts 1.2 times longer */
        for (int64_t i = 0; i < PHASES; i++) {
            ck_assert_double_gt(run_x(&r, i)[1], RADIUS);
            sum += pow(run_v(&r, i)[1] - e, 2.0);
        }
        run_free(&r);
    }
    return sqrt(sum / (PHASES * FRACTIONS));
}

/* What the force does at onset and end sets order and error: linear elastic, linear damped, Hertz
 * elastic, Hertz damped (Tsuji). */
static const struct {
    bool hertz;
    double e;
} impacts[] = {{false, 1.0}, {false, 0.5}, {true, 1.0}, {true, 0.5}};

/* Table of the design: errors at 50 steps per contact and orders. The orders fit within 0.2, the
 * errors within 15 % (two digits, and n counted on the elastic or the damped duration). gear with
 * its other alpha_0 does the same: no better than velocity-verlet. newmark is the table's velocity
 * Verlet with centred damping. yoshida is not in the table. contact-exact:
 * as measured, a hundred times below velocity-verlet and more in each of the four, as the issue asks
 * of the first two; what velocity Verlet errs in frequency between onset and end, (pi/n)^2/24, is 5.7e-5 of e = 0.5. */
static const struct {
    const char *integrator;
    const struct given *given;
    bool velocity; /* a damper of next to nothing where there is none: gear takes its other alpha_0
                    */
    double error[4], order[4];
} colliders[] = {
    {"velocity-verlet", NONE, false, {2.0e-4, 6.1e-3, 2.8e-5, 2.4e-3}, {2.0, 1.0, 2.5, 1.05}},
    {"leapfrog", NONE, false, {2.0e-4, 6.1e-3, 2.8e-5, 2.4e-3}, {2.0, 1.0, 2.5, 1.05}},
    {"verlet", NONE, false, {2.0e-4, 6.1e-3, 2.8e-5, 2.4e-3}, {2.0, 1.0, 2.5, 1.05}},
    {"gear", NONE, true, {2.0e-4, 5.6e-3, 2.8e-5, 1.6e-3}, {2.0, 1.0, 2.5, 1.25}},
    {"gear", NONE, false, {2.0e-4, 5.6e-3, 2.8e-5, 1.6e-3}, {2.0, 1.0, 2.5, 1.25}},
    {"rk4", NONE, false, {8.3e-5, 3.2e-3, 1.0e-5, 7.9e-4}, {2.0, 1.0, 2.5, 1.25}},
    {"yoshida", NONE, false, {NAN, NAN, NAN, NAN}, {2.0, 1.0, 2.5, 1.05}},
    {"newmark", NONE, false, {2.0e-4, 5.5e-3, 2.8e-5, 1.6e-3}, {2.0, 1.0, 2.5, 1.25}},
    {"contact-exact", NONE, false, {6.7e-7, 1.7e-5, 4.35e-8, 2.2e-5}, {4.0, 2.0, 5.0, 1.75}},
};

START_TEST(collision_orders)
{
    for (size_t k = 0; k < 4; k++) {
        double errors[LADDER];
        for (size_t q = 0; q < LADDER; q++)
            errors[q] = restitution_error(colliders[_i].integrator, colliders[_i].given,
                                          colliders[_i].velocity, impacts[k].hertz, impacts[k].e,
                                          LADDER_STEPS[q]);
        double order = -slope(LADDER, LADDER_STEPS, errors);
        const char *law = impacts[k].hertz ? "hertz" : "linear";
        ck_assert_msg(fabs(order - colliders[_i].order[k]) < 0.2,
                      "%s, %s e = %g: order %.3f instead of %g (%.3g %.3g %.3g %.3g)",
                      colliders[_i].integrator, law, impacts[k].e, order, colliders[_i].order[k],
                      errors[0], errors[1], errors[2], errors[3]);
        ck_assert_msg(impacts[k].hertz || strcmp(colliders[_i].integrator, "contact-exact") || order > 1.9,
                      "contact-exact, linear e = %g: order %.3f, not above 1.9", impacts[k].e, order);
        ck_assert_msg(
            isnan(colliders[_i].error[k]) || fabs(errors[1] / colliders[_i].error[k] - 1.0) < 0.15,
            "%s, %s e = %g: error %.3g instead of %g at 50 steps", colliders[_i].integrator, law,
            impacts[k].e, errors[1], colliders[_i].error[k]);
    }
}
END_TEST

/* ---- sub-steps by tolerance ---- */

static const double TOLERANCES[] = {1e-5, 1e-7, 1e-9};
enum { TOLERANCE_COUNT = sizeof TOLERANCES / sizeof *TOLERANCES };

/* Each of at most 60 sub-steps in a period errs by tol R in position and tol R/dt in velocity. */
START_TEST(errors_follow_the_tolerance)
{
    double last = INFINITY, energy;
    for (size_t k = 0; k < TOLERANCE_COUNT; k++) {
        struct given given[] = {{"tolerance", TOLERANCES[k]}, {NULL, 0.0}};
        double dt = 2.0 * M_PI / 10.0, bound = 60.0 * TOLERANCES[k] * (1.0 + 1.0 / dt) / AMPLITUDE;
        double error = oscillate("cash-karp", given, true, 10, 1, &energy);
        ck_assert_msg(error < bound && error < 0.1 * last, "tolerance %g: error %g of %g",
                      TOLERANCES[k], error, bound);
        last = error;
    }
}
END_TEST

/* Onset and end of a contact do not limit it: each of at most 80 sub-steps errs by tol R/dt in
 * velocity. One that passes a jump of the force between its nodes errs by up to 8 times what it
 * sees of it: an eighth of the step times the jump, against 277/14336 of it. At dt of 20 steps per
 * contact. */
START_TEST(collisions_follow_the_tolerance)
{
    for (size_t law = 0; law < 4; law++)
        for (size_t k = 0; k < TOLERANCE_COUNT; k++) {
            struct given given[] = {{"tolerance", TOLERANCES[k]}, {NULL, 0.0}};
            struct calx_scene *s =
                shower("cash-karp", given, false, impacts[law].hertz, impacts[law].e, 20.0);
            double bound = 100.0 * TOLERANCES[k] * RADIUS / s->models[0].dt, worst = 0.0;
            struct run r = run_start(s, 1);
            run_steps(&r, 60);
            for (int64_t i = 0; i < PHASES; i++)
                worst = fmax(worst, fabs(run_v(&r, i)[1] - impacts[law].e));
            ck_assert_msg(worst < bound, "%s e = %g, tolerance %g: error %g of %g",
                          impacts[law].hertz ? "hertz" : "linear", impacts[law].e, TOLERANCES[k],
                          worst, bound);
            run_free(&r);
        }
}
END_TEST

/* A floor and a gravity that move are met at the moments of the trials: to the tolerance, with 60
 * sub-steps at least. */
START_TEST(moving_floors_follow_the_tolerance)
{
    struct given given[] = {{"tolerance", 1e-11}, {NULL, 0.0}};
    ck_assert_double_lt(swung("cash-karp", given, 60), 1e-8);
}
END_TEST

/* ---- refusals ---- */

/* Euler gains so much energy that at 50 steps per contact it is beyond its limit. */
START_TEST(steps_beyond_the_limit_are_refused)
{
    static const struct {
        const char *integrator;
        double most; /* omega dt */
    } rows[] = {{"euler", 0.1106}, {"adams-bashforth-2", 0.5057},
                {"gear", 0.875},   {"leapfrog", 2.0},
                {"rk4", 2.828},    {"yoshida", 1.573},
                {"newmark", 2.0}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct calx_error e = {0};
        run_refused(oscillator(rows[k].integrator, NONE, false, 1.01 * rows[k].most), &e);
        ck_assert_msg(strstr(e.text, "above the stability limit") != NULL, "%s", e.text);
        struct calx_scene *below = oscillator(rows[k].integrator, NONE, false, 0.99 * rows[k].most);
        below->models[0].forced = rows[k].most > M_PI / 10.0; /* fewer than ten steps in half a period */
        struct run r = run_start(below, 1);
        run_free(&r);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("integrators");
    TCase *tcase = tcase_create("all");
    tcase_add_loop_test(tcase, oscillator_errors_and_orders, 0,
                        sizeof oscillators / sizeof *oscillators);
    tcase_add_loop_test(tcase, floors_and_gravity_at_the_right_moment, 0,
                        sizeof driven / sizeof *driven);
    tcase_add_loop_test(tcase, collision_orders, 0, sizeof colliders / sizeof *colliders);
    tcase_add_test(tcase, errors_follow_the_tolerance);
    tcase_add_test(tcase, collisions_follow_the_tolerance);
    tcase_add_test(tcase, moving_floors_follow_the_tolerance);
    tcase_add_test(tcase, steps_beyond_the_limit_are_refused);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What else acts between rigid bodies: cohesion, also one that weakens with heat, and conduction by the contact force; and models that do
 * not fit together.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/rigid.h"

/* ---- cohesion ---- */

/* A ball under a held one, which pulls it with `pull` times its weight. */
static struct run hanging(double pull, double gap)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    double weight = G * DENSITY * 4.0 / 3.0 * M_PI * RADIUS * RADIUS * RADIUS;
    scene_put(s, 0, 0.0, 0.0, 2.0 * RADIUS + gap, RADIUS);
    scene_put(s, 1, 0.0, 0.0, 0.0, RADIUS);
    scene_fix(s, 0);
    scene_gravity(s, 0.0, 0.0, -G);
    rigid_models(s, 0.5, 0.0, 1.0, 1e-4, NULL);
    scene_model(s, CALX_CONTACT, "cohesive",
                (struct given[]){{"pull", pull * weight}, {"distance", 1e-4}, {NULL, 0.0}});
    return run_start(s, 1);
}

START_TEST(a_pull_holds_what_is_lighter)
{
    struct run r = hanging(1.5, 0.0);
    run_steps(&r, 100);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2]), ROUND_OFF);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, 1);
    ck_assert_double_lt(fabs(f->normal_force[0] / rigid_weight(&r, 2) + 0.5), 1e-9);
    ck_assert_int_eq(f->status[0], 2);
    calx_frame_free(f);
    run_free(&r);
    r = hanging(0.5, 0.0); /* it opens with half of g, and falls freely beyond the distance */
    run_steps(&r, 10);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2] + 0.5 * G * 1e-3), ROUND_OFF);
    run_steps(&r, 90);
    ck_assert_double_lt(run_v(&r, 1)[2], -0.5 * G * 1e-2);
    f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, 0);
    calx_frame_free(f);
    run_free(&r);
    r = hanging(1.5, 0.5e-4); /* it closes the gap and stays */
    run_steps(&r, 200);
    ck_assert_double_lt(fabs(run_x(&r, 0)[2] - run_x(&r, 1)[2] - 2.0 * RADIUS), 1e-12);
    run_free(&r);
    r = hanging(1.5, 1.5e-4); /* beyond the distance nothing pulls */
    run_steps(&r, 10);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2] + G * 1e-3), ROUND_OFF);
    run_free(&r);
}
END_TEST

/* The pull between equal bodies is eta/R, here 1.5 weights cold, 0.5 hot, and 2 (1.5)(0.5)/(1.5 + 0.5) between the two. */
START_TEST(a_pull_weakens_with_heat)
{
    static const struct { double held, free, pull; } cases[] = {{300, 300, 1.5}, {400, 400, 0.5}, {300, 400, 0.75}, {400, 300, 0.75}};
    const double weight = G * DENSITY * 4.0 / 3.0 * M_PI * RADIUS * RADIUS * RADIUS;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_put(s, 0, 0.0, 0.0, 2.0 * RADIUS, RADIUS);
        scene_put(s, 1, 0.0, 0.0, 0.0, RADIUS);
        scene_fix(s, 0);
        scene_warm(s, 0, cases[k].held);
        scene_warm(s, 1, cases[k].free);
        scene_gravity(s, 0.0, 0.0, -G);
        scene_material_value(s, 0, "adhesion", weight * RADIUS);
        scene_material_value(s, 0, "adhesion-change", 0.5 * weight * RADIUS);
        scene_material_value(s, 0, "transition-temperature", 350.0);
        scene_material_value(s, 0, "transition-width", 1.0);
        rigid_models(s, 0.0, 0.0, 1.0, 1e-4, NULL);
        scene_model1(s, CALX_CONTACT, "cohesion-thermal", "distance", 1e-4);
        struct run r = run_start(s, 1);
        run_steps(&r, 10);
        ck_assert_double_lt(fabs(run_v(&r, 1)[2] + fmax(0.0, 1.0 - cases[k].pull) * G * 1e-3), ROUND_OFF);
        run_free(&r);
    }
}
END_TEST

/* ---- heat ---- */

/* The weight of a ball opens the way for heat from the floor: H = 2 k a, a^3 = 3 W R/(4 E*); discs: H = 2 k sqrt(2 b L). */
START_TEST(contact_forces_conduct)
{
    const double k = 50.0, young = 1e9, poisson = 0.25, modulus = young / (2.0 * (1.0 - poisson * poisson));
    for (uint32_t bodies = CALX_SPHERES; bodies <= CALX_DISCS; bodies++) {
        struct calx_scene *s = rigid_incline(bodies, 0.0, 0.0, 1.0, 1e-3);
        scene_material_value(s, 0, "conductivity", k);
        scene_material_value(s, 0, "young", young);
        scene_material_value(s, 0, "poisson", poisson);
        scene_model(s, CALX_CONDUCTANCE, "hertz", NULL);
        scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
        scene_wall_temperature(s, 0, 393.15);
        struct run r = run_start(s, 1);
        double w = rigid_weight(&r, 1), spheres = 2.0 * k * cbrt(3.0 * w * RADIUS / (4.0 * modulus));
        double discs = 2.0 * k * pow(16.0 * w * RADIUS / (M_PI * modulus), 0.25);
        run_steps(&r, 2);
        double before = run_v(&r, 0)[7], capacity = run_mass(&r, 0) * 1000.0;
        run_steps(&r, 1);
        double flow = (run_v(&r, 0)[7] - before) * capacity / 1e-3;
        ck_assert_double_lt(fabs(flow / ((bodies == CALX_DISCS ? discs : spheres) * (393.15 - before)) - 1.0), 1e-8);
        run_free(&r);
    }
}
END_TEST

/* ---- refusals ---- */

START_TEST(laws_and_integrators_that_do_not_fit_are_refused)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "signorini-coulomb", NULL);
    scene_model(s, CALX_MOTION, "velocity-verlet", NULL);
    s->models[0].dt = 1e-3;
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'signorini-coulomb' is non-smooth") && strstr(e.text, "nscd"), "%s", e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    scene_linear_by(s, "nscd", 1e3, NAN, -1.0, 1e-3);
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'nscd' solves for impulses") && strstr(e.text, "signorini-coulomb") && strstr(e.text, "'linear'"), "%s",
                  e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    rigid_models(s, 0.0, 0.0, 1.0, 0.0, NULL);
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "no time step: rigid contacts") && strstr(e.text, "'nscd'"), "%s", e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "cohesive", (struct given[]){{"pull", 1.0}, {"distance", 1e-3}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "nscd", NULL);
    s->models[0].dt = 1e-3;
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'cohesive' needs a law that provides a normal force"), "%s", e.text);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {a_pull_holds_what_is_lighter, a_pull_weakens_with_heat, contact_forces_conduct,
                            laws_and_integrators_that_do_not_fit_are_refused};
    return run_tests("nscd_laws", sizeof tests / sizeof *tests, tests);
}

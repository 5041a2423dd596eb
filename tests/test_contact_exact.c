/* SPDX-License-Identifier: BSD-3-Clause
 *
 * contact-exact through the whole engine, where velocity Verlet is of first order in the step:
 * oblique impacts with friction, of a grain on a wall and of two free grains, against themselves at
 * many more steps; the energy booked in them; a damped grain that rests on a floor, against its
 * closed form; momentum. And the weights that the engine uses at onset and end, against what defines
 * Hurwitz' zeta function. Head-on collisions are in test_integrators.c.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/onset.h"
#include "tests/impacts.h"

/* ---- weights ---- */

/* In the build for one instruction set, or the base of several. */
extern const double calx_onset_node_base[CALX_ONSET_NODES];

static const double POWERS[] = {0.0, 0.25, 1.0, 1.5};

static double weighted(const calx_v8 w[CALX_ONSET_NODES], size_t lane, double power)
{
    double sum = 0.0;
    for (int q = 0; q < CALX_ONSET_NODES; q++)
        sum += w[q][lane] * pow(calx_onset_node_base[q], power);
    return sum;
}

/* For F = t^p: the force at s is s^p and the moment before it s^(p+2)/((p+1)(p+2)). The tail is
 * -zeta(-p, s): the integral from 0 to s + N less the sum of N forces from s on and half of the
 * next, but for p (s+N)^(p-1)/12 and a term of 6e-9. Bounds: rounding times weights up to 23; 1e-7
 * for the engine's own formula of the tail. */
START_TEST(weights_integrate_powers)
{
    calx_v8 s = {1e-6, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0};
    struct calx_onset_weights w;
    calx_onset_weigh_base(s, &w);
    for (size_t k = 0; k < 4; k++)
        for (size_t lane = 0; lane < 8; lane++) {
            const size_t terms = 2000;
            double p = POWERS[k], x = s[lane];
            long double end = (long double)x + terms, sum = 0.0L;
            for (size_t j = 0; j < terms; j++)
                sum += powl((long double)x + j, p);
            double tail = (double)(powl(end, p + 1.0) / (p + 1.0) - 0.5L * powl(end, p) +
                                   p * powl(end, p - 1.0) / 12.0L - sum);
            ck_assert_double_eq_tol(weighted(w.force, lane, p), pow(x, p), 1e-13);
            ck_assert_double_eq_tol(weighted(w.later, lane, p),
                                    pow(x, p + 2.0) / ((p + 1.0) * (p + 2.0)), 1e-13);
            ck_assert_msg(fabs(weighted(w.tail, lane, p) - tail) < 1e-7,
                          "t^%g, s = %g: %.12g instead of %.12g", p, x, weighted(w.tail, lane, p),
                          tail);
        }
}
END_TEST

/* ---- oblique impacts ---- */

enum { PHASES = 8, SHIFTS = 3, ANGLES = 6, LADDER = 4, FINE = 3000 };
static const double STEPS[LADDER] = {20, 50, 100, 200}, RADIUS = 0.01, STIFFNESS = 1e6,
                    SPIN = 20.0;

struct kind {
    const char *name;
    bool hertz, twins;
    double e, mu; /* mu < 0: frictionless */
};

static void add_laws(struct calx_scene *s, const struct kind *k)
{
    const char *restitution = k->e < 1.0 ? "restitution" : NULL;
    set_material(s, 0, &(struct material){1e8, 0.3, 1000.0});
    set_material(s, scene_material(s, "wall", 1.0, 1.0), &RIGID);
    if (k->hertz) /* with friction clipped: a contact that attracts passes a force of 0, where friction lets go */
        scene_model(s, CALX_CONTACT, "hertz",
                    (struct given[]){{"clip", k->mu >= 0.0}, {restitution, k->e}, {NULL, 0.0}});
    else
        scene_model(s, CALX_CONTACT, "linear",
                    (struct given[]){
                        {"stiffness", STIFFNESS}, {"clip", 1.0}, {restitution, k->e}, {NULL, 0.0}});
    if (k->hertz && k->mu >= 0.0)
        scene_model1(s, CALX_CONTACT, "mindlin", "friction", k->mu);
    if (!k->hertz && k->mu >= 0.0)
        scene_model(s, CALX_CONTACT, "coulomb",
                    (struct given[]){
                        {"stiffness", 2.0 / 7.0 * STIFFNESS}, {"friction", k->mu}, {NULL, 0.0}});
}

static double duration_of(const struct kind *k, double mass)
{
    double half = k->twins ? 0.5 : 1.0, poisson[2] = {0.3, 0.3},
           young[2] = {1e8, k->twins ? 1e8 : 1e20};
    return k->hertz ? hertz_duration(calx_effective_modulus(young, poisson), half * mass,
                                     half * RADIUS, k->twins ? 2.0 : 1.0)
                    : hypot(M_PI, log(k->e)) * sqrt(half * mass / STIFFNESS);
}

static double sliding_speed(size_t angle)
{
    return tan((10.0 + 14.0 * (double)angle) * DEGREE);
}

/* Grain q of the angle q/phases: it begins to touch when nothing is between it and what it hits, two
 * to three steps from now. */
static void add_grain(struct calx_scene *s, const struct kind *k, size_t q, size_t phases, double dt)
{
    double gap = dt * (2.0 + ((double)(q % phases) + 0.5) / (double)phases),
           vt = sliding_speed(q / phases), x = (double)(q / phases),
           z = 10.0 * RADIUS * (double)(q % phases);
    scene_put(s, q, x - gap * vt, RADIUS + gap, z, RADIUS);
    scene_move(s, q, vt, -1.0, 0.0);
    scene_spin(s, q, 0.0, 0.0, SPIN);
    if (!k->twins)
        return;
    size_t twin = ANGLES * phases + q;
    scene_put(s, twin, x + gap * vt, -RADIUS - gap, z, RADIUS);
    scene_move(s, twin, -vt, 1.0, 0.0);
}

struct after {
    double v[3]; /* m/s: normal, tangential, of the spin at the surface */
};

/* All angles and phases at once; returns what the ledger lacks, per kg. */
static double impact(const char *integrator, const struct kind *k, double steps, size_t phases,
                     struct after *out)
{
    size_t n = ANGLES * phases;
    double mass = 4.0 / 3.0 * M_PI * pow(RADIUS, 3.0) * 1000.0, dt = duration_of(k, mass) / steps;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, k->twins ? 2 * n : n);
    add_laws(s, k);
    scene_model(s, CALX_MOTION, integrator, NULL);
    s->models[0].dt = dt;
    for (size_t q = 0; q < n; q++)
        add_grain(s, k, q, phases, dt);
    if (!k->twins)
        scene_plane(s, scene_wall(s, "plane", 1), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    struct run r = run_start(s, 1);
    run_steps(&r, (size_t)(2.5 * steps) + 10);
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    for (size_t q = 0; q < n; q++) {
        const double *v = run_v(&r, (int64_t)q);
        out[q] = (struct after){{v[1], v[0], RADIUS * v[6]}};
    }
    double residual = calx_sim_ledger(r.sim).residual / ((double)n * mass);
    run_free(&r);
    return residual;
}

/* rms over phases, shifts and components, the largest of the angles; and the mean residual. */
static double impact_error(const char *integrator, const struct kind *k, double steps,
                           const struct after *fine, double *residual)
{
    struct after got[ANGLES * PHASES];
    double sum[ANGLES] = {0}, worst = 0.0;
    *residual = 0.0;
    for (size_t f = 0; f < SHIFTS; f++) {
        *residual +=
            fabs(impact(integrator, k, steps + (double)f / SHIFTS, PHASES, got)) / SHIFTS;
        for (size_t q = 0; q < ANGLES * PHASES; q++)
            for (int c = 0; c < 3; c++)
                sum[q / PHASES] +=
                    pow(got[q].v[c] - fine[q / PHASES].v[c], 2.0) / (PHASES * SHIFTS);
    }
    for (size_t a = 0; a < ANGLES; a++)
        worst = fmax(worst, sqrt(sum[a]));
    return worst;
}

static const struct kind kinds[] = {{"wall", false, false, 0.5, 0.4},
                                    {"wall, elastic", false, false, 1.0, 0.4},
                                    {"twins", false, true, 0.5, 0.4},
                                    {"twins without friction", false, true, 0.5, -1.0},
                                    {"Hertz twins without friction", true, true, 0.5, -1.0}};

/* The law, its history and the integrator together. Where a contact goes from sliding to sticking
 * depends on the phase: the orders of four points scatter by 0.1, and single points may be better
 * than their order. The ledger closes to second order too, and no worse than with velocity Verlet. */
START_TEST(oblique_impacts_are_of_second_order)
{
    const struct kind *k = &kinds[_i];
    struct after fine[ANGLES];
    double error[LADDER], residual[LADDER], usual;
    impact("contact-exact", k, FINE, 1, fine);
    for (size_t q = 0; q < LADDER; q++)
        error[q] = impact_error("contact-exact", k, STEPS[q], fine, &residual[q]);
    double plain = impact_error("velocity-verlet", k, STEPS[LADDER - 1], fine, &usual);
    double order = -slope(LADDER, STEPS, error), closing = -slope(LADDER, STEPS, residual);
    ck_assert_msg(order > 1.9, "%s: order %.3f (%g .. %g)", k->name, order, error[0], error[3]);
    ck_assert_msg(closing > 1.9, "%s: the ledger closes with order %.3f (%g .. %g)", k->name,
                  closing, residual[0], residual[3]);
    ck_assert_msg(residual[LADDER - 1] < 1.1 * usual, "%s: the ledger lacks %g, %g with velocity-verlet",
                  k->name, residual[LADDER - 1], usual);
    ck_assert_msg(k->e == 1.0 || error[LADDER - 1] < 0.02 * plain, "%s: %g against %g", k->name,
                  error[LADDER - 1], plain);
}
END_TEST

/* mindlin, whose stiffness goes with the root of the overlap, with velocity Verlet where nothing is damped, and with contact-exact. Taking the
 * stiffness of the end of each increment gave order 0.9 and 3e-3 at 200 steps; counting the part of the onset's step in which the bodies touch
 * twice, order 1.6 and 1e-4. */
static const struct {
    struct kind kind;
    const char *integrator;
    double order, most; /* of the error; at 200 steps, m/s */
} mindlin[] = {{{"Mindlin wall", true, false, 1.0, 0.4}, "velocity-verlet", 1.9, 1e-4},
               {{"Mindlin twins", true, true, 1.0, 0.4}, "velocity-verlet", 1.9, 1e-4},
               {{"Mindlin wall", true, false, 1.0, 0.4}, "contact-exact", 1.9, 1e-4},
               {{"Mindlin twins", true, true, 1.0, 0.4}, "contact-exact", 1.9, 1e-4},
               {{"Mindlin twins, damped", true, true, 0.5, 0.4}, "contact-exact", 1.9, 1e-4}};

START_TEST(mindlin_with_the_mean_stiffness)
{
    const struct kind *k = &mindlin[_i].kind;
    struct after fine[ANGLES];
    double error[LADDER], residual;
    impact("contact-exact", k, FINE, 1, fine);
    for (size_t q = 0; q < LADDER; q++)
        error[q] = impact_error(mindlin[_i].integrator, k, STEPS[q], fine, &residual);
    double order = -slope(LADDER, STEPS, error);
    ck_assert_msg(order > mindlin[_i].order && error[LADDER - 1] < mindlin[_i].most, "%s, %s: order %.3f (%g .. %g)", k->name,
                  mindlin[_i].integrator, order, error[0], error[LADDER - 1]);
}
END_TEST

/* ---- momentum ---- */

/* What one grain gets the other gives, at onset and end too: rounding of 60 steps. Unequal masses. */
START_TEST(momentum_is_kept)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, STIFFNESS, 0.5, 0.4, 1e-5);
    for (size_t k = 0; k < s->models[0].count; k++)
        if (s->models[0].list[k].kind == CALX_MOTION)
            strcpy(s->models[0].list[k].plugin, "contact-exact");
    scene_put(s, 0, 0.0, 0.0, 0.0, RADIUS);
    scene_put(s, 1, 3.01 * RADIUS, 0.2 * RADIUS, 0.0, 2.0 * RADIUS);
    scene_move(s, 0, 2.0, 1.0, -1.0);
    scene_spin(s, 0, 10.0, 20.0, 30.0);
    struct run r = run_start(s, 1);
    double m[2] = {run_mass(&r, 0), run_mass(&r, 1)};
    run_steps(&r, 200);
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    ck_assert_double_gt(fabs(run_v(&r, 1)[0]), 0.01);
    for (int k = 0; k < 3; k++) {
        double before = m[0] * (double[3]){2.0, 1.0, -1.0}[k];
        ck_assert_double_eq_tol(m[0] * run_v(&r, 0)[k] + m[1] * run_v(&r, 1)[k], before,
                                200 * 2.3e-16 * m[0] * 3.0);
    }
    run_free(&r);
}
END_TEST

/* ---- rest ---- */

/* A damped grain in permanent contact with a floor, under gravity, let go at 1.5 times the overlap d at
 * which it will rest: d/2 e^(-b t) (cos w t + b/w sin w t) about that, w0 = 1/s. Laws see velocities
 * half a step late: with those velocity Verlet is of first order here. In the end the grain rests
 * where the spring carries it. */
static double settling_error(const char *integrator, size_t steps, double *rest)
{
    const double b = 0.2, w = sqrt(1.0 - b * b), d = 0.01, t = 4.0;
    double mass = 4.0 / 3.0 * M_PI * 1000.0;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", mass}, {"damping", 2.0 * b * mass}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrator, NULL);
    s->models[0].dt = t / (double)steps;
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    scene_gravity(s, 0.0, -d, 0.0);
    scene_put(s, 0, 0.0, 1.0 - 1.5 * d, 0.0, 1.0);
    struct run r = run_start(s, 1);
    run_steps(&r, steps);
    double deep = 0.5 * exp(-b * t) * (cos(w * t) + b / w * sin(w * t));
    double error = (1.0 - d - run_x(&r, 0)[1]) / d - deep;
    run_steps(&r, 50 * steps); /* e^(-40) is left */
    *rest = (1.0 - run_x(&r, 0)[1]) / d - 1.0;
    run_free(&r);
    return fabs(error);
}

START_TEST(damping_under_load_is_of_second_order)
{
    double steps[3] = {100, 200, 400}, error[3], plain[3], rest;
    for (size_t k = 0; k < 3; k++) {
        plain[k] = settling_error("velocity-verlet", (size_t)steps[k], &rest);
        error[k] = settling_error("contact-exact", (size_t)steps[k], &rest);
        ck_assert_double_lt(fabs(rest), 1e-13 / 0.01); /* coordinates of 1 m, an overlap of 0.01 m */
    }
    double order = -slope(3, steps, error);
    ck_assert_msg(order > 1.9, "order %.3f (%g .. %g)", order, error[0], error[2]);
    ck_assert_msg(error[2] < 0.1 * plain[2], "%g against %g", error[2], plain[2]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("contact_exact");
    TCase *tcase = tcase_create("all");
    tcase_add_test(tcase, weights_integrate_powers);
    tcase_add_loop_test(tcase, oblique_impacts_are_of_second_order, 0,
                        sizeof kinds / sizeof *kinds);
    tcase_add_loop_test(tcase, mindlin_with_the_mean_stiffness, 0, sizeof mindlin / sizeof *mindlin);
    tcase_add_test(tcase, momentum_is_kept);
    tcase_add_test(tcase, damping_under_load_is_of_second_order);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conduction through networks of contacts against closed forms: two bodies, the modes of chains
 * with insulated ends and between walls, steady flux, and what happens to a step that is too long.
 * Bodies are frozen: what moves is heat. Carslaw and Jaeger, Conduction of Heat in Solids (1959).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double H = 2.0;       /* W/K, of every contact where it is constant */
static const double RADIUS = 0.05; /* m */
static const double LAP = 1e-3;    /* m, overlap of neighbours */

/* A frozen scene of n grains with a constant conductance. */
static struct calx_scene *frozen(uint32_t dimension, size_t n, const char *integrator, double theta,
                                 double dt)
{
    struct calx_scene *s = scene_create(dimension, CALX_SPHERES, n);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
    scene_model1(s, CALX_TEMPERATURE, integrator, theta >= 0.0 ? "theta" : NULL, theta);
    s->models[0].frozen = true;
    s->models[0].heat_dt = dt;
    return s;
}

static double capacity(const struct calx_scene *s)
{
    return calx_particle_mass(s, RADIUS, 1000.0) * 1000.0;
}

/* What one step does to a mode that decays with rate s: Euler, the theta rule, the exponential. */
static double factor(const char *integrator, double theta, double x)
{
    return !strcmp(integrator, "heat-exponential") ? exp(-x)
           : !strcmp(integrator, "heat-euler")     ? 1.0 - x
                                                   : (1.0 - (1.0 - theta) * x) / (1.0 + theta * x);
}

static const struct {
    const char *integrator;
    double theta;
} schemes[] = {{"heat-euler", -1},
               {"heat-theta", 0.5},
               {"heat-theta", 1.0},
               {"heat-theta", 0.75},
               {"heat-exponential", -1}};

/* Conjugate gradients and the exponential stop at 1e-12 of the heat flow; over n steps errors add
 * up to n times that, and decay with the mode. */
static const double SOLVER = 1e-12;

/* ---- two bodies ---- */

START_TEST(two_bodies_relax)
{
    enum { STEPS = 500 };
    for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++) {
        struct calx_scene *s = frozen(3, 2, schemes[k].integrator, schemes[k].theta, 1.0);
        scene_material(s, "other", 3000.0, 400.0);
        s->particles.material[1] = 1;
        scene_put(s, 0, 0, 0, 0, RADIUS);
        scene_put(s, 1, 2.0 * RADIUS - LAP, 0, 0, RADIUS);
        double c[2] = {capacity(s), 1.2 * capacity(s)}, rate = H * (1.0 / c[0] + 1.0 / c[1]),
               dt = 0.01 / rate;
        s->models[0].heat_dt = dt;
        scene_warm(s, 0, 400.0);
        scene_warm(s, 1, 300.0);
        struct run r = run_start(s, 1);
        double heat = c[0] * 400.0 + c[1] * 300.0;
        for (int step = 1; step <= STEPS; step++) {
            run_steps(&r, 1);
            double t0 = run_v(&r, 0)[7], t1 = run_v(&r, 1)[7];
            double expected =
                100.0 * pow(factor(schemes[k].integrator, schemes[k].theta, 0.01), step);
            if (fabs(t0 - t1 - expected) > STEPS * 400.0 * 2.3e-16 + STEPS * SOLVER * 100.0 ||
                fabs((c[0] * t0 + c[1] * t1) / heat - 1.0) > 1e-13)
                ck_abort_msg("%s, theta %g, step %d: %.15g K instead of %.15g, heat %.15g",
                             schemes[k].integrator, schemes[k].theta, step, t0 - t1, expected,
                             (c[0] * t0 + c[1] * t1) / heat);
        }
        run_free(&r);
    }
}
END_TEST

/* After one decay time the error is s dt/2 of the exponential for theta 0 and 1, (s dt)^2/12 for
 * theta 1/2. */
START_TEST(orders_of_the_schemes)
{
    static const double steps[] = {20, 40, 80}; /* per decay time */
    const struct {
        const char *integrator;
        double theta, order;
    } rows[] = {{"heat-euler", -1, 1}, {"heat-theta", 1.0, 1}, {"heat-theta", 0.5, 2}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double error[3];
        for (size_t q = 0; q < 3; q++) {
            struct calx_scene *s = frozen(3, 2, rows[k].integrator, rows[k].theta, 1.0);
            double tau = capacity(s) / (2.0 * H);
            s->models[0].heat_dt = tau / steps[q];
            scene_put(s, 0, 0, 0, 0, RADIUS);
            scene_put(s, 1, 2.0 * RADIUS - LAP, 0, 0, RADIUS);
            scene_warm(s, 0, 400.0);
            scene_warm(s, 1, 300.0);
            struct run r = run_start(s, 1);
            run_steps(&r, (size_t)steps[q]);
            error[q] = fabs(run_v(&r, 0)[7] - run_v(&r, 1)[7] - 100.0 * exp(-1.0));
            run_free(&r);
        }
        double order = -slope(3, steps, error);
        /* the next order adds at most a tenth over steps of 1/20 and less */
        ck_assert_msg(fabs(order - rows[k].order) < 0.1, "%s, theta %g: order %.3f",
                      rows[k].integrator, rows[k].theta, order);
    }
}
END_TEST

/* ---- chains ---- */

enum { CHAIN = 15 };

/* A line of grains along x, between two hot walls if `walls`. */
static struct calx_scene *chain(const char *integrator, double theta, double x, bool walls)
{
    struct calx_scene *s = frozen(2, CHAIN, integrator, theta, 1.0);
    const double pitch = 2.0 * RADIUS - LAP;
    s->models[0].heat_dt = x * capacity(s) / (4.0 * H);
    for (size_t i = 0; i < CHAIN; i++)
        scene_put(s, i, pitch * (double)i, 0.0, 0.0, RADIUS);
    for (int side = 0; side < 2 && walls; side++) {
        int w = scene_wall(s, side ? "right" : "left", 0);
        double at = side ? pitch * (CHAIN - 1) + RADIUS - LAP : -RADIUS + LAP;
        scene_segment(s, w, at, -1.0, at, 1.0, 0);
        scene_wall_temperature(s, w, 300.0);
    }
    return s;
}

/* Each mode, alone, decays as itself: s_j = (4H/C) sin^2(j pi/(2 (N+1))) between walls, sin^2(j
 * pi/(2N)) insulated. */
static void check_modes(bool walls)
{
    enum { STEPS = 200 };
    for (size_t k = 0; k < sizeof schemes / sizeof *schemes; k++)
        for (int j = 1; j < CHAIN; j += 3) {
            double n = walls ? CHAIN + 1 : CHAIN, x = 0.2 * pow(sin(j * M_PI / (2.0 * n)), 2);
            struct calx_scene *s = chain(schemes[k].integrator, schemes[k].theta, 0.2, walls);
            double shape[CHAIN],
                worst = 0.0, left = pow(factor(schemes[k].integrator, schemes[k].theta, x), STEPS);
            for (int i = 0; i < CHAIN; i++) {
                shape[i] = walls ? sin(j * M_PI * (i + 1) / n) : cos(j * M_PI * (i + 0.5) / n);
                scene_warm(s, (size_t)i, 300.0 + 50.0 * shape[i]);
            }
            struct run r = run_start(s, 1);
            run_steps(&r, STEPS);
            for (int i = 0; i < CHAIN; i++)
                worst = fmax(worst, fabs(run_v(&r, i)[7] - 300.0 - 50.0 * left * shape[i]));
            ck_assert_msg(worst < STEPS * (350.0 * 2.3e-16 + 50.0 * SOLVER),
                          "%s, theta %g, mode %d: off by %g K", schemes[k].integrator,
                          schemes[k].theta, j, worst);
            run_free(&r);
        }
}

START_TEST(modes_of_chains)
{
    check_modes(false);
    check_modes(true);
}
END_TEST

/* Steady: a straight line of temperatures, the same flux through every contact, from an implicit
 * rule in a few long steps. */
START_TEST(steady_flux)
{
    const double hot = 500.0, cold = 300.0, flux = H * (hot - cold) / (CHAIN + 1), bound = 1e-10;
    struct calx_scene *s = chain("heat-theta", 1.0, 1e4, true);
    scene_wall_temperature(s, 0, hot);
    struct run r = run_start(s, 1);
    run_steps(&r, 12);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, CHAIN + 1);
    for (size_t c = 0; c < f->contact_count; c++)
        ck_assert_msg(fabs(fabs(f->heat_flow[c]) / flux - 1.0) < bound,
                      "contact of %lld and %lld carries %.12g W of %.12g", (long long)f->pair[c][0],
                      (long long)f->pair[c][1], f->heat_flow[c], flux);
    for (int i = 0; i < CHAIN; i++) {
        double expected = hot + (cold - hot) * (i + 1) / (CHAIN + 1);
        ck_assert_msg(fabs(f->temperature[i] / expected - 1.0) < bound, "body %d: %.12g K of %.12g",
                      i, f->temperature[i], expected);
        ck_assert_double_eq_tol(f->heat[i], 0.0, bound * flux);
    }
    calx_frame_free(f);
    run_free(&r);
}
END_TEST

/* ---- steps that are too long ---- */

/* No temperature leaves the range of the start, however long the step: the implicit rule damps,
 * theta is raised where it must be. */
START_TEST(long_implicit_steps_do_not_overshoot)
{
    static const double x[] = {1.01, 10.0, 1e4};
    for (size_t k = 1; k < sizeof schemes / sizeof *schemes; k++)
        for (size_t q = 0; q < sizeof x / sizeof *x; q++) {
            struct calx_scene *s = chain(schemes[k].integrator, schemes[k].theta, 4.0 * x[q], true);
            const double rounding = 1e-9;
            for (size_t i = 0; i < CHAIN; i++)
                scene_warm(s, i, i % 2 ? 400.0 : 300.0);
            struct run r = run_start(s, 1);
            for (int step = 0; step < 20; step++) {
                run_steps(&r, 1);
                for (int i = 0; i < CHAIN; i++)
                    if (run_v(&r, i)[7] < 300.0 - rounding || run_v(&r, i)[7] > 400.0 + rounding)
                        ck_abort_msg("theta %g, dt = %g C/H: %.12g K at step %d", schemes[k].theta,
                                     x[q], run_v(&r, i)[7], step);
            }
            run_free(&r);
        }
}
END_TEST

/* The explicit rule is stable up to dt = C/sum H: C/H in a pair, C/(2 H) in a chain. Beyond that
 * the run is refused; up to there it is not. */
START_TEST(long_explicit_steps_are_refused)
{
    static const struct {
        size_t n;
        double limit;
    } rows[] = {{2, 1.0}, {CHAIN, 0.5}};
    for (size_t k = 0; k < 2; k++)
        for (int beyond = 0; beyond < 2; beyond++) {
            struct calx_error e = {0};
            struct calx_scene *s = frozen(3, rows[k].n, "heat-euler", -1, 1.0);
            s->models[0].heat_dt = (beyond ? 1.01 : 0.99) * rows[k].limit * capacity(s) / H;
            for (size_t i = 0; i < rows[k].n; i++)
                scene_put(s, i, (2.0 * RADIUS - LAP) * (double)i, 0, 0, RADIUS);
            if (beyond) {
                run_refused(s, &e);
                ck_assert_int_eq(e.code, CALX_ERROR_PHYSICS);
                ck_assert_msg(strstr(e.text, "heat step") && strstr(e.text, "too long"), "%s",
                              e.text);
            } else {
                struct run r = run_start(s, 1);
                run_free(&r);
            }
        }
}
END_TEST

/* Bodies that meet during the run are seen within the steps between two looks. */
START_TEST(meeting_bodies_are_checked)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, 1e4, NAN, -1.0, 1e-4);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 1.01e4 * capacity(s));
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    scene_put(s, 0, 0, 0, 0, RADIUS);
    scene_put(s, 1, 2.0 * RADIUS + LAP, 0, 0, RADIUS);
    scene_move(s, 1, -0.1, 0, 0);
    struct run r = run_start(s, 1);
    int code = 0;
    while (!code && calx_sim_step_count(r.sim) < 1000)
        code = calx_sim_step(r.sim, &e);
    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
    ck_assert_msg(strstr(e.text, "heat step") != NULL, "%s", e.text);
    run_free(&r);
}
END_TEST

/* Scaling: k -> 3 k and t -> t/3 leave the temperatures of a frozen bed as they are, step by step.
 */
START_TEST(time_scales_with_conductivity)
{
    double t[2][CHAIN];
    for (int fast = 0; fast < 2; fast++) {
        struct calx_scene *s = chain("heat-theta", 0.5, 0.2, true);
        s->models[0].list[0].values[0].value *= fast ? 4.0 : 1.0;
        s->models[0].heat_dt /= fast ? 4.0 : 1.0;
        for (size_t i = 0; i < CHAIN; i++)
            scene_warm(s, i, 300.0 + 7.0 * (double)(i * i % 11));
        struct run r = run_start(s, 1);
        run_steps(&r, 100);
        for (int i = 0; i < CHAIN; i++)
            t[fast][i] = run_v(&r, i)[7];
        run_free(&r);
    }
    for (int i = 0; i < CHAIN; i++)
        ck_assert_double_eq_tol(t[0][i] / t[1][i], 1.0, 1e-12);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {two_bodies_relax,
                            orders_of_the_schemes,
                            modes_of_chains,
                            steady_flux,
                            long_implicit_steps_do_not_overshoot,
                            long_explicit_steps_are_refused,
                            meeting_bodies_are_checked,
                            time_scales_with_conductivity};
    return run_tests("heat", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductances, integrators of temperature and integrators of motion against closed forms, with the
 * plugins alone: the circle of two spheres, Hertz's contact, the steady state and the modes of a
 * chain of bodies, the oscillator.
 */
#include <stdbool.h>
#include <stdlib.h>

#include "tests/model.h"

/* ---- conductances ---- */

static double conductance_of(const char *name, const struct calx_setup *setup, const char *values,
                             double overlap, double k1, double k2, double fn)
{
    struct model m;
    struct contact c;
    double h[8] = {0};
    model_open(&m, CALX_CONDUCTANCE, name, setup, values);
    contact_begin(&c, 1e-6, 1, k1, k2);
    c.overlap[0] = overlap;
    c.fn[0] = fn;
    ((const struct calx_conductance_law *)m.plugin->law)->conductance(m.params, &c.batch, h);
    return h[0];
}

START_TEST(test_overlap_conductance)
{
    /* the thesis's form, from radii and distance; differences of squares there cost digits */
    for (double r2 = 0.001; r2 < 0.01; r2 *= 1.7)
        for (double d = 1e-6; d < 1e-3; d *= 3) {
            double r1 = 0.002, l = r1 + r2 - d, x = (r1 * r1 - r2 * r2 + l * l) / (2 * l),
                   h = 2 * 385 * sqrt(r1 * r1 - x * x);
            ck_assert_double_eq_tol(
                conductance_of("overlap", &spheres, "conductivity=385", d, 1 / r1, 1 / r2, 0) / h,
                1, 1e-11);
        }
    /* case 4 of the thesis; a wall; unlike materials; insulators; one inside the other */
    double h = 2 * 385 * sqrt(0.002 * 0.002 - 0.0019 * 0.0019);
    ck_assert_double_eq_tol(
        conductance_of("overlap", &spheres, "conductivity=385", 0.0002, 500, 500, 0) / h, 1, 1e-13);
    h = 2 * 385 * sqrt(0.0002 * (2 * 0.002 - 0.0002));
    ck_assert_double_eq_tol(
        conductance_of("overlap", &spheres, "conductivity=385", 0.0002, 500, 0, 0) / h, 1, 1e-13);
    h *= 2 * 16.0 / (385 + 16);
    ck_assert_double_eq_tol(
        conductance_of("overlap", &spheres, "conductivity=385:16", 0.0002, 500, 0, 0) / h, 1,
        1e-13);
    ck_assert_double_eq(conductance_of("overlap", &spheres, "conductivity=0", 0.0002, 500, 0, 0),
                        0);
    ck_assert_double_eq(
        conductance_of("overlap", &spheres, "conductivity=385", 0.0025, 500, 1000, 0), 0);
    ck_assert_double_eq(conductance_of("overlap", &spheres, "conductivity=385", 0, 500, 500, 0), 0);
}
END_TEST

START_TEST(test_hertz_conductance)
{
    const char *values = "conductivity=50 young=2.1e11 poisson=0.3";
    double modulus = 2.1e11 / (2 * (1 - 0.09)), radius = 1.0 / 700, h;
    h = 2 * 50 * cbrt(3 * 2.5 * radius / (4 * modulus));
    ck_assert_double_eq_tol(conductance_of("hertz", &spheres, values, 1e-7, 500, 200, 2.5) / h, 1,
                            1e-13);
    /* H = 2 k (16 fn R* L/(pi E*))^(1/4), L = 0.02 m */
    h = 2 * 50 * pow(16 * 2.5 * radius * 0.02 / (M_PI * modulus), 0.25);
    ck_assert_double_eq_tol(conductance_of("hertz", &discs, values, 1e-7, 500, 200, 2.5) / h, 1,
                            1e-13);
    ck_assert_double_eq(conductance_of("hertz", &spheres, values, 1e-7, 500, 200, -1), 0);
    ck_assert_double_eq(conductance_of("hertz", &spheres, values, -1e-7, 500, 200, 1), 0);
    /* a tenfold load: H grows by 10^(1/3) */
    double ratio = conductance_of("hertz", &spheres, values, 1e-7, 500, 0, 10) /
                   conductance_of("hertz", &spheres, values, 1e-7, 500, 0, 1);
    ck_assert_double_eq_tol(ratio, cbrt(10), 1e-13);
    ck_assert_double_eq(conductance_of("constant", &discs, "conductance=3", 1e-9, 500, 0, 0), 3);
    ck_assert_double_eq(conductance_of("constant", &discs, "conductance=3", 0, 500, 0, 0), 0);
}
END_TEST

/* ---- temperature ---- */

enum { CHAIN = 15 };

/* N equal bodies between walls of 400 and 300 K, conductance 1, capacity 1. */
struct line {
    struct calx_network net;
    double t[CHAIN], capacity[CHAIN], source[CHAIN], h[CHAIN], wall_h[2], wall_t[2], wall_heat[2];
    int32_t from[CHAIN], to[CHAIN], wall[2];
};

static void line_begin(struct line *l, double dt, size_t walls)
{
    memset(l, 0, sizeof *l);
    for (int i = 0; i < CHAIN; i++)
        l->t[i] = 300, l->capacity[i] = 1, l->h[i] = 1, l->from[i] = i, l->to[i] = i + 1;
    l->wall[1] = CHAIN - 1;
    l->wall_h[0] = l->wall_h[1] = 1;
    l->wall_t[0] = 400, l->wall_t[1] = 300;
    l->net = (struct calx_network){.size = sizeof l->net,
                                   .n = CHAIN,
                                   .dt = dt,
                                   .temperature = l->t,
                                   .capacity = l->capacity,
                                   .source = l->source,
                                   .edges = CHAIN - 1,
                                   .edge = {l->from, l->to},
                                   .edge_conductance = l->h,
                                   .boundaries = walls,
                                   .boundary = l->wall,
                                   .boundary_conductance = l->wall_h,
                                   .boundary_temperature = l->wall_t,
                                   .boundary_heat = l->wall_heat};
}

static void line_step(struct line *l, const struct model *m)
{
    char why[256] = "";
    const struct calx_temperature_integrator *law = m->plugin->law;
    ck_assert_msg(law->solve(m->params, &l->net, why, sizeof why) == 0, "%s", why);
}

/* Long implicit steps reach the steady state T_i = Ta + (Tb - Ta) i/(N + 1) with the flow H (Ta -
 * Tb)/(N + 1). */
START_TEST(test_steady_chain)
{
    struct model m;
    struct line l;
    model_open(&m, CALX_TEMPERATURE, "heat-theta", &spheres, "theta=1");
    line_begin(&l, 1e4, 2); /* the slowest mode decays with 26 s */
    for (int n = 0; n < 10; n++)
        line_step(&l, &m);
    for (int i = 0; i < CHAIN; i++)
        ck_assert_double_eq_tol(l.t[i], 400 - 100 * (i + 1.0) / (CHAIN + 1), 1e-9);
    ck_assert_double_eq_tol(l.wall_heat[0] / 1e4, 100.0 / (CHAIN + 1), 1e-9);
    ck_assert_double_eq_tol(l.wall_heat[1] / 1e4, -100.0 / (CHAIN + 1), 1e-9);
}
END_TEST

/* The slowest mode of the insulated chain, cos(pi (i - 1/2)/N), decays at 4 H/C sin^2(pi/(2 N)).
 * theta = 1/2 is of second order: the error of one time constant in 100 steps is (1/100)^2/12
 * = 8.4e-6. */
START_TEST(test_decay_of_chain)
{
    struct model m;
    struct line l;
    double rate = 4 * pow(sin(M_PI / (2 * CHAIN)), 2), heat = 0;
    model_open(&m, CALX_TEMPERATURE, "heat-theta", &spheres, "");
    line_begin(&l, 1 / rate / 100, 0);
    for (int i = 0; i < CHAIN; i++)
        l.t[i] += 10 * cos(M_PI * (i + 0.5) / CHAIN);
    for (int n = 0; n < 100; n++)
        line_step(&l, &m);
    for (int i = 0; i < CHAIN; i++) {
        ck_assert_double_eq_tol(l.t[i] - 300, 10 * exp(-1) * cos(M_PI * (i + 0.5) / CHAIN),
                                10 * exp(-1) * 8.5e-6);
        heat += l.t[i];
    }
    ck_assert_double_eq_tol(heat / (300 * CHAIN), 1, 1e-14);
}
END_TEST

/* A step of ten times C/H: no temperature leaves the range of before, for any theta with monotone;
 * without it theta = 1/2 overshoots. */
START_TEST(test_monotone)
{
    static const struct {
        const char *values;
        bool overshoots;
    } rows[] = {{"monotone=0", true},
                {"", false},
                {"theta=0", false},
                {"theta=1", false},
                {"theta=1 monotone=0", false}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct model m;
        struct line l;
        bool outside = false;
        model_open(&m, CALX_TEMPERATURE, "heat-theta", &spheres, rows[k].values);
        line_begin(&l, 10, 0);
        l.t[7] = 1000;
        for (int n = 0; n < 5; n++) {
            line_step(&l, &m);
            for (int i = 0; i < CHAIN; i++)
                outside |=
                    l.t[i] < 300 - 1e-9 || l.t[i] > 1000 + 1e-9; /* tolerance of the solver */
        }
        ck_assert_msg(outside == rows[k].overshoots, "%s", rows[k].values);
    }
}
END_TEST

/* Contacts of K and 1 W/K in a row, a step of up to 1e9 times what the stronger needs: bodies 0 and
 * 1 share their heat at once, then both with body 2 in the slow mode, of rate 3 K/f and shape (l -
 * 2, 1
 * - l, 1), f = K + 1 + sqrt((K + 1)^2 - 3 K). The flow of K, 200 K times 1e-16, hides that of 1. */
START_TEST(test_exponential_of_a_stiff_network)
{
    static const double strong[] = {1e3, 1e6, 1e9};
    for (size_t n = 0; n < sizeof strong / sizeof *strong; n++) {
        struct model m;
        struct line l;
        double k = strong[n], fast = k + 1 + sqrt((k + 1) * (k + 1) - 3 * k), slow = 3 * k / fast;
        double shape[] = {slow - 2, 1 - slow, 1}, share = 0, size = 0;
        model_open(&m, CALX_TEMPERATURE, "heat-exponential", &spheres, "");
        line_begin(&l, 1, 0);
        l.net.n = 3;
        l.net.edges = 2;
        l.h[0] = k;
        l.t[0] = 600, l.t[1] = 400, l.t[2] = 200;
        for (int i = 0; i < 3; i++)
            share += shape[i] * l.t[i], size += shape[i] * shape[i];
        line_step(&l, &m);
        for (int i = 0; i < 3; i++)
            ck_assert_double_eq_tol(l.t[i], 400 + share / size * exp(-slow) * shape[i],
                                    1e-9 + 4 * 2.2e-16 * k * 200);
        ck_assert_double_eq_tol(l.t[0] + l.t[1] + l.t[2], 1200, 1e-12);
    }
}
END_TEST

/* A chain of unlike contacts from 1e-4 to 1e4 W/K between walls: one step is two half steps, heat
 * is kept, and no temperature leaves the range. Flows of 100 K through the strongest contact round
 * to 1e-16 of 1e6 W, a few of them; that acts for the step or the time constant of the weakest. */
START_TEST(test_exponential_of_half_steps)
{
    static const double steps[] = {1e-3, 1, 1e3, 1e6};
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        struct model m;
        struct line whole, halves;
        double heat = 0, given = 0, dt = steps[k];
        double bound = 1e-9 + 4 * 2.2e-16 * 1e6 * fmin(dt, 1e4);
        model_open(&m, CALX_TEMPERATURE, "heat-exponential", &spheres, "");
        line_begin(&whole, steps[k], 2);
        for (int i = 0; i < CHAIN; i++) {
            whole.h[i] = pow(10, i * 5 % 9 - 4);
            whole.t[i] = 300 + 7 * (i * i % 14);
            whole.capacity[i] = 1 + 0.1 * i;
            heat += whole.capacity[i] * whole.t[i];
        }
        halves = whole;
        double *const moved[] = {halves.t, halves.capacity, halves.source, halves.h};
        halves.net = whole.net;
        halves.net.temperature = moved[0];
        halves.net.capacity = moved[1];
        halves.net.source = moved[2];
        halves.net.edge_conductance = moved[3];
        halves.net.boundary_heat = halves.wall_heat;
        halves.net.dt = 0.5 * steps[k];
        line_step(&whole, &m);
        line_step(&halves, &m);
        given = halves.wall_heat[0];
        line_step(&halves, &m);
        given += halves.wall_heat[0];
        ck_assert_double_eq_tol(given, whole.wall_heat[0], dt * bound);
        for (int i = 0; i < CHAIN; i++) {
            ck_assert_double_eq_tol(whole.t[i], halves.t[i], bound);
            ck_assert_msg(whole.t[i] > 300 - bound && whole.t[i] < 400 + bound, "%.12g K",
                          whole.t[i]);
            heat -= whole.capacity[i] * whole.t[i];
        }
        heat += whole.wall_heat[0] + whole.wall_heat[1];
        ck_assert_double_eq_tol(heat / (400 * CHAIN), 0, 1e-13 * fmax(1, dt / 10));
    }
}
END_TEST

START_TEST(test_solver_reports_failure)
{
    struct model m;
    struct line l;
    char why[256] = "";
    model_open(&m, CALX_TEMPERATURE, "heat-theta", &spheres, "");
    line_begin(&l, 0.1, 0);
    l.t[3] = NAN;
    const struct calx_temperature_integrator *law = m.plugin->law;
    ck_assert_int_eq(law->solve(m.params, &l.net, why, sizeof why), 1);
    ck_assert_ptr_nonnull(strstr(why, "did not reach the tolerance"));
    l.net.n = 0;
    ck_assert_int_eq(law->solve(m.params, &l.net, why, sizeof why), 0);
    model_open(&m, CALX_TEMPERATURE, "heat-exponential", &spheres, "");
    law = m.plugin->law;
    ck_assert_int_eq(law->solve(m.params, &l.net, why, sizeof why), 0);
    l.net.n = CHAIN;
    why[0] = 0;
    ck_assert_int_eq(law->solve(m.params, &l.net, why, sizeof why), 1);
    ck_assert_ptr_nonnull(strstr(why, "did not reach the tolerance"));
}
END_TEST

/* ---- integrators of motion ---- */

/* x'' = -x from (1, 0): the error of position and velocity after `periods`, and the energy. */
static double oscillate(const char *name, int steps_per_period, int periods, double *energy)
{
    struct calx_error error = {0};
    const struct calx_plugin *p = calx_registry_find(registry, CALX_MOTION, name, &error);
    ck_assert_msg(p != NULL, "%s", error.text);
    const struct calx_motion_integrator *law = p->law;
    double x[4] = {1}, v[4] = {0}, a[4] = {-1}, rows[4] = {0}, *extra[] = {rows},
           dt = 2 * M_PI / steps_per_period;
    struct calx_rows r = {.size = sizeof r,
                          .n = 1,
                          .stride = 4,
                          .dt = {dt, dt, dt, 0},
                          .x = x,
                          .v = v,
                          .a = a,
                          .extra = extra};
    for (int n = 0; n < steps_per_period * periods; n++) {
        law->translation->before(NULL, &r);
        a[0] = -x[0];
        law->translation->after(NULL, &r);
    }
    *energy = v[0] * v[0] + x[0] * x[0] - 1;
    return hypot(x[0] - 1, v[0]);
}

static const char *const integrators[] = {"velocity-verlet", "verlet"};

START_TEST(test_oscillator)
{
    double energy;
    /* the phase runs ahead by (omega dt)^2/24 of the period: 2 pi (2 pi/50)^2/24 = 4.13e-3 */
    ck_assert_double_eq_tol(oscillate(integrators[_i], 50, 1, &energy), 4.13e-3, 1e-5);
    oscillate(integrators[_i], 50, 100, &energy);
    ck_assert_double_eq_tol(energy, -6.4e-4, 1e-5); /* bounded for ever: 100 periods are like 1 */
    double coarse = oscillate(integrators[_i], 100, 1, &energy),
           fine = oscillate(integrators[_i], 200, 1, &energy);
    ck_assert_double_eq_tol(log2(coarse / fine), 2, 0.01);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("laws of heat");
    TCase *t = tcase_create("all");
    tcase_add_checked_fixture(t, set_up, tear_down);
    tcase_add_test(t, test_overlap_conductance);
    tcase_add_test(t, test_hertz_conductance);
    tcase_add_test(t, test_steady_chain);
    tcase_add_test(t, test_decay_of_chain);
    tcase_add_test(t, test_monotone);
    tcase_add_test(t, test_solver_reports_failure);
    tcase_add_test(t, test_exponential_of_a_stiff_network);
    tcase_add_test(t, test_exponential_of_half_steps);
    tcase_add_loop_test(t, test_oscillator, 0, 2);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact laws against closed forms, with the plugins alone: a sphere hits a plane or another
 * sphere in a small driver of this file, which does what the engine does for one contact under
 * velocity Verlet. Values: Chung and Ooi, Granular Matter 13 (2011) 643; Schwager and Poeschel,
 * Granular Matter 9 (2007) 465; and the integrals of Hertz's law.
 */
#include <stdbool.h>
#include <stdlib.h>

#include "tests/model.h"

static const struct {
    enum calx_kind kind;
    const char *name;
    const struct calx_setup *setup;
    const char *values, *words;
} refusals[] = {
    {CALX_CONTACT, "linear", &spheres, "stiffness=1 restitution=0.5 damping=1",
     "exclude each other"},
    {CALX_CONTACT, "linear", &spheres, "stiffness=1 drag=0 damping-rate=1", "exclude each other"},
    {CALX_CONTACT, "hertz", &spheres, "young=1e9 poisson=0.3 restitution=0.5 damping=1",
     "exclude each other"},
    {CALX_CONTACT, "hertz", &discs, "young=1e9 poisson=0.3", "use linear"},
    {CALX_CONTACT, "mindlin", &discs, "young=1e9 poisson=0.3 friction=0.5", "use coulomb"},
    {CALX_CONDUCTANCE, "overlap", &discs, "conductivity=1", "use hertz or constant"},
    {CALX_TEMPERATURE, "heat-theta", &spheres, "theta=0.4 monotone=0", "at least 0.5"},
};

START_TEST(test_refusals)
{
    struct model m;
    char why[256] = "";
    ck_assert_int_eq(model_prepare(&m, refusals[_i].kind, refusals[_i].name, refusals[_i].setup,
                                   refusals[_i].values, why, sizeof why),
                     1);
    ck_assert_msg(strstr(why, refusals[_i].words) != NULL, "no \"%s\" in: %s", refusals[_i].words,
                  why);
}
END_TEST

/* ---- head-on impacts ---- */

/* What came out of an impact. */
struct impact {
    double largest_overlap, largest_force, duration, restitution, dissipated;
};

/* Two bodies of effective mass m meet with speed v; velocity Verlet, the law sees the velocity of
 * half a step before. */
static struct impact collide(const struct model *law, double m, double curvature_i,
                             double curvature_j, double v, double dt)
{
    struct contact c;
    struct impact r = {0};
    contact_begin(&c, dt, 1 / m, curvature_i, curvature_j);
    double d = -0.37 * v * dt, speed = v, force = 0, began = -d / v, time = 0;
    do {
        speed -= 0.5 * dt * force / m;
        double before = d;
        d += dt * speed;
        time += dt;
        c.overlap[0] = d;
        c.vn[0] = -speed;
        contact_force(&c, law, NULL);
        force = c.fn[0];
        speed -= 0.5 * dt * force / m;
        r.largest_overlap = fmax(r.largest_overlap, d);
        r.largest_force = fmax(r.largest_force, force);
        r.duration = time - began - (d < 0 ? d / (d - before) * dt : 0);
    } while (d > 0 || time < 2 * dt);
    r.restitution = -speed / v;
    r.dissipated = c.work[0];
    return r;
}

/* At 1000 steps per contact: sampling of the maxima (pi/1000)^2/8 = 1e-6, velocity Verlet 1.4e-5
 * (5.1e-6 at 320 steps for the speed). The table has 7 digits. */
static const double IMPACT = 2e-5;

static const struct {
    double young, poisson, density, radius;
    bool wall;                              /* else an equal sphere */
    double young_wall;                      /* 0: rigid */
    double speed, overlap, force, duration; /* m/s; um, kN, us */
} hertzian[] = {
    {4.8e10, 0.20, 2800, 0.010, false, 0, 20, 274.1127, 10.69689, 40.3395},
    {2.0e10, 0.25, 2500, 0.010, false, 0, 20, 368.3040, 7.108241, 54.2010},
    {7.0e10, 0.30, 2699, 0.10, true, 0, 0.2, 49.71718, 11.36986, 731.657},
    {7.0e10, 0.30, 2699, 0.10, true, 7.0e13, 0.2, 49.73706, 11.36531, 731.949},
    {4.0e10, 0.35, 1800, 0.10, true, 0, 0.2, 52.12329, 7.232681, 767.066},
    {4.0e10, 0.35, 1800, 0.10, true, 4.0e13, 0.2, 52.14413, 7.229790, 767.373},
    {3.8e11, 0.23, 4000, 0.0025, true, 0, 3.9, 8.088808, 0.6153516, 6.104510},
    {1.0e11, 0.25, 7000, 0.0025, true, 0, 3.9, 17.18871, 0.5067602, 12.97208},
};

START_TEST(test_hertz_impacts)
{
    struct model m;
    char values[128];
    double young = hertzian[_i].young, wall = hertzian[_i].wall ? hertzian[_i].young_wall : young;
    snprintf(values, sizeof values, "young=%g:%g poisson=%g", young, wall > 0 ? wall : 1e20,
             hertzian[_i].poisson);
    model_open(&m, CALX_CONTACT, "hertz", &spheres, values);
    double mass = sphere_mass(hertzian[_i].density, hertzian[_i].radius),
           k = 1 / hertzian[_i].radius;
    struct impact r = collide(&m, hertzian[_i].wall ? mass : mass / 2, k, hertzian[_i].wall ? 0 : k,
                              hertzian[_i].speed, 1e-6 * hertzian[_i].duration / 1000);
    ck_assert_double_eq_tol(1e6 * r.largest_overlap / hertzian[_i].overlap, 1, IMPACT);
    ck_assert_double_eq_tol(1e-3 * r.largest_force / hertzian[_i].force, 1, IMPACT);
    ck_assert_double_eq_tol(1e6 * r.duration / hertzian[_i].duration, 1, IMPACT);
    ck_assert_double_eq_tol(r.restitution, 1, IMPACT);
}
END_TEST

/* Damped impacts at 4000 steps per contact: the error is of first order, 9.7e-4 at 320 steps for e
 * = 0.5 (linear). */
static const double DAMPED = 4e-4;

/* Unclipped: the requested restitution comes out, whatever the speed for hertz. Duration and
 * overlap of the linear law. */
START_TEST(test_restitution)
{
    static const double e[] = {0.2, 0.4, 0.5, 0.6, 0.8, 0.9, 1};
    char values[128];
    for (size_t i = 0; i < sizeof e / sizeof *e; i++) {
        struct model m;
        double mass = 0.02, k = 1e4, w = sqrt(k / mass), v = 0.7;
        snprintf(values, sizeof values, "stiffness=%g restitution=%g", k, e[i]);
        model_open(&m, CALX_CONTACT, "linear", &spheres, values);
        struct impact r = collide(&m, mass, 100, 50, v, M_PI / w / 4000);
        double b = -log(e[i]) / hypot(M_PI, log(e[i])), s = sqrt(1 - b * b);
        ck_assert_double_eq_tol(r.restitution, e[i], DAMPED);
        ck_assert_double_eq_tol(r.duration * w * s / M_PI, 1, DAMPED);
        ck_assert_double_eq_tol(r.largest_overlap * w / v / exp(-b * acos(b) / s), 1, DAMPED);
        /* what is booked is what is missing */
        ck_assert_double_eq_tol(r.dissipated / (0.5 * mass * v * v), 1 - e[i] * e[i], 2 * DAMPED);
        for (double speed = 0.39; speed < 5; speed *= 10) {
            double p = sphere_mass(4000, 0.0025), modulus = 3.8e11 / (1 - 0.23 * 0.23);
            double duration = 2.868266 * pow(p * p / (0.0025 * modulus * modulus * speed), 0.2);
            snprintf(values, sizeof values, "young=3.8e11:1e20 poisson=0.23 restitution=%g", e[i]);
            model_open(&m, CALX_CONTACT, "hertz", &spheres, values);
            r = collide(&m, p, 400, 0, speed, duration / 4000);
            ck_assert_double_eq_tol(r.restitution, e[i], DAMPED);
            ck_assert_double_eq_tol(r.dissipated / (0.5 * p * speed * speed), 1 - e[i] * e[i],
                                    2 * DAMPED);
        }
    }
}
END_TEST

/* Restitution of a clipped contact whose damping is that of the unclipped one. */
static const struct {
    double nominal, clipped;
} clipping[] = {{0.95, 0.950507}, {0.9, 0.902026}, {0.7, 0.718201}, {0.5, 0.550283},
                {0.3, 0.397140},  {0.1, 0.252729}, {0.01, 0.172881}};

START_TEST(test_clipped_table)
{
    struct model m;
    char values[128];
    double mass = 0.02, k = 1e4, b = calx_damping_ratio(clipping[_i].nominal, 0);
    ck_assert_double_eq_tol(calx_clipped_restitution(b), clipping[_i].clipped,
                            1e-6); /* digits of the table */
    snprintf(values, sizeof values, "stiffness=%g damping=%.17g clip=1", k, 2 * b * sqrt(k * mass));
    model_open(&m, CALX_CONTACT, "linear", &spheres, values);
    struct impact r = collide(&m, mass, 100, 50, 0.7, M_PI / sqrt(k / mass) / 4000);
    ck_assert_double_eq_tol(r.restitution, clipping[_i].clipped, DAMPED);
}
END_TEST

/* With clip and restitution the damping is inverted so that the value comes out, overdamped below
 * exp(-2), for both laws. */
START_TEST(test_clip_with_restitution)
{
    static const double e[] = {0.05, 0.1, 0.1353352832366127, 0.2, 0.5, 0.9, 1};
    char values[128];
    for (size_t i = 0; i < sizeof e / sizeof *e; i++) {
        struct model m;
        snprintf(values, sizeof values, "stiffness=1e4 restitution=%.17g clip=1", e[i]);
        model_open(&m, CALX_CONTACT, "linear", &spheres, values);
        struct impact r = collide(&m, 0.02, 100, 50, 0.7, M_PI / sqrt(1e4 / 0.02) / 10000);
        ck_assert_double_eq_tol(r.restitution, e[i], DAMPED);
        snprintf(values, sizeof values, "young=1e8 poisson=0.3 restitution=%.17g clip=1", e[i]);
        model_open(&m, CALX_CONTACT, "hertz", &spheres, values);
        double modulus = 1e8 / (2 * (1 - 0.09));
        r = collide(&m, 0.02, 100, 50, 0.7,
                    2.868266 * pow(4e-4 * 150 / (modulus * modulus * 0.7), 0.2) / 10000);
        ck_assert_double_eq_tol(r.restitution, e[i], DAMPED);
    }
    ck_assert_double_eq(calx_damping_ratio(1, 0), 0);
    ck_assert_double_eq(calx_damping_ratio(1, 1), 0);
    ck_assert_double_eq(calx_damping_ratio(0, 0), 1);
    ck_assert_double_eq(calx_damping_ratio(0, 1), calx_damping_ratio(1e-4, 1));
}
END_TEST

/* A clipped force never attracts; an unclipped one does at the end of a damped impact. */
START_TEST(test_clip_never_attracts)
{
    for (int clip = 0; clip < 2; clip++) {
        struct model m;
        struct contact c;
        char values[64];
        snprintf(values, sizeof values, "stiffness=1000 damping=3 clip=%d", clip);
        model_open(&m, CALX_CONTACT, "linear", &spheres, values);
        contact_begin(&c, 1e-5, 1e3, 500, 500);
        c.overlap[0] = 1e-6, c.vn[0] = 0.1;
        contact_force(&c, &m, NULL);
        ck_assert_double_eq_tol(c.fn[0], clip ? 0 : 1e-3 - 0.3, 1e-15);
    }
}
END_TEST

/* An overlap at rest is released into speed d sqrt(k/m), for Hertz sqrt((16/15) E* sqrt(R*)
 * d^(5/2)/m). */
START_TEST(test_release)
{
    struct model linear, hertz;
    model_open(&linear, CALX_CONTACT, "linear", &spheres, "stiffness=5000");
    model_open(&hertz, CALX_CONTACT, "hertz", &spheres, "young=1e7 poisson=0.25");
    double d0 = 1e-4, mass = 1e-3, modulus = 1e7 / (2 * (1 - 0.0625)), radius = 0.002;
    double expected[] = {d0 * sqrt(5000 / mass),
                         sqrt(16.0 / 15 * modulus * sqrt(radius) * pow(d0, 2.5) / mass)};
    const struct model *laws[] = {&linear, &hertz};
    for (int k = 0; k < 2; k++) {
        struct contact c;
        double dt = d0 / expected[k] / 1000, d = d0, speed = 0;
        contact_begin(&c, dt, 1 / mass, 250, 250);
        c.overlap[0] = d;
        contact_force(&c, laws[k], NULL);
        while (d > 0) {
            speed -= 0.5 * dt * c.fn[0] / mass;
            d += dt * speed;
            c.overlap[0] = d, c.vn[0] = -speed;
            contact_force(&c, laws[k], NULL);
            speed -= 0.5 * dt * c.fn[0] / mass;
        }
        /* the end of contact falls inside a step: error of second order, (1/1000)^2 */
        ck_assert_double_eq_tol(-speed / expected[k], 1, 1e-5);
    }
}
END_TEST

/* The damping rate and the drag of the thesis. */
START_TEST(test_other_dampings)
{
    struct model m;
    struct contact c;
    contact_begin(&c, 1e-5, 1 / 0.003, 500, 500);
    c.overlap[0] = 1e-5, c.vn[0] = 0.2, c.vt[0][0] = 0.5;
    model_open(&m, CALX_CONTACT, "linear", &spheres, "stiffness=1000 damping-rate=50");
    contact_force(&c, &m, NULL);
    ck_assert_double_eq_tol(c.fn[0], 0.01 - 50 * 0.003 * 0.2, 1e-15);
    ck_assert_double_eq(c.ft[0][0], 0);
    model_open(&m, CALX_CONTACT, "linear", &spheres, "stiffness=1000 drag=0.3");
    ck_assert_uint_eq(m.demand.needs, CALX_NEEDS_TANGENT | CALX_USES_VELOCITY);
    contact_force(&c, &m, NULL);
    ck_assert_double_eq_tol(c.fn[0], 0.01 - 0.3 * 0.2, 1e-15);
    ck_assert_double_eq_tol(c.ft[0][0], -0.3 * 0.5, 1e-15);
    model_open(&m, CALX_CONTACT, "linear", &spheres, "stiffness=1000 restitution=1");
    ck_assert_uint_eq(m.demand.history_scalars + m.demand.history_vectors + m.demand.needs, 0);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("laws");
    TCase *t = tcase_create("all");
    tcase_add_checked_fixture(t, set_up, tear_down);
    tcase_add_loop_test(t, test_refusals, 0, sizeof refusals / sizeof *refusals);
    tcase_add_loop_test(t, test_hertz_impacts, 0, sizeof hertzian / sizeof *hertzian);
    tcase_add_test(t, test_restitution);
    tcase_add_loop_test(t, test_clipped_table, 0, sizeof clipping / sizeof *clipping);
    tcase_add_test(t, test_clip_with_restitution);
    tcase_add_test(t, test_clip_never_attracts);
    tcase_add_test(t, test_release);
    tcase_add_test(t, test_other_dampings);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Normal and tangential laws together: a sphere hits a rigid plane at an angle. Against the table
 * of Chung and Ooi's test 4 (Granular Matter 13 (2011) 643), rigid-body results for sliding, and
 * energy: nothing gains, and what is lost is what the laws booked.
 */
#include <stdlib.h>

#include "tests/model.h"

/* A few operations on numbers up to 1. */
static const double ROUND_OFF = 1e-15;

/* ---- oblique impacts on a rigid plane ---- */

struct bounce {
    double vx, vy, spin, dissipated;
};

/* A sphere of radius r hits a plane with velocity (vx, -vy) and no spin; the patch moves with vx +
 * r spin. */
static struct bounce bounce(const struct model *normal, const struct model *tangential, double m,
                            double r, double vx, double vy, double dt)
{
    struct contact c;
    struct bounce s = {vx, -vy, 0, 0};
    double d = -0.37 * vy * dt, inertia = 0.4 * m * r * r;
    contact_begin(&c, dt, 1 / m, 1 / r, 0);
    do {
        double fx = c.ft[0][0], fy = c.fn[0];
        s.vx += 0.5 * dt * fx / m, s.vy += 0.5 * dt * fy / m, s.spin += 0.5 * dt * fx * r / inertia;
        d -= dt * s.vy;
        c.overlap[0] = d, c.vn[0] = s.vy, c.vt[0][0] = s.vx + r * s.spin;
        contact_force(&c, normal, tangential);
        fx = c.ft[0][0], fy = c.fn[0];
        s.vx += 0.5 * dt * fx / m, s.vy += 0.5 * dt * fy / m, s.spin += 0.5 * dt * fx * r / inertia;
    } while (d > 0 || s.vy < 0);
    s.dissipated = c.work[0];
    return s;
}

/* Chung and Ooi's test 4 for alumina and a rigid wall: 3.9 m/s at an angle from the normal; ratio
 * of tangential speeds, spin (rad/s), rebound angle of the contact patch (degrees). Force-increment
 * history. */
static const struct {
    double angle, ratio, spin, patch;
} oblique[] = {
    {5, 0.8904, 37.24, 3.151},    {10, 0.7134, 194.07, -0.031}, {15, 0.6275, 376.03, -4.749},
    {20, 0.6097, 520.62, -7.742}, {25, 0.6279, 613.33, -8.188}, {30, 0.6845, 615.26, -3.517},
    {35, 0.7398, 581.97, 3.656},  {40, 0.7829, 544.24, 11.620}, {50, 0.8471, 456.67, 29.487},
    {60, 0.8948, 355.23, 48.158}, {70, 0.9337, 242.99, 65.086}, {80, 0.9679, 123.37, 78.983},
    {85, 0.9841, 61.92, 84.812},
};

/* The table has four digits, the impact 2000 steps (1e-4 for e = 0.98). Spin and angle relative to
 * their full scale. */
static const double OBLIQUE_RATIO = 3e-4, OBLIQUE_SPIN = 3e-4 * 615, OBLIQUE_PATCH = 3e-4 * 90;

START_TEST(test_oblique_table)
{
    struct model normal, tangential;
    model_open(&normal, CALX_CONTACT, "hertz", &spheres,
               "young=3.8e11:1e20 poisson=0.23 restitution=0.98");
    model_open(&tangential, CALX_CONTACT, "mindlin", &spheres,
               "young=3.8e11:1e20 poisson=0.23 friction=0.092");
    double angle = oblique[_i].angle * M_PI / 180, vx = 3.9 * sin(angle), vy = 3.9 * cos(angle),
           r = 0.0025;
    double dt = 6.1e-6 * pow(cos(angle), -0.2) / 2000;
    struct bounce s = bounce(&normal, &tangential, sphere_mass(4000, r), r, vx, vy, dt);
    ck_assert_double_eq_tol(s.vx / vx, oblique[_i].ratio, OBLIQUE_RATIO);
    ck_assert_double_eq_tol(-s.spin, oblique[_i].spin, OBLIQUE_SPIN);
    ck_assert_double_eq_tol(atan2(s.vx + r * s.spin, s.vy) * 180 / M_PI, oblique[_i].patch,
                            OBLIQUE_PATCH);
}
END_TEST

/* Sliding throughout, tan > (7/2) mu (1 + e): the tangential impulse is mu times the normal one,
 * step by step, so the result is that of rigid bodies to round-off of a thousand steps; e has the
 * error of the step, 5.1e-6 at 320 steps. */
static const double SLIDING = 1e-12, ELASTIC = 1e-5;

START_TEST(test_gross_sliding)
{
    static const char *const names[][2] = {{"linear", "coulomb"}, {"hertz", "mindlin"}};
    static const char *const values[][2] = {
        {"stiffness=1e7", "stiffness=8e6 friction=0.2"},
        {"young=1e9:1e20 poisson=0.3", "young=1e9:1e20 poisson=0.3 friction=0.2"}};
    for (int k = 0; k < 2; k++)
        for (double theta = 60; theta < 86; theta += 5) {
            struct model normal, tangential;
            model_open(&normal, CALX_CONTACT, names[k][0], &spheres, values[k][0]);
            model_open(&tangential, CALX_CONTACT, names[k][1], &spheres, values[k][1]);
            double a = theta * M_PI / 180, r = 0.005, mass = sphere_mass(2500, r), v = 3;
            struct bounce s =
                bounce(&normal, &tangential, mass, r, v * sin(a), v * cos(a), k ? 4e-8 : 1e-7);
            double e = s.vy / (v * cos(a));
            ck_assert_double_eq_tol(e, 1, ELASTIC);
            ck_assert_double_eq_tol(s.vx / (v * sin(a)), 1 - 0.2 * (1 + e) / tan(a), SLIDING);
            ck_assert_double_eq_tol(-s.spin, 2.5 * 0.2 * (1 + e) * v * cos(a) / r, SLIDING * v / r);
        }
}
END_TEST

/* No impact gains energy: 1e-4 at 50 steps per contact, from the quadrature of velocity Verlet,
 * falling as n^-2. */
static double worst_gain(const char *const names[2], const char *const normal_values,
                         const char *const tangential_values, double dt)
{
    struct model normal, tangential;
    double worst = -1, r = 0.005, mass = sphere_mass(2500, r);
    model_open(&normal, CALX_CONTACT, names[0], &spheres, normal_values);
    model_open(&tangential, CALX_CONTACT, names[1], &spheres, tangential_values);
    for (double theta = 0.5; theta < 90; theta += 1) {
        double a = theta * M_PI / 180;
        struct bounce s = bounce(&normal, &tangential, mass, r, sin(a), cos(a), dt);
        worst = fmax(worst, s.vx * s.vx + s.vy * s.vy + 0.4 * r * r * s.spin * s.spin - 1);
    }
    return worst;
}

START_TEST(test_no_impact_gains_energy)
{
    static const char *const names[][2] = {{"linear", "coulomb"}, {"hertz", "mindlin"}};
    static const double friction[] = {0, 0.1, 0.5, 1, 5}, e[] = {0.1, 0.5, 1};
    double mass = sphere_mass(2500, 0.005), modulus = 1e7 / (1 - 0.09);
    double duration[] = {M_PI / sqrt(1e5 / mass),
                         2.868266 * pow(mass * mass / (0.005 * modulus * modulus), 0.2)};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 5; i++)
            for (int j = 0; j < 3; j++) {
                char normal[96], tangential[96];
                snprintf(normal, sizeof normal,
                         k ? "young=1e7:1e20 poisson=0.3 restitution=%g"
                           : "stiffness=1e5 restitution=%g",
                         e[j]);
                snprintf(tangential, sizeof tangential,
                         k ? "young=1e7:1e20 poisson=0.3 friction=%g" : "stiffness=8e4 friction=%g",
                         friction[i]);
                double coarse = worst_gain(names[k], normal, tangential, duration[k] / 50);
                double fine = worst_gain(names[k], normal, tangential, duration[k] / 200);
                ck_assert_double_le(coarse, 1e-4);
                ck_assert_double_le(fine, fmax(1e-4 / 16, 1e-9));
            }
}
END_TEST

/* The energy that a bounce loses is what the laws booked. At 400 steps per contact: (pi/400)^2/2 =
 * 3e-5 of the energy. */
START_TEST(test_bounce_books)
{
    struct model normal, tangential;
    double r = 0.005, mass = sphere_mass(2500, r);
    model_open(&normal, CALX_CONTACT, "linear", &spheres, "stiffness=1e5 restitution=0.7");
    static const char *const values[] = {"stiffness=8e4 friction=0.3",
                                         "stiffness=8e4 friction=0.3 damping=0.5",
                                         "stiffness=8e4 friction=0.3 damping=0.5 cap=1"};
    for (size_t k = 0; k < 3; k++)
        for (double theta = 5; theta < 90; theta += 10) {
            model_open(&tangential, CALX_CONTACT, "coulomb", &spheres, values[k]);
            double a = theta * M_PI / 180;
            struct bounce s = bounce(&normal, &tangential, mass, r, sin(a), cos(a),
                                     M_PI / sqrt(1e5 / mass) / 400);
            double lost =
                0.5 * mass * (1 - s.vx * s.vx - s.vy * s.vy - 0.4 * r * r * s.spin * s.spin);
            ck_assert_double_eq_tol(s.dissipated / (0.5 * mass), lost / (0.5 * mass), 3e-5);
        }
}
END_TEST

/* While it sticks the damper sees the whole velocity; when it slips, spring and damper share the
 * limit as one that moves with them; at rest only the spring is left. With the damper beside the
 * slider the spring alone is limited. */
START_TEST(test_damped_friction)
{
    static const struct {
        const char *values;
        double v, during, after; /* m/s; N, with k dt = 0.8 and c = 0.5 N s/m, mu fn = 0.2 N */
    } rows[] = {
        {"stiffness=8e4 friction=0.2 damping=0.5", 0.1, -0.13, -0.08},
        {"stiffness=8e4 friction=0.2 damping=0.5", 1, -0.2, -0.2 * 0.8 / 1.3},
        {"stiffness=8e4 friction=0.2 damping=0.5 cap=1", 0.1, -0.13, -0.08},
        {"stiffness=8e4 friction=0.2 damping=0.5 cap=1", 1, -0.7, -0.2},
        {"stiffness=8e4 friction=0.2 damping-rate=500", 0.1, -0.13, -0.08},
        {"stiffness=8e4 friction=0.2", 1, -0.2, -0.2},
    };
    struct model normal, tangential;
    struct contact c;
    model_open(&normal, CALX_CONTACT, "linear", &spheres, "stiffness=1e5");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        model_open(&tangential, CALX_CONTACT, "coulomb", &spheres, rows[k].values);
        contact_begin(&c, 1e-5, 1e3, 200, 300);
        c.overlap[0] = 1e-5, c.vt[0][0] = rows[k].v;
        contact_force(&c, &normal, &tangential);
        ck_assert_double_eq_tol(c.ft[0][0], rows[k].during, ROUND_OFF);
        c.vt[0][0] = 0;
        contact_force(&c, &normal, &tangential);
        ck_assert_double_eq_tol(c.ft[0][0], rows[k].after, ROUND_OFF);
    }
}
END_TEST

/* Force-increment history: at fixed displacement the tangential force stays while the overlap
 * changes. */
START_TEST(test_mindlin_keeps_force)
{
    struct model normal, tangential;
    struct contact c;
    model_open(&normal, CALX_CONTACT, "hertz", &spheres, "young=1e8 poisson=0.3");
    model_open(&tangential, CALX_CONTACT, "mindlin", &spheres,
               "young=1e8 poisson=0.3 friction=0.5");
    contact_begin(&c, 1e-6, 1e3, 200, 300);
    c.overlap[0] = 1e-5, c.vt[0][0] = 0.01;
    contact_force(&c, &normal, &tangential);
    double ft = c.ft[0][0], fn = c.fn[0];
    ck_assert_double_lt(ft, 0);
    ck_assert_double_lt(-ft, 0.25 * fn); /* far from the limit */
    c.vt[0][0] = 0;
    for (int k = 0; k < 10; k++) {
        c.overlap[0] = k % 2 ? 1e-5 : 0.8e-5;
        contact_force(&c, &normal, &tangential);
        ck_assert_double_eq(c.ft[0][0], ft);
    }
}
END_TEST

int main(void)
{
    Suite *s = suite_create("oblique");
    TCase *t = tcase_create("all");
    tcase_add_checked_fixture(t, set_up, tear_down);
    tcase_add_loop_test(t, test_oblique_table, 0, sizeof oblique / sizeof *oblique);
    tcase_add_test(t, test_gross_sliding);
    tcase_add_test(t, test_no_impact_gains_energy);
    tcase_add_test(t, test_bounce_books);
    tcase_add_test(t, test_damped_friction);
    tcase_add_test(t, test_mindlin_keeps_force);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The integrators that SUNDIALS makes possible, through the whole engine. arkode: collisions of a pair, of a grain and a wall, and of a pair
 * across a periodic border, all in one scene at different times, against the closed form of the restitution to 1e-11; and that the moments at which
 * contacts begin and end are found. cvode: the modes of a chain in one stiff step, a steady flux, and a stiff network of unlike bodies
 * against heat-exponential.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "tests/impacts.h"

/* ---- collisions ---- */

static const double RADIUS = 0.002, SPEED = 0.5, STIFFNESS = 1e4;
static const struct material GRAIN = {5e7, 0.25, 2500};

static const struct {
    const char *law;
    double e;
} laws[] = {{"linear", 1.0}, {"linear", 0.5}, {"hertz", 1.0}, {"hertz", 0.5}};

static double duration_of(const char *law, double mass, double radius)
{
    double young[2] = {GRAIN.young, GRAIN.young}, poisson[2] = {GRAIN.poisson, GRAIN.poisson};
    return strcmp(law, "linear") == 0 ? M_PI * sqrt(mass / STIFFNESS)
                                      : hertz_duration(calx_effective_modulus(young, poisson), mass, radius, SPEED);
}

/* Grain 0 falls on a wall; 1 meets 2, at rest; 3 meets 4, at rest beyond the periodic border along x: each a little later than the one before. */
static struct calx_scene *collisions(const char *law, double e, double steps, double *end)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 5);
    const double gap = 0.05e-3, wide = 0.04, mass = 4.0 / 3.0 * M_PI * pow(RADIUS, 3.0) * GRAIN.density;
    set_material(s, 0, &GRAIN);
    const struct given linear[] = {{"stiffness", STIFFNESS}, {e < 1 ? "restitution" : NULL, e}, {NULL, 0}};
    const struct given hertz[] = {{e < 1 ? "restitution" : NULL, e}, {NULL, 0}};
    scene_model(s, CALX_CONTACT, law, strcmp(law, "linear") ? hertz : linear);
    scene_model1(s, CALX_MOTION, "arkode", "tolerance", 1e-17);
    double longest = duration_of(law, mass, RADIUS), shortest = duration_of(law, 0.5 * mass, 0.5 * RADIUS);
    s->models[0].dt = shortest / steps;
    *end = 2.2 * longest + 3 * gap / SPEED;
    scene_extent(s, 0, 0.0, wide, 'p');
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    scene_put(s, 0, 0.01, RADIUS + gap, 0, RADIUS);
    scene_move(s, 0, 0, -SPEED, 0);
    scene_put(s, 1, 0.02, 0.02, 0, RADIUS);
    scene_move(s, 1, 0, 0, SPEED);
    scene_put(s, 2, 0.02, 0.02, 2 * RADIUS + 1.37 * gap, RADIUS);
    scene_put(s, 3, wide - 0.7 * RADIUS, 0.01, 0.01, RADIUS);
    scene_move(s, 3, SPEED, 0, 0);
    scene_put(s, 4, 1.3 * RADIUS + 2.1 * gap, 0.01, 0.01, RADIUS);
    return s;
}

static const double EXACT = 1e-11;

START_TEST(collisions_come_out_exactly)
{
    double end;
    struct calx_scene *s = collisions(laws[_i].law, laws[_i].e, 20, &end);
    struct run r = run_start(s, 1);
    size_t steps = (size_t)(end / s->models[0].dt);
    double rises = 0, most = 0;
    for (size_t k = 0; k < steps; k++) {
        run_steps(&r, 1);
        double contacts = (double)calx_sim_contact_count(r.sim);
        rises += contacts > most;
        most = fmax(most, contacts);
    }
    const double e = laws[_i].e, parted[] = {run_v(&r, 0)[1], run_v(&r, 2)[2] - run_v(&r, 1)[2], run_v(&r, 4)[0] - run_v(&r, 3)[0]};
    ck_assert_double_ge(rises, 1);
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    for (int k = 0; k < 3; k++)
        ck_assert_msg(fabs(parted[k] / (e * SPEED) - 1) < EXACT, "%s, e = %g, impact %d: off by %g", laws[_i].law, e, k,
                      parted[k] / (e * SPEED) - 1);
    ck_assert_double_eq_tol(run_v(&r, 1)[2] + run_v(&r, 2)[2], SPEED, EXACT * SPEED);
    run_free(&r);
}
END_TEST

/* An evaluation that is kept stands at each of the six moments. With a jump of the force, the depth at the first that sees a contact is that
 * of the moment itself: 1e-12 of the deepest, v/w, where a step of 1/20 of a contact has a sixth of it on average. */
START_TEST(moments_are_found)
{
    double end, first = 1;
    struct calx_scene *s = collisions("linear", 0.5, 20, &end);
    struct run r = run_start(s, 1);
    int64_t before = calx_sim_evaluation_count(r.sim), free_flight = 0;
    for (size_t k = 0; k < 8; k++) { /* less than the first gap, 0.1 ms */
        run_steps(&r, 1);
        free_flight = calx_sim_evaluation_count(r.sim) - before;
        before = calx_sim_evaluation_count(r.sim);
    }
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    while (calx_sim_contact_count(r.sim) == 0 && calx_sim_time(r.sim) < end) {
        before = calx_sim_evaluation_count(r.sim);
        run_steps(&r, 1);
    }
    first = (double)(calx_sim_evaluation_count(r.sim) - before);
    ck_assert_double_gt(first, 3.0 * (double)free_flight); /* it was looked for */
    double mass = run_mass(&r, 0), w = sqrt(STIFFNESS / mass), gone = calx_sim_time(r.sim) - 0.05e-3 / SPEED;
    double b = log(2) / hypot(M_PI, log(2)), fade = b * w, turn = w * sqrt(1 - b * b);
    double depth = SPEED / turn * exp(-fade * gone) * sin(turn * gone);
    ck_assert_double_eq_tol(RADIUS - run_x(&r, 0)[1], depth, EXACT * SPEED / w);
    run_free(&r);
}
END_TEST

/* ---- heat ---- */

static const double H = 2.0, BALL = 0.05, LAP = 1e-3; /* W/K, m, m */
enum { CHAIN = 15 };

/* A line of grains between two walls of 300 K, one heat step being x/4 of the decay time C/H of a grain; unlike: every second grain holds a
 * thousandth of the heat. */
static struct calx_scene *chain(const char *integrator, double x, bool unlike)
{
    struct calx_scene *s = scene_create(2, CALX_SPHERES, CHAIN);
    const double pitch = 2.0 * BALL - LAP;
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
    scene_model1(s, CALX_TEMPERATURE, integrator, NULL, 0.0);
    s->models[0].frozen = true;
    s->models[0].heat_dt = x * calx_particle_mass(s, BALL, 1000.0) * 1000.0 / (4.0 * H);
    int light = scene_material(s, "light", 1.0, 1000.0);
    for (size_t i = 0; i < CHAIN; i++) {
        scene_put(s, i, pitch * (double)i, 0.0, 0.0, BALL);
        s->particles.material[i] = unlike && i % 2 ? light : 0;
    }
    for (int side = 0; side < 2; side++) {
        int w = scene_wall(s, side ? "right" : "left", 0);
        double at = side ? pitch * (CHAIN - 1) + BALL - LAP : -BALL + LAP;
        scene_segment(s, w, at, -1.0, at, 1.0, 0);
        scene_wall_temperature(s, w, 300.0);
    }
    return s;
}

/* Some 400 sub-steps of a tolerance of 1e-15 of the range each, 50 K, errors of which add up where modes are slow; and rounding of 350 K. */
static const double STIFF = 1e-10;

START_TEST(modes_in_a_stiff_step)
{
    for (int j = 1; j < CHAIN; j += 3) {
        const double x = 40, n = CHAIN + 1, left = exp(-x * pow(sin(j * M_PI / (2.0 * n)), 2));
        struct calx_scene *s = chain("cvode", x, false);
        for (int i = 0; i < CHAIN; i++)
            scene_warm(s, (size_t)i, 300.0 + 50.0 * sin(j * M_PI * (i + 1) / n));
        struct run r = run_start(s, 1);
        run_steps(&r, 1);
        for (int i = 0; i < CHAIN; i++)
            ck_assert_double_eq_tol(run_v(&r, i)[7], 300.0 + 50.0 * left * sin(j * M_PI * (i + 1) / n), STIFF * 350);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_le(fabs(l.heat_residual), 1e-13 * l.heat_scale);
        run_free(&r);
    }
}
END_TEST

START_TEST(unlike_bodies_as_the_exponential)
{
    static const char *const names[] = {"cvode", "heat-exponential"};
    double t[2][CHAIN], given[2];
    for (int k = 0; k < 2; k++) {
        struct calx_scene *s = chain(names[k], 20, true);
        scene_wall_temperature(s, 0, 500.0);
        for (size_t i = 0; i < CHAIN; i++)
            scene_warm(s, i, 300.0 + 40.0 * cos(2.0 * (double)i));
        struct run r = run_start(s, 1);
        run_steps(&r, 3);
        for (int i = 0; i < CHAIN; i++)
            t[k][i] = run_v(&r, i)[7];
        struct calx_ledger l = calx_sim_ledger(r.sim);
        given[k] = l.wall_heat;
        ck_assert_double_le(fabs(l.heat_residual), 1e-13 * l.heat_scale);
        run_free(&r);
    }
    for (int i = 0; i < CHAIN; i++)
        ck_assert_double_eq_tol(t[0][i], t[1][i], STIFF * 500);
    ck_assert_double_eq_tol(given[0] / given[1], 1, 1e-9);
}
END_TEST

START_TEST(steady_flux)
{
    struct calx_scene *s = chain("cvode", 1e5, false);
    scene_wall_temperature(s, 0, 500.0);
    struct run r = run_start(s, 1);
    run_steps(&r, 3);
    for (int i = 0; i < CHAIN; i++)
        ck_assert_double_eq_tol(run_v(&r, i)[7], 500.0 - 200.0 * (i + 1) / (CHAIN + 1), STIFF * 500);
    run_free(&r);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sundials");
    TCase *t = tcase_create("all");
    tcase_add_loop_test(t, collisions_come_out_exactly, 0, sizeof laws / sizeof *laws);
    tcase_add_test(t, moments_are_found);
    tcase_add_test(t, modes_in_a_stiff_step);
    tcase_add_test(t, unlike_bodies_as_the_exponential);
    tcase_add_test(t, steady_flux);
    suite_add_tcase(suite, t);
    SRunner *r = srunner_create(suite);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

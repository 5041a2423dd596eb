/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What integrators of motion keep per body, and what their trial evaluations must not touch: a
 * crowd with friction, damping, heat of dissipation, a shaking floor and a periodic axis gives the
 * same bits on any number of threads and with a stop in between; a body may be re-sorted or cross a
 * periodic border; the ledger closes; a trial leaves no history behind.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const struct given NONE[] = {{NULL, 0.0}}, GEAR3[] = {{"order", 0.0}, {NULL, 0.0}};

/* closes: the residual of the ledger, relative to the energy that took part, at n = 50 steps per
 * contact: (pi/n)^2/2 = 2e-3 where laws see the velocity of the middle of the step. Where they see
 * that of its end, they book dissipation with it, half a step's change of velocity off: pi/(2 n) =
 * 0.03, more for several contacts of a grain. Of those of first order and adams-bashforth-2 the
 * energy itself is not better than that. */
static const struct {
    const char *name;
    const struct given *given;
    double closes;
} integrators[] = {
    {"velocity-verlet", NONE, 2e-3},
    {"verlet", NONE, 2e-3},
    {"leapfrog", NONE, 2e-3},
    {"symplectic-euler", NONE, 0.1},
    {"euler", NONE, INFINITY},
    {"adams-bashforth-2", NONE, 0.1},
    {"gear", NONE, 0.05},
    {"gear", GEAR3, 0.05},
    {"rk4", NONE, 0.05},
    {"yoshida", NONE, 0.05},
    {"newmark", NONE, 0.05},
    {"cash-karp", NONE, 0.05},
};
enum { COUNT = sizeof integrators / sizeof *integrators };

enum { EDGE = 13, GRAINS = EDGE * EDGE * EDGE, STEPS = 90 };
static const double RADIUS = 1e-3, SPACING = 2.05e-3;

static void add_grains(struct calx_scene *s)
{
    struct calx_random random;
    calx_random_seed(&random, 7);
    for (size_t i = 0; i < GRAINS; i++) {
        size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double x[3], v[3];
        for (int k = 0; k < 3; k++) {
            x[k] = SPACING * ((double)at[k] + 0.5) + 2e-5 * (calx_random_uniform(&random) - 0.5);
            v[k] = 2.0 * calx_random_uniform(&random) - 1.0;
        }
        scene_put(s, i, x[0], x[1], x[2], RADIUS * (1.0 - 0.1 * calx_random_uniform(&random)));
        scene_move(s, i, v[0], v[1], v[2]);
        scene_spin(s, i, 100.0 * v[1], 100.0 * v[2], 100.0 * v[0]);
        scene_warm(s, i, 300.0 + 10.0 * calx_random_uniform(&random));
    }
}

/* dt: 50 steps per contact; of Euler half that, below its limit. */
static struct calx_scene *crowd(int k)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, GRAINS);
    double size = SPACING * EDGE, mass = 4.0 / 3.0 * M_PI * pow(RADIUS, 3.0) * 1000.0;
    double duration = M_PI * sqrt(0.5 * mass / 2e3);
    scene_material_value(s, 0, "conductivity", 50.0);
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", 2e3}, {"restitution", 0.8}, {NULL, 0.0}});
    scene_model(s, CALX_CONTACT, "coulomb",
                (struct given[]){{"stiffness", 6e2}, {"friction", 0.4}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrators[k].name, integrators[k].given);
    scene_model(s, CALX_CONDUCTANCE, "overlap", NULL);
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    s->models[0].dt = duration / 50.0 * (strcmp(integrators[k].name, "euler") ? 1.0 : 0.5);
    s->models[0].heat_dt = 2.0 * s->models[0].dt;
    s->from_dissipation = 1.0;
    s->skin = 6e-5;
    scene_gravity(s, 0.0, -9.81, 0.0);
    add_grains(s);
    scene_extent(s, 0, 0.0, size, 'p');
    int floor_ = scene_wall(s, "floor", 0), box = scene_wall(s, "box", 0);
    scene_plane(s, floor_, (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    scene_plane(s, box, (double[3]){size, size, size}, (double[3]){0, -1, 0});
    scene_plane(s, box, (double[3]){0, 0, 0}, (double[3]){0, 0, 1});
    scene_plane(s, box, (double[3]){size, size, size}, (double[3]){0, 0, -1});
    struct calx_motion *m = scene_motion(s, 0, floor_);
    m->amplitude[1] = 1e-4;
    m->frequency = 500.0;
    return s;
}

struct said {
    uint64_t hash;
    struct calx_ledger ledger;
};

static struct said say(const struct run *r)
{
    struct said s;
    memset(&s, 0, sizeof s);
    s.hash = calx_sim_hash(r->sim);
    s.ledger = calx_sim_ledger(r->sim);
    s.ledger.scale = s.ledger.heat_scale = 0.0; /* the largest among the times of asking */
    return s;
}

static void same(const struct said *a, const struct said *b, const char *name, const char *what)
{
    ck_assert_msg(a->hash == b->hash, "%s, %s: another state", name, what);
    ck_assert_msg(!memcmp(&a->ledger, &b->ledger, sizeof a->ledger), "%s, %s: another ledger", name,
                  what);
}

static struct said straight(int k, int threads)
{
    struct run r = run_start(crowd(k), threads);
    run_steps(&r, STEPS);
    ck_assert_int_ge(r.sim->rebuilds, 3);
    ck_assert_uint_ge(r.sim->block_count, 2);
    ck_assert_uint_gt(calx_sim_contact_count(r.sim), GRAINS / 10);
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_msg(fabs(l.residual) < integrators[k].closes * l.scale, "%s: residual %g of %g J",
                  integrators[k].name, l.residual, l.scale);
    ck_assert_double_lt(fabs(l.heat_residual), 1e-12 * l.heat);
    ck_assert_double_gt(l.heat_of_dissipation, 0.0);
    struct said out = say(&r);
    run_free(&r);
    return out;
}

/* Runs `before` steps, hands the state to a new simulation, and goes on to STEPS there. */
static struct said resumed(int k, size_t before)
{
    struct calx_error e = {0};
    struct calx_block *blocks;
    size_t count;
    struct run first = run_start(crowd(k), 1), second = run_start(crowd(k), 1);
    run_steps(&first, before);
    run_steps(&second, 3); /* what it did before must not matter */
    ck_assert_msg(calx_sim_save(first.sim, &blocks, &count, &e) == 0, "%s", e.text);
    ck_assert_msg(calx_sim_restore(second.sim, blocks, count, &e) == 0, "%s", e.text);
    free(blocks);
    run_free(&first);
    run_steps(&second, STEPS - before);
    struct said out = say(&second);
    run_free(&second);
    return out;
}

START_TEST(threads_and_stops_change_nothing)
{
    struct said one = straight(_i, 1), two = straight(_i, 2), odd = resumed(_i, 41);
    same(&one, &two, integrators[_i].name, "2 threads");
    same(&one, &odd, integrators[_i].name, "resumed");
}
END_TEST

/* ---- periodic borders, and new orders of rows ---- */

enum { ROW = 24, JOSTLE = 400 };

/* Discs in a plane box, periodic along x, that jostle; `x0`: where they are, `skin`: how often
 * lists and rows are made anew. */
static struct run jostle(int k, double x0, double skin)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, ROW);
    struct calx_random random;
    calx_random_seed(&random, 11);
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", 1e7}, {"restitution", 0.9}, {NULL, 0.0}});
    scene_model(s, CALX_CONTACT, "coulomb",
                (struct given[]){{"stiffness", 3e6}, {"friction", 0.3}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrators[k].name, integrators[k].given);
    double mass = M_PI * 1000.0;
    s->models[0].dt = M_PI * sqrt(0.5 * mass / 1e7) / 60.0;
    s->skin = skin;
    scene_extent(s, 0, 0.0, 12.5, 'p');
    for (size_t i = 0; i < ROW; i++) {
        double x = 2.08 * (double)(i % 6) + x0, y = 2.03 * (double)(i / 6);
        scene_put(s, i, x - 12.5 * floor(x / 12.5), y, 0.0, 1.0);
        scene_move(s, i, 6.0 * calx_random_uniform(&random) - 3.0 + 14.0,
                   4.0 * (3.0 - (double)(i / 6)) / 3.0 * calx_random_uniform(&random), 0.0);
        scene_spin(s, i, 0.0, 0.0, 3.0 * calx_random_uniform(&random));
    }
    return run_start(s, 1);
}

/* Collisions magnify what rounding leaves of positions of 12 and velocities of 17, 1e-14 over the first collisions, by less than 1e4 in
 * this time; a contact that lost its history at the border is off in the third digit. */
static const double TRAJECTORY = 1e-10;

static void compare(const struct run *a, const struct run *b, double shift, const char *what)
{
    double worst = 0.0;
    for (int64_t i = 0; i < ROW; i++) {
        double dx = run_x(b, i)[0] - run_x(a, i)[0] - shift;
        dx -= 12.5 * round(dx / 12.5);
        worst = fmax(worst, fabs(dx));
        worst = fmax(worst, fabs(run_x(b, i)[1] - run_x(a, i)[1]));
        for (int q = 0; q < 7; q += q == 1 ? 5 : 1)
            worst = fmax(worst, fabs(run_v(b, i)[q] - run_v(a, i)[q]));
    }
    ck_assert_msg(worst < TRAJECTORY, "%s: off by %g", what, worst);
}

START_TEST(borders_and_orders_do_not_matter)
{
    struct run here = jostle(_i, 0.3, 0.3), there = jostle(_i, 5.9, 0.3),
               often = jostle(_i, 0.3, 0.01);
    run_steps(&here, JOSTLE);
    run_steps(&there, JOSTLE);
    run_steps(&often, JOSTLE);
    size_t crossed = 0;
    for (int32_t row = 0; row < ROW; row++)
        crossed += here.sim->r.image[row][0] != 0;
    ck_assert_uint_gt(crossed, 3);
    ck_assert_int_gt(often.sim->rebuilds, 5 * here.sim->rebuilds);
    compare(&here, &there, 5.6, integrators[_i].name);
    compare(&here, &often, 0.0, integrators[_i].name);
    run_free(&here);
    run_free(&there);
    run_free(&often);
}
END_TEST

/* ---- history ---- */

/* A grain pressed on a floor slides by less than it takes to slip: the spring is what it went times
 * the stiffness, to the share of a step that its velocity lags or leads; a trial that left its
 * history behind would stretch it two or three times. */
START_TEST(trials_leave_no_history)
{
    const double stiffness = 1e5, speed = 1e-3;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    double mass = 4.0 / 3.0 * M_PI * 1000.0, dt = 0.02 * sqrt(mass / stiffness);
    scene_model1(s, CALX_CONTACT, "linear", "stiffness", stiffness);
    scene_model(s, CALX_CONTACT, "coulomb",
                (struct given[]){{"stiffness", stiffness}, {"friction", 10.0}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrators[_i].name, integrators[_i].given);
    s->models[0].dt = dt;
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    scene_put(s, 0, 0.0, 0.999, 0.0, 1.0);
    scene_move(s, 0, speed, 0.0, 0.0);
    struct run r = run_start(s, 1);
    double went = 0.0; /* of the point in touch: the spin takes part */
    for (int k = 0; k < 10; k++) {
        double before = run_v(&r, 0)[0] + 0.9995 * run_v(&r, 0)[6];
        run_steps(&r, 1);
        went += 0.5 * dt * (before + run_v(&r, 0)[0] + 0.9995 * run_v(&r, 0)[6]);
    }
    double spring = -r.sim->wall_history[0];
    ck_assert_msg(fabs(spring / (stiffness * went) - 1.0) < 0.15, "%s: %g N for %g m",
                  integrators[_i].name, spring, went);
    run_free(&r);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("state of integrators");
    TCase *tcase = tcase_create("all");
    tcase_add_loop_test(tcase, threads_and_stops_change_nothing, 0, COUNT);
    tcase_add_loop_test(tcase, borders_and_orders_do_not_matter, 0, COUNT);
    tcase_add_loop_test(tcase, trials_leave_no_history, 0, COUNT);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The automatic step follows the contacts: a bed of Hertzian grains is pressed by a lid far beyond
 * what its start lets expect, and let go again. The step falls and comes back, each contact stays
 * resolved, energy closes, stages end exactly; the bits are the same for any number of threads,
 * with a stop and restart, for many steps at once and for who looks.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/stability.h"
#include "tests/scenes.h"

enum { EDGE = 11, GRAINS = EDGE * EDGE * EDGE };
static const double RADIUS = 1e-3, SPACING = 2.001e-3, SPEED = 2.0, PRESS = 1.5e-3, FRACTION = 0.1;

/* Grains on a lattice in a box, periodic along x and z; nearly at rest. */
static struct calx_scene *press(const char *motion, const char *heat)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, GRAINS);
    struct calx_random random;
    calx_random_seed(&random, 9);
    scene_material_value(s, 0, "young", 1e7);
    scene_material_value(s, 0, "poisson", 0.3);
    scene_model1(s, CALX_CONTACT, "hertz", "restitution", 0.5);
    scene_model1(s, CALX_CONTACT, "mindlin", "friction", 0.3);
    scene_model(s, CALX_MOTION, motion, NULL);
    if (heat) {
        scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 1e-3);
        scene_model(s, CALX_TEMPERATURE, heat, NULL);
        s->models[0].heat_dt = 1e-4;
        s->from_dissipation = 1.0;
    }
    s->models[0].dt_fraction = FRACTION;
    for (size_t i = 0; i < GRAINS; i++) {
        double u[3];
        for (int k = 0; k < 3; k++)
            u[k] = calx_random_uniform(&random) - 0.5;
        scene_put(s, i, SPACING * ((double)(i % EDGE) + 0.5),
                  SPACING * ((double)(i / EDGE % EDGE) + 0.5),
                  SPACING * ((double)(i / EDGE / EDGE) + 0.5), RADIUS);
        scene_move(s, i, 0.02 * u[0], 0.02 * u[1], 0.02 * u[2]);
    }
    double size = SPACING * EDGE;
    scene_extent(s, 0, 0.0, size, 'p');
    scene_extent(s, 2, 0.0, size, 'p');
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    int lid = scene_wall(s, "lid", 0);
    scene_plane(s, lid, (double[3]){0, size, 0}, (double[3]){0, -1, 0});
    s->stages[0].duration = PRESS;
    scene_motion(s, 0, lid)->velocity[1].value = -SPEED;
    size_t second = scene_stage(s);
    scene_motion(s, second, lid)->velocity[1].value = SPEED;
    s->stages[second].duration = 10.0 * PRESS;
    return s;
}

/* Half a period of the stiffest contact over the step. */
static double resolution(struct calx_sim *s)
{
    struct calx_stability now;
    ck_assert_int_eq(calx_stability_look(s, CALX_BOUND, &now, NULL), 0);
    ck_assert_msg(calx_sim_dt(s) < 0.75 * now.limit, "step %lld: dt %g s of a limit of %g s",
                  (long long)calx_sim_step_count(s), calx_sim_dt(s), now.limit);
    return now.shortest / calx_sim_dt(s);
}

START_TEST(the_step_follows_the_contacts)
{
    struct run r = run_start(press("velocity-verlet", NULL), 1);
    double longest = r.sim->plans[0].dt, shortest = longest, worst = INFINITY, pressed = NAN;
    ck_assert_double_eq(calx_sim_dt(r.sim), longest);
    int changes = 0;
    while (!calx_sim_done(r.sim)) {
        double before = calx_sim_dt(r.sim);
        run_steps(&r, 1);
        changes += calx_sim_dt(r.sim) != before;
        shortest = fmin(shortest, calx_sim_dt(r.sim));
        if (calx_sim_step_count(r.sim) % 16 == 0)
            worst = fmin(worst, resolution(r.sim));
        if (calx_sim_stage_began(r.sim) && isnan(pressed))
            pressed = calx_sim_time(r.sim);
    }
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_msg(shortest < 0.55 * longest, "%g s of %g s", shortest, longest);
    ck_assert_int_ge(changes, 4);
    ck_assert_double_eq(calx_sim_dt(r.sim), longest); /* nothing presses any more */
    /* the plan asks for pi/(2 * 0.1) = 15.7; overlaps may grow by half before a new choice,
     * stiffness by their root, omega by the fourth root, and for two more steps */
    ck_assert_msg(worst > 15.7 / pow(1.5, 0.25) * 0.9, "a contact has %g steps", worst);
    ck_assert_msg(fabs(pressed - PRESS) < 1e-12 * PRESS, "the first stage ends at %.17g s",
                  pressed); /* the step divides what is left */
    ck_assert_msg(fabs(calx_sim_time(r.sim) - 11.0 * PRESS) <= 0.5 * longest, "%g s",
                  calx_sim_time(r.sim));
    ck_assert_double_gt(l.dissipated, 0.1 * l.scale);
    /* (pi/15.7)^2/2 = 0.02 of the energy in contact, and half a step of the lid's force where it
     * turns */
    ck_assert_msg(fabs(l.residual) < 0.03 * l.scale, "residual %g of %g J", l.residual, l.scale);
    run_free(&r);
}
END_TEST

/* An integrator that declares it keeps the step of the start, and the run lives. */
START_TEST(a_constant_step_stays)
{
    struct calx_scene *s = press("constant-step", NULL);
    s->stages[0].duration = 0.3 * PRESS;
    s->models[0].dt_fraction = 0.02; /* enough for the pressed bed */
    struct run r = run_start(s, 1);
    double dt = calx_sim_dt(r.sim);
    while (calx_sim_stage(r.sim) == 0)
        run_steps(&r, 1);
    run_steps(&r, 10);
    ck_assert_double_eq(calx_sim_dt(r.sim), dt);
    run_free(&r);
}
END_TEST

/* ---- the same bits ---- */

struct said {
    uint64_t hash;
    int64_t step;
    double time, dt, residual, heat;
};

static struct said say(struct calx_sim *s)
{
    struct calx_ledger l = calx_sim_ledger(s);
    return (struct said){calx_sim_hash(s), calx_sim_step_count(s),
                         calx_sim_time(s), calx_sim_dt(s),
                         l.residual,       l.heat};
}

static void same(const struct said *a, const struct said *b, const char *what)
{
    ck_assert_msg(!memcmp(a, b, sizeof *a),
                  "%s: step %lld at %.17g s with %.17g s, instead of %lld at %.17g s with %.17g s",
                  what, (long long)b->step, b->time, b->dt, (long long)a->step, a->time, a->dt);
}

enum { STEPS = 700 };

static struct said straight(const char *heat, int threads, int *changes)
{
    struct run r = run_start(press("velocity-verlet", heat), threads);
    for (int k = 0; k < STEPS; k++) {
        double before = calx_sim_dt(r.sim);
        run_steps(&r, 1);
        *changes += calx_sim_dt(r.sim) != before;
    }
    struct said out = say(r.sim);
    run_free(&r);
    return out;
}

static struct said advanced(const char *heat, int threads)
{
    static const int64_t bites[] = {64, 1, 3, 40, 17, 64};
    struct run r = run_start(press("velocity-verlet", heat), threads);
    struct calx_error e = {0};
    for (size_t k = 0; calx_sim_step_count(r.sim) < STEPS; k++) {
        int64_t made = 0, left = STEPS - calx_sim_step_count(r.sim),
                bite = bites[k % 6] < left ? bites[k % 6] : left;
        ck_assert_msg(calx_sim_advance(r.sim, bite, &made, &e) == 0, "%s", e.text);
        if (!made)
            run_steps(&r, 1);
        ck_assert_int_eq(calx_sim_guard(r.sim, &e), 0); /* looking changes nothing */
        calx_sim_step_share(r.sim, NULL);
    }
    struct said out = say(r.sim);
    run_free(&r);
    return out;
}

static struct said resumed(const char *heat, size_t at)
{
    struct calx_error e = {0};
    struct calx_block *blocks;
    size_t count;
    struct run first = run_start(press("velocity-verlet", heat), 1), second = run_again(&first, 2);
    run_steps(&first, at);
    run_steps(&second, at % 11);
    ck_assert_int_eq(calx_sim_save(first.sim, &blocks, &count, &e), 0);
    ck_assert_msg(calx_sim_restore(second.sim, blocks, count, &e) == 0, "%s", e.text);
    free(blocks);
    run_steps(&second, STEPS - at);
    struct said out = say(second.sim);
    run_free(&second);
    run_free(&first);
    return out;
}

START_TEST(the_bits_are_the_same)
{
    static const char *const heat[] = {NULL, "heat-euler", "heat-theta"};
    for (size_t k = 0; k < 3; k++) {
        int changes = 0;
        struct said one = straight(heat[k], 1, &changes), other = straight(heat[k], 2, &changes);
        ck_assert_int_ge(changes, 6); /* of both */
        same(&one, &other, "two threads");
        for (int threads = 1; threads <= 2; threads++) {
            other = advanced(heat[k], threads);
            same(&one, &other, "many steps at once");
        }
        for (size_t at = 97; at < STEPS; at += 200) {
            other = resumed(heat[k], at);
            same(&one, &other, "resumed");
        }
    }
}
END_TEST

/* A fixed step that the case changes between a stop and a resume holds from there on; time goes on.
 */
START_TEST(a_resumed_run_may_have_another_step)
{
    static const double steps[] = {1e-6, 2.5e-7};
    struct calx_error e = {0};
    struct calx_block *blocks;
    size_t count;
    struct run r[2];
    for (int k = 0; k < 2; k++) {
        struct calx_scene *s = press("velocity-verlet", NULL);
        s->models[0].dt = steps[k];
        r[k] = run_start(s, 1);
    }
    run_steps(&r[0], 40);
    ck_assert_int_eq(calx_sim_save(r[0].sim, &blocks, &count, &e), 0);
    ck_assert_msg(calx_sim_restore(r[1].sim, blocks, count, &e) == 0, "%s", e.text);
    free(blocks);
    run_steps(&r[1], 4);
    ck_assert_double_eq_tol(calx_sim_time(r[1].sim), 41e-6, 1e-18);
    ck_assert_double_eq(calx_sim_dt(r[1].sim), steps[1]);
    run_free(&r[0]);
    run_free(&r[1]);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {the_step_follows_the_contacts, a_constant_step_stays,
                            the_bits_are_the_same, a_resumed_run_may_have_another_step};
    return run_tests("pace", sizeof tests / sizeof *tests, tests);
}

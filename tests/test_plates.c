/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Loaded plates, as walls and as rigid groups: free fall, the oscillation of a plate on springs with its second order, equilibrium under a
 * load, damping, the ledger, stages that let go and hold, floors that bear load and weights, the longest stable step, equal bits. And plates among
 * rigid bodies, where they are bodies of the contact problem.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double K = 1e4, MASS = 2.0, G = 10.0;

static struct calx_motion *release(struct calx_scene *s, int wall, int axis, double mass, double load)
{
    struct calx_motion *m = scene_motion(s, s->stage_count - 1, wall);
    m->free = true;
    m->free_axis = axis;
    m->mass = mass;
    m->load.value = load;
    return m;
}

/* A plate above a grain that is fixed at the origin (radius 1, its top at z = 1): as a wall its face is at `face`, as a group a grain of
 * radius 1 centred at face + 1. Contact stiffness K; a grain far away keeps the scene from being empty of free bodies. */
static struct calx_scene *plate_on_spring(bool group, const char *integrator, double face, double dt, int *plate)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 3);
    scene_linear_by(s, integrator, K, NAN, -1.0, dt);
    scene_fix(s, 0);
    scene_put(s, 1, 0.0, 0.0, -40.0, 1.0);
    scene_put(s, 2, 0.0, 0.0, group ? face + 1.0 : -20.0, 1.0);
    *plate = group ? scene_group(s, "plate") : scene_wall(s, "plate", 0);
    if (group)
        scene_carry(s, 2, *plate);
    else
        scene_plane(s, *plate, (double[3]){0, 0, face}, (double[3]){0, 0, -1});
    return s;
}

/* ---- motion ---- */

START_TEST(a_plate_falls)
{
    for (int group = 0; group < 2; group++) {
        int plate;
        struct calx_scene *s = plate_on_spring(group, "velocity-verlet", 30.0, 1e-3, &plate);
        scene_gravity(s, 0.0, 0.0, -G);
        release(s, plate, 2, MASS, 3.0)->velocity[0].value = 0.5;
        struct run r = run_start(s, 1);
        run_steps(&r, 1000);
        double a = 3.0 / MASS - G;
        const struct calx_frame *f = calx_measure_frame(r.sim);
        ck_assert_double_eq_tol(f->displacement_of_wall[plate][2], 0.5 * a, 1e-11);
        ck_assert_double_eq_tol(f->velocity_of_wall[plate][2], a, 1e-11);
        ck_assert_double_eq_tol(f->displacement_of_wall[plate][0], 0.5, 1e-11);
        if (group) {
            ck_assert_double_eq_tol(f->position[2][2], 31.0 + 0.5 * a, 1e-11);
            ck_assert_double_eq_tol(f->velocity[2][2], a, 1e-11);
        }
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_eq_tol(l.gravity_work, 3.0 * 0.5 * a, 1e-10); /* of the load */
        ck_assert_double_lt(fabs(l.residual), 1e-12 * l.scale);
        run_free(&r);
    }
}
END_TEST

/* Pressed at rest with its face DEEP below the top of the grain and let go at equilibrium plus DEEP under a load: an oscillator of omega =
 * sqrt(K/MASS) about the depth of equilibrium. Its place after a time, against the cosine, relative to the amplitude. */
static double oscillator_error(bool group, const char *integrator, double steps_per_period, int *count)
{
    double omega = sqrt(K / MASS), period = 2.0 * M_PI / omega, load = -50.0, rest = -load / K, amplitude = 0.5 * rest;
    int plate;
    double dt = period / steps_per_period;
    struct calx_scene *s = plate_on_spring(group, integrator, 1.0 - rest + amplitude, dt, &plate);
    release(s, plate, 2, MASS, load);
    struct run r = run_start(s, 1);
    double worst = 0.0;
    for (*count = 0; *count < (int)(3.25 * steps_per_period); ++*count) {
        run_steps(&r, 1);
        double t = dt * (*count + 1), got = calx_measure_frame(r.sim)->displacement_of_wall[plate][2];
        worst = fmax(worst, fabs(got - amplitude * (cos(omega * t) - 1.0)));
    }
    run_free(&r);
    return worst / amplitude;
}

/* Velocity Verlet's frequency is too high by (omega dt)^2/24: the phase lags by that times omega t, and the error is at most so much. The other
 * integrators leave the plate as it is. */
START_TEST(a_plate_on_a_spring_oscillates_to_second_order)
{
    static const char *const integrators[] = {"velocity-verlet", "rk4", "gear", "leapfrog", "adams-bashforth-2", "cash-karp"};
    for (size_t k = 0; k < sizeof integrators / sizeof *integrators; k++)
        for (int group = 0; group < 2; group++) {
            int count;
            double coarse = oscillator_error(group, integrators[k], 40.0, &count);
            double fine = oscillator_error(group, integrators[k], 80.0, &count);
            double bound = pow(2.0 * M_PI / 40.0, 2) / 24.0 * 2.0 * M_PI * 3.25;
            ck_assert_msg(coarse <= 1.02 * bound, "%s: %g of %g", integrators[k], coarse, bound);
            ck_assert_msg(coarse >= 0.8 * bound || k == 5, "%s: %g of %g", integrators[k], coarse, bound);
            ck_assert_msg(k == 5 || fabs(log2(coarse / fine) - 2.0) < 0.1, "%s: order %g", integrators[k], log2(coarse / fine));
        }
}
END_TEST

/* With damping c it decays as exp(-c t/2m) about the depth -load/K; what the damping takes is in the ledger. */
START_TEST(a_damped_plate_comes_to_rest_under_its_load)
{
    static const double LOAD = -50.0;
    int plate;
    double omega = sqrt(K / MASS), dt = 2.0 * M_PI / omega / 100.0;
    struct calx_scene *s = plate_on_spring(false, "velocity-verlet", 1.0 - 0.5e-2, dt, &plate);
    scene_gravity(s, 0.0, 0.0, -G);
    release(s, plate, 2, MASS, LOAD)->damping = 0.2 * MASS * omega;
    struct run r = run_start(s, 1);
    run_steps(&r, 6000); /* exp(-0.1 * 2 pi 60) = 4e-17 */
    const struct calx_frame *f = calx_measure_frame(r.sim);
    double depth = (MASS * G - LOAD) / K;
    ck_assert_double_eq_tol(f->displacement_of_wall[plate][2], 0.5e-2 - depth, 1e-12);
    ck_assert_double_eq_tol(f->force_on_wall[plate][2], MASS * G - LOAD, 1e-9);
    struct calx_ledger l = calx_sim_ledger(r.sim);
    /* it came from 0.5 cm deep: of the springs' and weight's energy the difference is gone */
    double lost = 0.5 * K * pow(depth - 0.5e-2, 2);
    ck_assert_double_eq_tol(l.dissipated, lost, 0.01 * lost); /* (omega dt)^2/12 of trapezoids and more */
    ck_assert_double_lt(fabs(l.residual), 0.01 * lost);
    run_free(&r);
}
END_TEST

/* The energy that goes to and fro is balanced to second order: (omega dt)^2/8 of it at most, for velocity Verlet's energy swings by
 * (omega dt)^2/4 of the potential part, and none is lost in the end. */
START_TEST(the_ledger_closes)
{
    double worst[2];
    for (int fine = 0; fine < 2; fine++) {
        int plate;
        double omega = sqrt(K / MASS), n = fine ? 80.0 : 40.0, dt = 2.0 * M_PI / omega / n;
        struct calx_scene *s = plate_on_spring(true, "velocity-verlet", 1.0 + 0.02, dt, &plate);
        scene_gravity(s, 0.0, 0.0, -G);
        release(s, plate, 2, MASS, -30.0);
        struct run r = run_start(s, 1);
        worst[fine] = 0.0;
        for (int k = 0; k < (int)(20.0 * n); k++) {
            run_steps(&r, 1);
            struct calx_ledger l = calx_sim_ledger(r.sim);
            worst[fine] = fmax(worst[fine], fabs(l.residual) / l.scale);
            ck_assert_double_eq_tol(l.wall_work, 0.0, 1e-13 * l.scale); /* nothing is prescribed */
        }
        ck_assert_double_lt(worst[fine], pow(omega * dt, 2) / 4.0);
        run_free(&r);
    }
    ck_assert_double_gt(worst[0] / worst[1], 3.0);
}
END_TEST

/* A plate that slides as prescribed along x over a grain with friction, and is free along z: the work of walls is that along x alone. */
START_TEST(prescribed_and_free_motion_are_booked_apart)
{
    double share[2], dt[2] = {2e-5, 1e-5};
    for (int k = 0; k < 2; k++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
        scene_linear(s, 1e5, NAN, 0.4, dt[k]);
        scene_put(s, 0, 0.0, 0.0, 0.1, 0.1);
        int floor_ = scene_wall(s, "floor", 0), plate = scene_wall(s, "plate", 0);
        scene_plane(s, floor_, (double[3]){0}, (double[3]){0, 0, 1});
        scene_plane(s, plate, (double[3]){0, 0, 0.201}, (double[3]){0, 0, -1});
        release(s, plate, 2, 3.0, -40.0)->velocity[0].value = 0.3;
        struct run r = run_start(s, 1);
        run_steps(&r, k ? 20000 : 10000);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_gt(l.wall_work, 0.05 * l.scale);
        share[k] = fabs(l.residual) / l.scale;
        ck_assert_double_lt(share[k], 2e-3);
        run_free(&r);
    }
}
END_TEST

/* ---- a bed ---- */

/* Grains between a floor and a plate come to rest: the floor bears load and all weights, the plate is borne with its load and weight. */
START_TEST(the_floor_bears_load_and_weights)
{
    enum { GRAINS = 16 };
    static const double LOAD = -300.0, R = 0.05;
    struct calx_scene *s = scene_create(2, CALX_DISCS, GRAINS);
    scene_linear(s, 1e6, 0.3, 0.3, 2e-5);
    scene_extent(s, 0, 0.0, 8 * 2.02 * R, 'p');
    scene_gravity(s, 0.0, -G, 0.0);
    double weights = 0.0;
    for (size_t i = 0; i < GRAINS; i++)
        scene_put(s, i, 2.02 * R * ((double)(i % 8) + 0.5 + 0.4 * (double)(i / 8)), R + 1.85 * R * (double)(i / 8), 0.0,
                  R * (1.0 - 0.01 * (double)(i % 3)));
    int floor_ = scene_wall(s, "floor", 0), plate = scene_wall(s, "plate", 0);
    scene_plane(s, floor_, (double[3]){0}, (double[3]){0, 1, 0});
    scene_plane(s, plate, (double[3]){0, 4.2 * R, 0}, (double[3]){0, -1, 0});
    release(s, plate, 1, 5.0, LOAD)->damping = 500.0;
    struct run r = run_start(s, 1);
    for (size_t i = 0; i < GRAINS; i++)
        weights += G * run_mass(&r, (int64_t)i);
    run_steps(&r, 100000);
    const struct calx_frame *f = calx_measure_frame(r.sim);
    ck_assert_double_eq_tol(f->force_on_wall[plate][1], 5.0 * G - LOAD, 1e-6 * weights);
    ck_assert_double_eq_tol(f->force_on_wall[floor_][1], -(5.0 * G - LOAD + weights), 1e-6 * weights);
    run_free(&r);
}
END_TEST

/* ---- stages ---- */

/* Lifted at a given speed, let go, held: it is thrown with the speed it had; what its energies jump by is work from outside. */
START_TEST(a_plate_is_let_go_and_held)
{
    int plate;
    struct calx_scene *s = plate_on_spring(false, "velocity-verlet", 10.0, 1e-3, &plate);
    scene_gravity(s, 0.0, 0.0, -G);
    s->stages[0].duration = 0.5;
    scene_motion(s, 0, plate)->velocity[2].value = 2.0;
    scene_stage(s);
    release(s, plate, 2, MASS, 0.0)->velocity[2].value = 0.0;
    scene_stage(s);
    s->stages[2].motion[plate].load.value = 4.0;
    scene_stage(s);
    s->stages[3].motion[plate] = (struct calx_motion){0};
    s->stages[3].duration = INFINITY;
    struct run r = run_start(s, 1);
    run_steps(&r, 1000);
    double u = 2.0 - 0.5 * G, q = 1.0 + 0.5 * 2.0 - 0.125 * G, a = 4.0 / MASS - G;
    ck_assert_double_eq_tol(calx_measure_frame(r.sim)->velocity_of_wall[plate][2], u, 1e-11);
    ck_assert_double_eq_tol(calx_measure_frame(r.sim)->displacement_of_wall[plate][2], q, 1e-11);
    run_steps(&r, 499);
    ck_assert_double_lt(fabs(calx_sim_ledger(r.sim).residual), 1e-11 * calx_sim_ledger(r.sim).scale);
    run_steps(&r, 1);
    q += 0.5 * u + 0.125 * a;
    ck_assert_double_eq_tol(calx_measure_frame(r.sim)->velocity_of_wall[plate][2], 0.0, 0.0 + 1e-300);
    ck_assert_double_eq_tol(calx_measure_frame(r.sim)->displacement_of_wall[plate][2], q, 1e-11);
    run_steps(&r, 100);
    ck_assert_double_eq_tol(calx_measure_frame(r.sim)->displacement_of_wall[plate][2], q, 1e-11);
    ck_assert_double_lt(fabs(calx_sim_ledger(r.sim).residual), 1e-11 * calx_sim_ledger(r.sim).scale);
    run_free(&r);
}
END_TEST

/* ---- the longest step ---- */

/* A light plate between springs vibrates faster than any grain: N contacts of stiffness K with fixed grains give omega^2 = N K/m exactly. */
START_TEST(a_light_plate_shortens_the_step)
{
    enum { SPRINGS = 5 };
    static const double LIGHT = 1e-3;
    for (int group = 0; group < 2; group++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2 * SPRINGS);
        scene_linear(s, K, NAN, -1.0, 1e-5);
        int plate = group ? scene_group(s, "plate") : scene_wall(s, "plate", 0);
        for (size_t i = 0; i < SPRINGS; i++) {
            scene_put(s, i, 4.0 * (double)i, 0.0, 0.0, 1.0);
            scene_fix(s, i);
            scene_put(s, SPRINGS + i, 4.0 * (double)i, group ? 0.0 : 9.0, 1.99, 1.0);
            if (group)
                scene_carry(s, SPRINGS + i, plate);
            else
                scene_fix(s, SPRINGS + i);
        }
        if (!group)
            scene_plane(s, plate, (double[3]){0, 0, 0.99}, (double[3]){0, 0, -1});
        if (!group)
            for (size_t i = SPRINGS; i < 2 * SPRINGS; i++)
                s->particles.position[i][2] = -5.0;
        release(s, plate, 2, LIGHT, 0.0);
        struct run r = run_start(s, 1);
        double expected = 2.0 / sqrt(SPRINGS * K / LIGHT);
        double share = calx_sim_step_share(r.sim, NULL);
        ck_assert_double_eq_tol(share, 1e-5 / expected, 1e-9 * share);
        run_free(&r);
    }
}
END_TEST

/* Free grains under a plate: the bound is never above the truth, which for SPRINGS equal grains of mass m under a plate of mass M, each on a
 * contact K with it, is omega^2 = K (1/m + SPRINGS/M), and at most twice below it. */
START_TEST(the_bound_holds_for_grains_under_a_plate)
{
    enum { SPRINGS = 7 };
    for (double mass = 1.0; mass < 1e6; mass *= 10.0) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, SPRINGS);
        scene_linear(s, K, NAN, -1.0, 1e-5);
        int plate = scene_wall(s, "plate", 0);
        for (size_t i = 0; i < SPRINGS; i++)
            scene_put(s, i, 4.0 * (double)i, 0.0, 0.0, 1.0);
        scene_plane(s, plate, (double[3]){0, 0, 0.99}, (double[3]){0, 0, -1});
        release(s, plate, 2, mass, 0.0);
        struct run r = run_start(s, 1);
        double limit = 2.0 / sqrt(K * (1.0 / run_mass(&r, 0) + SPRINGS / mass));
        double share = calx_sim_step_share(r.sim, NULL);
        ck_assert_double_ge(share, (1.0 - 1e-12) * 1e-5 / limit);
        ck_assert_double_le(share, 2.0 * 1e-5 / limit);
        run_free(&r);
    }
}
END_TEST

/* A fixed step that is too long for a light plate is refused before it blows up, and the message says so. */
START_TEST(a_step_too_long_for_a_plate_is_refused)
{
    struct calx_error e = {0};
    int plate;
    struct calx_scene *s = plate_on_spring(false, "velocity-verlet", 0.99, 2.1 / sqrt(K / 1e-3), &plate);
    release(s, plate, 2, 1e-3, 0.0);
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "set by a loaded plate"), "%s", e.text);
    s = plate_on_spring(false, "velocity-verlet", 0.99, 1.9 / sqrt(K / 1e-3), &plate);
    release(s, plate, 2, 1e-3, 0.0);
    struct run r = run_start(s, 1);
    run_steps(&r, 100);
    run_free(&r);
}
END_TEST

/* ---- bits ---- */

START_TEST(the_same_bits)
{
    enum { CROWD = 3000, STEPS = 300 };
    struct calx_scene *s = scene_create(3, CALX_SPHERES, CROWD);
    struct calx_random random;
    struct calx_error e = {0};
    calx_random_seed(&random, 11);
    scene_linear(s, 1e4, 0.5, 0.3, 1e-5);
    int lid = scene_wall(s, "lid", 0), base = scene_group(s, "base");
    for (size_t i = 0; i < CROWD; i++) {
        scene_put(s, i, 0.0199 * ((double)(i % 16) + 0.5), 0.0199 * ((double)(i / 16 % 16) + 0.5),
                  0.0199 * ((double)(i / 256) + 0.5), 0.01);
        scene_move(s, i, 2.0 * calx_random_uniform(&random) - 1.0, 2.0 * calx_random_uniform(&random) - 1.0, 1.0);
        if (i < 256)
            scene_carry(s, i, base);
    }
    for (int k = 0; k < 2; k++)
        scene_extent(s, k, 0.0, 0.0199 * 16, 'p');
    scene_plane(s, lid, (double[3]){0, 0, 0.0199 * 12}, (double[3]){0, 0, -1});
    release(s, lid, 2, 0.01, -5.0)->velocity[0].value = 0.1;
    release(s, base, 2, 0.02, 5.0);
    struct run first = run_start(s, 1), two = run_again(&first, 2), broken = run_again(&first, 2),
               resumed = run_again(&first, 1), quiet = run_again(&first, 1);
    struct calx_block *blocks;
    size_t count;
    run_steps(&first, STEPS);
    run_steps(&two, STEPS);
    run_steps(&broken, STEPS / 3);
    ck_assert_int_eq(calx_sim_save(broken.sim, &blocks, &count, &e), 0);
    ck_assert_int_eq(calx_sim_restore(resumed.sim, blocks, count, &e), 0);
    free(blocks);
    run_steps(&resumed, STEPS - STEPS / 3);
    for (int64_t made, left = STEPS; left > 0; left -= made) {
        ck_assert_int_eq(calx_sim_advance(quiet.sim, left, &made, &e), 0);
        if (made < left) {
            ck_assert_int_eq(calx_sim_step(quiet.sim, &e), 0);
            made++;
        }
    }
    uint64_t hash = calx_sim_hash(first.sim);
    ck_assert_double_ne(first.sim->plates[base].speed, 0.0);
    ck_assert_uint_eq(calx_sim_hash(two.sim), hash);
    ck_assert_uint_eq(calx_sim_hash(resumed.sim), hash);
    ck_assert_uint_eq(calx_sim_hash(quiet.sim), hash);
    run_free(&two);
    run_free(&broken);
    run_free(&resumed);
    run_free(&quiet);
    run_free(&first);
}
END_TEST

/* ---- among rigid bodies ---- */

static const double ROUND_OFF = 1e-12; /* a few hundred operations */

static void rigid(struct calx_scene *s, double friction, double restitution, double dt, const struct given *solver)
{
    scene_model(s, CALX_CONTACT, "signorini-coulomb",
                (struct given[]){{"friction", friction}, {"restitution", restitution}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "nscd", solver);
    s->models[0].dt = dt;
}

static const struct given strict[] = {{"tolerance", 1e-13}, {"accuracy", 1e-13}, {NULL, 0.0}};

/* Under weight, load and damping with c: u' = a - (c/m) u, by the midpoint in each step; the way is that of the mean speed. */
START_TEST(a_plate_falls_among_rigid_bodies)
{
    enum { STEPS = 100 };
    static const double DT = 1e-3, C = 30.0, LOAD = 3.0;
    for (int group = 0; group < 2; group++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_put(s, 0, 0.0, 0.0, -40.0, 1.0);
        scene_put(s, 1, 0.0, 0.0, group ? 31.0 : -20.0, 1.0);
        int plate = group ? scene_group(s, "plate") : scene_wall(s, "plate", 0);
        if (group)
            scene_carry(s, 1, plate);
        else
            scene_plane(s, plate, (double[3]){0, 0, 30}, (double[3]){0, 0, -1});
        scene_gravity(s, 0.0, 0.0, -G);
        release(s, plate, 2, MASS, LOAD)->damping = C;
        rigid(s, 0.0, 0.0, DT, NULL);
        struct run r = run_start(s, 1);
        run_steps(&r, STEPS);
        double u = 0.0, way = 0.0, half = 0.5 * DT * C / MASS;
        for (int k = 0; k < STEPS; k++) {
            double before = u;
            u = ((1.0 - half) * u + DT * (LOAD / MASS - G)) / (1.0 + half);
            way += 0.5 * DT * (before + u);
        }
        const struct calx_frame *f = calx_measure_frame(r.sim);
        ck_assert_double_eq_tol(f->velocity_of_wall[plate][2], u, ROUND_OFF);
        ck_assert_double_eq_tol(f->displacement_of_wall[plate][2], way, ROUND_OFF);
        if (group)
            ck_assert_double_eq_tol(f->position[1][2], 31.0 + way, 31.0 * ROUND_OFF);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_eq_tol(l.gravity_work, LOAD * way, ROUND_OFF);
        ck_assert_double_gt(l.dissipated, 0.0);
        ck_assert_double_lt(fabs(l.residual), ROUND_OFF * l.scale);
        run_free(&r);
    }
}
END_TEST

/* A plate presses three grains on a floor, a wall or a group, whatever the solver and its order: floor and plate bear what is above them. */
START_TEST(a_plate_presses_rigid_grains)
{
    static const double LOAD = -5e4;
    static const struct given solvers[][4] = {{{"tolerance", 1e-13}, {"accuracy", 1e-13}, {NULL, 0.0}},
                                              {{"tolerance", 1e-13}, {"accuracy", 1e-13}, {"solver", 1.0}, {NULL, 0.0}},
                                              {{"tolerance", 1e-13}, {"accuracy", 1e-13}, {"order", 1.0}, {NULL, 0.0}},
                                              {{"tolerance", 1e-13}, {"accuracy", 1e-13}, {"order", 2.0}, {NULL, 0.0}}};
    for (size_t k = 0; k < sizeof solvers / sizeof *solvers; k++)
        for (int group = 0; group < 2; group++) {
            struct calx_scene *s = scene_create(3, CALX_SPHERES, 4);
            for (size_t i = 0; i < 4; i++)
                scene_put(s, i, 0.0, 0.0, 2.0 * (double)i + 1.0, 1.0);
            int floor = scene_wall(s, "floor", 0), plate = group ? scene_group(s, "plate") : scene_wall(s, "plate", 0);
            scene_plane(s, floor, (double[3]){0, 0, 0}, (double[3]){0, 0, 1});
            if (group)
                scene_carry(s, 3, plate);
            else
                scene_plane(s, plate, (double[3]){0, 0, 8}, (double[3]){0, 0, -1});
            scene_gravity(s, 0.0, 0.0, -G);
            release(s, plate, 2, MASS, LOAD);
            rigid(s, 0.3, 0.0, 1e-3, solvers[k]);
            struct run r = run_start(s, 1);
            run_steps(&r, 50);
            double on_plate = MASS * G - LOAD, on_floor = on_plate;
            for (int64_t i = 0; i < (group ? 3 : 4); i++)
                on_floor += run_mass(&r, i) * G;
            const struct calx_frame *f = calx_measure_frame(r.sim);
            ck_assert_double_eq_tol(f->force_on_wall[plate][2], on_plate, 1e-9 * on_floor);
            ck_assert_double_eq_tol(f->force_on_wall[floor][2], -on_floor, 1e-9 * on_floor);
            ck_assert_double_eq_tol(f->velocity_of_wall[plate][2], 0.0, 1e-9);
            struct calx_ledger l = calx_sim_ledger(r.sim);
            ck_assert_double_eq_tol(l.wall_work, 0.0, ROUND_OFF);
            run_free(&r);
        }
}
END_TEST

/* A plate whose one grain meets a free one obliquely, without friction: it keeps to its axis, the free one is pushed along the normal n, so with the
 * masses M, m the impulse is (1 + e) V n_z/(n_z^2/M + 1/m). The two meet up to a step late, so that n is off by V dt/2R. */
START_TEST(a_plate_hits_obliquely)
{
    static const double V = 1.0, DT = 1e-3, M = 1e3, restitutions[] = {0.0, 0.5, 1.0};
    static const double n[3] = {0.6, 0.0, -0.8}; /* from the plate's grain to the other */
    for (size_t k = 0; k < sizeof restitutions / sizeof *restitutions; k++) {
        double e = restitutions[k];
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_put(s, 0, 0.0, 0.0, 0.0, 1.0);
        scene_put(s, 1, -2.0 * n[0], 0.0, -2.0 * n[2] + 0.01, 1.0);
        int plate = scene_group(s, "plate");
        scene_carry(s, 1, plate);
        rigid(s, 0.0, e, DT, strict);
        scene_stage(s);
        s->stages[0].duration = DT;
        s->stages[0].motion[plate].moves = true;
        s->stages[0].motion[plate].velocity[2].value = -V;
        release(s, plate, 2, M, 0.0)->moves = true;
        struct run r = run_start(s, 1);
        run_steps(&r, 50);
        double m = run_mass(&r, 0), impulse = (1.0 + e) * V * fabs(n[2]) / (n[2] * n[2] / M + 1.0 / m);
        double speed = r.sim->plates[plate].speed;
        const double *v = run_v(&r, 0);
        ck_assert_double_eq_tol(v[0], impulse * n[0] / m, 2e-3 * V);
        ck_assert_double_eq_tol(v[2], impulse * n[2] / m, 2e-3 * V);
        ck_assert_double_eq_tol(M * (speed + V) + m * v[2], 0.0, ROUND_OFF * M * V);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        double lost = 0.5 * (1.0 - e * e) * V * V * n[2] * n[2] / (n[2] * n[2] / M + 1.0 / m);
        ck_assert_double_eq_tol(l.dissipated, lost, 2e-3 * M * V * V);
        ck_assert_double_lt(fabs(l.residual), ROUND_OFF * l.scale);
        run_free(&r);
    }
}
END_TEST

/* The same bits of a plate among rigid grains with any number of threads and after a restart. */
START_TEST(the_same_bits_among_rigid_bodies)
{
    enum { STEPS = 150, GRAINS = 12, PLATE = 4 };
    static const struct given coloured[] = {{"order", 2.0}, {NULL, 0.0}};
    struct calx_scene *s = scene_create(2, CALX_DISCS, GRAINS + PLATE);
    for (size_t i = 0; i < GRAINS; i++)
        scene_put(s, i, 2.1 * (double)(i % 4) + 0.3 * (double)(i / 4), 1.0 + 2.0 * (double)(i / 4), 0.0, 1.0);
    int floor = scene_wall(s, "floor", 0), plate = scene_group(s, "plate");
    scene_plane(s, floor, (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    for (size_t i = GRAINS; i < GRAINS + PLATE; i++) {
        scene_put(s, i, 2.2 * (double)(i - GRAINS), 7.5, 0.0, 1.0);
        scene_carry(s, i, plate);
    }
    scene_gravity(s, 0.0, -G, 0.0);
    release(s, plate, 1, 1e3, -1e5)->moves = true;
    scene_motion(s, 0, plate)->velocity[0].value = 0.5;
    rigid(s, 0.3, 0.0, 1e-3, coloured);
    struct calx_block *blocks;
    size_t count;
    struct calx_error e;
    struct run first = run_start(s, 1), two = run_again(&first, 2), broken = run_again(&first, 1), resumed = run_again(&first, 2);
    run_steps(&first, STEPS);
    run_steps(&two, STEPS);
    run_steps(&broken, STEPS / 3);
    ck_assert_int_eq(calx_sim_save(broken.sim, &blocks, &count, &e), 0);
    ck_assert_int_eq(calx_sim_restore(resumed.sim, blocks, count, &e), 0);
    free(blocks);
    run_steps(&resumed, STEPS - STEPS / 3);
    ck_assert_double_ne(first.sim->plates[plate].speed, 0.0);
    ck_assert_double_gt(first.sim->wall_force[plate][1], 0.0);
    ck_assert_uint_eq(calx_sim_hash(two.sim), calx_sim_hash(first.sim));
    ck_assert_uint_eq(calx_sim_hash(resumed.sim), calx_sim_hash(first.sim));
    run_free(&two);
    run_free(&broken);
    run_free(&resumed);
    run_free(&first);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {a_plate_falls,
                            a_plate_on_a_spring_oscillates_to_second_order,
                            a_damped_plate_comes_to_rest_under_its_load,
                            the_ledger_closes,
                            prescribed_and_free_motion_are_booked_apart,
                            the_floor_bears_load_and_weights,
                            a_plate_is_let_go_and_held,
                            a_light_plate_shortens_the_step,
                            a_step_too_long_for_a_plate_is_refused,
                            the_bound_holds_for_grains_under_a_plate,
                            the_same_bits,
                            a_plate_falls_among_rigid_bodies,
                            a_plate_presses_rigid_grains,
                            the_same_bits_among_rigid_bodies,
                            a_plate_hits_obliquely};
    return run_tests("plates", sizeof tests / sizeof *tests, tests);
}

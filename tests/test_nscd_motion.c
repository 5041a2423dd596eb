/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Motion of rigid bodies with known answers: columns at rest, impacts up to their accumulation point, inclines, grooves, sliding to a stop and to
 * rolling, floors that shake; and what holds of every run: momentum, the ledger.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/rigid.h"

/* ---- at rest ---- */

/* 10^4 steps: the forces are the weights above, and no contact closes by more than 1e-9 of the radius. */
START_TEST(a_column_rests)
{
    enum { N = 10, STEPS = 10000 };
    struct run r = run_start(rigid_column(N, DENSITY, 1e-3, (struct given[]){{"tolerance", 1e-10}, {NULL, 0.0}}), 1);
    run_steps(&r, STEPS);
    ck_assert_double_lt(rigid_worst_force(&r, N), 1e-9);
    ck_assert_double_lt(fabs(r.sim->wall_force[0][2] + rigid_weight(&r, N)), 1e-9 * rigid_weight(&r, N));
    for (int64_t i = 0; i < N; i++) {
        double gap = run_x(&r, i)[2] - (i ? run_x(&r, i - 1)[2] + RADIUS : 0.0) - RADIUS;
        ck_assert_double_gt(gap, -1e-9 * RADIUS);
    }
    run_free(&r);
}
END_TEST

/* A second stage has a solver of its own: the column has its weights from the first step on, which starts from the impulses of the last. */
START_TEST(a_column_rests_under_another_solver)
{
    enum { N = 10, STEPS = 50 };
    struct calx_scene *s = rigid_column(N, DENSITY, 1e-3, (struct given[]){{"tolerance", 1e-12}, {NULL, 0.0}});
    s->stages[0].duration = STEPS * 1e-3;
    size_t second = scene_stage(s);
    s->stages[second].duration = INFINITY;
    struct calx_models *models = scene_models_anew(s, second);
    for (size_t m = 0; m < models->count; m++)
        for (size_t v = 0; v < models->list[m].value_count; v++)
            if (strcmp(models->list[m].values[v].name, "tolerance") == 0)
                models->list[m].values[v].value = 1e-10;
    struct run r = run_start(s, 1);
    for (int step = 0; step < STEPS + 2; step++) {
        double residual;
        run_steps(&r, 1);
        ck_assert_double_lt(fabs(r.sim->wall_force[0][2] + rigid_weight(&r, N)), 1e-9 * rigid_weight(&r, N));
        ck_assert_uint_eq(calx_sim_contact_count(r.sim), N);
        if (step >= STEPS)
            ck_assert_double_eq(calx_sim_solver(r.sim, &residual), 1.0);
    }
    ck_assert_int_eq(calx_sim_stage(r.sim), 1);
    run_free(&r);
}
END_TEST

/* ---- impacts ---- */

static struct calx_scene *ball(double height, double restitution, double dt, double theta)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_put(s, 0, 0.0, 0.0, RADIUS + height, RADIUS);
    scene_gravity(s, 0.0, 0.0, -G);
    rigid_floor(s);
    rigid_models(s, 0.0, restitution, 1.0, dt, (struct given[]){{"theta", theta}, {NULL, 0.0}});
    return s;
}

/* Bounce n reaches e^(2n) of the height; bounces accumulate at sqrt(2h/g)(1 + e)/(1 - e), after which the ball lies. */
START_TEST(a_ball_bounces_through_its_accumulation_point)
{
    const double height = 0.2, e = 0.6, dt = 1e-4, speed = sqrt(2.0 * G * height);
    const double end = sqrt(2.0 * height / G) * (1.0 + e) / (1.0 - e);
    for (double theta = 0.5; theta <= 1.0; theta += 0.25) {
        struct run r = run_start(ball(height, e, dt, theta), 1);
        double highest = 0.0, first = sqrt(2.0 * height / G), turn = first * (1.0 + e);
        while (calx_sim_time(r.sim) < end + 0.05) {
            run_steps(&r, 1);
            double t = calx_sim_time(r.sim);
            if (t > turn - 0.5 * e * first && t < turn + 0.5 * e * first)
                highest = fmax(highest, run_x(&r, 0)[2] - RADIUS);
        }
        ck_assert_double_lt(fabs(highest / (e * e * height) - 1.0), 2.0 * G * dt / (e * speed) + 4.0 * speed * dt / height);
        ck_assert_double_lt(fabs(run_x(&r, 0)[2] - RADIUS), speed * dt);
        ck_assert_double_le(fabs(run_v(&r, 0)[2]), G * dt * (1.0 + e));
        run_free(&r);
    }
}
END_TEST

/* Two spheres meet head on: they part with e times the speed, and m v^2 (1 - e^2) becomes heat, half in each. */
START_TEST(an_impact_heats_both_bodies)
{
    const double v = 1.0, e = 0.5, heat = 385.0;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    s->materials[0].specific_heat = heat;
    scene_material_value(s, 0, "conductivity", 400.0);
    for (size_t i = 0; i < 2; i++) {
        double side = i ? 1.0 : -1.0;
        scene_put(s, i, side * (RADIUS + 1.05e-4), 0.0, 0.0, RADIUS);
        scene_move(s, i, -side * v, 0.0, 0.0);
    }
    rigid_models(s, 0.0, e, 1.0, 1e-5, NULL);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 1e-6);
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    s->from_dissipation = 1.0;
    struct run r = run_start(s, 1);
    run_steps(&r, 30);
    for (int64_t i = 0; i < 2; i++) {
        ck_assert_double_lt(fabs(fabs(run_v(&r, i)[0]) - e * v), ROUND_OFF);
        ck_assert_double_lt(fabs(run_v(&r, i)[7] - 293.15 - v * v * (1.0 - e * e) / (2.0 * heat)), 1e-10);
    }
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_double_lt(fabs(l.residual), ROUND_OFF * l.scale);
    run_free(&r);
}
END_TEST

/* ---- one body on an incline ---- */

static double velocity_after(struct calx_scene *s, size_t steps)
{
    struct run r = run_start(s, 1);
    run_steps(&r, steps);
    double v = run_v(&r, 0)[0];
    run_free(&r);
    return v;
}

/* A block holds up to tan a = mu and slides beyond, with a = g (sin a - mu cos a). */
START_TEST(a_block_slides_above_the_critical_angle)
{
    const double mu = 0.5, dt = 1e-3;
    enum { STEPS = 1000 };
    for (int side = -1; side <= 1; side += 2) {
        double steep = mu * (1.0 + 1e-6 * side), a = atan(steep), t = STEPS * dt;
        double v = velocity_after(rigid_incline(CALX_SPHERES, steep, mu, 0.0, dt), STEPS);
        double expected = side > 0 ? G * (sin(a) - mu * cos(a)) * t : 0.0;
        ck_assert_double_lt(fabs(v - expected), ROUND_OFF * G * t);
    }
    double a = atan(1.5), v = velocity_after(rigid_incline(CALX_SPHERES, 1.5, mu, 0.0, dt), 100);
    ck_assert_double_lt(fabs(v - G * (sin(a) - mu * cos(a)) * 0.1), ROUND_OFF * G);
}
END_TEST

/* A sphere rolls while tan a <= 7/2 mu, with 5/7 g sin a, a disc while tan a <= 3 mu, with 2/3. */
START_TEST(spheres_and_discs_roll)
{
    static const struct { uint32_t bodies; double share, limit; } cases[] = {{CALX_SPHERES, 5.0 / 7.0, 3.5},
                                                                            {CALX_DISCS, 2.0 / 3.0, 3.0}};
    const double mu = 0.3, dt = 1e-3;
    for (int k = 0; k < 2; k++)
        for (int side = -1; side <= 1; side += 2) {
            double steep = mu * cases[k].limit * (1.0 + 1e-6 * side), a = atan(steep);
            double v = velocity_after(rigid_incline(cases[k].bodies, steep, mu, 1.0, dt), 500) / 0.5;
            double rolls = cases[k].share * G * sin(a), slides = G * (sin(a) - mu * cos(a));
            ck_assert_double_lt(fabs(v - (side < 0 ? rolls : slides)), 10.0 * ROUND_OFF * G);
        }
}
END_TEST

/* From u0 a block comes to rest after u0^2/(2 mu g), a sphere to rolling with 5/7 u0. */
START_TEST(sliding_ends)
{
    const double mu = 0.4, u0 = 1.0, dt = 1e-3;
    for (int turning = 0; turning < 2; turning++) {
        struct calx_scene *s = rigid_incline(CALX_SPHERES, 0.0, mu, turning, dt);
        scene_move(s, 0, u0, 0.0, 0.0);
        struct run r = run_start(s, 1);
        run_steps(&r, 500);
        if (turning) {
            ck_assert_double_lt(fabs(run_v(&r, 0)[0] - 5.0 / 7.0 * u0), ROUND_OFF);
            ck_assert_double_lt(fabs(run_v(&r, 0)[5] - 5.0 / 7.0 * u0 / RADIUS), ROUND_OFF / RADIUS);
        } else {
            ck_assert_double_lt(fabs(run_v(&r, 0)[0]), ROUND_OFF);
            ck_assert_double_lt(fabs(run_x(&r, 0)[0] / (u0 * u0 / (2.0 * mu * G)) - 1.0), dt * G * mu / u0);
        }
        struct calx_ledger l = calx_sim_ledger(r.sim);
        double lost = turning ? run_mass(&r, 0) * u0 * u0 / 7.0 : 0.5 * run_mass(&r, 0) * u0 * u0;
        ck_assert_double_lt(fabs(l.dissipated / lost - 1.0), 1e-10);
        run_free(&r);
    }
}
END_TEST

/* A disc in a groove of two planes, both inclined by a, presses on each with W/(2 cos a). */
START_TEST(a_disc_lies_in_a_groove)
{
    for (double degrees = 20.0; degrees < 80.0; degrees += 25.0) {
        double a = degrees * M_PI / 180.0;
        struct calx_scene *s = scene_create(2, CALX_DISCS, 1);
        scene_put(s, 0, 0.0, RADIUS / cos(a), 0.0, RADIUS);
        scene_gravity(s, 0.0, -G, 0.0);
        for (int side = -1; side <= 1; side += 2) {
            int wall = scene_wall(s, side < 0 ? "left" : "right", 0);
            scene_plane(s, wall, (double[3]){0, 0, 0}, (double[3]){-side * sin(a), cos(a), 0});
        }
        rigid_models(s, 0.0, 0.0, 1.0, 1e-3, (struct given[]){{"tolerance", 1e-13}, {"accuracy", 1e-11}, {NULL, 0.0}});
        struct run r = run_start(s, 1);
        run_steps(&r, 10);
        for (int w = 0; w < 2; w++) {
            double *f = r.sim->wall_force[w];
            ck_assert_double_lt(fabs(sqrt(f[0] * f[0] + f[1] * f[1]) / (rigid_weight(&r, 1) / (2.0 * cos(a))) - 1.0), 1e-10);
        }
        run_free(&r);
    }
}
END_TEST

/* A disc meets both sides of a groove of 90 degrees at once. Without friction each component along a normal becomes -e times what it was; with
 * friction no energy comes of it at e = 0 and 1/2. (At e = 1 it does, 7 %: Newton's restitution and friction add energy there, in any solution.) */
START_TEST(two_contacts_at_once_add_no_energy)
{
    const double half = sqrt(0.5), speed[2] = {0.3, -1.0};
    for (int k = 0; k < 5; k++) {
        double e = 0.5 * (k % 3), mu = k < 3 ? 0.0 : 0.3;
        struct calx_scene *s = scene_create(2, CALX_DISCS, 1);
        scene_put(s, 0, 0.0, sqrt(2.0) * RADIUS, 0.0, RADIUS);
        scene_move(s, 0, speed[0], speed[1], 0.0);
        for (int side = -1; side <= 1; side += 2)
            scene_plane(s, scene_wall(s, side < 0 ? "left" : "right", 0), (double[3]){0, 0, 0}, (double[3]){-side * half, half, 0});
        rigid_models(s, mu, e, 1.0, 1e-5, (struct given[]){{"tolerance", 1e-13}, {"accuracy", 1e-13}, {NULL, 0.0}});
        struct run r = run_start(s, 1);
        double before = calx_sim_ledger(r.sim).kinetic, after;
        run_steps(&r, 1);
        after = calx_sim_ledger(r.sim).kinetic + calx_sim_ledger(r.sim).rotational;
        ck_assert_uint_eq(calx_sim_contact_count(r.sim), 2);
        ck_assert_msg(after <= before * (1.0 + 1e-12), "e = %g, mu = %g: %g of the energy", e, mu, after / before);
        for (int q = 0; q < 2 && mu == 0.0; q++)
            ck_assert_double_lt(fabs(run_v(&r, 0)[q] + e * speed[q]), ROUND_OFF);
        run_free(&r);
    }
}
END_TEST

/* ---- crowds ---- */

/* The residual of the solver does not enter the ledger: what impulses do to bodies is what contacts dissipate. A floor that shakes works. */
START_TEST(the_ledger_closes)
{
    struct calx_scene *s = rigid_pile(0.4, 0.3, G, (struct given[]){{"tolerance", 1e-4}, {"accuracy", 1e9}, {NULL, 0.0}});
    struct calx_motion *m = scene_motion(s, 0, (rigid_box(s, 12.0 * RADIUS), rigid_floor(s)));
    m->amplitude[2] = 2e-3;
    m->amplitude[0] = 1e-3;
    m->frequency = 20.0;
    struct run r = run_start(s, 1);
    run_steps(&r, 1000);
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_uint_gt(calx_sim_contact_count(r.sim), 50);
    ck_assert_double_gt(fabs(l.wall_work), 1e-3 * l.scale);
    ck_assert_double_gt(l.dissipated, 0.1 * l.scale);
    ck_assert_double_lt(fabs(l.residual), 1e-11 * l.scale);
    run_free(&r);
}
END_TEST

/* In free space impulses keep momentum; with e between 0 and 1 and a solution to the tolerance they take energy, or keep it. */
START_TEST(momentum_stays_and_energy_does_not_grow)
{
    for (int k = 0; k < 2; k++) {
        double scale = 0.0, start[3];
        struct run r = run_start(rigid_pile(0.4, 0.5 * k, 0.0, NULL), 1);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        memcpy(start, l.momentum, sizeof start);
        scale = sqrt(2.0 * l.kinetic * run_mass(&r, 0) * 125.0);
        double before = l.kinetic + l.rotational;
        for (int step = 0; step < 400; step++) {
            run_steps(&r, 1);
            l = calx_sim_ledger(r.sim);
            ck_assert_double_le(l.kinetic + l.rotational, before * (1.0 + 1e-9));
            before = l.kinetic + l.rotational;
        }
        for (int q = 0; q < 3; q++)
            ck_assert_double_lt(fabs(l.momentum[q] - start[q]), 1e-12 * scale);
        ck_assert_double_gt(l.dissipated, 0.01 * l.scale);
        run_free(&r);
    }
}
END_TEST

/* A ball on a floor that moves is carried along, whatever the motion, and comes to no harm. */
START_TEST(a_shaken_floor_carries_a_ball)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_put(s, 0, 0.0, 0.0, RADIUS, RADIUS);
    scene_gravity(s, 0.0, 0.0, -G);
    struct calx_motion *m = scene_motion(s, 0, rigid_floor(s));
    m->amplitude[2] = 1e-3; /* its acceleration is below g: the ball stays */
    m->frequency = 10.0;
    m->velocity[0].value = 0.5;
    const double dt = 1e-3, fastest = 1e-3 * 2.0 * M_PI * 10.0, rate = 2.0 * M_PI * 10.0;
    scene_move(s, 0, 0.0, 0.0, fastest);
    rigid_models(s, 0.5, 0.0, 0.0, dt, NULL);
    struct run r = run_start(s, 1);
    for (int step = 0; step < 1000; step++) {
        run_steps(&r, 1);
        double floor_ = 1e-3 * sin(rate * calx_sim_time(r.sim));
        /* the trapezoid of the velocities misses the way by its error, (omega h)^2/12 */
        ck_assert_double_lt(fabs(run_x(&r, 0)[2] - RADIUS - floor_), 1e-3 * rate * rate * dt * dt / 6.0);
    }
    ck_assert_double_lt(fabs(run_v(&r, 0)[2] - fastest * cos(rate * 1.0)), 1e-9);
    ck_assert_double_lt(fabs(run_v(&r, 0)[0] - 0.5), 1e-9);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {a_column_rests, a_column_rests_under_another_solver, a_ball_bounces_through_its_accumulation_point, an_impact_heats_both_bodies,
                            a_block_slides_above_the_critical_angle, spheres_and_discs_roll, sliding_ends,
                            a_disc_lies_in_a_groove, two_contacts_at_once_add_no_energy, the_ledger_closes, momentum_stays_and_energy_does_not_grow,
                            a_shaken_floor_carries_a_ball};
    return run_tests("nscd_motion", sizeof tests / sizeof *tests, tests);
}

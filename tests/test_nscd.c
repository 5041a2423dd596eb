/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Non-smooth contact dynamics on scenes whose answer is known: how many sweeps Gauss-Seidel takes, columns, impacts up to
 * their accumulation point, inclines, grooves, sliding to a stop and to rolling, heavy on light, walls that close in, cohesion; and what holds
 * of every run: momentum, the ledger.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double G = 9.81, RADIUS = 0.01, DENSITY = 1000.0;
/* A few hundred operations on numbers of one size. */
static const double ROUND_OFF = 1e-12;

/* The non-smooth models; `solver` are the integrator's numbers. */
static void rigid(struct calx_scene *s, double friction, double restitution, double turning, double dt,
                  const struct given *solver)
{
    scene_model(s, CALX_CONTACT, "signorini-coulomb",
                (struct given[]){{"friction", friction}, {"restitution", restitution}, {"turning", turning}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "nscd", solver);
    s->models[0].dt = dt;
}

static int add_floor(struct calx_scene *s)
{
    int wall = scene_wall(s, "floor", 0);
    scene_plane(s, wall, (double[3]){0, 0, 0}, s->dimension == 2 ? (double[3]){0, 1, 0} : (double[3]){0, 0, 1});
    return wall;
}

static double weight_of(const struct run *r, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += G * run_mass(r, (int64_t)i);
    return sum;
}

/* ---- columns ---- */

/* Bodies on top of each other on a floor; the topmost of density `top`. */
static struct calx_scene *column(size_t n, double top, double dt, const struct given *solver)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, n);
    scene_material(s, "top", top, 1000.0);
    for (size_t i = 0; i < n; i++)
        scene_put(s, i, 0.0, 0.0, RADIUS * (2.0 * (double)i + 1.0), RADIUS);
    s->particles.material[n - 1] = 1;
    scene_gravity(s, 0.0, 0.0, -G);
    add_floor(s);
    rigid(s, 0.0, 0.0, 1.0, dt, solver);
    return s;
}

/* The largest error of a contact force, relative to the largest force. */
static double worst_force(const struct run *r, size_t n)
{
    struct calx_frame *f = calx_frame_create(r->sim, true);
    double worst = 0.0, weight = weight_of(r, n);
    size_t found = 0;
    ck_assert_ptr_nonnull(f);
    for (size_t k = 0; k < f->contact_count; k++) {
        double above = 0.0;
        int64_t lower = f->pair[k][1] < 0 ? -1 : f->pair[k][0] < f->pair[k][1] ? f->pair[k][0] : f->pair[k][1];
        for (int64_t i = lower + 1; i < (int64_t)n; i++)
            above += G * run_mass(r, i);
        worst = fmax(worst, fabs(f->normal_force[k] - above) / weight);
        found++;
    }
    calx_frame_free(f);
    return found == n ? worst : 1.0; /* a contact without any force is not there */
}

/* The error after one step of so many sweeps from nothing. */
static double error_after(size_t n, double ratio, double sweeps)
{
    const struct given solver[] = {{"sweeps", sweeps}, {"unsolved", 1.0}, {"tolerance", 1e-14}, {"accuracy", 1e-14},
                                   {"order", 1.0}, {NULL, 0.0}};
    struct run r = run_start(column(n, ratio * DENSITY, 1e-3, solver), 1);
    run_steps(&r, 1);
    double error = worst_force(&r, n);
    run_free(&r);
    return error;
}

/* Counts worked out from the iteration matrix of the column: rate cos^2(pi/(2N)); heavy M on light m: M/(M + m). */
static const struct {
    size_t n;
    double ratio; /* of the topmost mass to the others */
    int sweeps;   /* to an error of 1e-6 */
} counts[] = {{2, 1, 20}, {5, 1, 136}, {10, 1, 550}, {20, 1, 2204}, {50, 1, 13784}, {2, 10, 145},
              {2, 100, 1389}, {2, 1000, 13823}, {2, 0.1, 6}, {2, 0.01, 3}, {2, 0.001, 2}};

START_TEST(sweeps_are_those_of_the_theory)
{
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        double few = error_after(counts[k].n, counts[k].ratio, fmax(1, counts[k].sweeps - 3)),
               many = error_after(counts[k].n, counts[k].ratio, counts[k].sweeps + 2);
        ck_assert_msg(many <= 1e-6, "%zu bodies, ratio %g: error %g after %d sweeps", counts[k].n, counts[k].ratio, many,
                      counts[k].sweeps + 2);
        ck_assert_msg(few > 1e-6 || counts[k].sweeps < 4, "%zu bodies, ratio %g: error %g after %d sweeps", counts[k].n,
                      counts[k].ratio, few, counts[k].sweeps - 3);
    }
}
END_TEST

/* 10^4 steps: the forces are the weights above, and no contact closes by more than 1e-9 of the radius. */
START_TEST(a_column_rests)
{
    enum { N = 10, STEPS = 10000 };
    struct run r = run_start(column(N, DENSITY, 1e-3, (struct given[]){{"tolerance", 1e-10}, {NULL, 0.0}}), 1);
    run_steps(&r, STEPS);
    ck_assert_double_lt(worst_force(&r, N), 1e-9);
    ck_assert_double_lt(fabs(r.sim->wall_force[0][2] + weight_of(&r, N)), 1e-9 * weight_of(&r, N));
    for (int64_t i = 0; i < N; i++) {
        double gap = run_x(&r, i)[2] - (i ? run_x(&r, i - 1)[2] + RADIUS : 0.0) - RADIUS;
        ck_assert_double_gt(gap, -1e-9 * RADIUS);
    }
    run_free(&r);
}
END_TEST

/* Starting from the impulses of the last step, a column at rest needs at least five times fewer sweeps. */
START_TEST(a_warm_start_saves_sweeps)
{
    double sweeps[2];
    for (int warm = 0; warm < 2; warm++) {
        struct run r = run_start(column(10, DENSITY, 1e-3, (struct given[]){{"warm-start", warm}, {NULL, 0.0}}), 1);
        run_steps(&r, 20);
        sweeps[warm] = r.sim->sweeps;
        run_free(&r);
    }
    ck_assert_double_le(5.0 * sweeps[1], sweeps[0]);
}
END_TEST

/* Impulses go when what they were for does: gravity ends with the first stage, and nobody moves. */
START_TEST(impulses_end_with_their_cause)
{
    for (int descent = 0; descent < 2; descent++) {
        struct calx_scene *s = column(10, DENSITY, 1e-3, (struct given[]){{"solver", descent}, {NULL, 0.0}});
        s->stages[0].duration = 0.01;
        size_t second = scene_stage(s);
        s->stages[second].duration = INFINITY;
        s->stages[second].gravity[2].value = 0.0;
        struct run r = run_start(s, 1);
        run_steps(&r, 20);
        ck_assert_double_lt(fabs(r.sim->wall_force[0][2]), 1e-9 * weight_of(&r, 10) + G * run_mass(&r, 0) * 1e-2);
        for (int64_t i = 0; i < 10; i++)
            ck_assert_double_lt(fabs(run_v(&r, i)[2]), 1e-2 * G * 1e-3);
        run_free(&r);
    }
}
END_TEST

/* Over-relaxation at the best value for a chain, 2/(1 + sin(pi/(2N))), takes a column in less than 5 N sweeps. */
START_TEST(over_relaxation_takes_columns_quickly)
{
    for (size_t n = 10; n <= 40; n *= 2) {
        double omega = 2.0 / (1.0 + sin(M_PI / (2.0 * (double)n)));
        struct run r = run_start(column(n, DENSITY, 1e-3, (struct given[]){{"relaxation", omega}, {"tolerance", 1e-6}, {NULL, 0.0}}), 1);
        run_steps(&r, 1);
        ck_assert_double_lt(r.sim->sweeps, 5.0 * (double)n);
        ck_assert_double_lt(worst_force(&r, n), 1e-4);
        run_free(&r);
    }
}
END_TEST

/* The force on the floor is within a thousandth of the weight, or the run says that it could not be found: sweeps alone give up where
 * they would need a million, descent does not. */
START_TEST(heavy_on_light_is_right_or_refused)
{
    for (double ratio = 1.0; ratio < 2e6; ratio *= 10.0)
        for (int descent = 0; descent < 2; descent++) {
            struct calx_error e = {0};
            struct run r = run_start(column(2, ratio * DENSITY, 1e-3, (struct given[]){{"solver", descent}, {NULL, 0.0}}), 1);
            if (calx_sim_step(r.sim, &e) == 0)
                ck_assert_msg(worst_force(&r, 2) < 1e-3, "ratio %g: %g", ratio, worst_force(&r, 2));
            else
                ck_assert_msg(ratio > 1e3 && !descent && strstr(e.text, "heavy bodies on light"), "ratio %g: %s", ratio, e.text);
            run_free(&r);
        }
}
END_TEST

/* A column of n bodies in less than 10 n iterations, and to the forces of the theory. */
START_TEST(descent_takes_columns_quickly)
{
    for (size_t n = 10; n <= 160; n *= 2) {
        struct run r = run_start(column(n, DENSITY, 1e-3, (struct given[]){{"solver", 1.0}, {"accuracy", 1e-4}, {NULL, 0.0}}), 1);
        run_steps(&r, 1);
        ck_assert_msg(r.sim->sweeps < 10.0 * (double)n, "%zu bodies: %g iterations", n, r.sim->sweeps);
        ck_assert_double_lt(worst_force(&r, n), 1e-3);
        run_free(&r);
    }
}
END_TEST

/* ---- impacts ---- */

static struct calx_scene *ball(double height, double restitution, double dt, double theta)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_put(s, 0, 0.0, 0.0, RADIUS + height, RADIUS);
    scene_gravity(s, 0.0, 0.0, -G);
    add_floor(s);
    rigid(s, 0.0, restitution, 1.0, dt, (struct given[]){{"theta", theta}, {NULL, 0.0}});
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
    rigid(s, 0.0, e, 1.0, 1e-5, NULL);
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

/* ---- one body on an incline; gravity is turned instead of the floor ---- */

static struct calx_scene *incline(uint32_t bodies, double slope_, double friction, double turning, double dt)
{
    struct calx_scene *s = scene_create(bodies == CALX_DISCS ? 2 : 3, bodies, 1);
    double a = atan(slope_);
    if (bodies == CALX_DISCS) {
        scene_put(s, 0, 0.0, RADIUS, 0.0, RADIUS);
        scene_gravity(s, G * sin(a), -G * cos(a), 0.0);
    } else {
        scene_put(s, 0, 0.0, 0.0, RADIUS, RADIUS);
        scene_gravity(s, G * sin(a), 0.0, -G * cos(a));
    }
    add_floor(s);
    rigid(s, friction, 0.0, turning, dt, NULL);
    return s;
}

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
        double v = velocity_after(incline(CALX_SPHERES, steep, mu, 0.0, dt), STEPS);
        double expected = side > 0 ? G * (sin(a) - mu * cos(a)) * t : 0.0;
        ck_assert_double_lt(fabs(v - expected), ROUND_OFF * G * t);
    }
    double a = atan(1.5), v = velocity_after(incline(CALX_SPHERES, 1.5, mu, 0.0, dt), 100);
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
            double v = velocity_after(incline(cases[k].bodies, steep, mu, 1.0, dt), 500) / 0.5;
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
        struct calx_scene *s = incline(CALX_SPHERES, 0.0, mu, turning, dt);
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
        rigid(s, 0.0, 0.0, 1.0, 1e-3, (struct given[]){{"tolerance", 1e-13}, {"accuracy", 1e-11}, {NULL, 0.0}});
        struct run r = run_start(s, 1);
        run_steps(&r, 10);
        for (int w = 0; w < 2; w++) {
            double *f = r.sim->wall_force[w];
            ck_assert_double_lt(fabs(sqrt(f[0] * f[0] + f[1] * f[1]) / (weight_of(&r, 1) / (2.0 * cos(a))) - 1.0), 1e-10);
        }
        run_free(&r);
    }
}
END_TEST

/* ---- crowds ---- */

/* A loose pile of grains of three sizes that falls into a box. */
static struct calx_scene *pile(double friction, double restitution, double gravity, const struct given *solver)
{
    enum { EDGE = 5, N = EDGE * EDGE * EDGE };
    struct calx_scene *s = scene_create(3, CALX_SPHERES, N);
    struct calx_random random;
    calx_random_seed(&random, 3);
    for (size_t i = 0; i < N; i++) {
        const size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double x[3], v[3];
        for (int k = 0; k < 3; k++) {
            x[k] = RADIUS * (2.1 * (double)at[k] + 1.1 + 0.05 * calx_random_uniform(&random));
            v[k] = 0.4 * (calx_random_uniform(&random) - 0.5);
        }
        scene_put(s, i, x[0], x[1], x[2], RADIUS * (0.8 + 0.1 * (double)(i % 3)));
        scene_move(s, i, v[0], v[1], v[2]);
    }
    scene_gravity(s, 0.0, 0.0, -gravity);
    rigid(s, friction, restitution, 1.0, 5e-4, solver);
    return s;
}

static void add_box(struct calx_scene *s, double size)
{
    int box = scene_wall(s, "box", 0);
    for (int k = 0; k < 2; k++)
        for (int side = 0; side < 2; side++) {
            double a[3] = {0}, n[3] = {0};
            a[k] = side * size;
            n[k] = side ? -1.0 : 1.0;
            scene_plane(s, box, a, n);
        }
}

/* The residual of the solver does not enter the ledger: what impulses do to bodies is what contacts dissipate. A floor that shakes works. */
START_TEST(the_ledger_closes)
{
    struct calx_scene *s = pile(0.4, 0.3, G, (struct given[]){{"tolerance", 1e-4}, {"accuracy", 1e9}, {NULL, 0.0}});
    struct calx_motion *m = scene_motion(s, 0, (add_box(s, 12.0 * RADIUS), add_floor(s)));
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
        struct run r = run_start(pile(0.4, 0.5 * k, 0.0, NULL), 1);
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

/* Sweeps in any order and descent solve a pile with friction, to the same residual; the floor and the box carry its weight. */
START_TEST(solvers_agree_on_a_pile)
{
    static const struct { double solver, order; } ways[] = {{1, 0}, {0, 1}, {0, 2}, {0, 0}};
    enum { WAYS = sizeof ways / sizeof *ways };
    double height[WAYS];
    for (size_t way = 0; way < WAYS; way++) {
        struct calx_scene *s = pile(0.4, 0.0, G,
                                    (struct given[]){{"solver", ways[way].solver}, {"order", ways[way].order}, {"tolerance", 1e-3},
                                                     {"accuracy", 1e-2}, {NULL, 0.0}});
        add_box(s, 12.0 * RADIUS);
        add_floor(s);
        struct run r = run_start(s, 1);
        run_steps(&r, 1500);
        double sum = 0.0;
        for (int64_t i = 0; i < 125; i++)
            sum += run_mass(&r, i) * run_x(&r, i)[2];
        height[way] = sum;
        double *f = r.sim->wall_force[1], g[3] = {r.sim->wall_force[0][0], r.sim->wall_force[0][1], r.sim->wall_force[0][2]};
        ck_assert_double_lt(fabs(f[2] + g[2] + weight_of(&r, 125)), 1e-2 * weight_of(&r, 125)); /* it creeps to rest */
        ck_assert_double_le(r.sim->residual, 1e-3);
        run_free(&r);
        ck_assert_double_lt(fabs(height[way] / height[0] - 1.0), 0.02);
    }
}
END_TEST

/* Nothing can be done for a ball between two walls that close in: the run stops and says so. */
START_TEST(a_wedged_body_stops_the_run)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_put(s, 0, 0.0, 0.0, RADIUS, RADIUS);
    add_floor(s);
    int lid = scene_wall(s, "lid", 0);
    scene_plane(s, lid, (double[3]){0, 0, 2.0 * RADIUS}, (double[3]){0, 0, -1});
    scene_motion(s, 0, lid)->velocity[2].value = -0.1;
    rigid(s, 0.3, 0.0, 1.0, 1e-3, NULL);
    struct run r = run_start(s, 1);
    ck_assert_int_eq(calx_sim_step(r.sim, &e), CALX_ERROR_PHYSICS);
    ck_assert_msg(strstr(e.text, "no solution") && strstr(e.text, "wedged") && strstr(e.text, "residual"), "%s", e.text);
    run_free(&r);
}
END_TEST

/* A ball on a floor that moves is carried along, whatever the motion, and comes to no harm. */
START_TEST(a_shaken_floor_carries_a_ball)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_put(s, 0, 0.0, 0.0, RADIUS, RADIUS);
    scene_gravity(s, 0.0, 0.0, -G);
    struct calx_motion *m = scene_motion(s, 0, add_floor(s));
    m->amplitude[2] = 1e-3; /* its acceleration is below g: the ball stays */
    m->frequency = 10.0;
    m->velocity[0].value = 0.5;
    const double dt = 1e-3, fastest = 1e-3 * 2.0 * M_PI * 10.0, rate = 2.0 * M_PI * 10.0;
    scene_move(s, 0, 0.0, 0.0, fastest);
    rigid(s, 0.5, 0.0, 0.0, dt, NULL);
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

/* ---- cohesion ---- */

/* A ball under a held one, which pulls it with `pull` times its weight. */
static struct run hanging(double pull, double gap)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    double weight = G * DENSITY * 4.0 / 3.0 * M_PI * RADIUS * RADIUS * RADIUS;
    scene_put(s, 0, 0.0, 0.0, 2.0 * RADIUS + gap, RADIUS);
    scene_put(s, 1, 0.0, 0.0, 0.0, RADIUS);
    scene_fix(s, 0);
    scene_gravity(s, 0.0, 0.0, -G);
    rigid(s, 0.5, 0.0, 1.0, 1e-4, NULL);
    scene_model(s, CALX_CONTACT, "cohesive",
                (struct given[]){{"pull", pull * weight}, {"distance", 1e-4}, {NULL, 0.0}});
    return run_start(s, 1);
}

START_TEST(a_pull_holds_what_is_lighter)
{
    struct run r = hanging(1.5, 0.0);
    run_steps(&r, 100);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2]), ROUND_OFF);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, 1);
    ck_assert_double_lt(fabs(f->normal_force[0] / weight_of(&r, 2) + 0.5), 1e-9);
    ck_assert_int_eq(f->status[0], 2);
    calx_frame_free(f);
    run_free(&r);
    r = hanging(0.5, 0.0); /* it opens with half of g, and falls freely beyond the distance */
    run_steps(&r, 10);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2] + 0.5 * G * 1e-3), ROUND_OFF);
    run_steps(&r, 90);
    ck_assert_double_lt(run_v(&r, 1)[2], -0.5 * G * 1e-2);
    f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, 0);
    calx_frame_free(f);
    run_free(&r);
    r = hanging(1.5, 0.5e-4); /* it closes the gap and stays */
    run_steps(&r, 200);
    ck_assert_double_lt(fabs(run_x(&r, 0)[2] - run_x(&r, 1)[2] - 2.0 * RADIUS), 1e-12);
    run_free(&r);
    r = hanging(1.5, 1.5e-4); /* beyond the distance nothing pulls */
    run_steps(&r, 10);
    ck_assert_double_lt(fabs(run_v(&r, 1)[2] + G * 1e-3), ROUND_OFF);
    run_free(&r);
}
END_TEST

/* The pull between equal bodies is eta/R, here 1.5 weights cold, 0.5 hot, and 2 (1.5)(0.5)/(1.5 + 0.5) between the two. */
START_TEST(a_pull_weakens_with_heat)
{
    static const struct { double held, free, pull; } cases[] = {{300, 300, 1.5}, {400, 400, 0.5}, {300, 400, 0.75}, {400, 300, 0.75}};
    const double weight = G * DENSITY * 4.0 / 3.0 * M_PI * RADIUS * RADIUS * RADIUS;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_put(s, 0, 0.0, 0.0, 2.0 * RADIUS, RADIUS);
        scene_put(s, 1, 0.0, 0.0, 0.0, RADIUS);
        scene_fix(s, 0);
        scene_warm(s, 0, cases[k].held);
        scene_warm(s, 1, cases[k].free);
        scene_gravity(s, 0.0, 0.0, -G);
        scene_material_value(s, 0, "adhesion", weight * RADIUS);
        scene_material_value(s, 0, "adhesion-change", 0.5 * weight * RADIUS);
        scene_material_value(s, 0, "transition-temperature", 350.0);
        scene_material_value(s, 0, "transition-width", 1.0);
        rigid(s, 0.0, 0.0, 1.0, 1e-4, NULL);
        scene_model1(s, CALX_CONTACT, "cohesion-thermal", "distance", 1e-4);
        struct run r = run_start(s, 1);
        run_steps(&r, 10);
        ck_assert_double_lt(fabs(run_v(&r, 1)[2] + fmax(0.0, 1.0 - cases[k].pull) * G * 1e-3), ROUND_OFF);
        run_free(&r);
    }
}
END_TEST

/* ---- heat ---- */

/* The weight of a ball opens the way for heat from the floor: H = 2 k a, a^3 = 3 W R/(4 E*); discs: H = 2 k sqrt(2 b L). */
START_TEST(contact_forces_conduct)
{
    const double k = 50.0, young = 1e9, poisson = 0.25, modulus = young / (2.0 * (1.0 - poisson * poisson));
    for (uint32_t bodies = CALX_SPHERES; bodies <= CALX_DISCS; bodies++) {
        struct calx_scene *s = incline(bodies, 0.0, 0.0, 1.0, 1e-3);
        scene_material_value(s, 0, "conductivity", k);
        scene_material_value(s, 0, "young", young);
        scene_material_value(s, 0, "poisson", poisson);
        scene_model(s, CALX_CONDUCTANCE, "hertz", NULL);
        scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
        scene_wall_temperature(s, 0, 393.15);
        struct run r = run_start(s, 1);
        double w = weight_of(&r, 1), spheres = 2.0 * k * cbrt(3.0 * w * RADIUS / (4.0 * modulus));
        double discs = 2.0 * k * pow(16.0 * w * RADIUS / (M_PI * modulus), 0.25);
        run_steps(&r, 2);
        double before = run_v(&r, 0)[7], capacity = run_mass(&r, 0) * 1000.0;
        run_steps(&r, 1);
        double flow = (run_v(&r, 0)[7] - before) * capacity / 1e-3;
        ck_assert_double_lt(fabs(flow / ((bodies == CALX_DISCS ? discs : spheres) * (393.15 - before)) - 1.0), 1e-8);
        run_free(&r);
    }
}
END_TEST

/* ---- refusals ---- */

START_TEST(laws_and_integrators_that_do_not_fit_are_refused)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "signorini-coulomb", NULL);
    scene_model(s, CALX_MOTION, "velocity-verlet", NULL);
    s->models[0].dt = 1e-3;
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'signorini-coulomb' is non-smooth") && strstr(e.text, "nscd"), "%s", e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    scene_linear_by(s, "nscd", 1e3, NAN, -1.0, 1e-3);
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'nscd' solves for impulses") && strstr(e.text, "signorini-coulomb") && strstr(e.text, "'linear'"), "%s",
                  e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    rigid(s, 0.0, 0.0, 1.0, 0.0, NULL);
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "no time step: rigid contacts") && strstr(e.text, "'nscd'"), "%s", e.text);
    s = scene_create(3, CALX_SPHERES, 1);
    scene_model(s, CALX_CONTACT, "cohesive", (struct given[]){{"pull", 1.0}, {"distance", 1e-3}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "nscd", NULL);
    s->models[0].dt = 1e-3;
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "'cohesive' needs a law that provides a normal force"), "%s", e.text);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {sweeps_are_those_of_the_theory, a_column_rests, a_warm_start_saves_sweeps,
                            impulses_end_with_their_cause,
                            over_relaxation_takes_columns_quickly, heavy_on_light_is_right_or_refused, descent_takes_columns_quickly,
                            a_ball_bounces_through_its_accumulation_point, an_impact_heats_both_bodies,
                            a_block_slides_above_the_critical_angle, spheres_and_discs_roll, sliding_ends, a_disc_lies_in_a_groove,
                            the_ledger_closes, solvers_agree_on_a_pile, momentum_stays_and_energy_does_not_grow, a_wedged_body_stops_the_run,
                            a_shaken_floor_carries_a_ball, a_pull_holds_what_is_lighter, a_pull_weakens_with_heat, contact_forces_conduct,
                            laws_and_integrators_that_do_not_fit_are_refused};
    return run_tests("nscd", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The solution of the contact problem where it is known: how many sweeps Gauss-Seidel takes, from nothing and from the last step's impulses,
 * with over-relaxation and by descent; heavy on light, walls that close in; that all ways agree on a pile.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/rigid.h"

/* The error after one step of so many sweeps from nothing. */
static double error_after(size_t n, double ratio, double sweeps)
{
    const struct given solver[] = {{"sweeps", sweeps}, {"unsolved", 1.0}, {"tolerance", 1e-14}, {"accuracy", 1e-14},
                                   {"order", 1.0}, {NULL, 0.0}};
    struct run r = run_start(rigid_column(n, ratio * DENSITY, 1e-3, solver), 1);
    run_steps(&r, 1);
    double error = rigid_worst_force(&r, n);
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

/* Starting from the impulses of the last step, a column at rest needs at least five times fewer sweeps. */
START_TEST(a_warm_start_saves_sweeps)
{
    double sweeps[2];
    for (int warm = 0; warm < 2; warm++) {
        struct run r = run_start(rigid_column(10, DENSITY, 1e-3, (struct given[]){{"warm-start", warm}, {NULL, 0.0}}), 1);
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
        struct calx_scene *s = rigid_column(10, DENSITY, 1e-3, (struct given[]){{"solver", descent}, {NULL, 0.0}});
        s->stages[0].duration = 0.01;
        size_t second = scene_stage(s);
        s->stages[second].duration = INFINITY;
        s->stages[second].gravity[2].value = 0.0;
        struct run r = run_start(s, 1);
        run_steps(&r, 20);
        ck_assert_double_lt(fabs(r.sim->wall_force[0][2]), 1e-9 * rigid_weight(&r, 10) + G * run_mass(&r, 0) * 1e-2);
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
        struct run r = run_start(rigid_column(n, DENSITY, 1e-3, (struct given[]){{"relaxation", omega}, {"tolerance", 1e-6}, {NULL, 0.0}}), 1);
        run_steps(&r, 1);
        ck_assert_double_lt(r.sim->sweeps, 5.0 * (double)n);
        ck_assert_double_lt(rigid_worst_force(&r, n), 1e-4);
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
            struct run r = run_start(rigid_column(2, ratio * DENSITY, 1e-3, (struct given[]){{"solver", descent}, {NULL, 0.0}}), 1);
            if (calx_sim_step(r.sim, &e) == 0)
                ck_assert_msg(rigid_worst_force(&r, 2) < 1e-3, "ratio %g: %g", ratio, rigid_worst_force(&r, 2));
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
        struct run r = run_start(rigid_column(n, DENSITY, 1e-3, (struct given[]){{"solver", 1.0}, {"accuracy", 1e-4}, {NULL, 0.0}}), 1);
        run_steps(&r, 1);
        ck_assert_msg(r.sim->sweeps < 10.0 * (double)n, "%zu bodies: %g iterations", n, r.sim->sweeps);
        ck_assert_double_lt(rigid_worst_force(&r, n), 1e-3);
        run_free(&r);
    }
}
END_TEST

/* A column is a chain, solved at once: with a heavy body on top too, where sweeps alone would need a million. What the residual (1e-10) leaves
 * adds up along the column. */
START_TEST(a_chain_is_solved_at_once)
{
    const struct given solver[] = {{"chains", 1.0}, {"warm-start", 0.0}, {"tolerance", 1e-10}, {"accuracy", 1e-10}, {NULL, 0.0}};
    static const struct { size_t n; double ratio; } columns[] = {{2, 1}, {3, 1}, {10, 1}, {160, 1}, {1000, 1}, {2, 1e6}, {10, 1e-6}, {50, 1e6}};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
        struct run r = run_start(rigid_column(columns[k].n, columns[k].ratio * DENSITY, 1e-3, solver), 1);
        run_steps(&r, 1);
        ck_assert_msg(r.sim->sweeps <= 3.0, "%zu bodies, ratio %g: %g sweeps", columns[k].n, columns[k].ratio, r.sim->sweeps);
        ck_assert_msg(rigid_worst_force(&r, columns[k].n) < 1e-10 * (double)columns[k].n, "%zu bodies, ratio %g: error %g", columns[k].n, columns[k].ratio,
                      rigid_worst_force(&r, columns[k].n));
        run_free(&r);
    }
}
END_TEST

/* Discs in a ring that all go for its middle stop each other, wherever the ring is cut. */
START_TEST(a_ring_is_a_chain_that_is_cut)
{
    enum { N = 12 };
    const struct given solver[] = {{"chains", 1.0}, {"tolerance", 1e-12}, {"accuracy", 1e-12}, {NULL, 0.0}};
    const double wide = RADIUS / sin(M_PI / N), speed = 0.1;
    struct calx_scene *s = scene_create(2, CALX_DISCS, N);
    for (size_t i = 0; i < N; i++) {
        double angle = 2.0 * M_PI * (double)i / N;
        scene_put(s, i, wide * cos(angle), wide * sin(angle), 0.0, RADIUS);
        scene_move(s, i, -speed * cos(angle), -speed * sin(angle), 0.0);
    }
    rigid_models(s, 0.0, 0.0, 1.0, 1e-5, solver);
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    for (int64_t i = 0; i < N; i++)
        for (size_t d = 0; d < 2; d++)
            ck_assert_double_lt(fabs(run_v(&r, i)[d]), 1e-9 * speed);
    run_free(&r);
}
END_TEST

/* Between a floor and a lid that both stay a column has one contact more than bodies, and elimination no pivot: sweeps find one of its solutions. */
START_TEST(a_chain_between_two_walls_is_left_to_sweeps)
{
    enum { N = 5 };
    struct calx_scene *s = rigid_column(N, DENSITY, 1e-3, (struct given[]){{"chains", 1.0}, {"tolerance", 1e-9}, {"accuracy", 1e-9}, {NULL, 0.0}});
    int lid = scene_wall(s, "lid", 0);
    scene_plane(s, lid, (double[3]){0, 0, 2.0 * N * RADIUS}, (double[3]){0, 0, -1});
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    double weight = rigid_weight(&r, N), carried = -r.sim->wall_force[0][2] - r.sim->wall_force[1][2];
    ck_assert_double_gt(r.sim->sweeps, 3.0);
    ck_assert_double_lt(fabs(carried / weight - 1.0), 1e-6);
    run_free(&r);
}
END_TEST

/* Sweeps in any order, with chains or without, and descent solve a pile with friction, to the same residual; the floor and the box carry its weight. */
START_TEST(solvers_agree_on_a_pile)
{
    static const struct { double solver, order, chains; } ways[] = {{1, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 0, 0}, {0, 2, 1}, {0, 0, 1}};
    enum { WAYS = sizeof ways / sizeof *ways };
    double height[WAYS];
    for (size_t way = 0; way < WAYS; way++) {
        struct calx_scene *s = rigid_pile(0.4, 0.0, G,
                                    (struct given[]){{"solver", ways[way].solver}, {"order", ways[way].order}, {"chains", ways[way].chains}, {"tolerance", 1e-3},
                                                     {"accuracy", 1e-2}, {NULL, 0.0}});
        rigid_box(s, 12.0 * RADIUS);
        rigid_floor(s);
        struct run r = run_start(s, 1);
        run_steps(&r, 1500);
        double sum = 0.0;
        for (int64_t i = 0; i < 125; i++)
            sum += run_mass(&r, i) * run_x(&r, i)[2];
        height[way] = sum;
        double *f = r.sim->wall_force[1], g[3] = {r.sim->wall_force[0][0], r.sim->wall_force[0][1], r.sim->wall_force[0][2]};
        ck_assert_double_lt(fabs(f[2] + g[2] + rigid_weight(&r, 125)), 1e-2 * rigid_weight(&r, 125)); /* it creeps to rest */
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
    rigid_floor(s);
    int lid = scene_wall(s, "lid", 0);
    scene_plane(s, lid, (double[3]){0, 0, 2.0 * RADIUS}, (double[3]){0, 0, -1});
    scene_motion(s, 0, lid)->velocity[2].value = -0.1;
    rigid_models(s, 0.3, 0.0, 1.0, 1e-3, NULL);
    struct run r = run_start(s, 1);
    ck_assert_int_eq(calx_sim_step(r.sim, &e), CALX_ERROR_PHYSICS);
    ck_assert_msg(strstr(e.text, "no solution") && strstr(e.text, "wedged") && strstr(e.text, "residual"), "%s", e.text);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {sweeps_are_those_of_the_theory, a_warm_start_saves_sweeps, impulses_end_with_their_cause,
                            over_relaxation_takes_columns_quickly, heavy_on_light_is_right_or_refused,
                            descent_takes_columns_quickly, a_chain_is_solved_at_once, a_ring_is_a_chain_that_is_cut,
                            a_chain_between_two_walls_is_left_to_sweeps, solvers_agree_on_a_pile, a_wedged_body_stops_the_run};
    return run_tests("nscd_solver", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Rigid groups as walls: a ring carries a grain as the round wall does; energy is booked between
 * two groups; what frames, the critical step and the guards make of their bodies.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double RADIUS = 0.1;

/* ---- a ring ---- */

enum { RING = 720 };
static const double INNER = 0.5, SMALL = 0.01, TURN = 1.0;

/* A grain that rolls at the bottom of a drum: a ring of bodies that overlap, or a round wall. */
static struct run drum(bool ring)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, ring ? RING + 1 : 1);
    scene_linear_by(s, "velocity-verlet", 1e6, 0.5, 0.5, 1e-4);
    scene_put(s, 0, 0.0, -(INNER - RADIUS), 0.0, RADIUS);
    scene_spin(s, 0, 0.0, 0.0, TURN * INNER / RADIUS);
    scene_gravity(s, 0.0, -9.81, 0.0);
    int wall = ring ? scene_group(s, "drum") : scene_wall(s, "drum", 0);
    for (size_t k = 1; ring && k <= RING; k++) {
        double angle = 2.0 * M_PI * (double)k / RING;
        scene_put(s, k, (INNER + SMALL) * cos(angle), (INNER + SMALL) * sin(angle), 0.0, SMALL);
        scene_carry(s, k, wall);
    }
    if (!ring)
        scene_primitive(
            s, wall,
            (struct calx_primitive){
                .shape = CALX_CYLINDER, .inside = true, .n = {0, 0, 1}, .radius = INNER});
    struct calx_motion *m = scene_motion(s, 0, wall);
    m->rate.value = TURN;
    m->axis[2] = 1.0;
    struct run r = run_start(s, 1);
    run_steps(&r, 2000);
    return r;
}

/* It rolls at the bottom: its spin is that of the surface, TURN INNER/RADIUS. On the ring, two or
 * three bodies bear it at a time, each x = 5 mm or less from below it, so that it approaches or
 * leaves them with v x/(RADIUS + SMALL) = 0.02 m/s: damping with c = 2400 kg/s dissipates some 2 to
 * 3 W, which the drum puts in at v = 0.5 m/s against the slope of 5 N/(m g) = 0.016 that the grain
 * is carried up. */
START_TEST(a_ring_carries_as_a_round_wall)
{
    struct run wall = drum(false), ring = drum(true);
    double spin = TURN * INNER / RADIUS, mean[2] = {0}, x[2] = {0};
    for (int k = 0; k < 1000; k++, run_steps(&ring, 10), run_steps(&wall, 10)) {
        mean[0] += 1e-3 * run_v(&wall, 0)[6];
        mean[1] += 1e-3 * run_v(&ring, 0)[6];
        x[0] += 1e-3 * run_x(&wall, 0)[0];
        x[1] += 1e-3 * run_x(&ring, 0)[0];
    }
    ck_assert_double_eq_tol(mean[0], spin, 0.01 * spin);
    ck_assert_double_eq_tol(mean[1], mean[0], 0.01 * spin);
    ck_assert_double_eq_tol(x[0], 0.0, 1e-3 * INNER);
    ck_assert_double_eq_tol(x[1], x[0], 0.025 * (INNER - RADIUS));
    ck_assert_double_lt(fabs(calx_sim_ledger(ring.sim).residual),
                        1e-3 * calx_sim_ledger(ring.sim).scale);
    run_free(&wall);
    run_free(&ring);
}
END_TEST

/* ---- between two groups ---- */

/* Residual of the ledger over its scale for a grain that two shaking bodies throw to and fro. */
static double residual(const char *integrator, double dt)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, 3);
    scene_linear_by(s, integrator, 1e6, 0.8, 0.2, dt);
    scene_put(s, 0, 0.001, 0.0, 0.0, RADIUS);
    scene_move(s, 0, 0.8, 0.02, 0.0);
    for (size_t k = 1; k <= 2; k++) {
        int group = scene_group(s, k == 1 ? "left" : "right");
        scene_put(s, k, k == 1 ? -0.205 : 0.205, 0.0, 0.0, RADIUS);
        scene_carry(s, k, group);
        struct calx_motion *m = scene_motion(s, 0, group);
        m->amplitude[0] = k == 1 ? 1e-3 : -2e-3;
        m->frequency = 20.0;
        m->phase = 0.3;
    }
    struct run r = run_start(s, 1);
    run_steps(&r, (size_t)lround(0.15 / dt));
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_double_gt(fabs(l.wall_work), 0.03 * l.scale);
    ck_assert_double_gt(l.dissipated, 0.1 * l.scale);
    double share = fabs(l.residual) / l.scale;
    run_free(&r);
    return share;
}

/* Works are booked by the trapezoid; damping begins at the moment of touching with a jump, which a
 * fixed step meets to first order: the residual goes down at least as the step does. */
START_TEST(energy_is_booked_between_two_groups)
{
    double coarse = residual("velocity-verlet", 4e-5), fine = residual("velocity-verlet", 5e-6);
    ck_assert_double_lt(coarse, 1e-4);
    ck_assert_double_lt(fine, coarse / 4.0);
    ck_assert_double_lt(residual("rk4", 4e-5), 2e-3);
    ck_assert_double_lt(residual("gear", 4e-5), 2e-3);
}
END_TEST

/* ---- looking ---- */

START_TEST(frames_tell_groups_apart)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, 4);
    scene_linear_by(s, "velocity-verlet", 1e5, 0.5, 0.3, 1e-4);
    scene_wall(s, "wall", 0);
    int a = scene_group(s, "a"), b = scene_group(s, "b");
    for (size_t i = 0; i < 4; i++)
        scene_put(s, i, 0.5 * (double)i, 0.0, 0.0, RADIUS);
    scene_carry(s, 1, b);
    scene_carry(s, 3, a);
    scene_gravity(s, 0.0, -9.81, 0.0);
    struct run r = run_start(s, 1);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    const int32_t expected[4] = {-1, 1, -1, 0};
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(f->group[i], expected[i]);
    calx_frame_free(f);
    run_free(&r);
}
END_TEST

/* A group may be driven no faster than bodies may go. */
START_TEST(a_group_that_is_too_fast_is_refused)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(2, CALX_DISCS, 2);
    scene_linear_by(s, "velocity-verlet", 1e5, 0.5, 0.3, 1e-4);
    scene_put(s, 1, 1.0, 0.0, 0.0, RADIUS);
    int group = scene_group(s, "arrow");
    scene_carry(s, 1, group);
    scene_put(s, 0, -1.0, 0.0, 0.0, RADIUS);
    scene_motion(s, 0, group)->velocity[0].value = 600.0;
    run_refused(s, &e);
    ck_assert_msg(strstr(e.text, "particle 1 moves"), "%s", e.text);
}
END_TEST

/* Small bodies of a group do not shorten the step: what limits it is a pair of grains, with the
 * reduced mass of half of one and velocity Verlet's limit omega dt = 2. */
START_TEST(a_body_of_a_group_has_no_mass_to_vibrate)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, 3);
    scene_linear_by(s, "velocity-verlet", 1e5, 1.0, -1.0, 0.0);
    s->models[0].dt_fraction = 0.5;
    int group = scene_group(s, "group");
    scene_put(s, 0, 0.0, 1.0, 0.0, RADIUS);
    for (size_t i = 1; i < 3; i++) {
        scene_put(s, i, 0.02 * (double)i, 0.0, 0.0, 0.1 * RADIUS);
        scene_carry(s, i, group);
    }
    struct run r = run_start(s, 1);
    double alone = 0.5 * run_mass(&r, 0); /* two grains */
    ck_assert_double_eq_tol(r.sim->plan->critical_dt, 2.0 * sqrt(alone / 1e5), 1e-12);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {a_ring_carries_as_a_round_wall, energy_is_booked_between_two_groups,
                            frames_tell_groups_apart, a_body_of_a_group_has_no_mass_to_vibrate,
                            a_group_that_is_too_fast_is_refused};
    return run_tests("group_walls", sizeof tests / sizeof *tests, tests);
}

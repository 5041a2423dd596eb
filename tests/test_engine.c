/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What breaks such programs: coincident centres, steps that are too long, deep overlaps and wild
 * speeds; contacts that cross a periodic border or turn with the bodies; coordinates far from the
 * origin; stages that change gravity and walls.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double RADIUS = 0.01, STIFFNESS = 1e4;

static double mass_of(double radius)
{
    return 4.0 / 3.0 * M_PI * pow(radius, 3.0) * 1000.0;
}

/* A step with n of them in an impact of two equal grains. */
static double step_for(double n)
{
    return M_PI * sqrt(0.5 * mass_of(RADIUS) / STIFFNESS) / n;
}

static struct calx_scene *pair(double distance, double friction, double n)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, STIFFNESS, NAN, friction, step_for(n));
    scene_put(s, 0, 0.0, 0.0, 0.0, RADIUS);
    scene_put(s, 1, distance, 0.0, 0.0, RADIUS);
    return s;
}

/* ---- what is refused ---- */

static void refused_with(struct calx_scene *s, enum calx_code code, const char *const *words)
{
    struct calx_error e = {0};
    run_refused(s, &e);
    ck_assert_int_eq(e.code, code);
    for (; *words; words++)
        ck_assert_msg(strstr(e.text, *words) != NULL, "no '%s' in: %s", *words, e.text);
    ck_assert_msg(!strstr(e.text, "nan"), "%s", e.text);
}

START_TEST(overlaps_at_the_start)
{
    refused_with(pair(0.0, 0.5, 50), CALX_ERROR_PHYSICS,
                 (const char *[]){"particle 0", "particle 1", "200 %", NULL});
    refused_with(pair(1.4 * RADIUS, -1, 50), CALX_ERROR_PHYSICS,
                 (const char *[]){"particle 0", "particle 1", "60 %", NULL});
    struct calx_scene *s = pair(1.0, -1, 50);
    scene_plane(s, scene_wall(s, "lid", 0), (double[3]){0.0, 0.3 * RADIUS, 0.0},
                (double[3]){0, -1, 0});
    refused_with(s, CALX_ERROR_PHYSICS, (const char *[]){"wall 'lid'", "70 %", NULL});
    /* through the periodic border: both are named by their own ids */
    for (int swap = 0; swap < 4; swap++) {
        s = scene_create(3, CALX_SPHERES, 3);
        scene_material(s, "other", 1000.0, 1000.0);
        s->particles.material[swap & 2 ? 2 : 0] = 1;
        scene_linear(s, STIFFNESS, NAN, -1.0, step_for(50));
        scene_put(s, 0, swap & 1 ? 0.998 : 0.002, 0.0, 0.0, RADIUS);
        scene_put(s, 1, 0.5, 0.0, 0.0, RADIUS);
        scene_put(s, 2, swap & 1 ? 0.002 : 0.998, 0.0, 0.0, RADIUS);
        scene_extent(s, 0, 0.0, 1.0, 'p');
        refused_with(s, CALX_ERROR_PHYSICS, (const char *[]){"particle 0", "particle 2", NULL});
    }
    s = pair(0.001, -1, 50); /* two fixed grains may overlap: nothing acts between them */
    scene_fix(s, 0);
    scene_fix(s, 1);
    struct run r = run_start(s, 1);
    run_steps(&r, 3);
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    run_free(&r);
}
END_TEST

/* Walls that move about an empty scene: nothing to compute, and nothing fails. */
START_TEST(no_grains_at_all)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 0);
    scene_linear(s, STIFFNESS, NAN, 0.5, 1e-4);
    int w = scene_wall(s, "drum", 0);
    scene_primitive(s, w,
                    (struct calx_primitive){
                        .shape = CALX_CYLINDER, .inside = true, .n = {0, 0, 1}, .radius = 0.5});
    scene_motion(s, 0, w)->rate.value = 2.0;
    struct run r = run_start(s, 2);
    run_steps(&r, 600);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    ck_assert_ptr_nonnull(f);
    ck_assert_uint_eq(f->n + f->contact_count, 0);
    ck_assert_double_eq(calx_sim_ledger(r.sim).residual, 0.0);
    calx_frame_free(f);
    run_free(&r);
}
END_TEST

/* The limit is 2/omega with omega = sqrt(k/m*): pi/2 steps per contact. */
START_TEST(unstable_steps)
{
    refused_with(pair(1.0, -1, 0.99 * M_PI / 2.0), CALX_ERROR_INPUT,
                 (const char *[]){"stability limit", "dt", NULL});
    struct run r = run_start(pair(1.0, -1, 1.01 * M_PI / 2.0), 1);
    run_free(&r);
    struct calx_scene *s = pair(1.0, -1, 50);
    s->models[0].dt = 0.0;
    s->models[0].dt_fraction = 0.1;
    r = run_start(s, 1);
    ck_assert_double_eq_tol(calx_sim_dt(r.sim) * sqrt(STIFFNESS / (0.5 * mass_of(RADIUS))), 0.2,
                            1e-12);
    run_free(&r);
}
END_TEST

START_TEST(wild_speeds)
{
    struct calx_error e = {0};
    struct calx_scene *s = pair(1.0, -1, 50);
    scene_move(s, 1, 0.0, 0.51 * RADIUS / step_for(50),
               0.0); /* half a radius a step is the limit */
    struct run r = run_start(s, 1);
    int code = 0;
    for (int k = 0; k < 3 && !code; k++)
        code = calx_sim_step(r.sim, &e);
    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
    ck_assert_ptr_nonnull(strstr(e.text, "particle 1 moves"));
    run_free(&r);
}
END_TEST

/* ---- periodic borders ---- */

enum { MEETINGS = 6, CROSSING = 4000 };

/* Grains in a periodic box collide and rub on a floor, shifted by `shift` along x; the lists last
 * until grains have moved by the skin. */
static struct run crossing(double shift, double skin)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, MEETINGS);
    scene_linear(s, STIFFNESS, 0.8, 0.5, step_for(50));
    scene_extent(s, 0, 0.0, 0.125, 'p');
    scene_extent(s, 2, 0.0, 0.125, 'p');
    for (size_t i = 0; i < MEETINGS; i++) {
        double x = 0.02 * (double)i + shift;
        scene_put(s, i, x - (x >= 0.125 ? 0.125 : 0.0), 1.0005 * RADIUS,
                  0.0625 + 0.004 * (double)(i % 2), RADIUS);
        scene_move(s, i, 1.0 + 0.5 * (double)(i % 3), -0.1, 0.05 * (double)(i % 2));
        scene_spin(s, i, 3.0, 2.0, -5.0);
    }
    s->skin = skin;
    scene_gravity(s, 0.3, -9.81, 0.1);
    scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    return run_start(s, 1);
}

/* Half a box away and with lists that last three hundred times as long, the same things happen:
 * positions round by the last bit of 0.125 m, and the collisions let errors grow. A contact that
 * lost its friction at the border, or when lists are made anew in nearly every step, would differ
 * in the first digits. */
START_TEST(borders_do_not_matter)
{
    const double bound = 1e-9;
    struct run here = crossing(0.0, 1e-5), there = crossing(0.0625, 3e-3);
    size_t borders = 0;
    for (int k = 0; k < CROSSING; k++) { /* contacts between grains that reach through the border */
        run_steps(&here, 1);
        run_steps(&there, 1);
        for (size_t p = 0; p < here.sim->pairs.places; p++)
            borders += calx_pair_touches(here.sim, p) && here.sim->r.source &&
                       calx_row_of_place(here.sim->pairs.j[p]) >= MEETINGS;
    }
    ck_assert_int_gt(here.sim->rebuilds, CROSSING / 4);
    ck_assert_int_lt(there.sim->rebuilds, CROSSING / 20);
    ck_assert_uint_gt(borders, 20);
    for (int64_t i = 0; i < MEETINGS; i++) {
        const double *x = run_x(&here, i), *y = run_x(&there, i), *v = run_v(&here, i),
                     *w = run_v(&there, i);
        double dx = fmod(y[0] - x[0] + 1.0, 0.125) - 0.0625;
        ck_assert_msg(fabs(dx) + fabs(y[1] - x[1]) < bound * 0.125, "grain %lld is off by %g m",
                      (long long)i, dx);
        for (int k = 0; k < 7; k++)
            if (k != 3)
                ck_assert_msg(fabs(v[k] - w[k]) < bound * (k < 3 ? 1.0 : 1.0 / RADIUS),
                              "grain %lld, speed %d: %.15g, %.15g", (long long)i, k, v[k], w[k]);
    }
    run_free(&here);
    run_free(&there);
}
END_TEST

enum { FLOCK = 27 };

/* Grains that collide and rub in a periodic box, seen from a frame in which all fly with `drift`
 * m/s along each axis. */
static struct run flock(double drift)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, FLOCK);
    struct calx_random random;
    calx_random_seed(&random, 2);
    scene_linear(s, STIFFNESS, 0.8, 0.5, step_for(50));
    for (size_t i = 0; i < FLOCK; i++) {
        double u[6];
        for (int k = 0; k < 6; k++)
            u[k] = 2.0 * calx_random_uniform(&random) - 1.0;
        scene_put(s, i, 0.04 * (double)(i % 3), 0.04 * (double)(i / 3 % 3), 0.04 * (double)(i / 9),
                  RADIUS);
        scene_move(s, i, 2.0 * u[0] + drift, 2.0 * u[1] - 0.7 * drift, 2.0 * u[2] + 0.4 * drift);
        scene_spin(s, i, 100.0 * u[3], 100.0 * u[4], 100.0 * u[5]);
    }
    for (int k = 0; k < 3; k++)
        scene_extent(s, k, 0.0, 0.125, 'p');
    s->skin = 0.3 * RADIUS; /* narrow: many rebuilds are what is tested */
    return run_start(s, 1);
}

/* In flight, a contact passes several cells of the order of grains, and borders, while it lasts:
 * its two bodies change places in the lists. Nothing else may change: speeds of 40 m/s round 1e2
 * times as coarsely, and each collision of grains that are a few radii apart lets errors grow
 * tenfold: measured 1e-8; friction that changed sign would be seen in the first digit. */
START_TEST(a_common_flight_does_not_matter)
{
    const double bound = 1e-6, drift = 40.0;
    struct run rest = flock(0.0), flight = flock(drift);
    run_steps(&rest, CROSSING);
    run_steps(&flight, CROSSING);
    struct calx_ledger l = calx_sim_ledger(rest.sim);
    ck_assert_double_gt(l.dissipated, 0.1 * l.scale); /* they did collide */
    ck_assert_int_gt(flight.sim->rebuilds, CROSSING / 4);
    for (int64_t i = 0; i < FLOCK; i++) {
        const double *v = run_v(&rest, i), *w = run_v(&flight, i),
                     common[3] = {drift, -0.7 * drift, 0.4 * drift};
        for (int k = 0; k < 7; k++)
            if (k != 3 && fabs(w[k] - (k < 3 ? common[k] : 0.0) - v[k]) >
                              bound * (k < 3 ? 1.0 : 1.0 / RADIUS))
                ck_abort_msg("grain %lld, speed %d: %.12g at rest, %.12g in flight", (long long)i,
                             k, v[k], w[k]);
    }
    run_free(&rest);
    run_free(&flight);
}
END_TEST

/* ---- turning with the bodies ---- */

/* Where both grains are now and were a step ago gives their speeds; the spin is that of a chord, so
 * that they turn as one rigid body. */
static void place(const struct run *r, const double to[2][3], const double spin[3])
{
    double dt = calx_sim_dt(r->sim);
    for (int64_t i = 0; i < 2; i++) {
        double *x = (double *)run_x(r, i), *v = (double *)run_v(r, i);
        for (int k = 0; k < 3; k++) {
            v[k] = (to[i][k] - x[k]) / dt;
            x[k] = to[i][k];
            v[4 + k] = spin[k];
        }
    }
    r->sim->lag = 0.5 * dt; /* as in a step of velocity Verlet */
    r->sim->engine->block_forces(r->sim, 0, &(struct calx_pass){.dt = dt, .stage = -1}, r->sim->r.a);
}

/* p turned by `angle` about the unit axis u through the origin (Rodrigues). */
static void turned(const double p[3], const double u[3], double angle, double out[3])
{
    double along = p[0] * u[0] + p[1] * u[1] + p[2] * u[2];
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = p[k] * cos(angle) + (u[a] * p[b] - u[b] * p[a]) * sin(angle) +
                 u[k] * along * (1.0 - cos(angle));
    }
}

/* A loaded contact is turned by 360 degrees in 1e4 steps about an axis across it: friction turns
 * with it and keeps its size. The normal half way is exact for a chord: what remains is rounding of
 * 1e4 steps, and the slide of 1e-5 m beside coordinates of 2e-2 m. */
START_TEST(friction_turns_with_the_bodies)
{
    enum { TURN = 10000 };
    const double gap = 1.99 * RADIUS, slide = 1e-5, none[3] = {0},
                 bound = 1e-9; /* the design asks for 1e-6 */
    const double from[3] = {gap, slide, -0.5 * slide},
                 distance = sqrt(gap * gap + 1.25 * slide * slide);
    for (int way = 1; way < 3; way++) {
        struct run r = run_start(pair(gap, 100.0, 50), 1);
        const double *ft[3];
        double start[3], at[2][3] = {{0}}, delta = 2.0 * M_PI / TURN, spin[3], axis[3], expected[3],
                         worst = 0.0;
        for (int k = 1; k <= 10; k++) /* load it along both directions of the plane of contact */
            place(&r, (const double[2][3]){{0, 0, 0}, {gap, 0.1 * slide * k, -0.05 * slide * k}},
                  none);
        for (size_t q = 0; q < 3; q++) {
            ft[q] = calx_group_history(r.sim, r.sim->groups, q);
            start[q] = *ft[q];
        }
        double size = sqrt(start[0] * start[0] + start[1] * start[1] + start[2] * start[2]),
               across = from[way] / distance;
        ck_assert_double_eq_tol(size / (2.0 / 7.0 * STIFFNESS * slide * sqrt(1.25)), 1.0,
                                slide / gap);
        for (int k = 0; k < 3; k++)
            axis[k] = ((k == way) - across * from[k] / distance) / sqrt(1.0 - across * across);
        for (int k = 0; k < 3; k++)
            spin[k] = axis[k] * 2.0 * sin(0.5 * delta) / calx_sim_dt(r.sim);
        for (int k = 1; k <= TURN; k++) {
            turned(from, axis, delta * k, at[1]);
            turned(start, axis, delta * k, expected);
            place(&r, (const double(*)[3])at, spin);
            for (int q = 0; q < 3; q++)
                worst = fmax(worst, fabs(*ft[q] - expected[q]) / size);
        }
        ck_assert_msg(worst < bound, "axis %d: friction is off by %g", way, worst);
        run_free(&r);
    }
}
END_TEST

/* ---- far from the origin ---- */

/* Moved by 1e6 radii, forces change by what the coordinates round: k times two last bits, and
 * nothing more. */
START_TEST(far_away_is_as_here)
{
    enum { HEAP = 27 };
    const double far_ = 1e6 * RADIUS, bit = nextafter(far_, 2.0 * far_) - far_;
    double force[2][HEAP][3];
    for (int moved = 0; moved < 2; moved++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, HEAP);
        scene_linear(s, STIFFNESS, NAN, -1.0, step_for(50));
        for (size_t i = 0; i < HEAP; i++)
            scene_put(s, i, moved * far_ + 1.95 * RADIUS * (double)(i % 3),
                      moved * far_ + 1.96 * RADIUS * (double)(i / 3 % 3),
                      -moved * far_ + 1.97 * RADIUS * (double)(i / 9), RADIUS);
        struct run r = run_start(s, 1);
        struct calx_frame *f = calx_frame_create(r.sim, false);
        memcpy(force[moved], f->force, sizeof force[moved]);
        calx_frame_free(f);
        run_free(&r);
    }
    double largest = 0.0, worst = 0.0;
    for (int i = 0; i < HEAP; i++)
        for (int k = 0; k < 3; k++) {
            largest = fmax(largest, fabs(force[0][i][k]));
            worst = fmax(worst, fabs(force[1][i][k] - force[0][i][k]));
        }
    ck_assert_double_gt(largest, 0.02 * STIFFNESS * RADIUS);
    /* up to six contacts, each of two coordinates that round by half a bit, and as much again in
     * the direction */
    ck_assert_msg(worst < 12.0 * STIFFNESS * bit, "%g N of %g", worst, 12.0 * STIFFNESS * bit);
}
END_TEST

/* ---- stages ---- */

/* Gravity turns, then a wall starts and stops: what a change of gravity does to the potential
 * energy is work from outside, and the ledger closes. */
START_TEST(stages_hand_over)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    const double n = 50.0, bounds[3] = {0.1, 0.2, 0.3};
    scene_linear(s, STIFFNESS, 0.7, 0.4, step_for(n));
    scene_put(s, 0, 0.0, 1.5 * RADIUS, 0.0, RADIUS);
    scene_put(s, 1, 0.1, 2.0 * RADIUS, 0.0, RADIUS);
    scene_move(s, 0, 0.3, 0.0, 0.0);
    scene_gravity(s, 0.0, -9.81, 0.0);
    int w = scene_wall(s, "floor", 0);
    scene_plane(s, w, (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    s->stages[0].duration = bounds[0];
    size_t second = scene_stage(s), third = scene_stage(s);
    s->stages[second].gravity[0].value = 5.0;
    scene_motion(s, second, w)->velocity[1].value = 0.2;
    s->stages[third].motion[w].moves = false;
    s->stages[third].gravity[0].value = 0.0;
    struct run r = run_start(s, 1);
    int began = 0;
    double worst = 0.0;
    while (!calx_sim_done(r.sim)) {
        run_steps(&r, 1);
        began += calx_sim_stage_began(r.sim);
        worst = fmax(worst, fabs(calx_sim_ledger(r.sim).residual));
    }
    ck_assert_int_eq(began, 3);
    ck_assert_double_eq_tol(calx_sim_time(r.sim), bounds[2],
                            1.5 * calx_sim_dt(r.sim)); /* each stage ends at the nearest step */
    ck_assert_double_eq_tol(r.sim->posed[0].p.a[1], 0.2 * 0.1, 0.2 * calx_sim_dt(r.sim));
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_double_gt(fabs(l.gravity_work), 0.01 * l.scale);
    ck_assert_msg(worst < 0.5 * pow(M_PI / n, 2) * l.scale, "residual %g of %g J", worst, l.scale);
    run_free(&r);
}
END_TEST

/* Three spheres that meet and rub with friction, without damping. `change`: in the middle of it models come that are the same, or that have a
 * step of half the length. */
static struct run rubbed(double change, double end)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 3);
    scene_linear(s, STIFFNESS, NAN, 0.4, step_for(100.0));
    for (size_t i = 0; i < 3; i++)
        scene_put(s, i, 1.977 * RADIUS * (double)i, i == 1 ? 0.3 * RADIUS : 0.0, 0.0, RADIUS);
    scene_move(s, 0, 0.2, 0.1, 0.05);
    scene_move(s, 2, -0.2, 0.0, -0.1);
    s->stages[0].duration = end;
    if (change > 0.0) {
        s->stages[0].duration = 0.4 * end;
        size_t second = scene_stage(s);
        s->stages[second].duration = 0.6 * end;
        scene_models_anew(s, second)->dt *= change;
    }
    struct run r = run_start(s, 1);
    while (!calx_sim_done(r.sim))
        run_steps(&r, 1);
    return r;
}

/* Other models with the same contact laws take contacts over as they are, with their tangential springs: the same models change nothing but
 * roundings, half the step what half the step does, of second order. */
START_TEST(contacts_go_on_under_new_models)
{
    const double end = 40.0 * step_for(100.0);
    struct run whole = rubbed(0.0, end), same = rubbed(1.0, end), finer = rubbed(0.5, end);
    ck_assert_int_eq(calx_sim_stage(same.sim), 1);
    ck_assert_uint_eq(calx_sim_contact_count(whole.sim), 2);
    for (int64_t i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(run_v(&same, i)[k], run_v(&whole, i)[k], 1e-14);
            ck_assert_double_eq_tol(run_v(&finer, i)[k], run_v(&whole, i)[k], 0.2 * pow(M_PI / 100.0, 2));
        }
    run_free(&whole);
    run_free(&same);
    run_free(&finer);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {overlaps_at_the_start,
                            no_grains_at_all,
                            unstable_steps,
                            wild_speeds,
                            borders_do_not_matter,
                            a_common_flight_does_not_matter,
                            friction_turns_with_the_bodies,
                            far_away_is_as_here,
                            stages_hand_over,
                            contacts_go_on_under_new_models};
    return run_tests("engine", sizeof tests / sizeof *tests, tests);
}

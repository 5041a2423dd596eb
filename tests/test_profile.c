/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Profiles against closed forms: solid fraction of slices of lattices, virial of a contact, stress under a column's weight, velocities of a
 * uniform shear, means over a window of a free fall; across periodic borders; with equal bits for any number of threads, when a run
 * stops within a window, and whoever looks at the state in between.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double ROUNDING = 1e-13;

/* A profile of one-sample windows every `every`; returns it to be changed. */
static struct calx_profile *add_profile(struct calx_scene *s, int axis, size_t layers, const double low[3], const double high[3],
                                        double every)
{
    s->profiles = realloc(s->profiles, (s->profile_count + 1) * sizeof *s->profiles);
    ck_assert_ptr_nonnull(s->profiles);
    struct calx_profile *p = &s->profiles[s->profile_count++];
    *p = (struct calx_profile){.name = "test", .axis = axis, .layers = layers, .every = every, .over = every};
    memcpy(p->low, low, sizeof p->low);
    memcpy(p->high, high, sizeof p->high);
    return p;
}

/* ---- solid fraction ---- */

enum { EDGE = 3, CELLS = EDGE * EDGE * EDGE };
static const double RADIUS = 0.4;

/* A simple cubic lattice of spacing 1, or a square one of discs, periodic, in which it drifts by `shift`. */
static struct calx_scene *lattice(uint32_t dimension, double shift)
{
    size_t n = dimension == 2 ? EDGE * EDGE : CELLS;
    struct calx_scene *s = scene_create(dimension, dimension == 2 ? CALX_DISCS : CALX_SPHERES, n);
    scene_linear(s, 1e3, NAN, -1.0, 1e-3);
    for (size_t i = 0; i < n; i++)
        scene_put(s, i, (double)(i % EDGE) + shift, (double)(i / EDGE % EDGE) + shift,
                  dimension == 2 ? 0.0 : (double)(i / EDGE / EDGE) + shift, RADIUS);
    for (int k = 0; k < (int)dimension; k++)
        scene_extent(s, k, 0.0, EDGE, 'p');
    return s;
}

/* Volume between two planes at a and b from the centre of a ball, by Simpson's rule, which is exact for the area pi (R^2 - u^2); of a disc
 * of thickness 1 by the midpoint rule in the angle, u = R sin t, exact to rounding with so many points over a full period. */
static double simpson_ball(double a, double b)
{
    double m = 0.5 * (a + b), r2 = RADIUS * RADIUS;
    return M_PI * (b - a) / 6.0 * ((r2 - a * a) + 4.0 * (r2 - m * m) + (r2 - b * b));
}

static double sum_disc(double a, double b)
{
    enum { POINTS = 20000 };
    double from = asin(a / RADIUS), to = asin(b / RADIUS), sum = 0.0, h = (to - from) / POINTS;
    for (int k = 0; k < POINTS; k++) {
        double c = RADIUS * cos(from + h * (k + 0.5));
        sum += 2.0 * c * c * h;
    }
    return sum;
}

/* Layers of 0.3, so that ten of them make a period: spheres centred at 0.1 + k span up to four of them, unequally. */
static void check_lattice(uint32_t dimension, double (*volume)(double, double), double tolerance)
{
    enum { LAYERS = 10 };
    double shift = 0.1, h = 0.3, all = 0.0;
    struct calx_scene *s = lattice(dimension, shift);
    double z = dimension == 2 ? 0.5 : EDGE;
    int axis = dimension == 2 ? 1 : 2;
    add_profile(s, axis, LAYERS, (double[3]){0, 0, dimension == 2 ? -z : 0}, (double[3]){EDGE, EDGE, z}, 1e-3);
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    struct calx_profile_view v = calx_sim_profile(r.sim, 0);
    ck_assert_int_eq(v.windows, 1);
    for (int k = 0; k < LAYERS; k++) {
        double expected = 0.0;
        for (int plane = -1; plane <= EDGE; plane++) {
            double centre = shift + plane, a = fmax(h * k - centre, -RADIUS), b = fmin(h * (k + 1) - centre, RADIUS);
            expected += a < b ? volume(a, b) * (dimension == 2 ? 1.0 / (EDGE * h) * EDGE : 1.0 / h) : 0.0;
        }
        ck_assert_double_eq_tol(v.layers[k].solid_fraction, expected, tolerance);
        ck_assert_double_eq_tol(v.layers[k].position, h * (k + 0.5), ROUNDING);
        all += v.layers[k].solid_fraction / LAYERS;
    }
    double whole = dimension == 2 ? M_PI * RADIUS * RADIUS : 4.0 / 3.0 * M_PI * pow(RADIUS, 3);
    ck_assert_double_eq_tol(all, whole, ROUNDING);
    run_free(&r);
}

START_TEST(solid_fraction_of_slices_is_exact)
{
    check_lattice(3, simpson_ball, ROUNDING);
    check_lattice(2, sum_disc, 1e-8); /* the sum's own error: h^2 */
}
END_TEST

/* ---- velocities ---- */

/* Planes move with SHEAR z along x; layers of half a spacing with the planes in their middle, and so others between them. */
START_TEST(uniform_shear_is_exact)
{
    static const double SHEAR = 2.0;
    struct calx_scene *s = lattice(3, 0.5);
    for (size_t i = 0; i < CELLS; i++) {
        scene_move(s, i, SHEAR * s->particles.position[i][2], 0.1, 0.0);
        scene_warm(s, i, 300.0 + 10.0 * s->particles.position[i][2]);
    }
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 1.0);
    add_profile(s, 2, EDGE, (double[3]){0}, (double[3]){EDGE, EDGE, EDGE}, 1e-3);
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    struct calx_profile_view v = calx_sim_profile(r.sim, 0);
    for (int k = 0; k < EDGE; k++) {
        ck_assert_double_eq_tol(v.layers[k].velocity[0], SHEAR * (k + 0.5), ROUNDING);
        ck_assert_double_eq_tol(v.layers[k].velocity[1], 0.1, ROUNDING);
        ck_assert_double_lt(v.layers[k].fluctuation[0], 1e-7); /* the root of a difference of rounding */
        ck_assert_double_eq_tol(v.layers[k].temperature, 300.0 + 10.0 * (k + 0.5), 1e-10);
        for (int q = 0; q < 9; q++) {
            ck_assert_double_eq_tol(v.layers[k].contact_stress[q], 0.0, 0.0 + 1e-300);
            ck_assert_double_eq_tol(v.layers[k].kinetic_stress[q], 0.0, 1e-9); /* of rho v^2 = 1e4 */
        }
    }
    run_free(&r);
}
END_TEST

/* A body that falls, in one layer: mean and spread of g t over the samples of a window, the second one. */
START_TEST(a_window_averages_its_samples)
{
    enum { SAMPLES = 8, EVERY = 5 };
    static const double G = 10.0, DT = 1e-3;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_linear(s, 1e3, NAN, -1.0, DT);
    scene_gravity(s, 0.0, 0.0, -G);
    struct calx_profile *p =
        add_profile(s, 2, 1, (double[3]){-2, -2, -2}, (double[3]){2, 2, 2}, EVERY * DT);
    p->over = SAMPLES * EVERY * DT;
    p->after = 2 * DT;
    struct run r = run_start(s, 1);
    run_steps(&r, 2 + 2 * SAMPLES * EVERY - 1);
    ck_assert_int_eq(calx_sim_profile(r.sim, 0).windows, 1);
    run_steps(&r, 1);
    struct calx_profile_view v = calx_sim_profile(r.sim, 0);
    ck_assert_int_eq(v.windows, 2);
    ck_assert_double_eq_tol(v.end, (2 + 2 * SAMPLES * EVERY) * DT, ROUNDING);
    double mean = 0.0, square = 0.0;
    for (int k = SAMPLES + 1; k <= 2 * SAMPLES; k++)
        mean += G * DT * (2 + EVERY * k) / SAMPLES;
    for (int k = SAMPLES + 1; k <= 2 * SAMPLES; k++)
        square += pow(G * DT * (2 + EVERY * k) - mean, 2) / SAMPLES;
    ck_assert_double_eq_tol(v.layers[0].velocity[2], -mean, ROUNDING);
    ck_assert_double_eq_tol(v.layers[0].fluctuation[2], sqrt(square), 1e-12);
    double volume = 4.0 / 3.0 * M_PI; /* fluctuations in time are a stress too: rho phi <v'^2> */
    ck_assert_double_eq_tol(v.layers[0].kinetic_stress[8], 1000.0 * volume * square / 64.0, 1e-9);
    run_free(&r);
}
END_TEST

/* ---- stress ---- */

/* Two bodies that overlap by DEPTH along a slanting line, at rest: one layer around both holds f x l / V, with f = k DEPTH; two layers with a
 * border at the middle of the branch have half of it each; the body apart has none. */
START_TEST(two_bodies_in_contact_have_their_virial)
{
    static const double K = 1e4, DEPTH = 0.01, DT = 1e-9;
    const double n[3] = {0.48, 0.6, 0.64}, l = 2.0 - DEPTH, volume = 8.0 * 8.0 * 8.0;
    for (size_t layers = 1; layers <= 2; layers++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_linear(s, K, NAN, -1.0, DT);
        for (size_t i = 0; i < 2; i++)
            scene_put(s, i, (i ? -0.5 : 0.5) * l * n[0], (i ? -0.5 : 0.5) * l * n[1], (i ? -0.5 : 0.5) * l * n[2], 1.0);
        add_profile(s, 1, layers, (double[3]){-4, -4, -4}, (double[3]){4, 4, 4}, DT);
        struct run r = run_start(s, 1);
        run_steps(&r, 1);
        struct calx_profile_view v = calx_sim_profile(r.sim, 0);
        for (size_t k = 0; k < layers; k++) {
            for (int q = 0; q < 9; q++)
                ck_assert_double_eq_tol(v.layers[k].contact_stress[q], K * DEPTH * l * n[q / 3] * n[q % 3] / volume,
                                        1e-12 * K * DEPTH);
            ck_assert_double_eq_tol(v.layers[k].coordination, 1.0, ROUNDING);
        }
        run_free(&r);
    }
}
END_TEST

/* A column at rest on a floor, each contact with the overlap that carries the weight above it: in a layer between two centres the stress
 * is that weight over the area, also across a periodic border beside it; below the lowest centre that of all. */
START_TEST(a_column_bears_its_weight)
{
    enum { COLUMN = 5 };
    static const double K = 1e9, G = 10.0, AREA = 25.0, DT = 1e-9;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, COLUMN);
    scene_linear(s, K, NAN, -1.0, DT);
    scene_gravity(s, 0.0, 0.0, -G);
    scene_extent(s, 0, 0.0, 5.0, 'p');
    scene_extent(s, 1, 0.0, 5.0, 'p');
    int floor_ = scene_wall(s, "floor", 0);
    scene_plane(s, floor_, (double[3]){0}, (double[3]){0, 0, 1});
    double mass = 4.0 / 3.0 * M_PI * 1000.0, centre[COLUMN], z = 0.0;
    for (size_t i = 0; i < COLUMN; i++) {
        z += (i ? 2.0 : 1.0) - mass * G * (double)(COLUMN - i) / K;
        centre[i] = z;
        scene_put(s, i, 0.1, 1.5, z, 1.0);
    }
    /* ten layers per spacing, nearly: those that a centre lies in are not looked at */
    add_profile(s, 2, 50, (double[3]){0}, (double[3]){5, 5, 10}, DT);
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    struct calx_profile_view v = calx_sim_profile(r.sim, 0);
    int seen = 0;
    for (int k = 0; k < 50; k++) {
        double low = 0.2 * k, high = 0.2 * (k + 1);
        size_t above = 0;
        bool cut = false;
        for (size_t i = 0; i < COLUMN; i++) {
            above += centre[i] > high;
            cut |= centre[i] >= low && centre[i] <= high;
        }
        if (cut)
            continue;
        seen++;
        ck_assert_double_eq_tol(v.layers[k].contact_stress[8], mass * G * (double)above / AREA, 1e-6 * mass * G / AREA);
        ck_assert_double_eq_tol(v.layers[k].contact_stress[0], 0.0, ROUNDING);
    }
    ck_assert_int_ge(seen, 40);
    run_free(&r);
}
END_TEST

/* A contact through the periodic border along the axis counts on both sides of it. */
START_TEST(a_contact_across_the_border_counts_on_both_sides)
{
    static const double K = 1e4, DEPTH = 0.01, DT = 1e-9;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, K, NAN, -1.0, DT);
    scene_extent(s, 2, 0.0, 10.0, 'p');
    scene_put(s, 0, 0.0, 0.0, 0.5, 1.0);
    scene_put(s, 1, 0.0, 0.0, 8.5 + DEPTH, 1.0);
    add_profile(s, 2, 10, (double[3]){-2, -2, 0}, (double[3]){2, 2, 10}, DT);
    struct run r = run_start(s, 1);
    run_steps(&r, 1);
    struct calx_profile_view v = calx_sim_profile(r.sim, 0);
    double f = K * DEPTH / 16.0;
    double expected[10] = {0.5 * f, 0, 0, 0, 0, 0, 0, 0, (0.5 - DEPTH) * f, f};
    for (int k = 0; k < 10; k++)
        ck_assert_double_eq_tol(v.layers[k].contact_stress[8], expected[k], 1e-9 * f);
    run_free(&r);
}
END_TEST

/* Bodies of groups count only if asked for; their contacts with grains do in any case. */
START_TEST(groups_count_if_asked_for)
{
    for (int groups = 0; groups < 2; groups++) {
        struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
        scene_linear(s, 1e4, NAN, -1.0, 1e-9);
        scene_put(s, 1, 0.0, 0.0, 1.99, 1.0);
        scene_carry(s, 1, scene_group(s, "plate"));
        add_profile(s, 2, 1, (double[3]){-4, -4, -4}, (double[3]){4, 4, 4}, 1e-9)->groups = groups;
        struct run r = run_start(s, 1);
        run_steps(&r, 1);
        struct calx_profile_view v = calx_sim_profile(r.sim, 0);
        ck_assert_double_eq_tol(v.layers[0].solid_fraction, (1 + groups) * 4.0 / 3.0 * M_PI / 512.0, ROUNDING);
        ck_assert_double_eq_tol(v.layers[0].contact_stress[8], 100.0 * 1.99 / 512.0, 1e-9);
        run_free(&r);
    }
}
END_TEST

/* ---- bits ---- */

enum { CROWD = 4000, PERIOD = 7, LONG = 3 * PERIOD * 4 };

static struct calx_scene *crowd(void)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, CROWD);
    struct calx_random random;
    calx_random_seed(&random, 3);
    scene_linear(s, 1e4, 0.5, 0.3, 1e-5);
    for (size_t i = 0; i < CROWD; i++) {
        scene_put(s, i, 0.0205 * ((double)(i % 16) + 0.5), 0.0205 * ((double)(i / 16 % 16) + 0.5),
                  0.0205 * ((double)(i / 256) + 0.5), 0.01);
        scene_move(s, i, 4.0 * calx_random_uniform(&random) - 2.0, 4.0 * calx_random_uniform(&random) - 2.0, 0.0);
    }
    for (int k = 0; k < 3; k++)
        scene_extent(s, k, 0.0, 0.0205 * 16, 'p');
    struct calx_profile *p = add_profile(s, 0, 5, (double[3]){0}, (double[3]){0.328, 0.328, 0.328}, PERIOD * 1e-5);
    p->over = 4 * PERIOD * 1e-5;
    return s;
}

static void check_equal(const struct calx_layer *expected, const struct run *r)
{
    struct calx_profile_view v = calx_sim_profile(r->sim, 0);
    ck_assert_int_eq(v.windows, 3);
    ck_assert_mem_eq(v.layers, expected, 5 * sizeof *expected);
}

START_TEST(the_same_bits)
{
    struct run first = run_start(crowd(), 1);
    struct calx_layer expected[5];
    struct calx_error e = {0};
    run_steps(&first, LONG);
    memcpy(expected, calx_sim_profile(first.sim, 0).layers, sizeof expected);
    ck_assert_double_gt(expected[0].contact_stress[0], 0.0);
    struct run two = run_again(&first, 2);
    run_steps(&two, LONG);
    check_equal(expected, &two);
    run_free(&two);

    struct run broken = run_again(&first, 1), resumed = run_again(&first, 2);
    struct calx_block *blocks;
    size_t count;
    run_steps(&broken, LONG / 2 + 3); /* within a window, between samples */
    ck_assert_int_eq(calx_sim_save(broken.sim, &blocks, &count, &e), 0);
    ck_assert_msg(calx_sim_restore(resumed.sim, blocks, count, &e) == 0, "%s", e.text);
    free(blocks);
    run_free(&broken);
    run_steps(&resumed, LONG - LONG / 2 - 3);
    check_equal(expected, &resumed);
    run_free(&resumed);

    struct run quiet = run_again(&first, 1); /* steps that nobody looks at do not go over a sample */
    for (int64_t made, left = LONG; left > 0; left -= made) {
        ck_assert_int_eq(calx_sim_advance(quiet.sim, left, &made, &e), 0);
        if (made < left) {
            ck_assert_int_eq(calx_sim_step(quiet.sim, &e), 0);
            made++;
        }
    }
    check_equal(expected, &quiet);
    run_free(&quiet);
    run_free(&first);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {solid_fraction_of_slices_is_exact,
                            uniform_shear_is_exact,
                            a_window_averages_its_samples,
                            two_bodies_in_contact_have_their_virial,
                            a_column_bears_its_weight,
                            a_contact_across_the_border_counts_on_both_sides,
                            groups_count_if_asked_for,
                            the_same_bits};
    return run_tests("profile", sizeof tests / sizeof *tests, tests);
}

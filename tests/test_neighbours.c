/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The pair search against brute force: directly, on random scenes of size ratio 1 to 100 in two and
 * three dimensions, periodic or not; and through the simulation, where every touching pair must be
 * in the contact network at every step, through rebuilds and periodic crossings. A grain that
 * leaves a bounded domain is reported.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/pairs.h"
#include "tests/scenes.h"

/* ---- the search itself ---- */

struct random_scene {
    uint32_t dimension;
    double ratio;
    bool periodic[3];
};

static const struct random_scene scenes[] = {
    {2, 1, {0}},         {2, 10, {0}},       {2, 100, {0}},     {2, 1, {1, 1, 0}},
    {2, 10, {1, 0, 0}},  {2, 100, {1, 1}},   {3, 1, {0}},       {3, 10, {0}},
    {3, 100, {0}},       {3, 1, {1, 1, 1}},  {3, 3, {0, 1, 0}}, {3, 10, {1, 1, 1}},
    {3, 100, {1, 1, 1}}, {3, 30, {1, 0, 1}},
};

enum { N = 1500, BLOCK = 128, SEEDS = 3 };
static const double LARGEST =
    0.11; /* of a unit box: with the skin below, half the box holds no second image */
static const double SKIN = 0.01, NEAR[2] = {0.002, 0.006};
static const double CORNER = -0.4; /* of the box, so that positions have both signs */

static double rows[4 * N];

/* Sizes uniform in log R; a few centres on the border of the box, on one another and in one line.
 */
static void fill_rows(const struct random_scene *s, uint64_t seed)
{
    struct calx_random random;
    calx_random_seed(&random, seed);
    for (size_t i = 0; i < N; i++) {
        for (uint32_t k = 0; k < 3; k++)
            rows[4 * i + k] = k < s->dimension ? CORNER + calx_random_uniform(&random) : 0.0;
        rows[4 * i + 3] = LARGEST * pow(s->ratio, -calx_random_uniform(&random));
    }
    rows[4 * 7] = rows[4 * 900 + 1] = CORNER;
    rows[4 * 8] = nextafter(CORNER + 1.0, CORNER);
    memcpy(rows + 4 * 1200, rows + 4 * 3, 3 * sizeof(double));
}

static int by_pair(const void *a, const void *b)
{
    const struct calx_found *p = a, *q = b;
    return p->i != q->i ? p->i - q->i : p->j - q->j;
}

/* All pairs i < j with the nearest image of j, by trying every image. */
static size_t brute_force(const struct random_scene *s, struct calx_found *out)
{
    size_t count = 0;
    for (int32_t i = 0; i < N; i++)
        for (int32_t j = i + 1; j < N; j++) {
            double reach = rows[4 * i + 3] + rows[4 * j + 3] + SKIN;
            for (int shift = 0; shift < 27; shift++) {
                int turn[3] = {shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1};
                double d2 = 0.0;
                for (int k = 0; k < 3; k++) {
                    double d = rows[4 * i + k] - rows[4 * j + k] - turn[k];
                    d2 += !s->periodic[k] && turn[k] ? INFINITY : d * d;
                }
                double soon = reach - SKIN + NEAR[1], close = reach - SKIN + NEAR[0];
                uint8_t nearness = d2 < close * close ? CALX_CLOSE : d2 < soon * soon ? CALX_SOON : CALX_LATER;
                if (d2 < reach * reach)
                    out[count++] = (struct calx_found){i, j, (uint8_t)shift, nearness};
            }
        }
    return count;
}

static size_t search(const struct random_scene *s, int threads, struct calx_found *out)
{
    size_t blocks = (N + BLOCK - 1) / BLOCK, count = 0;
    struct calx_found_list *lists = calloc(blocks, sizeof *lists);
    struct calx_pairs_input in = {.x = rows,
                                  .n = N,
                                  .block = BLOCK,
                                  .skin = SKIN,
                                  .near = {NEAR[0], NEAR[1]},
                                  .dimension = s->dimension,
                                  .low = {CORNER, CORNER, CORNER},
                                  .length = {1, 1, 1},
                                  .threads = threads};
    memcpy(in.periodic, s->periodic, sizeof in.periodic);
    ck_assert_int_eq(calx_engine_pick(NULL)->find_pairs(&in, lists), 0);
    for (size_t b = 0; b < blocks; b++) {
        for (size_t k = 0; k < lists[b].count; k++) {
            if ((size_t)lists[b].list[k].i / BLOCK != b)
                ck_abort_msg("pair of %d is in the list of block %zu", lists[b].list[k].i, b);
            out[count++] = lists[b].list[k];
        }
        free(lists[b].list);
    }
    free(lists);
    return count;
}

START_TEST(search_equals_brute_force)
{
    struct calx_found *found = malloc(N * N * sizeof *found),
                      *expected = malloc(N * N * sizeof *expected);
    for (size_t c = 0; c < sizeof scenes / sizeof *scenes; c++)
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            fill_rows(&scenes[c], seed);
            size_t n = search(&scenes[c], 1, found), all = brute_force(&scenes[c], expected);
            qsort(found, n, sizeof *found, by_pair);
            ck_assert_uint_gt(all, N);
            ck_assert_msg(n == all, "scene %zu seed %llu: %zu pairs found, %zu exist", c,
                          (unsigned long long)seed, n, all);
            for (size_t k = 0; k < n; k++)
                if (by_pair(&found[k], &expected[k]) || found[k].shift != expected[k].shift || found[k].nearness != expected[k].nearness)
                    ck_abort_msg("scene %zu: pair %zu is (%d, %d, %d, %d), not (%d, %d, %d, %d)", c, k,
                                 found[k].i, found[k].j, found[k].shift, found[k].nearness, expected[k].i,
                                 expected[k].j, expected[k].shift, expected[k].nearness);
        }
    free(found);
    free(expected);
}
END_TEST

START_TEST(order_does_not_depend_on_threads)
{
    struct calx_found *one = malloc(N * N * sizeof *one), *other = malloc(N * N * sizeof *other);
    for (size_t c = 0; c < sizeof scenes / sizeof *scenes; c++) {
        fill_rows(&scenes[c], 11);
        size_t n = search(&scenes[c], 1, one);
        for (int threads = 2; threads <= 4; threads++) {
            ck_assert_uint_eq(search(&scenes[c], threads, other), n);
            for (size_t k = 0; k < n; k++)
                if (by_pair(&one[k], &other[k]) || one[k].shift != other[k].shift)
                    ck_abort_msg("scene %zu, %d threads: place %zu of the list differs", c, threads,
                                 k);
        }
    }
    free(one);
    free(other);
}
END_TEST

/* ---- through the simulation ---- */

struct gas {
    uint32_t dimension;
    double ratio;
    char kind[3]; /* of each axis: 'p' periodic, 'w' between walls */
    int threads;
};

static const struct gas gases[] = {
    {2, 1, "wwp", 1},  {2, 8, "ppp", 2}, {2, 4, "pwp", 1},   {3, 1, "ppp", 2},
    {3, 20, "ppp", 1}, {3, 5, "pwp", 3}, {3, 100, "pww", 2},
};

enum { GRAINS = CALX_BLOCK + 200, STEPS = 400, REBUILDS = 20, BORDER = 10 };
static const double GRAIN[] = {
    0.0074, 0.0277}; /* of a unit box, in 2D and 3D: a fifth to two fifths of it are full */
static const double FASTEST = 3.5; /* m/s, 2 along each of three axes */

static bool overlaps(const struct calx_scene *s, size_t count, const double *x, double radius)
{
    for (size_t j = 0; j < count; j++) {
        double d2 = 0.0, reach = radius + s->particles.radius[j];
        for (int k = 0; k < 3; k++) {
            double d = fabs(x[k] - s->particles.position[j][k]);
            d = s->periodic[k] ? fmin(d, 1.0 - d) : d;
            d2 += d * d;
        }
        if (d2 < reach * reach)
            return true;
    }
    return false;
}

/* One grain at random without overlap; the first few start at the border and leave through it. */
static void insert(struct calx_scene *s, size_t i, double radius, struct calx_random *random)
{
    double x[3] = {0}, v[3] = {0};
    do {
        for (uint32_t k = 0; k < s->dimension; k++) {
            double room = s->periodic[k] ? 1.0 : 1.0 - 2.0 * radius,
                   u = calx_random_uniform(random);
            bool leaves = i < BORDER && i % s->dimension == k && s->periodic[k];
            x[k] = leaves ? 1e-3 * u * radius : 0.5 + room * (u - 0.5);
            v[k] = 4.0 * calx_random_uniform(random) - 2.0;
            v[k] = leaves ? -fabs(v[k]) : v[k];
        }
    } while (overlaps(s, i, x, radius));
    scene_put(s, i, x[0], x[1], x[2], radius);
    scene_move(s, i, v[0], v[1], v[2]);
}

static void add_walls(struct calx_scene *s, const struct gas *g)
{
    const double one[3] = {1, 1, 1}, zero[3] = {0};
    int wall = scene_wall(s, "box", 0);
    for (uint32_t q = 0; q < g->dimension; q++) {
        double n[3] = {0}, back[3] = {0};
        n[q] = 1.0;
        back[q] = -1.0;
        scene_extent(s, (int)q, 0.0, 1.0, g->kind[q] == 'p' ? 'p' : 'n');
        if (g->kind[q] == 'w') {
            scene_plane(s, wall, zero, n);
            scene_plane(s, wall, one, back);
        }
    }
}

/* A gas that collides gently: the largest grains overlap by a fifth of their radius, and the skin
 * lasts ten steps. */
static struct calx_scene *gas_scene(const struct gas *g, uint64_t seed)
{
    struct calx_scene *s = scene_create(g->dimension, CALX_SPHERES, GRAINS);
    struct calx_random random;
    calx_random_seed(&random, seed);
    double largest = GRAIN[g->dimension - 2], smallest = largest / g->ratio,
           volume = 4.0 / 3.0 * M_PI * 1000.0;
    double k = 0.5 * volume * pow(largest, 3.0) * pow(2.0 * FASTEST / (0.2 * largest), 2.0);
    double dt = 0.2 * sqrt(0.5 * volume * pow(smallest, 3.0) / k);
    scene_linear(s, k, NAN, -1.0, dt);
    s->skin = 20.0 * FASTEST * dt;
    add_walls(s, g);
    for (size_t i = 0; i < GRAINS; i++) /* large ones first: they find room */
        insert(s, i,
               i < 40  ? largest
               : i % 2 ? smallest
                       : largest * pow(g->ratio, -calx_random_uniform(&random)),
               &random);
    return s;
}

/* Marks, per pair, what is in the network; then every pair that overlaps by brute force must be
 * marked. */
static void compare(const struct calx_scene *scene, struct calx_sim *sim, const char *what)
{
    static uint8_t seen[GRAINS][GRAINS];
    const double rounding =
        1e-12; /* of a unit box: positions of either image differ by the last bits */
    struct calx_frame *f = calx_frame_create(sim, true);
    size_t touching = 0;
    memset(seen, 0, sizeof seen);
    for (size_t k = 0; k < f->contact_count; k++) {
        int64_t i = f->pair[k][0], j = f->pair[k][1];
        if (j < 0)
            continue;
        const double *a = f->pair_position[k][0], *b = f->pair_position[k][1];
        double apart = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
        if (fabs(f->radius[i] + f->radius[j] - apart - f->overlap[k]) > rounding || seen[i][j])
            ck_abort_msg("%s: pair %lld, %lld twice, or of another image", what, (long long)i,
                         (long long)j);
        seen[i][j] = seen[j][i] = 1;
        touching++;
    }
    for (size_t i = 0; i < GRAINS; i++)
        for (size_t j = i + 1; j < GRAINS; j++) {
            double d2 = 0.0, reach = f->radius[i] + f->radius[j];
            for (int k = 0; k < 3; k++) {
                double d = fabs(f->position[i][k] - f->position[j][k]);
                d = scene->periodic[k] && d > 0.5 ? 1.0 - d : d;
                d2 += d * d;
            }
            touching -= seen[i][j];
            bool near = d2 < (reach + rounding) * (reach + rounding);
            if (seen[i][j] ? !near : d2 < (reach - rounding) * (reach - rounding))
                ck_abort_msg("%s: %zu and %zu at t = %g are %sin the network", what, i, j, f->time,
                             seen[i][j] ? "" : "not ");
        }
    ck_assert_uint_eq(touching, 0);
    calx_frame_free(f);
}

START_TEST(every_touching_pair_is_in_the_network)
{
    for (size_t g = 0; g < sizeof gases / sizeof *gases; g++) {
        char what[32];
        struct run r = run_start(gas_scene(&gases[g], g), gases[g].threads);
        int64_t turns = 0;
        snprintf(what, sizeof what, "gas %zu", g);
        for (size_t k = 0; k < STEPS; k++) {
            if (k % 8 == 0)
                compare(r.scene, r.sim, what);
            run_steps(&r, 1);
        }
        for (size_t b = 0; b < r.sim->block_count && r.sim->r.image; b++)
            for (int32_t row = r.sim->blocks[b].first;
                 row < r.sim->blocks[b].first + r.sim->blocks[b].own; row++)
                for (int k = 0; k < 3; k++)
                    turns += abs(r.sim->r.image[row][k]);
        ck_assert_msg(r.sim->rebuilds >= REBUILDS, "%s: %lld rebuilds", what,
                      (long long)r.sim->rebuilds);
        ck_assert_msg(!r.sim->r.image || turns > 0, "%s: nobody crossed the border", what);
        run_free(&r);
    }
}
END_TEST

/* ---- leaving ---- */

static const double LEAVING_SPEED = 3.0, LEAVING_STEP = 1e-3;
enum { GUARD_STEPS = 256 }; /* steps between checks of the domain */

/* Grain 2 of `grains` leaves the box [0, 1] along `axis` at t = 0.5/3 s. */
static void leave(size_t grains, int axis)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, grains);
    struct calx_error e = {0};
    double reported = 0.0;
    long long id = -1;
    size_t leaver = grains - 1;
    scene_linear(s, 1e3, NAN, -1.0, LEAVING_STEP);
    for (size_t i = 0; i < grains; i++)
        scene_put(s, i, 0.1 + 0.2 * (double)i, 0.5, 0.5, 0.05);
    scene_put(s, leaver, 0.5, 0.5, 0.5, 0.05);
    scene_move(s, leaver, axis == 0 ? LEAVING_SPEED : 0.0, axis == 1 ? -LEAVING_SPEED : 0.0, 0.0);
    scene_extent(s, axis, 0.0, 1.0, 'b');
    struct run r = run_start(s, 1);
    int code = 0;
    for (int k = 0; k < 2 * GUARD_STEPS && !code; k++)
        code = calx_sim_step(r.sim, &e);
    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
    ck_assert_msg(sscanf(e.text, "at t = %lg s particle %lld left the domain", &reported, &id) == 2,
                  "%s", e.text);
    ck_assert_int_eq(id, (long long)leaver);
    ck_assert_double_ge(reported, 0.5 / LEAVING_SPEED - LEAVING_STEP);
    ck_assert_double_le(reported, 0.5 / LEAVING_SPEED + (GUARD_STEPS + 1) * LEAVING_STEP);
    run_free(&r);
}

START_TEST(leaving_the_domain_is_reported)
{
    leave(1, 0);
    leave(2, 1);
    leave(3, 0);
}
END_TEST

START_TEST(short_periodic_box_is_refused)
{
    struct calx_error e = {0};
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, 1e3, NAN, -1.0, 1e-4);
    scene_put(s, 0, 0.1, 0.1, 0.1, 0.1);
    scene_put(s, 1, 0.3, 0.1, 0.1, 0.1);
    scene_extent(s, 0, 0.0, 0.39, 'p'); /* 0.4 m hold two diameters */
    run_refused(s, &e);
    ck_assert_int_eq(e.code, CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(e.text, "too short"));
}
END_TEST

int main(void)
{
    const TTest *tests[] = {short_periodic_box_is_refused, leaving_the_domain_is_reported,
                            search_equals_brute_force, order_does_not_depend_on_threads,
                            every_touching_pair_is_in_the_network};
    return run_tests("neighbours", sizeof tests / sizeof *tests, tests);
}

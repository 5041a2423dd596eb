/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Packings: what must be refused first, then every packing against brute force (no overlap, inside
 * by formulas of this file's own), bodies that are already there, seeds.
 */
#include "tests/regions.h"

/* ---- refusals ---- */

static const double one_radius[] = {0.002}, two_radii[] = {0.001, 0.002}, bad_radii[] = {0.001, -1},
                    bad_weights[] = {1, 0};

static const struct {
    struct calx_sizes sizes;
    size_t count;
    double fill;
    const char *words;
} bad_sizes[] = {
    {{.kind = CALX_SIZES_FIXED, .a = 0}, 1, 0, "must be positive"},
    {{.kind = CALX_SIZES_FIXED, .a = NAN}, 1, 0, "must be positive"},
    {{.kind = CALX_SIZES_FIXED, .a = INFINITY}, 1, 0, "must be positive"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.001}, 1, 0.1, "not both"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.001}, 0, 1, "between 0 and 1"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.001}, 0, -0.1, "between 0 and 1"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.001}, 0, NAN, "between 0 and 1"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.001}, 0, 1e-9, "so small a solid fraction"},
    {{.kind = CALX_SIZES_FIXED, .a = 1e-9}, 0, 0.5, "more than 100000000 bodies"},
    {{.kind = CALX_SIZES_UNIFORM, .a = 0.002, .b = 0.001}, 1, 0, "below the least"},
    {{.kind = CALX_SIZES_NORMAL, .a = 0.002}, 1, 0, "standard deviation"},
    {{.kind = CALX_SIZES_NORMAL, .a = 0.002, .b = 0.001, .min = 0.002, .max = 0.001},
     1,
     0,
     "min < max"},
    {{.kind = CALX_SIZES_LOGNORMAL, .a = 0.002, .b = 0.0001, .min = 1, .max = 2},
     1,
     0,
     "leave nothing"},
    {{.kind = CALX_SIZES_MASSES}, 1, 0, "no radii"},
    {{.kind = CALX_SIZES_MASSES, .count = 2, .list = two_radii, .weight = bad_weights},
     9,
     0,
     "mass fractions"},
    {{.kind = CALX_SIZES_LIST, .count = 2, .list = bad_radii}, 0, 0, "radii must be positive"},
    {{.kind = CALX_SIZES_LIST, .count = 1, .list = one_radius}, 2, 0, "its own count"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.055}, 1, 0, "does not fit into the region"},
    {{.kind = CALX_SIZES_FIXED, .a = 0.002},
     2000,
     0,
     "2000 bodies cannot fit: together they are 2.51 times the region"},
};

START_TEST(test_bad_sizes)
{
    struct calx_region region = make_rectangle();
    int code = calx_pack_region(&region, &bad_sizes[_i].sizes, bad_sizes[_i].count,
                                bad_sizes[_i].fill, 1, NULL, &packing, &error);
    ck_assert_int_eq(code, CALX_ERROR_INPUT);
    ck_assert_msg(strstr(error.text, bad_sizes[_i].words) != NULL, "%s", error.text);
    ck_assert_uint_eq(packing.count, 0);
    ck_assert_ptr_null(packing.position);
}
END_TEST

/* ---- wrong bodies ---- */

START_TEST(test_bad_body_there)
{
    struct calx_region region = make_box();
    const struct calx_sizes sizes = {.kind = CALX_SIZES_FIXED, .a = 0.002};
    const double position[1][3] = {{0, NAN, 0}}, good[1][3] = {{0}}, radius[] = {0.001},
                 zero[] = {0};
    const struct calx_bodies_at there[] = {{1, position, radius}, {1, good, zero}};
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(calx_pack_region(&region, &sizes, 1, 0, 1, &there[k], &packing, &error),
                         CALX_ERROR_INPUT);
}
END_TEST

/* Denser than any packing of equal discs, 0.9069: what was reached and what would fit is said, and
 * is true. */
START_TEST(test_too_dense)
{
    struct calx_region region = make_rectangle();
    const struct calx_sizes sizes = {.kind = CALX_SIZES_FIXED, .a = 0.002};
    ck_assert_int_eq(calx_pack_region(&region, &sizes, 0, 0.92, 1, NULL, &packing, &error),
                     CALX_ERROR_INPUT);
    size_t wanted, trials, fit;
    double fraction, random, reached, smaller;
    int found = sscanf(
        error.text,
        "%zu bodies, a solid fraction of %lf, do not fit without overlap: random trials placed "
        "%zu (%lf), and pushing all apart reached %lf, with radii %lf %% smaller; ask for about "
        "%zu bodies",
        &wanted, &fraction, &trials, &random, &reached, &smaller, &fit);
    ck_assert_msg(found == 7, "%s", error.text);
    ck_assert_uint_eq(wanted, 732); /* 0.92 * 0.01 m2/(pi 4e-6 m2) */
    ck_assert_double_eq_tol(random, (double)trials / (double)wanted * fraction, 1e-3);
    ck_assert_double_gt(random, 0.3);
    ck_assert_double_lt(random,
                        0.547); /* the jamming limit of random sequential addition of discs */
    ck_assert_double_gt(reached, random);
    ck_assert_double_lt(reached, 0.9069);
    ck_assert_int_eq(calx_pack_region(&region, &sizes, fit, 0, 1, NULL, &packing, &error), CALX_OK);
}
END_TEST

/* ---- what must hold of a packing, by other formulas than the packer's ---- */

/* Angle that the outlines turn about x: a multiple of 2 pi; odd ones are inside where outlines nest
 * as here. */
static double winding(const struct calx_region *region, const double x[3])
{
    double sum = 0;
    for (size_t e = 0; e < region->edge_count; e++) {
        const double *s = region->edges[e];
        double ax = s[0] - x[0], ay = s[1] - x[1], bx = s[2] - x[0], by = s[3] - x[1];
        sum += atan2(ax * by - ay * bx, ax * bx + ay * by);
    }
    return sum;
}

static double distance_to(const double s[4], const double x[3])
{
    double length = hypot(s[2] - s[0], s[3] - s[1]);
    double along = ((x[0] - s[0]) * (s[2] - s[0]) + (x[1] - s[1]) * (s[3] - s[1])) / length;
    double across = fabs((x[0] - s[0]) * (s[3] - s[1]) - (x[1] - s[1]) * (s[2] - s[0])) / length;
    if (along < 0)
        return hypot(x[0] - s[0], x[1] - s[1]);
    return along > length ? hypot(x[0] - s[2], x[1] - s[3]) : across;
}

/* The smallest distance from the surface of a body to a wall of its region. */
static double wall_gap(const struct calx_region *region, const double x[3], double radius)
{
    double gap = INFINITY, out[3] = {0}, along = 0, norm = 0;
    for (uint32_t k = 0; k < region->dimension; k++) {
        if (!region->periodic[k])
            gap = fmin(gap, fmin(x[k] - region->low[k], region->high[k] - x[k]));
        out[k] = x[k] - region->centre[k];
        norm += region->axis[k] * region->axis[k];
        along += out[k] * region->axis[k];
    }
    double square = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
    if (region->kind == CALX_REGION_BALL)
        gap = fmin(gap, region->radius - sqrt(square));
    if (region->kind == CALX_REGION_CYLINDER) {
        gap = fmin(gap, region->radius - sqrt(square - along * along / norm)); /* Pythagoras */
        if (region->length > 0)
            gap = fmin(gap, region->length / 2 - fabs(along) / sqrt(norm));
    }
    for (size_t e = 0; e < region->edge_count; e++)
        gap = fmin(gap, distance_to(region->edges[e], x));
    for (size_t e = 0; e < region->obstacle_count; e++)
        gap = fmin(gap, distance_to(region->obstacles[e], x));
    if (region->kind == CALX_REGION_OUTLINE && lrint(winding(region, x) / (2 * M_PI)) % 2 == 0)
        gap = -gap;
    return gap - radius - region->clearance;
}

static double pair_gap(const struct calx_region *region, const double a[3], double ra,
                       const double b[3], double rb)
{
    double square = 0;
    for (uint32_t k = 0; k < region->dimension; k++) {
        double d = fabs(a[k] - b[k]), period = region->high[k] - region->low[k];
        if (region->periodic[k])
            d = fmin(d, fabs(period - d));
        square += d * d;
    }
    return sqrt(square) - ra - rb;
}

/* Rounding of a distance of up to 1 m: a few 2^-53. */
static const double ROUNDING = 1e-15;

static void check_packing(const struct calx_region *region)
{
    double worst = INFINITY;
    for (size_t i = 0; i < packing.count; i++) {
        const double *x = packing.position[i];
        worst = fmin(worst, wall_gap(region, x, packing.radius[i]));
        for (uint32_t k = 0; k < region->dimension; k++)
            if (region->periodic[k])
                ck_assert(x[k] >= region->low[k] && x[k] < region->high[k]);
        if (region->dimension == 2)
            ck_assert_double_eq(x[2], 0);
    }
    ck_assert_double_ge(worst, -ROUNDING);
    for (size_t i = 0; i < packing.count; i++)
        for (size_t j = 0; j < i; j++)
            worst = fmin(worst, pair_gap(region, packing.position[i], packing.radius[i],
                                         packing.position[j], packing.radius[j]));
    ck_assert_double_ge(worst, -ROUNDING);
}

static double solid(uint32_t dimension, double r)
{
    return dimension == 2 ? M_PI * r * r : 4 * M_PI / 3 * r * r * r;
}

/* ---- packings ---- */

static const struct calx_sizes fixed = {.kind = CALX_SIZES_FIXED, .a = 0.002},
                               small = {.kind = CALX_SIZES_FIXED, .a = 0.001},
                               uniform = {.kind = CALX_SIZES_UNIFORM, .a = 0.001, .b = 0.002},
                               wide = {.kind = CALX_SIZES_UNIFORM, .a = 0.0002, .b = 0.008},
                               normal = {.kind = CALX_SIZES_NORMAL, .a = 0.002, .b = 0.0004},
                               lognormal = {.kind = CALX_SIZES_LOGNORMAL,
                                            .a = 0.001,
                                            .b = 0.0005,
                                            .max = 0.006};

static const struct {
    struct calx_region (*make)(void);
    const struct calx_sizes *sizes;
    size_t count;
    double fill;
} packings[] = {
    {make_rectangle, &fixed, 1, 0},
    {make_rectangle, &uniform, 0, 0.3},
    {make_rectangle, &uniform, 0, 0.6},
    {make_rectangle, &uniform, 0, 0.75},
    {make_rectangle, &fixed, 0, 0.75},
    {make_rectangle, &wide, 0, 0.75},
    {make_circle, &normal, 0, 0.6},
    {make_circle, &uniform, 0, 0.72},
    {make_outline, &uniform, 0, 0.4},
    {make_outline, &uniform, 0, 0.65},
    {make_clear_outline, &uniform, 0, 0.6},
    {make_box, &small, 0, 0.3},
    {make_box, &small, 0, 0.5},
    {make_box, &wide, 0, 0.4},
    {make_periodic_box, &small, 0, 0.55},
    {make_periodic_box, &lognormal, 0, 0.55},
    {make_slab, &fixed, 0, 0.45},
    {make_ball, &fixed, 0, 0.4},
    {make_tilted, &small, 0, 0.4},
    {make_prism, &fixed, 0, 0.35},
    {make_drum, &fixed, 8000, 0},
    {make_half_drum, &fixed, 8000, 0},
};

START_TEST(test_packing)
{
    struct calx_region region = packings[_i].make();
    const struct calx_sizes *sizes = packings[_i].sizes;
    int code = calx_pack_region(&region, sizes, packings[_i].count, packings[_i].fill, (uint64_t)_i,
                                NULL, &packing, &error);
    ck_assert_msg(code == CALX_OK, "%s", error.text);
    if (packings[_i].count > 0)
        ck_assert_uint_eq(packing.count, packings[_i].count);
    double sum = 0, largest = 0;
    for (size_t i = 0; i < packing.count; i++) {
        double own = solid(region.dimension, packing.radius[i]);
        sum += own;
        largest = fmax(largest, own);
    }
    double volume = calx_region_volume(&region);
    ck_assert_double_eq_tol(packing.fraction, sum / volume,
                            1e-12); /* sums of up to 1e4 terms in another order */
    if (packings[_i].fill > 0) /* the last body is taken or left, whichever is nearer; the one left
                                  may be larger than all, by 8 in volume */
        ck_assert_double_eq_tol(packing.fraction, packings[_i].fill, 8 * largest / volume / 2);
    check_packing(&region);
    calx_region_clear(&region);
}
END_TEST

/* Without count and fill: what random trials reach, between half of and the full limit of
 * sequential addition. */
START_TEST(test_loose)
{
    struct calx_region region = _i == 0 ? make_rectangle() : make_box();
    const double limit = _i == 0 ? 0.547 : 0.3841;
    ck_assert_int_eq(calx_pack_region(&region, &small, 0, 0, 5, NULL, &packing, &error), CALX_OK);
    ck_assert_double_lt(packing.fraction, limit);
    ck_assert_double_gt(packing.fraction,
                        0.75 *
                            limit); /* the wall layer of width r and the end of trials cost some */
    check_packing(&region);
}
END_TEST

START_TEST(test_bodies_there)
{
    enum { THERE = 40 };
    struct calx_region region = make_periodic_box();
    const struct calx_sizes large = {.kind = CALX_SIZES_FIXED, .a = 0.003};
    struct calx_packing there;
    ck_assert_int_eq(calx_pack_region(&region, &large, THERE, 0, 7, NULL, &there, &error), CALX_OK);
    const struct calx_bodies_at avoid = {THERE, (const double(*)[3])there.position, there.radius};
    const double fills[] = {0.05, 0.3}; /* by trials; by pushing apart, 0.37 with what is there */
    for (int k = 0; k < 2; k++) {
        ck_assert_msg(calx_pack_region(&region, &small, 0, fills[k], 8, &avoid, &packing, &error) ==
                          CALX_OK,
                      "%s", error.text);
        double worst = INFINITY;
        for (size_t i = 0; i < packing.count; i++)
            for (size_t j = 0; j < THERE; j++)
                worst = fmin(worst, pair_gap(&region, packing.position[i], packing.radius[i],
                                             there.position[j], there.radius[j]));
        ck_assert_double_ge(worst, -ROUNDING);
        check_packing(&region);
        calx_packing_free(&packing);
    }
    calx_packing_free(&there);
}
END_TEST

START_TEST(test_list)
{
    struct calx_region region = make_rectangle();
    const double list[] = {0.001, 0.004, 0.002, 0.004};
    const struct calx_sizes sizes = {.kind = CALX_SIZES_LIST, .count = 4, .list = list};
    ck_assert_int_eq(calx_pack_region(&region, &sizes, 0, 0, 1, NULL, &packing, &error), CALX_OK);
    ck_assert_uint_eq(packing.count, 4);
    ck_assert_mem_eq(packing.radius, list, sizeof list);
    check_packing(&region);
}
END_TEST

START_TEST(test_seed)
{
    struct calx_region region = make_rectangle();
    struct calx_packing again, other;
    const double fills[] = {0.3, 0.7};
    for (int k = 0; k < 2; k++) {
        ck_assert_int_eq(
            calx_pack_region(&region, &uniform, 0, fills[k], 3, NULL, &packing, &error), CALX_OK);
        ck_assert_int_eq(calx_pack_region(&region, &uniform, 0, fills[k], 3, NULL, &again, &error),
                         CALX_OK);
        ck_assert_int_eq(calx_pack_region(&region, &uniform, 0, fills[k], 4, NULL, &other, &error),
                         CALX_OK);
        ck_assert_uint_eq(packing.count, again.count);
        ck_assert_mem_eq(packing.position, again.position,
                         packing.count * sizeof *packing.position);
        ck_assert_mem_eq(packing.radius, again.radius, packing.count * sizeof *packing.radius);
        ck_assert(memcmp(packing.position, other.position, sizeof *packing.position) != 0);
        calx_packing_free(&packing);
        calx_packing_free(&again);
        calx_packing_free(&other);
    }
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("pack");
    TCase *tcase = tcase_create("pack");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_bad_sizes, bad_sizes);
    tcase_add_test(tcase, test_bad_body_there);
    tcase_add_test(tcase, test_too_dense);
    LOOP(test_packing, packings);
    tcase_add_loop_test(tcase, test_loose, 0, 2);
    tcase_add_test(tcase, test_bodies_there);
    tcase_add_test(tcase, test_list);
    tcase_add_test(tcase, test_seed);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

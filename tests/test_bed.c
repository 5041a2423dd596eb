/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Beds of grains: the mixing index against its definition at both ends and its mean over shuffles;
 * the classes it divides grains into; slopes of a heap of known angles.
 */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/heap.h"
#include "core/lacey.h"
#include "core/measure.h"

/* A few operations on numbers of order 1: some units in the last place. */
static const double ROUNDING = 1e-14;

enum { GRAINS = 4 };

static double positions[GRAINS][3] = {{0, 0, 0}, {1, 2, 0}, {2, 4, 0}, {3, 8, 1}};
static double radii[GRAINS] = {0.5, 1, 0.5, 2};
static double temperatures[GRAINS] = {300, 310, 320, 350};
static int32_t materials[GRAINS] = {0, 1, 0, 1};

/* ---- mixing ---- */

enum { SIDE = 16, LATTICE = SIDE * SIDE, CELL = 4, CELLS = LATTICE / (CELL * CELL) };

static double lattice[LATTICE][3], lattice_radii[LATTICE];

static struct calx_frame make_lattice(void)
{
    for (int i = 0; i < LATTICE; ++i) {
        lattice[i][0] = i % SIDE + 0.5 - SIDE / 2; /* on both sides of 0 */
        lattice[i][1] = i / SIDE + 0.5;
        lattice[i][2] = 0;
        lattice_radii[i] = 0.5;
    }
    return (struct calx_frame){
        .dimension = 2, .n = LATTICE, .position = lattice, .radius = lattice_radii};
}

static int left_half(int i)
{
    return i % SIDE < SIDE / 2;
}
static int checkers(int i)
{
    return (i % SIDE + i / SIDE) % 2;
}
static int nobody(int i)
{
    return i < 0;
}
static int one_in_four(int i)
{
    return i % 2 == 0 && i / SIDE % 2 == 0;
}

static const struct {
    int (*is_one)(int);
    double index;
} mixtures[] = {
    {nobody, NAN},
    {left_half, 0}, /* no cell is mixed: s2 = s02 */
    /* every cell has the share of the whole: s2 = 0 and M = 1/(1 - (C-1)/(N-1)) */
    {checkers, 1 / (1 - (CELLS - 1.0) / (LATTICE - 1.0))},
    {one_in_four, 1 / (1 - (CELLS - 1.0) / (LATTICE - 1.0))},
};

START_TEST(the_index_is_right_at_both_ends)
{
    struct calx_frame frame = make_lattice();
    uint8_t classes[LATTICE];
    for (int i = 0; i < LATTICE; ++i)
        classes[i] = (uint8_t)mixtures[_i].is_one(i);
    double got = calx_lacey_index(&frame, classes, CELL);
    if (isnan(mixtures[_i].index))
        ck_assert(isnan(got));
    else
        ck_assert_double_eq_tol(got, mixtures[_i].index, ROUNDING * LATTICE);
}
END_TEST

/* A fixed sequence (Numerical Recipes' constants), so that the test is the same everywhere. */
static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

START_TEST(shuffled_grains_have_an_index_of_one_on_average)
{
    enum { SHUFFLES = 2000 };
    struct calx_frame frame = make_lattice();
    uint8_t classes[LATTICE];
    uint32_t state = 1;
    double sum = 0, squares = 0;
    for (int i = 0; i < LATTICE; ++i)
        classes[i] = i < LATTICE / 2;
    for (int s = 0; s < SHUFFLES; ++s) {
        for (uint32_t i = LATTICE - 1; i > 0; --i) {
            uint32_t j = next_random(&state) % (i + 1);
            uint8_t swapped = classes[i];
            classes[i] = classes[j];
            classes[j] = swapped;
        }
        double index = calx_lacey_index(&frame, classes, CELL);
        sum += index;
        squares += index * index;
    }
    double mean = sum / SHUFFLES, deviation = sqrt(squares / SHUFFLES - mean * mean);
    /* four standard errors of the mean; sr2 without the finite population (C/N) would be off by
     * 1/N/(1-C/N) = 4e-3 */
    double tolerance = 4 * deviation / sqrt(SHUFFLES);
    ck_assert_double_lt(tolerance, 3e-3);
    ck_assert_double_eq_tol(mean, 1, tolerance);
}
END_TEST

START_TEST(automatic_cells_hold_about_eight_grains)
{
    /* squares of edge 0.5*sqrt(8 pi/0.8) = 2.802 on a lattice of unit distance: the halves share
     * one column of cells at most */
    struct calx_frame frame = make_lattice();
    uint8_t classes[LATTICE];
    for (int i = 0; i < LATTICE; ++i)
        classes[i] = (uint8_t)left_half(i);
    double cell = 0.5 * sqrt(8 * M_PI / 0.8);
    ck_assert_double_eq(calx_lacey_index(&frame, classes, 0),
                        calx_lacey_index(&frame, classes, cell));
    ck_assert_double_lt(calx_lacey_index(&frame, classes, 0), 0.2);
}
END_TEST

static const struct {
    const char *name;
    double up[3];
    uint8_t classes[GRAINS];
} kinds[] = {
    {"start-hight", {0, 1, 0}, {0, 0, 0, 0}},       {"start-height", {0, 1, 0}, {0, 0, 1, 1}},
    {"start-height", {0, -1, 0}, {1, 1, 0, 0}},     {"start-x", {0, 1, 0}, {0, 0, 1, 1}},
    {"material", {0, 1, 0}, {0, 1, 0, 1}},          {"start-radius", {0, 1, 0}, {0, 1, 0, 1}},
    {"start-temperature", {0, 1, 0}, {0, 0, 1, 1}},
};

START_TEST(classes_follow_their_name)
{
    const struct calx_frame frame = {.dimension = 3,
                                     .n = GRAINS,
                                     .position = positions,
                                     .radius = radii,
                                     .material = materials,
                                     .temperature = temperatures};
    uint8_t classes[GRAINS] = {9, 9, 9, 9};
    calx_lacey_classes(&frame, kinds[_i].name, kinds[_i].up, classes);
    ck_assert_int_eq(calx_measure_is_class(kinds[_i].name), _i > 0); /* the first is misspelt */
    ck_assert_int_eq(strstr(calx_measure_classes(), kinds[_i].name) != NULL, _i > 0);
    ck_assert_mem_eq(classes, kinds[_i].classes, GRAINS);
}
END_TEST

START_TEST(equal_radii_make_no_classes)
{
    struct calx_frame frame = make_lattice();
    uint8_t classes[LATTICE];
    const double up[3] = {0, 1, 0};
    calx_lacey_classes(&frame, "start-radius", up, classes);
    ck_assert(isnan(calx_lacey_index(&frame, classes, CELL)));
}
END_TEST

/* ---- heap ---- */

enum { COLUMNS = 41, TOP = 18, HEAP = COLUMNS + 1 };

/* One grain per column of a width that is a power of two (so that the columns are exact), on two
 * straight slopes. */
static struct calx_frame make_heap(double left, double right, double (*x)[3], double *r)
{
    const double width = 0.25, degree = M_PI / 180;
    for (int i = 0; i < COLUMNS; ++i) {
        double fall = i < TOP ? tan(left * degree) : tan(right * degree);
        double height = 4 - fall * fabs(width * (i - TOP));
        x[i][0] = width * i;
        x[i][1] = fmax(height, 0) + width / 2;
        x[i][2] = 0;
        r[i] = width / 2;
    }
    x[COLUMNS][0] = 100; /* one rolled away */
    x[COLUMNS][1] = width / 2;
    r[COLUMNS] = width / 2;
    return (struct calx_frame){.dimension = 2, .n = HEAP, .position = x, .radius = r};
}

static const struct {
    double left, right;
} slopes[] = {{45, 45}, {40, 30}, {60, 20}, {42, -1}};

START_TEST(slopes_are_those_of_the_heap)
{
    double x[HEAP][3], r[HEAP];
    struct calx_frame frame = make_heap(slopes[_i].left, slopes[_i].right, x, r);
    if (slopes[_i].right < 0) { /* rises to the right: the top is the last column, nothing falls */
        ck_assert(isnan(calx_heap_slope(&frame, 1)));
        return;
    }
    /* sums of 40 numbers of order 10: 1e-13 relative in the slope */
    ck_assert_double_eq_tol(calx_heap_slope(&frame, -1), slopes[_i].left, 1e-10);
    ck_assert_double_eq_tol(calx_heap_slope(&frame, 1), slopes[_i].right, 1e-10);
    frame.dimension = 3;
    ck_assert(isnan(calx_heap_slope(&frame, 1)));
}
END_TEST

/* Above, below and beside the heap, and larger: nothing changes. */
START_TEST(bodies_of_groups_are_no_grains)
{
    enum { ALL = HEAP + 3 };
    double x[ALL][3], r[ALL], temperature[ALL];
    int32_t group[ALL];
    uint8_t classes[ALL], alone[HEAP];
    const double up[3] = {0, 1, 0};
    struct calx_frame heap = make_heap(40, 30, x, r), all = heap;
    for (int i = 0; i < ALL; i++) {
        group[i] = i < HEAP ? -1 : 0;
        temperature[i] = i < HEAP ? 300 + i : 1000;
        if (i >= HEAP) {
            x[i][0] = i - HEAP;
            x[i][1] = i == HEAP ? 50 : -50;
            x[i][2] = 0;
            r[i] = 3;
        }
    }
    heap.temperature = temperature;
    all = heap;
    all.n = ALL;
    all.group = group;
    ck_assert_double_eq(calx_heap_slope(&all, -1), calx_heap_slope(&heap, -1));
    ck_assert_double_eq(calx_heap_height(&all, up), calx_heap_height(&heap, up));
    calx_lacey_classes(&heap, "start-temperature", up, alone);
    calx_lacey_classes(&all, "start-temperature", up, classes);
    ck_assert_mem_eq(classes, alone, HEAP);
    ck_assert_double_eq(calx_lacey_index(&all, classes, 0), calx_lacey_index(&heap, alone, 0));
    for (int i = 0; i < ALL; i++)
        group[i] = 0;
    ck_assert(isnan(calx_heap_slope(&all, -1)));
    ck_assert_double_eq(calx_heap_height(&all, up), 0);
    ck_assert(isnan(calx_lacey_index(&all, classes, 0)));
}
END_TEST

START_TEST(no_grains_have_no_shape)
{
    struct calx_frame frame = {.dimension = 2};
    const double up[3] = {0, 1, 0};
    ck_assert(isnan(calx_heap_slope(&frame, 1)));
    ck_assert(isnan(calx_lacey_index(&frame, NULL, 0)));
    ck_assert_double_eq(calx_heap_height(&frame, up), 0);
}
END_TEST

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

int main(void)
{
    Suite *suite = suite_create("bed");
    TCase *test = tcase_create("bed");
    tcase_add_loop_test(test, the_index_is_right_at_both_ends, 0, COUNT(mixtures));
    tcase_add_test(test, shuffled_grains_have_an_index_of_one_on_average);
    tcase_add_test(test, automatic_cells_hold_about_eight_grains);
    tcase_add_loop_test(test, classes_follow_their_name, 0, COUNT(kinds));
    tcase_add_test(test, equal_radii_make_no_classes);
    tcase_add_loop_test(test, slopes_are_those_of_the_heap, 0, COUNT(slopes));
    tcase_add_test(test, bodies_of_groups_are_no_grains);
    tcase_add_test(test, no_grains_have_no_shape);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

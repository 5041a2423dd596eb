/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Quantities: values, reductions and names against numbers worked out by hand, on frames made by hand; the mixing index
 * against its definition at both ends and its mean over shuffles; slopes of a heap of known angles.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "core/heap.h"
#include "core/lacey.h"
#include "tests/fake_engine.h"

/* A few operations on numbers of order 1: some units in the last place. */
static const double ROUNDING = 1e-14;

enum { GRAINS = 4 };

static double positions[GRAINS][3] = {{0, 0, 0}, {1, 2, 0}, {2, 4, 0}, {3, 8, 1}};
static double velocities[GRAINS][3] = {{3, 4, 0}, {0, 0, 0}, {0, 0, -2}, {1, 0, 0}};
static double radii[GRAINS] = {0.5, 1, 0.5, 2};
static double masses[GRAINS] = {1, 2, 3, 4};
static double temperatures[GRAINS] = {300, 310, 320, 350};
static int32_t materials[GRAINS] = {0, 1, 0, 1};
static int32_t coordination[GRAINS] = {1, 2, 1, 0};
static int64_t pairs[2][2] = {{0, 1}, {1, -1}};
static double overlaps[2] = {0.05, 0.08};
static int32_t cell_walls[2] = {1, 0};
static double wall_forces[2][3] = {{0, 0, 7}, {3, 4, 0}};
static double wall_temperatures[2] = {400, 500};

static struct calx_scene scene;
static struct calx_stage_spec stage;
static struct calx_sim sim;

static void make_sim(void)
{
    scene = (struct calx_scene){.dimension = 3, .stage_count = 1, .stages = &stage};
    stage = (struct calx_stage_spec){.gravity = {{.value = 0}, {.value = -9.81}, {.value = 0}}};
    sim = (struct calx_sim){.scene = &scene, .time = 0.25, .step = 7, .contacts = 2};
    sim.frame = (struct calx_frame){
        .dimension = 3, .n = GRAINS, .position = positions, .velocity = velocities, .radius = radii, .mass = masses,
        .temperature = temperatures, .material = materials, .contacts = coordination, .contact_count = 2, .pair = pairs,
        .overlap = overlaps, .wall_cells = 2, .wall_of_cell = cell_walls, .wall_force = wall_forces,
        .wall_temperature = wall_temperatures,
    };
    sim.ledger = (struct calx_ledger){.kinetic = 1, .rotational = 2, .residual = 0.5, .scale = 4, .heat = 8,
                                      .heat_residual = 3, .heat_scale = 0, .momentum = {1, -2, 2}};
}

static void clear_sim(void)
{
    calx_measure_clear(&sim.cache);
}

/* ---- values ---------------------------------------------------------------------------------------------- */

static const struct {
    struct calx_probe probe;
    double value; /* NAN: does not exist */
} values[] = {
    {{.quantity = "no-such-thing", .particle = -1, .material = -1, .wall = -1}, NAN},
    {{.quantity = "", .particle = -1, .material = -1, .wall = -1}, NAN},
    {{.quantity = "temperature", .particle = GRAINS, .material = -1, .wall = -1}, NAN},
    {{.quantity = "temperature", .particle = -1, .material = 2, .wall = -1, .reduce = "mean"}, NAN},
    {{.quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "median"}, NAN},
    {{.quantity = "spin", .particle = 0, .material = -1, .wall = -1}, NAN},
    {{.quantity = "heat-flow", .particle = -1, .material = -1, .wall = -1, .reduce = "sum"}, NAN},
    {{.quantity = "wall-force", .particle = -1, .material = -1, .wall = -1}, NAN},
    {{.quantity = "wall-force", .particle = -1, .material = -1, .wall = 2}, NAN},
    {{.quantity = "lacey-index", .particle = -1, .material = -1, .wall = -1}, NAN},
    {{.quantity = "temperature", .particle = 3, .material = -1, .wall = -1}, 350},
    {{.quantity = "temperature", .particle = -1, .material = -1, .wall = -1}, 320},
    {{.quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "min"}, 300},
    {{.quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "max"}, 350},
    {{.quantity = "temperature", .particle = -1, .material = 1, .wall = -1, .reduce = "mean"}, 330},
    {{.quantity = "temperature", .particle = -1, .material = 0, .wall = -1, .reduce = "std"}, 10},
    {{.quantity = "mass", .particle = -1, .material = -1, .wall = -1, .reduce = "sum"}, 10},
    {{.quantity = "speed", .particle = -1, .material = -1, .wall = -1, .reduce = "max"}, 5},
    {{.quantity = "velocity", .particle = 0, .material = -1, .wall = -1}, 5},
    {{.quantity = "velocity", .particle = 0, .material = -1, .wall = -1, .component = 'm'}, 5},
    {{.quantity = "velocity", .particle = 2, .material = -1, .wall = -1, .component = 'z'}, -2},
    {{.quantity = "velocity", .particle = -1, .material = -1, .wall = -1, .component = 'x', .reduce = "sum"}, 4},
    {{.quantity = "position", .particle = 3, .material = -1, .wall = -1, .component = 'y'}, 8},
    {{.quantity = "radius", .particle = -1, .material = -1, .wall = -1, .reduce = "mean"}, 1},
    {{.quantity = "coordination-number", .particle = -1, .material = -1, .wall = -1, .reduce = "mean"}, 1},
    {{.quantity = "time", .particle = -1, .material = -1, .wall = -1}, 0.25},
    {{.quantity = "step", .particle = -1, .material = -1, .wall = -1}, 7},
    {{.quantity = "count", .particle = -1, .material = -1, .wall = -1}, 4},
    {{.quantity = "contacts", .particle = -1, .material = -1, .wall = -1}, 2},
    {{.quantity = "max-overlap", .particle = -1, .material = -1, .wall = -1}, 0.08},
    {{.quantity = "max-overlap-relative", .particle = -1, .material = -1, .wall = -1}, 0.1},
    {{.quantity = "momentum", .particle = -1, .material = -1, .wall = -1}, 3},
    {{.quantity = "momentum", .particle = -1, .material = -1, .wall = -1, .component = 'y'}, -2},
    {{.quantity = "wall-force", .particle = -1, .material = -1, .wall = 0}, 5},
    {{.quantity = "wall-force", .particle = -1, .material = -1, .wall = 1, .component = 'z'}, 7},
    {{.quantity = "wall-temperature", .particle = -1, .material = -1, .wall = 0}, 500},
    {{.quantity = "kinetic-energy", .particle = -1, .material = -1, .wall = -1}, 1},
    {{.quantity = "rotational-energy", .particle = -1, .material = -1, .wall = -1}, 2},
    {{.quantity = "heat-content", .particle = -1, .material = -1, .wall = -1}, 8},
    {{.quantity = "residual-relative", .particle = -1, .material = -1, .wall = -1}, 0.125},
    {{.quantity = "heat-residual-relative", .particle = -1, .material = -1, .wall = -1}, 3},
    {{.quantity = "bed-height", .particle = -1, .material = -1, .wall = -1}, 10.5},
};

START_TEST(a_probe_gives_its_value)
{
    double got = calx_sim_measure(&sim, &values[_i].probe);
    if (isnan(values[_i].value))
        ck_assert_msg(isnan(got), "%s: %g exists", values[_i].probe.quantity, got);
    else
        ck_assert_msg(fabs(got - values[_i].value) <= ROUNDING * fabs(values[_i].value), "%s: %.17g, not %.17g",
                      values[_i].probe.quantity, got, values[_i].value);
}
END_TEST

START_TEST(every_row_of_the_table_is_complete_and_found)
{
    for (size_t i = 0; i < calx_measure_count(); ++i) {
        const struct calx_measure *m = calx_measure_at(i);
        ck_assert_ptr_eq(calx_measure_find(m->name), m);
        ck_assert(m->unit[0] && m->doc[0]);
        ck_assert(m->components == 1 || m->components == 3);
    }
    ck_assert_ptr_null(calx_measure_find("temprature"));
    for (size_t i = 0; i < calx_column_count(); ++i)
        ck_assert_ptr_nonnull(calx_measure_find(calx_column_at(i)->quantity));
}
END_TEST

/* ---- names ----------------------------------------------------------------------------------------------- */

static const struct {
    const char *of, *quantity, *reduce; /* quantity NULL: a mistake */
    const char *hint;
} names[] = {
    {"mixin", NULL, NULL, "mixing"},
    {"temperature", NULL, NULL, "temperature_m"}, /* of a particle: a reduction is needed */
    {"heat-contend", NULL, NULL, "heat"},
    {"", NULL, NULL, "''"},
    {"mixing", "lacey-index", "", NULL},
    {"kinetic", "kinetic-energy", "", NULL},
    {"kinetic_energy", "kinetic-energy", "", NULL},
    {"heat-content", "heat-content", "", NULL},
    {"temperature_max", "temperature", "max", NULL},
    {"temperature-max", "temperature", "max", NULL},
    {"count", "count", "", NULL},
    {"particles", "count", "", NULL},
};

START_TEST(an_expectation_name_means_one_quantity)
{
    struct calx_probe mixing = {.name = "mixing", .quantity = "lacey-index", .particle = -1, .material = -1, .wall = -1};
    struct calx_probe space;
    struct calx_error error = {0};
    scene.probe_count = 1;
    scene.probes = &mixing;
    int code = calx_measure_resolve(&scene, names[_i].of, &space, &error);
    if (!names[_i].quantity) {
        ck_assert_int_eq(code, CALX_ERROR_INPUT);
        ck_assert_int_eq(error.code, CALX_ERROR_INPUT);
        ck_assert_msg(strstr(error.text, names[_i].hint), "%s", error.text);
        return;
    }
    ck_assert_int_eq(code, CALX_OK);
    ck_assert_str_eq(space.quantity, names[_i].quantity);
    ck_assert_str_eq(space.reduce, names[_i].reduce);
}
END_TEST

/* ---- the cache ------------------------------------------------------------------------------------------- */

START_TEST(one_record_makes_one_frame)
{
    const struct calx_probe hot = {.quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "max"};
    const struct calx_probe overlap = {.quantity = "max-overlap", .particle = -1, .material = -1, .wall = -1};
    for (int i = 0; i < 3; ++i) {
        calx_sim_measure(&sim, &hot);
        calx_sim_measure(&sim, &overlap);
    }
    ck_assert_int_eq(sim.frames_made, 1);
    temperatures[3] = 400;
    sim.step += 1;
    ck_assert_double_eq(calx_sim_measure(&sim, &hot), 400);
    temperatures[3] = 350;
    ck_assert_int_eq(sim.frames_made, 2);
}
END_TEST

START_TEST(walls_change_since_the_frame_that_was_written)
{
    static const bool changed[] = {true, false, false, false, true, false, false};
    static const bool written[] = {true, false, true, false, false, true, true};
    static const bool expected[] = {true, false, false, false, true, true, false};
    for (size_t i = 0; i < sizeof changed / sizeof *changed; ++i) {
        sim.step += 1;
        sim.frame.walls_changed = changed[i];
        ck_assert_msg(calx_measure_frame(&sim)->walls_changed == expected[i], "frame %zu", i);
        if (written[i])
            calx_measure_mark_written(&sim);
    }
}
END_TEST

START_TEST(a_new_stage_makes_a_new_frame)
{
    calx_measure_frame(&sim);
    calx_measure_begin_stage(&sim, 1);
    calx_measure_frame(&sim);
    ck_assert_int_eq(sim.frames_made, 2);
}
END_TEST

/* ---- mixing ---------------------------------------------------------------------------------------------- */

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
    return (struct calx_frame){.dimension = 2, .n = LATTICE, .position = lattice, .radius = lattice_radii};
}

static int left_half(int i) { return i % SIDE < SIDE / 2; }
static int checkers(int i) { return (i % SIDE + i / SIDE) % 2; }
static int nobody(int i) { return i < 0; }
static int one_in_four(int i) { return i % 2 == 0 && i / SIDE % 2 == 0; }

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
    /* four standard errors of the mean; sr2 without the finite population (C/N) would be off by 1/N/(1-C/N) = 4e-3 */
    double tolerance = 4 * deviation / sqrt(SHUFFLES);
    ck_assert_double_lt(tolerance, 3e-3);
    ck_assert_double_eq_tol(mean, 1, tolerance);
}
END_TEST

START_TEST(automatic_cells_hold_about_eight_grains)
{
    /* squares of edge 0.5*sqrt(8 pi/0.8) = 2.802 on a lattice of unit distance: the halves share one column of cells at most */
    struct calx_frame frame = make_lattice();
    uint8_t classes[LATTICE];
    for (int i = 0; i < LATTICE; ++i)
        classes[i] = (uint8_t)left_half(i);
    double cell = 0.5 * sqrt(8 * M_PI / 0.8);
    ck_assert_double_eq(calx_lacey_index(&frame, classes, 0), calx_lacey_index(&frame, classes, cell));
    ck_assert_double_lt(calx_lacey_index(&frame, classes, 0), 0.2);
}
END_TEST

static const struct {
    const char *name;
    double up[3];
    uint8_t classes[GRAINS];
} kinds[] = {
    {"start-hight", {0, 1, 0}, {0, 0, 0, 0}},
    {"start-height", {0, 1, 0}, {0, 0, 1, 1}},
    {"start-height", {0, -1, 0}, {1, 1, 0, 0}},
    {"start-x", {0, 1, 0}, {0, 0, 1, 1}},
    {"material", {0, 1, 0}, {0, 1, 0, 1}},
    {"start-radius", {0, 1, 0}, {0, 1, 0, 1}},
    {"start-temperature", {0, 1, 0}, {0, 0, 1, 1}},
};

START_TEST(classes_follow_their_name)
{
    uint8_t classes[GRAINS] = {9, 9, 9, 9};
    calx_lacey_classes(&sim.frame, kinds[_i].name, kinds[_i].up, classes);
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

START_TEST(a_stage_assigns_the_classes_of_its_own_probes)
{
    struct calx_probe probe = {.quantity = "lacey-index", .particle = -1, .material = -1, .wall = -1,
                               .classes = "start-height", .stage = 1, .cell = 100};
    uint8_t classes[GRAINS] = {9, 9, 9, 9};
    static const uint8_t assigned[GRAINS] = {0, 0, 1, 1};
    scene.probe_count = 1;
    scene.probes = &probe;
    sim.classes = classes;
    calx_measure_begin_stage(&sim, 0);
    ck_assert_int_eq(classes[0], 9);
    calx_measure_begin_stage(&sim, 1);
    ck_assert_mem_eq(classes, assigned, GRAINS);
    /* all in one cell: no variance, and a random mixture has none either: M = 1 */
    ck_assert_double_eq(calx_sim_measure(&sim, &probe), 1);
}
END_TEST

/* ---- heap ------------------------------------------------------------------------------------------------ */

enum { COLUMNS = 41, TOP = 18, HEAP = COLUMNS + 1 };

/* One grain per column of a width that is a power of two (so that the columns are exact), on two straight slopes. */
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

static const struct { double left, right; } slopes[] = {{45, 45}, {40, 30}, {60, 20}, {42, -1}};

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
    Suite *suite = suite_create("measure");
    TCase *test = tcase_create("measure");
    tcase_add_checked_fixture(test, make_sim, clear_sim);
    tcase_add_loop_test(test, a_probe_gives_its_value, 0, COUNT(values));
    tcase_add_test(test, every_row_of_the_table_is_complete_and_found);
    tcase_add_loop_test(test, an_expectation_name_means_one_quantity, 0, COUNT(names));
    tcase_add_test(test, one_record_makes_one_frame);
    tcase_add_test(test, walls_change_since_the_frame_that_was_written);
    tcase_add_test(test, a_new_stage_makes_a_new_frame);
    tcase_add_loop_test(test, the_index_is_right_at_both_ends, 0, COUNT(mixtures));
    tcase_add_test(test, shuffled_grains_have_an_index_of_one_on_average);
    tcase_add_test(test, automatic_cells_hold_about_eight_grains);
    tcase_add_loop_test(test, classes_follow_their_name, 0, COUNT(kinds));
    tcase_add_test(test, equal_radii_make_no_classes);
    tcase_add_test(test, a_stage_assigns_the_classes_of_its_own_probes);
    tcase_add_loop_test(test, slopes_are_those_of_the_heap, 0, COUNT(slopes));
    tcase_add_test(test, no_grains_have_no_shape);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

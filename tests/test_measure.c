/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Quantities: values, reductions and names against numbers worked out by hand, on frames made by
 * hand; frames are made once per step.
 */
#include <check.h>
#include <math.h>
#include <string.h>

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
static double wall_forces[2][3] = {{3, 4, 0}, {0, 0, 7}};
static double wall_temperatures[2] = {500, 400};

static struct calx_scene scene;
static struct calx_stage_spec stage;
static struct calx_sim sim;

static void make_sim(void)
{
    scene = (struct calx_scene){.dimension = 3, .stage_count = 1, .stages = &stage};
    stage = (struct calx_stage_spec){.gravity = {{.value = 0}, {.value = -9.81}, {.value = 0}}};
    sim = (struct calx_sim){.scene = &scene, .time = 0.25, .step = 7, .contacts = 2};
    sim.frame = (struct calx_frame){
        .dimension = 3,
        .n = GRAINS,
        .position = positions,
        .velocity = velocities,
        .radius = radii,
        .mass = masses,
        .temperature = temperatures,
        .material = materials,
        .contacts = coordination,
        .contact_count = 2,
        .pair = pairs,
        .overlap = overlaps,
        .walls = 2,
        .force_on_wall = wall_forces,
        .temperature_of_wall = wall_temperatures,
    };
    sim.ledger = (struct calx_ledger){.kinetic = 1,
                                      .rotational = 2,
                                      .residual = 0.5,
                                      .scale = 4,
                                      .heat = 8,
                                      .heat_residual = 3,
                                      .heat_scale = 0,
                                      .momentum = {1, -2, 2}};
}

static void clear_sim(void)
{
    calx_measure_clear(&sim.cache);
}

/* ---- values ---- */

#define P(what, id, of_material, of_wall, axis, reduction)                                         \
    {                                                                                              \
        .quantity = what, .particle = id, .material = of_material, .wall = of_wall,                \
        .component = axis, .reduce = reduction                                                     \
    }

static const struct {
    struct calx_probe probe;
    double value; /* NAN: does not exist */
} values[] = {
    {P("no-such-thing", -1, -1, -1, 0, ""), NAN},
    {P("", -1, -1, -1, 0, ""), NAN},
    {P("temperature", GRAINS, -1, -1, 0, ""), NAN},
    {P("temperature", -1, 2, -1, 0, "mean"), NAN},
    {P("temperature", -1, -1, -1, 0, "median"), NAN},
    {P("spin", 0, -1, -1, 0, ""), NAN},
    {P("heat-flow", -1, -1, -1, 0, "sum"), NAN},
    {P("wall-force", -1, -1, -1, 0, ""), NAN},
    {P("wall-force", -1, -1, 2, 0, ""), NAN},
    {P("lacey-index", -1, -1, -1, 0, ""), NAN},
    {P("peak-force", -1, -1, -1, 0, ""), NAN}, /* nobody watches */
    {P("temperature", 3, -1, -1, 0, ""), 350},
    {P("temperature", -1, -1, -1, 0, ""), 320},
    {P("temperature", -1, -1, -1, 0, "min"), 300},
    {P("temperature", -1, -1, -1, 0, "max"), 350},
    {P("temperature", -1, 1, -1, 0, "mean"), 330},
    {P("temperature", -1, 0, -1, 0, "std"), 10},
    {P("mass", -1, -1, -1, 0, "sum"), 10},
    {P("speed", -1, -1, -1, 0, "max"), 5},
    {P("velocity", 0, -1, -1, 0, ""), 5},
    {P("velocity", 0, -1, -1, 'm', ""), 5},
    {P("velocity", 2, -1, -1, 'z', ""), -2},
    {P("velocity", -1, -1, -1, 'x', "sum"), 4},
    {P("position", 3, -1, -1, 'y', ""), 8},
    {P("radius", -1, -1, -1, 0, "mean"), 1},
    {P("coordination-number", -1, -1, -1, 0, "mean"), 1},
    {P("time", -1, -1, -1, 0, ""), 0.25},
    {P("step", -1, -1, -1, 0, ""), 7},
    {P("count", -1, -1, -1, 0, ""), 4},
    {P("contacts", -1, -1, -1, 0, ""), 2},
    {P("max-overlap", -1, -1, -1, 0, ""), 0.08},
    {P("max-overlap-relative", -1, -1, -1, 0, ""), 0.1},
    {P("momentum", -1, -1, -1, 0, ""), 3},
    {P("momentum", -1, -1, -1, 'y', ""), -2},
    {P("wall-force", -1, -1, 0, 0, ""), 5},
    {P("wall-force", -1, -1, 1, 'z', ""), 7},
    {P("wall-temperature", -1, -1, 0, 0, ""), 500},
    {P("kinetic-energy", -1, -1, -1, 0, ""), 1},
    {P("rotational-energy", -1, -1, -1, 0, ""), 2},
    {P("heat-content", -1, -1, -1, 0, ""), 8},
    {P("residual-relative", -1, -1, -1, 0, ""), 0.125},
    {P("heat-residual-relative", -1, -1, -1, 0, ""), 3},
    {P("bed-height", -1, -1, -1, 0, ""), 10.5},
};

START_TEST(a_probe_gives_its_value)
{
    double got = calx_sim_measure(&sim, &values[_i].probe);
    if (isnan(values[_i].value))
        ck_assert_msg(isnan(got), "%s: %g exists", values[_i].probe.quantity, got);
    else
        ck_assert_msg(fabs(got - values[_i].value) <= ROUNDING * fabs(values[_i].value),
                      "%s: %.17g, not %.17g", values[_i].probe.quantity, got, values[_i].value);
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

/* ---- names ---- */

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
    struct calx_probe mixing = {
        .name = "mixing", .quantity = "lacey-index", .particle = -1, .material = -1, .wall = -1};
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

/* ---- the cache ---- */

START_TEST(one_record_makes_one_frame)
{
    const struct calx_probe hot = {
        .quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "max"};
    const struct calx_probe overlap = {
        .quantity = "max-overlap", .particle = -1, .material = -1, .wall = -1};
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

/* ---- classes ---- */

START_TEST(a_stage_assigns_the_classes_of_its_own_probes)
{
    struct calx_probe probe = {.quantity = "lacey-index",
                               .particle = -1,
                               .material = -1,
                               .wall = -1,
                               .classes = "start-height",
                               .stage = 1,
                               .cell = 100};
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
    tcase_add_test(test, a_stage_assigns_the_classes_of_its_own_probes);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

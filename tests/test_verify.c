/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Expectations: each kind against a short history of states given by hand, with what must pass and
 * what must fail; the same verdicts after a stop and restore in the middle.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "io/verify.h"
#include "tests/fake_engine.h"

/* The history: at each state the time, the kinetic energy, and the stage that its step belonged to
 * and the one it led to. */
static const struct {
    double time, value;
    int from, to;
} history[] = {
    {0, 1, 0, 0}, {0.1, 4, 0, 0}, {0.2, 2, 0, 1}, {0.3, -3, 1, 1}, {0.4, 1.5, 1, 1},
};

enum { STATES = sizeof history / sizeof *history };

static double twice_time(const void *context, double t, const double x[3])
{
    (void)context, (void)x;
    return 2 * t;
}

#define EXPECT(...)                                                                                \
    {                                                                                              \
        .of = "kinetic", .above = NAN, .below = NAN, __VA_ARGS__                                   \
    }
#define BOUND(...)                                                                                 \
    {                                                                                              \
        .of = "kinetic", __VA_ARGS__                                                               \
    }
#define VALUE(v) .has_value = true, .value = {.value = v}

static const struct {
    struct calx_expect expect;
    bool passed;
    double got, time;
} cases[] = {
    /* what must fail */
    {EXPECT(.when = CALX_AT_END, VALUE(1.4), .atol = 0.09), false, 1.5, 0.4},
    {EXPECT(.when = CALX_AT_END, VALUE(NAN), .atol = 1), false, 1.5, 0.4},
    {EXPECT(.when = CALX_AT_TIME, .time = 0.5, VALUE(1.5)), false, NAN, NAN},
    {EXPECT(.when = CALX_AT_END, .stage = "third", VALUE(1.5)), false, NAN, NAN},
    {BOUND(.when = CALX_AT_END, .above = 1.6, .below = NAN), false, 1.5, 0.4},
    {BOUND(.when = CALX_AT_END, .above = 0, .below = 1), false, 1.5, 0.4},
    {BOUND(.when = CALX_ALWAYS, .above = NAN, .below = 3), false, 4, 0.1},
    {EXPECT(.when = CALX_ALWAYS, VALUE(1), .atol = 3.5), false, -3, 0.3},
    {EXPECT(.when = CALX_CHANGE, VALUE(0), .rtol = 0.3), false, 0.5, 0.4},
    {{.of = "temperature_max",
      .when = CALX_AT_END,
      VALUE(300),
      .atol = 1e9,
      .above = NAN,
      .below = NAN},
     false,
     NAN,
     0.4},
    {{.of = "temperature_max", .when = CALX_AT_END, .above = 0, .below = NAN}, false, NAN, 0.4},
    /* what must pass */
    {EXPECT(.when = CALX_AT_END, VALUE(1.5)), true, 1.5, 0.4},
    {EXPECT(.when = CALX_AT_END, VALUE(1.4), .atol = 0.05, .rtol = 0.04), true, 1.5, 0.4},
    {EXPECT(.when = CALX_AT_END, .stage = "first", VALUE(2)), true, 2, 0.2},
    {EXPECT(.when = CALX_AT_TIME, .time = 0, VALUE(1)), true, 1, 0},
    {EXPECT(.when = CALX_AT_TIME, .time = 0.1 + 1e-9, VALUE(4)), true, 4,
     0.1}, /* within the rounding of a step */
    {EXPECT(.when = CALX_AT_TIME, .time = 0.15, VALUE(2)), true, 2,
     0.2}, /* the step that reaches it */
    {EXPECT(.when = CALX_AT_TIME, .time = 0.3, .has_value = true, .value = {twice_time, NULL, 0},
            .atol = 3.6 + 1e-12),
     true, -3, 0.3},
    {EXPECT(.when = CALX_MINIMUM, VALUE(-3)), true, -3, 0.3},
    {EXPECT(.when = CALX_MAXIMUM, VALUE(4)), true, 4, 0.1},
    {EXPECT(.when = CALX_MAXIMUM, .stage = "second", VALUE(2)), true, 2, 0.2},
    {EXPECT(.when = CALX_ALWAYS, VALUE(1), .atol = 4), true, -3, 0.3},
    {BOUND(.when = CALX_ALWAYS, .above = -3, .below = 4), true, 1.5, 0.4},
    {EXPECT(.when = CALX_CHANGE, VALUE(0.5)), true, 0.5, 0.4},
    {EXPECT(.when = CALX_CHANGE, VALUE(0), .rtol = 0.34), true, 0.5, 0.4}, /* 0.5 <= 0.34*1.5 */
    {EXPECT(.when = CALX_CHANGE, .stage = "second", VALUE(-0.5)), true, -0.5, 0.4},
};

static struct calx_stage_spec stages[3] = {
    {.name = "first"}, {.name = "second"}, {.name = "third"}};
static struct calx_scene scene;
static struct calx_sim sim;
static struct calx_expect expect;

static void make_sim(void)
{
    scene = (struct calx_scene){
        .stage_count = 3, .stages = stages, .expect_count = 1, .expects = &expect};
    sim = (struct calx_sim){.scene = &scene};
}

static void clear_sim(void)
{
    calx_measure_clear(&sim.cache);
}

static struct calx_verify *create(void)
{
    struct calx_error error;
    struct calx_verify *verify = calx_verify_create(&scene, &error);
    ck_assert_msg(verify != NULL, "%s", verify ? "" : error.text);
    return verify;
}

/* States from first to last; those without a record of the CSV are judged only if due. */
static void show(struct calx_verify *verify, int first, int last)
{
    for (int i = first; i < last; ++i) {
        double before = i ? history[i - 1].time : history[i].time;
        sim.time = history[i].time;
        sim.ledger.kinetic = history[i].value;
        sim.stage = history[i].to;
        sim.step = i;
        calx_verify_record(verify, &sim, before, history[i].from);
    }
}

static void check_verdict(struct calx_verify *verify, int i)
{
    struct calx_verdict v = calx_verify_verdict(verify, 0);
    ck_assert_msg(v.passed == cases[i].passed, "case %d: error %g, tolerance %g", i, v.error,
                  v.tolerance);
    ck_assert_msg(v.got == cases[i].got || (isnan(v.got) && isnan(cases[i].got)), "case %d: got %g",
                  i, v.got);
    ck_assert_msg(v.time == cases[i].time || (isnan(v.time) && isnan(cases[i].time)),
                  "case %d: time %g", i, v.time);
    ck_assert_uint_eq(calx_verify_failures(verify), !cases[i].passed);
}

START_TEST(an_unknown_quantity_is_named_with_its_place)
{
    struct calx_error error;
    expect = (struct calx_expect){.of = "kinetik", .place = {"some.xml", 12}};
    ck_assert_ptr_null(calx_verify_create(&scene, &error));
    ck_assert_int_eq(error.code, CALX_ERROR_INPUT);
    ck_assert_int_eq(error.line, 12);
    ck_assert_str_eq(error.file, "some.xml");
    ck_assert_msg(strstr(error.text, "kinetic"), "%s", error.text);
}
END_TEST

START_TEST(an_expectation_is_judged)
{
    expect = cases[_i].expect;
    struct calx_verify *verify = create();
    show(verify, 0, STATES);
    check_verdict(verify, _i);
    calx_verify_free(verify);
}
END_TEST

START_TEST(a_stop_in_the_middle_changes_no_verdict)
{
    expect = cases[_i].expect;
    for (int stop = 1; stop < STATES; ++stop) {
        struct calx_error error;
        struct calx_verify *before = create(), *after = create();
        show(before, 0, stop);
        struct calx_block block = calx_verify_save(before);
        ck_assert_int_eq(calx_verify_restore(after, &block, &error), CALX_OK);
        calx_verify_free(before);
        show(after, stop, STATES);
        check_verdict(after, _i);
        calx_verify_free(after);
    }
}
END_TEST

START_TEST(what_was_kept_of_other_expectations_is_refused)
{
    struct calx_error error;
    expect = cases[0].expect;
    struct calx_verify *verify = create();
    struct calx_block block = calx_verify_save(verify);
    block.bytes *= 2;
    ck_assert_int_eq(calx_verify_restore(verify, &block, &error), CALX_ERROR_INPUT);
    calx_verify_free(verify);
}
END_TEST

START_TEST(a_time_is_due_in_one_step_only)
{
    static const double step = 1e-5;
    expect = (struct calx_expect)EXPECT(.when = CALX_AT_TIME, .time = 0.02, VALUE(0));
    struct calx_verify *verify = create();
    int due = 0, first = -1;
    double time = 0;
    for (int i = 1; i <= 4000; ++i) { /* summed steps, which do not add up to 0.02 exactly */
        double before = time;
        time += step;
        bool now = calx_verify_is_due(verify, before, time);
        due += now;
        first = now && first < 0 ? i : first;
    }
    ck_assert_int_eq(due, 1);
    ck_assert_int_eq(first, 2000);
    calx_verify_free(verify);
}
END_TEST

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

int main(void)
{
    Suite *suite = suite_create("verify");
    TCase *test = tcase_create("verify");
    tcase_add_checked_fixture(test, make_sim, clear_sim);
    tcase_add_test(test, an_unknown_quantity_is_named_with_its_place);
    tcase_add_loop_test(test, an_expectation_is_judged, 0, COUNT(cases));
    tcase_add_loop_test(test, a_stop_in_the_middle_changes_no_verdict, 0, COUNT(cases));
    tcase_add_test(test, what_was_kept_of_other_expectations_is_refused);
    tcase_add_test(test, a_time_is_due_in_one_step_only);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

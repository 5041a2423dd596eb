/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers with units, and expressions: what is refused and with which words, then what is read, to
 * the bit where the decimal prefix allows it.
 */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/expression.h"
#include "io/quantity.h"

static struct calx_error error;
static struct calx_scene *scene;

static void set_up(void)
{
    error = (struct calx_error){0};
    scene = calx_scene_create();
    ck_assert_ptr_nonnull(scene);
}

static void tear_down(void)
{
    calx_scene_free(scene);
}

/* ---- quantities
 * ---------------------------------------------------------------------------------------- */

static const struct {
    const char *text, *unit, *words[2];
} refused[] = {
    {"", "m", {"holds no number", "'m'"}},
    {"   ", "m", {"holds no number", "'m'"}},
    {"mm", "m", {"no number", "mm"}},
    {"nan", "m", {"not finite", "nan"}},
    {"NaN m", "m", {"not finite", "NaN"}},
    {"-inf", "m", {"not finite", "inf"}},
    {"infinity m", "m", {"not finite", "infinity"}},
    {"1e999 m", "m", {"not finite", "1e999"}},
    {"1e307 km", "m", {"not finite", "1e307"}},
    {"0x10 m", "m", {"no number", "0x10"}},
    {"2,5 m", "m", {"no number", "2,5"}},
    {"2 kg", "m", {"'kg'", "'m'"}},
    {"2 mmm", "m", {"unknown unit 'mmm'", "'m'"}},
    {"2 m", "1", {"'m'", "without unit"}},
    {"2 m 3 m", "m", {"more than one number", "2 m 3 m"}},
    {"10 rpm", "1/s", {"'rpm'", "'1/s'"}}, /* an angle is no pure number */
    {"10 Hz", "rad/s", {"'Hz'", "'rad/s'"}},
    {"1 - 2", "m", {"unknown unit '-'", "'m'"}},
    {"2 m m", "m", {"'m m'", "'m'"}},
    {"1 (", "m", {"unknown unit '('", "'m'"}},
};

START_TEST(test_refused)
{
    double v = 0;
    ck_assert_int_eq(calx_quantity_parse(refused[_i].text, refused[_i].unit, &v, &error),
                     CALX_ERROR_INPUT);
    for (int k = 0; k < 2; k++)
        ck_assert_msg(strstr(error.text, refused[_i].words[k]) != NULL, "'%s' lacks '%s'",
                      error.text, refused[_i].words[k]);
    ck_assert_int_eq(calx_quantity_parse(refused[_i].text, refused[_i].unit, &v, NULL),
                     CALX_ERROR_INPUT);
}
END_TEST

/* Units other than powers of ten are products of doubles: three roundings. */
#define ROUNDING 4e-16

static const struct {
    const char *text, *unit;
    double value, tolerance; /* relative; 0: the same bits */
} read[] = {
    {"2", "m", 2, 0},
    {"-1.5e-3", "m", -1.5e-3, 0},
    {"3.8 mm", "m", 0.0038, 0},
    {"3.8mm", "m", 0.0038, 0},
    {"  .5\tkm\n", "m", 500, 0},
    {"6000 N/m", "N/m", 6000, 0},
    {"172 J/(kg K)", "J/(kg K)", 172, 0},
    {"16 W/(m degC)", "W/(m K)", 16, ROUNDING},
    {"7 uN m", "J", 7e-6, 0},
    {"210 GPa", "Pa", 210e9, 0},
    {"5 1/s", "1/s", 5, 0},
    {"50 %", "1", 0.5, 0},
    {"107 degC", "K", 380.15, ROUNDING},
    {"25 \302\260C", "K", 298.15, ROUNDING},
    {"90 deg", "rad", 1.5707963267948966, ROUNDING},
    {"10 rpm", "rad/s", 1.0471975511965976, ROUNDING},
    {"2 rev/min", "rad/s", 0.20943951023931953, ROUNDING},
    {"60 1/min", "1/s", 1, ROUNDING},
    {"3 J/m2", "N/m", 3, ROUNDING},
};

START_TEST(test_read)
{
    double v = 0;
    int code = calx_quantity_parse(read[_i].text, read[_i].unit, &v, &error);
    ck_assert_msg(code == CALX_OK, "%s: %s", read[_i].text, error.text);
    ck_assert_msg(fabs(v - read[_i].value) <= read[_i].tolerance * fabs(read[_i].value),
                  "%s gives %.17g", read[_i].text, v);
}
END_TEST

START_TEST(test_difference_of_temperatures)
{
    double v = 0;
    ck_assert_int_eq(calx_quantity_parse_difference("5 degC", "K", &v, &error), CALX_OK);
    ck_assert_double_eq(v, 5);
    ck_assert_int_eq(calx_quantity_parse_difference("5 m", "K", &v, &error), CALX_ERROR_INPUT);
}
END_TEST

static const struct {
    const char *text;
    size_t count; /* 0: refused */
    double values[4];
} lists[] = {
    {"1 mm 2", 0, {0}}, /* the last one has no unit */
    {"1 2 3 4 5 mm", 0, {0}},
    {"1 2 q", 0, {0}},
    {"mm 1", 0, {0}},
    {"1", 1, {1}},
    {"1 2 3", 3, {1, 2, 3}},
    {"1 2 mm", 2, {0.001, 0.002}},
    {"1 mm 2 cm", 2, {0.001, 0.02}},
    {"1 2 mm 3 4 cm", 4, {0.001, 0.002, 0.03, 0.04}},
};

START_TEST(test_lists)
{
    double values[4];
    size_t count = 0;
    int code = calx_quantity_parse_list(lists[_i].text, "m", values, 4, &count, &error);
    ck_assert_int_eq(code, lists[_i].count ? CALX_OK : CALX_ERROR_INPUT);
    if (code)
        return;
    ck_assert_uint_eq(count, lists[_i].count);
    for (size_t k = 0; k < count; k++)
        ck_assert_double_eq(values[k], lists[_i].values[k]);
}
END_TEST

START_TEST(test_units)
{
    double scale = 0, offset = 0;
    ck_assert_int_eq(calx_quantity_check_unit("nonsense", &error), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "nonsense"));
    ck_assert_int_eq(calx_quantity_check_unit("W/(m K)", &error), CALX_OK);
    ck_assert_int_eq(calx_quantity_conversion("degC", "kg", &scale, &offset, &error),
                     CALX_ERROR_INPUT);
    ck_assert_int_eq(calx_quantity_conversion("degC", "K", &scale, &offset, &error), CALX_OK);
    ck_assert_double_eq(scale, 1);
    ck_assert_double_eq(offset, 273.15);
}
END_TEST

/* ---- expressions
 * --------------------------------------------------------------------------------------- */

static const struct calx_expression_options length = {
    .unit = "m", .variables = "tx", .where = "a = 2; b = a^2*_pi;"};

static const struct {
    const char *text, *where, *words[2];
} bad_expressions[] = {
    {"2 kg", NULL, {"'kg'", "'m'"}},
    {"2 mmm", NULL, {"mmm", "'m'"}},
    {"2*q", NULL, {"character 3", "\"q\""}},
    {"y", NULL, {"\"y\"", "tx"}}, /* not a variable here */
    {"sin(", NULL, {"expression", "end"}},
    {"t +", NULL, {"expression", "t +"}},
    {"t*2 [kg]", NULL, {"'kg'", "'m'"}},
    {"1/0", NULL, {"not finite", "1/0"}},
    {"log(-1)", NULL, {"not finite", "log"}},
    {"t, x", NULL, {"2 numbers", "one"}},
    {"", NULL, {"expression", ""}},
    {"t", "a", {"where", "name = expression"}},
    {"t", "a = 1/0", {"where", "not finite"}},
    {"t", "a = q", {"\"q\"", ""}},
    {"t", "1 = 2", {"", ""}},
};

START_TEST(test_bad_expressions)
{
    struct calx_function f = {0};
    struct calx_expression_options options = length;
    if (bad_expressions[_i].where)
        options.where = bad_expressions[_i].where;
    ck_assert_int_eq(calx_expression_read(bad_expressions[_i].text, &options, scene, &f, &error),
                     CALX_ERROR_INPUT);
    for (int k = 0; k < 2; k++)
        ck_assert_msg(strstr(error.text, bad_expressions[_i].words[k]) != NULL, "'%s' lacks '%s'",
                      error.text, bad_expressions[_i].words[k]);
}
END_TEST

START_TEST(test_endless_expression)
{
    static char text[100000];
    struct calx_function f = {0};
    memset(text, '(', sizeof text - 1);
    ck_assert_int_eq(calx_expression_read(text, &length, scene, &f, &error), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "characters"));
}
END_TEST

/* Evaluated at t = 0.5 s, x = 3 m; muParser and this file call the same libm. */
static const struct {
    const char *text;
    bool varies;
    double value;
} expressions[] = {
    {"2 mm", false, 0.002},
    {"a", false, 2},
    {"b", false, 4 * 3.141592653589793},
    {"2*3", false, 6},
    {"t", true, 0.5},
    {"x - t", true, 2.5},
    {"x*t [mm]", true, 1.5 * 0.001},
    {"1 + a*t^2", true, 1.5},
    {"t > 1 ? 5 : 7", true, 7},
};

START_TEST(test_expressions)
{
    struct calx_function f = {0};
    ck_assert_int_eq(calx_expression_read(expressions[_i].text, &length, scene, &f, &error),
                     CALX_OK);
    ck_assert_int_eq(f.eval != NULL, expressions[_i].varies);
    ck_assert_double_eq(calx_evaluate(&f, 0.5, (double[3]){3, 0, 0}), expressions[_i].value);
}
END_TEST

START_TEST(test_expression_of_temperature)
{
    struct calx_expression_options kelvin = {.unit = "K", .variables = "t"};
    struct calx_function f = {0};
    ck_assert_int_eq(calx_expression_read("25 + 10*t [degC]", &kelvin, scene, &f, &error), CALX_OK);
    ck_assert_double_eq(calx_evaluate(&f, 0.5, NULL), 30 + 273.15);
    kelvin.difference = true;
    ck_assert_int_eq(calx_expression_read("10*t [degC]", &kelvin, scene, &f, &error), CALX_OK);
    ck_assert_double_eq(calx_evaluate(&f, 0.5, NULL), 5);
}
END_TEST

static const struct {
    const char *text;
    size_t count;     /* 0: refused */
    double values[3]; /* at t = 0.5 s */
} components[] = {
    {"", 0, {0}},
    {"[mm]", 0, {0}},
    {"1 + t 0", 0, {0}}, /* blanks inside need semicolons */
    {"t t t t", 0, {0}},
    {"0 kg", 0, {0}},
    {"0 -9.81 m", 2, {0, -9.81}},
    {"t 0", 2, {0.5, 0}},
    {"1 + t; 0", 2, {1.5, 0}},
    {"t 2*t (1 + t) [mm]", 3, {0.0005, 0.001, 0.0015}},
};

START_TEST(test_components)
{
    struct calx_function f[3] = {{0}, {0}, {0}};
    size_t count = 0;
    int code = calx_expression_read_list(components[_i].text, &length, scene, f, &count, &error);
    ck_assert_int_eq(code, components[_i].count ? CALX_OK : CALX_ERROR_INPUT);
    if (code)
        return;
    ck_assert_uint_eq(count, components[_i].count);
    for (size_t k = 0; k < count; k++)
        ck_assert_double_eq(calx_evaluate(&f[k], 0.5, (double[3]){0, 0, 0}),
                            components[_i].values[k]);
}
END_TEST

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

int main(void)
{
    Suite *suite = suite_create("quantity");
    TCase *cases = tcase_create("quantity");
    tcase_add_checked_fixture(cases, set_up, tear_down);
    tcase_add_loop_test(cases, test_refused, 0, COUNT(refused));
    tcase_add_loop_test(cases, test_read, 0, COUNT(read));
    tcase_add_test(cases, test_difference_of_temperatures);
    tcase_add_loop_test(cases, test_lists, 0, COUNT(lists));
    tcase_add_test(cases, test_units);
    tcase_add_loop_test(cases, test_bad_expressions, 0, COUNT(bad_expressions));
    tcase_add_test(cases, test_endless_expression);
    tcase_add_loop_test(cases, test_expressions, 0, COUNT(expressions));
    tcase_add_test(cases, test_expression_of_temperature);
    tcase_add_loop_test(cases, test_components, 0, COUNT(components));
    suite_add_tcase(suite, cases);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers and durations as the progress shows them; silence when it has no file. The bar itself is
 * tested with the program.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "io/terminal.h"

static const struct {
    double number;
    const char *text;
} numbers[] = {
    {NAN, "nan"},      {INFINITY, "infT"}, {-1500, "-1.5k"}, {0, "0"},         {1, "1"},
    {0.25, "0.25"},    {999, "999"},       {999.6, "1k"},    {12345, "12.3k"}, {1e6, "1M"},
    {2.61e9, "2.61G"}, {3e12, "3T"},       {5e15, "5e+03T"},
};

START_TEST(a_number_is_short)
{
    char text[32];
    ck_assert_str_eq(calx_terminal_number(numbers[_i].number, text, sizeof text), numbers[_i].text);
}
END_TEST

static const struct {
    double seconds;
    const char *text;
} durations[] = {
    {NAN, "long"},         {INFINITY, "long"}, {1e9, "long"},       {0, "0 s"},
    {0.123, "0.12 s"},     {9.4, "9.4 s"},     {12, "12 s"},        {59.4, "59 s"},
    {59.6, "1:00"},        {187, "3:07"},      {3599.7, "1:00:00"}, {3753, "1:02:33"},
    {360000, "100:00:00"},
};

START_TEST(a_duration_reads_as_a_clock)
{
    char text[32];
    ck_assert_str_eq(calx_terminal_duration(durations[_i].seconds, text, sizeof text),
                     durations[_i].text);
}
END_TEST

START_TEST(a_line_stands_above_the_bar)
{
    char text[64] = "";
    struct calx_terminal terminal = {.drawn = true};
    calx_terminal_say(&terminal, "nobody %s", "listens");
    FILE *file = fmemopen(text, sizeof text, "w");
    ck_assert_ptr_nonnull(file);
    terminal.file = file;
    calx_terminal_say(&terminal, "stage %d", 2);
    ck_assert(!terminal.drawn);
    calx_terminal_say(&terminal, "end");
    fclose(file);
    ck_assert_str_eq(text, "\r\033[Kstage 2\nend\n");
}
END_TEST

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

int main(void)
{
    Suite *suite = suite_create("terminal");
    TCase *test = tcase_create("terminal");
    tcase_add_loop_test(test, a_number_is_short, 0, COUNT(numbers));
    tcase_add_loop_test(test, a_duration_reads_as_a_clock, 0, COUNT(durations));
    tcase_add_test(test, a_line_stands_above_the_bar);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The CSV table: header, digits, replaced rows, going on after a restart with rows cut off. Folders
 * and disks that cannot be written come first.
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "io/table.h"
#include "tests/folder.h"

START_TEST(test_unwritable_folder)
{
    struct calx_table_column column = {"time", "s"};
    ck_assert_ptr_null(calx_table_create(in_folder("missing/a.csv"), &column, 1, &error));
    ck_assert_int_eq(error.code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, "No such file or directory"));
}
END_TEST

START_TEST(test_disk_full)
{
    struct calx_table_column column = {"time", "s"};
    struct calx_table *t = calx_table_create(in_folder("a.csv"), &column, 1, &error);
    ck_assert_ptr_nonnull(t);
    limit_files(20);
    int code = CALX_OK;
    for (double time = 0; !code && time < 20; time++)
        code = calx_table_write(t, &time, &error);
    limit_files(0);
    ck_assert_int_eq(code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, strerror(EFBIG)));
    calx_table_free(t);
}
END_TEST

static const struct calx_table_column columns[] = {
    {"time", "s"}, {"kinetic", "J"}, {"a \"b\", c", "1"}, {"d", NULL}};

static void expect_file(const char *name, const char *want)
{
    char text[1000];
    FILE *f = fopen(in_folder(name), "r");
    ck_assert_ptr_nonnull(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    ck_assert_str_eq(text, want);
}

static void write_row(struct calx_table *t, double time, double value)
{
    double row[4] = {time, value, 0, 0};
    ck_assert_int_eq(calx_table_write(t, row, &error), CALX_OK);
}

#define HEADER "time [s],kinetic [J],\"a \"\"b\"\", c\",d\n"

START_TEST(test_table)
{
    struct calx_table *t = calx_table_create(in_folder("a.csv"), columns, 4, &error);
    ck_assert_ptr_nonnull(t);
    expect_file("a.csv", HEADER);
    write_row(t, 0, 1.0 / 3);
    write_row(t, 0.1, -NAN);
    expect_file("a.csv",
                HEADER "0,0.33333333333333331,0,0\n0.10000000000000001,nan,0,0\n"); /* flushed */
    write_row(t, 0.1, 2); /* the same time again */
    write_row(t, 0.2, INFINITY);
    calx_table_free(t);
    expect_file(
        "a.csv", HEADER
        "0,0.33333333333333331,0,0\n0.10000000000000001,2,0,0\n0.20000000000000001,inf,0,0\n");
}
END_TEST

static const struct {
    const char *before;
    double time;
    const char *after; /* NULL: refused */
} resumed[] = {
    {"", 1, NULL},
    {"time [s],kinetic [J]\n0,1\n", 1, NULL},
    {"time [s],kinetic [J],\"a \"\"b\"\", c\",d", 1, NULL},
    {HEADER, 1, HEADER},
    {HEADER "0,1,0,0\n1,2,0,0\n2,3,0,0\n", 1, HEADER "0,1,0,0\n1,2,0,0\n"},
    {HEADER "0,1,0,0\n1,2,0", 1, HEADER "0,1,0,0\n"},
    {HEADER "0,1,0,0\nnan,2,0,0\n", 1, HEADER "0,1,0,0\n"},
    {HEADER "0,1,0,0\n", -1, HEADER},
};

START_TEST(test_table_resume)
{
    char want[512];
    put_file("a.csv", resumed[_i].before);
    struct calx_table *t =
        calx_table_resume(in_folder("a.csv"), columns, 4, resumed[_i].time, &error);
    if (!resumed[_i].after) {
        ck_assert_ptr_null(t);
        ck_assert_ptr_nonnull(strstr(error.text, "other columns"));
        expect_file("a.csv", resumed[_i].before);
        return;
    }
    ck_assert_ptr_nonnull(t);
    expect_file("a.csv", resumed[_i].after);
    write_row(t, 1.5, 4);
    calx_table_free(t);
    snprintf(want, sizeof want, "%s1.5,4,0,0\n", resumed[_i].after);
    expect_file("a.csv", want);
}
END_TEST

/* The row at the restart time may be written again. */
START_TEST(test_table_resume_replaces)
{
    put_file("a.csv", HEADER "0,1,0,0\n1,2,0,0\n2,3,0,0\n");
    struct calx_table *t = calx_table_resume(in_folder("a.csv"), columns, 4, 1, &error);
    ck_assert_ptr_nonnull(t);
    write_row(t, 1, 5);
    calx_table_free(t);
    expect_file("a.csv", HEADER "0,1,0,0\n1,5,0,0\n");
}
END_TEST

START_TEST(test_table_resume_of_nothing)
{
    struct calx_table *t = calx_table_resume(in_folder("a.csv"), columns, 4, 1, &error);
    ck_assert_ptr_nonnull(t);
    calx_table_free(t);
    expect_file("a.csv", HEADER);
}
END_TEST

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

int main(void)
{
    Suite *suite = suite_create("table");
    TCase *tests = tcase_create("table");
    tcase_set_timeout(tests, 120); /* a busy machine */
    tcase_add_checked_fixture(tests, make_folder, remove_folder);
    tcase_add_test(tests, test_unwritable_folder);
    tcase_add_test(tests, test_disk_full);
    tcase_add_test(tests, test_table);
    tcase_add_loop_test(tests, test_table_resume, 0, COUNT(resumed));
    tcase_add_test(tests, test_table_resume_replaces);
    tcase_add_test(tests, test_table_resume_of_nothing);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

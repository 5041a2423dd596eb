/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Time series (.pvd): what they list, going on after a restart, and writers that
 * are killed or meet a full disk. Damaged files come first. What is listed is opened with the
 * independent reader of tests/vtu.h.
 */
#include <errno.h>
#include <math.h>
#include <sys/wait.h>
#include <time.h>

#include "io/series.h"
#include "tests/folder.h"
#include "tests/frames.h"
#include "tests/vtu.h"

/* ---- what cannot be written, or gone on with ---- */

START_TEST(test_unwritable_folder)
{
    put_file("file", "");
    ck_assert_ptr_null(calx_series_create(in_folder("file/deeper"), "a", &plain, &error));
    ck_assert_int_eq(error.code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, "Not a directory"));
}
END_TEST

START_TEST(test_disk_full)
{
    struct calx_frame f = frame_of(MOST, 0);
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    ck_assert_ptr_nonnull(s);
    f.n = 3;
    ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
    f.n = MOST;
    f.time = 1;
    limit_files(20000);
    int code = calx_series_write(s, &f, &error);
    limit_files(0);
    ck_assert_int_eq(code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, strerror(EFBIG)));
    ck_assert(!exists("a_000001.vtu") && !exists("a_000001.vtu.tmp"));
    ck_assert_uint_eq(calx_series_count(s), 1);
    calx_series_free(s);
}
END_TEST

static const struct {
    const char *text;
} damaged[] = {
    {""},
    {"<VTKFile type='Collection'><Collection><DataSet timestep='0' file='a_000"},
    {"<other/>"},
    {"<VTKFile><Collection><DataSet timestep='0' file='/etc/passwd'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet timestep='0' file='../a_000000.vtu'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet timestep='soon' file='a_000000.vtu'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet timestep='nan' file='a_000000.vtu'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet file='a_000000.vtu'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet timestep='0'/></Collection></VTKFile>"},
    {"<VTKFile><Collection><DataSet timestep='1' file='a_000000.vtu'/><DataSet timestep='0' "
     "file='a_000001.vtu'/>"
     "</Collection></VTKFile>"},
};

START_TEST(test_damaged_series)
{
    put_file("a.pvd", damaged[_i].text);
    ck_assert_ptr_null(calx_series_resume(folder, "a", &plain, 1, &error));
    ck_assert_int_eq(error.code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, "a.pvd is damaged"));
    struct calx_series *s =
        calx_series_create(folder, "a", &plain, &error); /* a new run may replace it */
    ck_assert_ptr_nonnull(s);
    ck_assert(!exists("a.pvd"));
    calx_series_free(s);
}
END_TEST

START_TEST(test_backwards)
{
    struct calx_frame f = frame_of(2, 1);
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
    f.time = 0.5;
    ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_ERROR_IO);
    ck_assert_uint_eq(calx_series_count(s), 1);
    calx_series_free(s);
}
END_TEST

/* ---- what a .pvd lists ---- */

/* Checks that a .pvd is well-formed and that every file it lists opens. Returns the number of
 * lines, their times and files. */
static size_t read_pvd(const char *name, double *times, char files[][64], size_t most)
{
    char query[64], text[64];
    xmlDoc *doc = xmlReadFile(in_folder(name), NULL, XML_PARSE_NONET);
    ck_assert_msg(doc != NULL, "%s is not well-formed", name);
    ck_assert_uint_eq(vtu_query(doc, NULL, 0, "/VTKFile[@type='Collection']/Collection"), 1);
    size_t n = vtu_query(doc, NULL, 0, "//DataSet");
    ck_assert_uint_le(n, most);
    for (size_t i = 0; i < n; i++) {
        snprintf(query, sizeof query, "//DataSet[%zu]/@timestep", i + 1);
        ck_assert_uint_eq(vtu_query(doc, text, sizeof text, query), 1);
        times[i] = strtod(text, NULL);
        snprintf(query, sizeof query, "//DataSet[%zu]/@file", i + 1);
        ck_assert_uint_eq(vtu_query(doc, files[i], sizeof files[i], query), 1);
        struct vtu v = vtu_open(in_folder(files[i]));
        vtu_close(&v);
    }
    xmlFreeDoc(doc);
    return n;
}

enum { MOST_LINES = 4000 };
static double times[MOST_LINES];
static char files[MOST_LINES][64];

static void expect_pvd(const char *name, size_t n, const double *want_times,
                       const char *const *want_files)
{
    ck_assert_uint_eq(read_pvd(name, times, files, MOST_LINES), n);
    for (size_t i = 0; i < n; i++) {
        ck_assert_double_eq(times[i], want_times[i]);
        ck_assert_str_eq(files[i], want_files[i]);
    }
}

static void write_frames(struct calx_series *s, size_t n, const double *at, const bool *changed)
{
    ck_assert_ptr_nonnull(s);
    for (size_t i = 0; i < n; i++) {
        struct calx_frame f = frame_of(3, at[i]);
        f.walls_changed = changed[i];
        ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
    }
}

static const double four_times[] = {0, 0.1, 0.2, 0.3};
static const bool third_changes[] = {false, false, true, false};

START_TEST(test_series)
{
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    write_frames(s, 4, four_times, third_changes);
    ck_assert_str_eq(calx_series_path(s), in_folder("a.pvd"));
    ck_assert_uint_eq(calx_series_count(s), 4);
    ck_assert_double_eq(calx_series_last(s), 0.3);
    calx_series_free(s);
    expect_pvd("a.pvd", 4, four_times,
               (const char *[]){"a_000000.vtu", "a_000001.vtu", "a_000002.vtu", "a_000003.vtu"});
    expect_pvd("a_walls.pvd", 4, four_times,
               (const char *[]){"a_walls_000000.vtu", "a_walls_000000.vtu", "a_walls_000002.vtu",
                                "a_walls_000002.vtu"});
    ck_assert(!exists("a_walls_000001.vtu") && !exists("a_walls_000003.vtu"));
    expect_pvd("a_contacts.pvd", 4, four_times,
               (const char *[]){"a_contacts_000000.vtu", "a_contacts_000001.vtu",
                                "a_contacts_000002.vtu", "a_contacts_000003.vtu"});
}
END_TEST

/* Whatever a wall file holds: a change of it makes a new file, though the frame says that nothing
 * moved. */
START_TEST(test_walls_that_stand)
{
    double *const changing[] = {&wall_force[1][2], &wall_temperature[2], &wall_velocity[3][0],
                                &wall_position[5][1]};
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    struct calx_frame f = frame_of(3, 0);
    f.walls_changed = false;
    for (size_t i = 0; i < 4; i++) {
        ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
        f.time += 0.5;
        ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
        f.time += 0.5;
        *changing[i] += 1e-9;
    }
    calx_series_free(s);
    expect_pvd("a_walls.pvd", 8, (const double[]){0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5},
               (const char *[]){"a_walls_000000.vtu", "a_walls_000000.vtu", "a_walls_000002.vtu",
                                "a_walls_000002.vtu", "a_walls_000004.vtu", "a_walls_000004.vtu",
                                "a_walls_000006.vtu", "a_walls_000006.vtu"});
}
END_TEST

START_TEST(test_series_without_walls_and_contacts)
{
    struct calx_output output = {.fields = CALX_FIELD_ALL, .compression = 6};
    struct calx_series *s = calx_series_create(folder, "a", &output, &error);
    struct calx_frame f = frame_of(0, 0);
    f.wall_cells = f.wall_points = 0;
    ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
    calx_series_free(s);
    expect_pvd("a.pvd", 1, four_times, (const char *[]){"a_000000.vtu"});
    ck_assert(!exists("a_walls.pvd") && !exists("a_contacts.pvd"));
}
END_TEST

START_TEST(test_same_time_replaces)
{
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    write_frames(s, 2, four_times, third_changes);
    struct calx_frame f = frame_of(7, four_times[1]);
    ck_assert_int_eq(calx_series_write(s, &f, &error), CALX_OK);
    calx_series_free(s);
    expect_pvd("a.pvd", 2, four_times, (const char *[]){"a_000000.vtu", "a_000001.vtu"});
    expect_pvd("a_walls.pvd", 2, four_times,
               (const char *[]){"a_walls_000000.vtu", "a_walls_000001.vtu"});
    struct vtu v = vtu_open(in_folder("a_000001.vtu"));
    ck_assert_uint_eq(vtu_query(v.doc, NULL, 0, "//Piece[@NumberOfPoints='7']"), 1);
    vtu_close(&v);
}
END_TEST

START_TEST(test_resume)
{
    struct calx_series *s = calx_series_create(folder, "a", &plain, &error);
    write_frames(s, 4, four_times, third_changes);
    calx_series_free(s);
    put_file("a_mine.vtu", "not of the series");
    s = calx_series_resume(folder, "a", &plain, 0.15, &error);
    ck_assert_uint_eq(calx_series_count(s), 2);
    expect_pvd("a.pvd", 2, four_times, (const char *[]){"a_000000.vtu", "a_000001.vtu"});
    expect_pvd("a_walls.pvd", 2, four_times,
               (const char *[]){"a_walls_000000.vtu", "a_walls_000000.vtu"});
    ck_assert(!exists("a_000002.vtu") && !exists("a_walls_000002.vtu") &&
              !exists("a_contacts_000003.vtu"));
    static const double later[] = {0.25, 0.5};
    write_frames(s, 2, later, third_changes);
    calx_series_free(s);
    expect_pvd("a.pvd", 4, (const double[]){0, 0.1, 0.25, 0.5},
               (const char *[]){"a_000000.vtu", "a_000001.vtu", "a_000002.vtu", "a_000003.vtu"});
    /* the walls are written anew after a restart, whatever the frame says of the one before */
    expect_pvd("a_walls.pvd", 4, (const double[]){0, 0.1, 0.25, 0.5},
               (const char *[]){"a_walls_000000.vtu", "a_walls_000000.vtu", "a_walls_000002.vtu",
                                "a_walls_000002.vtu"});
    calx_series_free(calx_series_create(folder, "a", &plain,
                                        &error)); /* a new run leaves nothing of the old one */
    ck_assert(!exists("a.pvd") && !exists("a_000000.vtu") && !exists("a_walls_000002.vtu") &&
              exists("a_mine.vtu"));
    s = calx_series_resume(folder, "a", &plain, 1,
                           &error); /* nothing to go on with: an empty series */
    ck_assert_uint_eq(calx_series_count(s), 0);
    calx_series_free(s);
}
END_TEST

/* ---- killed writers ---- */

/* Writes frames until it is killed, and a byte into the pipe after each. */
static void write_for_ever(double from, int pipe_end)
{
    struct calx_series *s = calx_series_resume(folder, "a", &plain, from, &error);
    for (double time = from + 1; s && time < 1e6; time++) {
        struct calx_frame f = frame_of(50, time);
        if (calx_series_write(s, &f, &error) || write(pipe_end, "", 1) != 1)
            break;
    }
    _exit(1); /* only after an error */
}

/* Kills a writer after a random time; if `patient`, not before it has written a frame. */
static void kill_writer(double from, bool patient)
{
    enum { LONGEST = 10000000 /* ns: some frames */ };
    int ends[2], how;
    char byte;
    ck_assert_int_eq(pipe(ends), 0);
    pid_t child = fork();
    if (!child)
        write_for_ever(from, ends[1]);
    close(ends[1]);
    if (patient)
        ck_assert_int_eq(read(ends[0], &byte, 1), 1);
    nanosleep(&(struct timespec){0, rand() % LONGEST}, NULL);
    kill(child, SIGKILL);
    waitpid(child, &how, 0);
    close(ends[0]);
    ck_assert_msg(WIFSIGNALED(how), "the writer stopped by itself");
}

/* What is listed opens, whenever the writer was killed; and the series can be gone on with. */
START_TEST(test_killed)
{
    enum { TRIES = 24 };
    srand(7);
    size_t complete = 0; /* frames in the .pvd that is written last */
    for (int i = 0; i < TRIES; i++) {
        kill_writer((double)complete - 1, i % 2);
        size_t n = exists("a.pvd") ? read_pvd("a.pvd", times, files, MOST_LINES) : 0;
        for (size_t k = 0; k < n; k++)
            ck_assert_double_eq(times[k], (double)k);
        size_t before = complete;
        complete =
            exists("a_contacts.pvd") ? read_pvd("a_contacts.pvd", times, files, MOST_LINES) : 0;
        ck_assert_uint_ge(complete, before + (size_t)(i % 2));
        ck_assert(n == complete || n == complete + 1);
        if (complete)
            ck_assert_uint_ge(read_pvd("a_walls.pvd", times, files, MOST_LINES), complete);
    }
}
END_TEST

/* ---- the runner ---- */

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

int main(void)
{
    Suite *suite = suite_create("series");
    TCase *tests = tcase_create("series");
    tcase_set_timeout(tests, 120); /* a busy machine */
    tcase_add_checked_fixture(tests, make_folder, remove_folder);
    tcase_add_test(tests, test_unwritable_folder);
    tcase_add_test(tests, test_disk_full);
    tcase_add_loop_test(tests, test_damaged_series, 0, COUNT(damaged));
    tcase_add_test(tests, test_backwards);
    tcase_add_test(tests, test_series);
    tcase_add_test(tests, test_walls_that_stand);
    tcase_add_test(tests, test_series_without_walls_and_contacts);
    tcase_add_test(tests, test_same_time_replaces);
    tcase_add_test(tests, test_resume);
    tcase_add_test(tests, test_killed);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

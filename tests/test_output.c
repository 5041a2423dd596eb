/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Single .vtu files. Frames made by hand are written and read back by an independent reader
 * (tests/vtu.h): values, types, units, cells, empty frames, one and many blocks. Files that cannot
 * be written come first.
 */
#include <errno.h>

#include "io/file.h"
#include "io/vtk.h"
#include "tests/folder.h"
#include "tests/frames.h"
#include "tests/vtu.h"

/* ---- what cannot be written ---- */

static const struct {
    const char *folder, *text;
} no_folder[] = {{"missing", "No such file or directory"}, {"file", "Not a directory"}};

START_TEST(test_unwritable_folder)
{
    char name[64];
    struct calx_frame f = frame_of(3, 0);
    put_file("file", "");
    snprintf(name, sizeof name, "%s/a.vtu", no_folder[_i].folder);
    ck_assert_int_eq(calx_vtk_write(in_folder(name), CALX_VTK_PARTICLES, &f, &plain, &error),
                     CALX_ERROR_IO);
    ck_assert_int_eq(error.code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, no_folder[_i].text));
    ck_assert_ptr_nonnull(strstr(error.text, full_path));
}
END_TEST

START_TEST(test_no_such_folder_can_be_made)
{
    put_file("file", "");
    ck_assert_int_eq(calx_file_create_folder(in_folder("file"), &error), CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, "Not a directory"));
    ck_assert_int_eq(calx_file_create_folder(in_folder("file/deeper"), &error), CALX_ERROR_IO);
    ck_assert_int_eq(calx_file_create_folder("", &error), CALX_ERROR_IO);
    ck_assert_int_eq(calx_file_create_folder(in_folder("one/two/three"), &error), CALX_OK);
    ck_assert_int_eq(calx_file_create_folder(in_folder("one/two/three/"), &error), CALX_OK);
    ck_assert(exists("one/two/three"));
}
END_TEST

/* A file that was there stays as it was when its successor does not fit on the disk. */
START_TEST(test_disk_full)
{
    struct calx_frame f = frame_of(MOST, 0);
    put_file("a.vtu", "before");
    in_folder("a.vtu");
    limit_files(20000);
    int code = calx_vtk_write(full_path, CALX_VTK_PARTICLES, &f, &plain, &error);
    limit_files(0);
    ck_assert_int_eq(code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, strerror(EFBIG)));
    ck_assert(!exists("a.vtu.tmp"));
    size_t size;
    char *text = vtu_load(in_folder("a.vtu"), &size);
    ck_assert_str_eq(text, "before");
    free(text);
}
END_TEST

/* ---- .vtu ---- */

static const struct {
    size_t n;
    bool single;
    int compression;
} vtu_cases[] = {
    {0, false, 6},    {0, false, 0},  {0, true, 1},      {1, false, 6}, {1, true, 0},
    {200, false, 0},  {200, true, 9}, {16384, false, 6}, /* 8 bytes each: exactly one block of 128
                                                            KiB */
    {MOST, false, 1},                                    /* several blocks, the last one shorter */
};

/* Half a unit in the last place of a 32-bit float: 2^-24, relative. */
static const double single_rounding = 1.0 / (1 << 24);

static void check_reals(const struct vtu *v, const char *section, const char *name,
                        size_t components, const double *expected, size_t n, bool single)
{
    char type[16];
    size_t found_components, bytes;
    unsigned char *data = vtu_array(v, section, name, type, &found_components, &bytes);
    ck_assert_msg(data != NULL, "no array %s", name);
    ck_assert_str_eq(type, single ? "Float32" : "Float64");
    ck_assert_uint_eq(components, found_components);
    ck_assert_uint_eq(bytes, n * (single ? 4 : 8));
    for (size_t i = 0; i < n; i++) {
        double want = expected[i];
        if (isnan(want))
            ck_assert(
                isnan(single ? (double)((float *)(void *)data)[i] : ((double *)(void *)data)[i]));
        else if (single)
            ck_assert_double_le(fabs((double)((float *)(void *)data)[i] - want),
                                single_rounding * fabs(want));
        else
            ck_assert_double_eq(((double *)(void *)data)[i], want);
    }
    free(data);
}

static void check_bytes(const struct vtu *v, const char *section, const char *name,
                        const char *expected_type, const void *expected, size_t expected_bytes)
{
    char type[16];
    size_t components, bytes;
    unsigned char *data = vtu_array(v, section, name, type, &components, &bytes);
    ck_assert_msg(data != NULL, "no array %s", name);
    ck_assert_str_eq(type, expected_type);
    ck_assert_uint_eq(bytes, expected_bytes);
    ck_assert(!bytes || !memcmp(data, expected, bytes));
    free(data);
}

static struct vtu write_and_open(enum calx_vtk_part part, const struct calx_frame *f,
                                 const struct calx_output *output)
{
    ck_assert_int_eq(calx_vtk_write(in_folder("a.vtu"), part, f, output, &error), CALX_OK);
    ck_assert(!exists("a.vtu.tmp"));
    return vtu_open(in_folder("a.vtu"));
}

START_TEST(test_particles)
{
    size_t n = vtu_cases[_i].n;
    bool single = vtu_cases[_i].single;
    struct calx_output output = {.fields =
                                     CALX_FIELD_VELOCITY | CALX_FIELD_TEMPERATURE | CALX_FIELD_SPIN,
                                 .single = single,
                                 .compression = vtu_cases[_i].compression};
    struct calx_frame f = frame_of(n, 0.1);
    struct vtu v = write_and_open(CALX_VTK_PARTICLES, &f, &output);
    char text[64];
    vtu_query(v.doc, text, sizeof text, "//Piece/@NumberOfPoints");
    ck_assert_uint_eq(strtoul(text, NULL, 10), n);
    vtu_query(v.doc, text, sizeof text, "//FieldData/DataArray[@Name='TimeValue']");
    ck_assert_double_eq(strtod(text, NULL), 0.1);
    check_reals(&v, "Points", "position", 3, &position[0][0], 3 * n, single);
    check_reals(&v, "PointData", "velocity", 3, &velocity[0][0], 3 * n, single);
    check_reals(&v, "PointData", "radius", 1, radius, n, single);
    check_reals(&v, "PointData", "temperature", 1, temperature, n, single);
    check_bytes(&v, "PointData", "id", "Int64", id, n * 8);
    check_bytes(&v, "Cells", "connectivity", "Int64", id, n * 8);
    /* spin is asked for but not in the frame, material is in the frame but not asked for */
    ck_assert_uint_eq(vtu_query(v.doc, NULL, 0, "//PointData/DataArray"), 4);
    ck_assert_uint_eq(
        vtu_query(v.doc, text, sizeof text, "//DataArray[@Name='velocity']/InformationKey"), 1);
    ck_assert_str_eq(text, "m/s");
    vtu_close(&v);
}
END_TEST

START_TEST(test_walls)
{
    struct calx_frame f = frame_of(1, 0);
    struct vtu v = write_and_open(CALX_VTK_WALLS, &f, &plain);
    static const int64_t connectivity[] = {0, 1, 2, 3, 4, 5, 1, 4, 2}, offsets[] = {4, 6, 9};
    static const uint8_t types[] = {9, 3, 5}; /* quadrilateral, line, triangle in vtkCellType.h */
    check_bytes(&v, "Cells", "connectivity", "Int64", connectivity, sizeof connectivity);
    check_bytes(&v, "Cells", "offsets", "Int64", offsets, sizeof offsets);
    check_bytes(&v, "Cells", "types", "UInt8", types, sizeof types);
    check_bytes(&v, "CellData", "wall", "Int32", wall_of_cell, sizeof wall_of_cell);
    check_reals(&v, "CellData", "temperature", 1, wall_temperature, 3, false);
    check_reals(&v, "CellData", "force", 3, &wall_force[0][0], 9, false);
    check_reals(&v, "PointData", "velocity", 3, &wall_velocity[0][0], 18, false);
    vtu_close(&v);
}
END_TEST

START_TEST(test_contacts)
{
    struct calx_frame f = frame_of(1, 0);
    struct vtu v = write_and_open(CALX_VTK_CONTACTS, &f, &plain);
    static const int64_t connectivity[] = {0, 1, 2, 3, 4, 5};
    static const uint8_t types[] = {3, 3, 3};
    check_bytes(&v, "Cells", "connectivity", "Int64", connectivity, sizeof connectivity);
    check_bytes(&v, "Cells", "types", "UInt8", types, sizeof types);
    check_reals(&v, "Points", "position", 3, &pair_position[0][0][0], 18, false);
    check_bytes(&v, "CellData", "pair", "Int64", pair, sizeof pair);
    check_bytes(&v, "CellData", "status", "Int32", status, sizeof status);
    check_reals(&v, "CellData", "normal_force", 1, normal_force, 3, false);
    check_reals(&v, "CellData", "tangential_force", 1, tangential_force, 3, false);
    check_reals(&v, "CellData", "heat_flow", 1, heat_flow, 3, false);
    check_reals(&v, "CellData", "overlap", 1, overlap, 3, false);
    vtu_close(&v);
}
END_TEST

/* ---- the runner ---- */

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

int main(void)
{
    Suite *suite = suite_create("output");
    TCase *tests = tcase_create("vtu");
    tcase_set_timeout(tests, 120); /* a busy machine */
    tcase_add_checked_fixture(tests, make_folder, remove_folder);
    tcase_add_loop_test(tests, test_unwritable_folder, 0, COUNT(no_folder));
    tcase_add_test(tests, test_no_such_folder_can_be_made);
    tcase_add_test(tests, test_disk_full);
    tcase_add_loop_test(tests, test_particles, 0, COUNT(vtu_cases));
    tcase_add_test(tests, test_walls);
    tcase_add_test(tests, test_contacts);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

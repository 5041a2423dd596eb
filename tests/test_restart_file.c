/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The restart file: every way in which it can be wrong has its own message and no memory error (a
 * fuzzer flips, cuts and overwrites bytes at random); what is written comes back bit by bit; the
 * file before survives a full disk.
 */
#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <zlib.h>

#include "io/restart.h"
#include "tests/folder.h"

static const uint64_t this_case = 0x1234567890abcdefu;
static unsigned char bytes[1000];
static const double numbers[] = {1.0 / 3, -0.0, 1e308};
static const struct calx_block blocks[] = {{"numbers", numbers, sizeof numbers},
                                           {"empty", NULL, 0},
                                           {"bytes", bytes, sizeof bytes},
                                           {"odd", bytes, 17}};
enum { BLOCKS = sizeof blocks / sizeof *blocks };

static void write_blocks(void)
{
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(i * 37);
    ck_assert_int_eq(calx_restart_write(in_folder("a.restart"), this_case, blocks, BLOCKS, &error),
                     CALX_OK);
}

static unsigned char *load(size_t *size)
{
    FILE *f = fopen(in_folder("a.restart"), "rb");
    ck_assert_ptr_nonnull(f);
    unsigned char *data = malloc(1 << 16);
    *size = fread(data, 1, 1 << 16, f);
    fclose(f);
    return data;
}

static void save(const unsigned char *data, size_t size)
{
    FILE *f = fopen(in_folder("a.restart"), "wb");
    ck_assert_ptr_nonnull(f);
    ck_assert_uint_eq(fwrite(data, 1, size, f), size);
    fclose(f);
}

static int read_back(struct calx_restart *r)
{
    error = (struct calx_error){0};
    return calx_restart_read(in_folder("a.restart"), this_case, r, &error);
}

/* ---- what is wrong is named ---- */

/* Layout of the head: magic 0, byte order 8, format 12, version 16, case 48, number of blocks 56,
 * CRC 76, first label 80, its CRC 124, data 128. */
enum { HEAD_CRC = 76 };

/* Overwrites `count` bytes at `at` (from the end if negative), mends the checksum of the head if
 * asked, and cuts. */
static const struct {
    long at;
    const char *with;
    size_t count;
    bool mend;
    long size; /* 0: as it is; negative: cut from the end */
    const char *text;
} wrong[] = {
    {0, "", 0, false, -100000, "not a calx restart file"},
    {0, "X", 1, false, 0, "not a calx restart file"},
    {0, "", 0, false, 40, "cut short"},
    {8, "\1\2\3\4", 4, false, 0, "other byte order"},
    {12, "\2", 1, false, 0, "checksum of its head"},
    {12, "\2", 1, true, 0, "another version: format 2 of calx " CALX_VERSION},
    {16, "9.9.9", 6, true, 0, "another version: format 1 of calx 9.9.9"},
    {48, "\1", 1, true, 0, "another case"},
    {56, "\377\377\377\377\377\377\377\377", 8, true, 0, "cut short"},
    {56, "\5", 1, true, 0, "cut short"},
    {56, "\3", 1, true, 0, "checksum of the whole"},
    {80, "X", 1, false, 0, "checksum between two blocks"},
    {112, "\377\377\377\377\377\377\377\377", 8, false, 0, "checksum between two blocks"},
    {130, "X", 1, false, 0, "checksum of the block 'numbers'"},
    {0, "", 0, false, 300, "cut short"},
    {0, "", 0, false, -1, "cut short"},
    {-1, "X", 1, false, 0, "checksum of the whole"},
    {-17, "X", 1, false, 0,
     "checksum of the whole"}, /* padding: only the checksum of the whole covers it */
    {0, "", 0, false, 10000, "bytes follow its end"},
};

START_TEST(test_wrong)
{
    size_t size;
    write_blocks();
    unsigned char *data = load(&size);
    memset(data + size, 0, (1 << 16) - size);
    memcpy(data + (wrong[_i].at < 0 ? (long)size + wrong[_i].at : wrong[_i].at), wrong[_i].with,
           wrong[_i].count);
    if (wrong[_i].mend) {
        uint32_t crc = (uint32_t)crc32(0, data, HEAD_CRC);
        memcpy(data + HEAD_CRC, &crc, sizeof crc);
    }
    long length = wrong[_i].size > 0 ? wrong[_i].size : (long)size + wrong[_i].size;
    save(data, length > 0 ? (size_t)length : 0);
    free(data);
    struct calx_restart r;
    ck_assert_int_eq(read_back(&r), CALX_ERROR_INPUT);
    ck_assert_msg(strstr(error.text, wrong[_i].text) != NULL, "'%s' does not say '%s'", error.text,
                  wrong[_i].text);
    ck_assert_str_eq(error.file, in_folder("a.restart"));
    ck_assert(r.blocks == NULL && r.memory == NULL && r.count == 0);
}
END_TEST

START_TEST(test_missing)
{
    struct calx_restart r;
    ck_assert_int_eq(read_back(&r), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "no restart file"));
    ck_assert_int_eq(calx_restart_read(folder, this_case, &r, &error), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "not a calx restart file"));
    ck_assert_int_eq(calx_restart_write(in_folder("missing/a"), this_case, blocks, BLOCKS, &error),
                     CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, "No such file"));
}
END_TEST

/* Puts the bytes into a new file: ext4 brings one that is truncated to the disk at once, which takes
 * longer than all the rest. */
static void replace(const char *path, const unsigned char *data, size_t size)
{
    unlink(path);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size)
        abort();
    fclose(f);
}

/* A flipped bit in every byte, and random cuts and overwritten stretches: always a clean error. */
START_TEST(test_fuzz)
{
    enum { TRIES = 2000, LONGEST = 32 };
    size_t size, wrongly_read = 0, unnamed = 0;
    struct calx_restart r;
    write_blocks();
    unsigned char *data = load(&size), *copy = malloc(size);
    const char *path = in_folder("a.restart");
    srand(11);
    for (size_t i = 0; i < size + TRIES; i++) {
        size_t length = size;
        memcpy(copy, data, size);
        if (i < size) {
            copy[i] ^= (unsigned char)(1 << rand() % 8);
        } else if (i % 2) {
            length = (size_t)rand() % size;
        } else {
            for (size_t at = (size_t)rand() % size, n = 1 + (size_t)rand() % LONGEST;
                 n && at < size; n--, at++)
                copy[at] = (unsigned char)rand();
        }
        bool same = length == size && !memcmp(copy, data, size);
        replace(path, copy, length);
        error = (struct calx_error){0};
        int code = calx_restart_read(path, this_case, &r, &error);
        wrongly_read += code != (same ? CALX_OK : CALX_ERROR_INPUT);
        unnamed += !same && !error.text[0];
        calx_restart_clear(&r);
    }
    ck_assert_uint_eq(wrongly_read, 0);
    ck_assert_uint_eq(unnamed, 0);
    free(copy);
    free(data);
}
END_TEST

/* ---- what is right ---- */

START_TEST(test_round_trip)
{
    struct calx_restart r;
    write_blocks();
    ck_assert_int_eq(read_back(&r), CALX_OK);
    ck_assert_uint_eq(r.count, BLOCKS);
    for (size_t i = 0; i < BLOCKS; i++) {
        ck_assert_str_eq(r.blocks[i].name, blocks[i].name);
        ck_assert_uint_eq(r.blocks[i].bytes, blocks[i].bytes);
        ck_assert(!blocks[i].bytes || !memcmp(r.blocks[i].data, blocks[i].data, blocks[i].bytes));
        ck_assert_uint_eq((uintptr_t)r.blocks[i].data % 16, 0);
    }
    ck_assert_ptr_eq(calx_restart_find(&r, "odd"), &r.blocks[3]);
    ck_assert_ptr_null(calx_restart_find(&r, "other"));
    calx_restart_clear(&r);
    ck_assert(!exists("a.restart.tmp") && !exists("a.restart.bak"));
}
END_TEST

START_TEST(test_no_blocks)
{
    struct calx_restart r;
    ck_assert_int_eq(calx_restart_write(in_folder("a.restart"), this_case, NULL, 0, &error),
                     CALX_OK);
    ck_assert_int_eq(read_back(&r), CALX_OK);
    ck_assert_uint_eq(r.count, 0);
    calx_restart_clear(&r);
}
END_TEST

/* The file before is still good when the new one does not fit on the disk; and when only the copy
 * is left. */
START_TEST(test_survives)
{
    struct calx_restart r;
    write_blocks();
    in_folder("a.restart");
    limit_files(500);
    int code = calx_restart_write(full_path, 1, blocks, BLOCKS, &error);
    limit_files(0);
    ck_assert_int_eq(code, CALX_ERROR_IO);
    ck_assert_ptr_nonnull(strstr(error.text, strerror(EFBIG)));
    ck_assert(!exists("a.restart.tmp") && !exists("a.restart.bak"));
    ck_assert_int_eq(read_back(&r), CALX_OK);
    calx_restart_clear(&r);
    char backup[600];
    snprintf(backup, sizeof backup, "%s/a.restart.bak", folder);
    ck_assert_int_eq(rename(in_folder("a.restart"), backup), 0);
    ck_assert(!exists("a.restart"));
    ck_assert_int_eq(read_back(&r), CALX_OK);
    ck_assert_uint_eq(r.count, BLOCKS);
    calx_restart_clear(&r);
}
END_TEST

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

int main(void)
{
    Suite *suite = suite_create("restart file");
    TCase *tests = tcase_create("restart file");
    tcase_set_timeout(tests, 120); /* a busy machine */
    tcase_add_checked_fixture(tests, make_folder, remove_folder);
    tcase_add_loop_test(tests, test_wrong, 0, COUNT(wrong));
    tcase_add_test(tests, test_missing);
    tcase_add_test(tests, test_fuzz);
    tcase_add_test(tests, test_round_trip);
    tcase_add_test(tests, test_no_blocks);
    tcase_add_test(tests, test_survives);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

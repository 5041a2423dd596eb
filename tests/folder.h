/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A folder of its own for each test that writes files, and a disk that is full.
 */
#ifndef CALX_TESTS_FOLDER_H
#define CALX_TESTS_FOLDER_H

#include <check.h>
#include <ftw.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

static char folder[256], full_path[512];
static struct calx_error error;

static inline void make_folder(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/calx-output-XXXXXX", base ? base : "/tmp");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    error = (struct calx_error){0};
}

static inline int remove_one(const char *name, const struct stat *s, int type, struct FTW *ftw)
{
    (void)s, (void)type, (void)ftw;
    return remove(name);
}

static inline void remove_folder(void)
{
    nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

static inline const char *in_folder(const char *name)
{
    int n = snprintf(full_path, sizeof full_path, "%s/%s", folder, name);
    ck_assert_int_lt(n, sizeof full_path);
    return full_path;
}

static inline bool exists(const char *name)
{
    return !access(in_folder(name), F_OK);
}

static inline void put_file(const char *name, const char *text)
{
    FILE *f = fopen(in_folder(name), "w");
    ck_assert_ptr_nonnull(f);
    fputs(text, f);
    fclose(f);
}

/* Files may not grow beyond `bytes`, until 0 lifts it: what a full disk does to write(), without
 * root. No assertion in between: Check writes each of them into a file. */
static inline void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes ? bytes : limit.rlim_max;
    setrlimit(RLIMIT_FSIZE, &limit);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the tests of the case reader share: a registry, the problems, the scene, a folder, and the
 * case that has everything.
 */
#ifndef CALX_TESTS_CASE_FILES_H
#define CALX_TESTS_CASE_FILES_H

#include <string.h>

#include "io/case.h"
#include "tests/folder.h"

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

static struct calx_registry *registry;
static struct calx_problems problems;
static struct calx_scene *scene;

static inline void set_up(void)
{
    make_folder();
    registry = calx_registry_create(NULL);
    ck_assert_ptr_nonnull(registry);
}

static inline void tear_down(void)
{
    calx_scene_free(scene);
    scene = NULL;
    calx_problems_clear(&problems);
    calx_registry_free(registry);
    remove_folder();
}

static inline const char *source_path(const char *name)
{
    static char path[512];
    const char *root = getenv("CALX_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/%s", root ? root : ".", name);
    return path;
}

static inline void read_everything(const struct calx_setting *settings, size_t count)
{
    scene = calx_case_read(source_path("tests/data/cases/everything.xml"), registry, settings,
                           count, &problems);
    if (!scene && !count)
        calx_problems_print(&problems, stderr);
}

static inline int run_suite(const char *name, void (*add)(TCase *))
{
    Suite *suite = suite_create(name);
    TCase *cases = tcase_create(name);
    tcase_add_checked_fixture(cases, set_up, tear_down);
    add(cases);
    suite_add_tcase(suite, cases);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif

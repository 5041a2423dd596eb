/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance suite: each check finds the deliberately wrong plugin made for it
 * (tests/plugins), the right variant of the same file passes, and every plugin that calx finds
 * passes all checks.
 */
#include <check.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/conform.h"
#include "core/loader.h"
#include "io/catalogue.h"

/* Folder of the wrong plugins: beside this program. */
static const char *faulty_folder(void)
{
    static char path[PATH_MAX + 16];
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    snprintf(path, sizeof path, "%s/plugins", dirname(program));
    return path;
}

static const char *path_of(const char *file)
{
    static char path[PATH_MAX + 64];
    snprintf(path, sizeof path, "%s/%s.so", faulty_folder(), file);
    return path;
}

static void run(const char *file, struct calx_conformance *report)
{
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_error error = {0};
    const struct calx_plugin *p = calx_registry_load(r, path_of(file), &error);
    ck_assert_msg(p != NULL, "%s", error.text);
    ck_assert_int_eq(calx_conform_run(p, report, &error), 0);
    calx_registry_free(r);
}

static const struct {
    const char *file, *check;
} faults[] = {
    {"faulty-normal-pieces", "same bits in pieces"},
    {"faulty-normal-order", "same bits in another order"},
    {"faulty-normal-padding", "padding is ignored"},
    {"faulty-normal-undeclared", "undeclared columns are unused"},
    {"faulty-normal-infinite", "finite at every bound of the parameters"},
    {"faulty-normal-apart", "no force without overlap"},
    {"faulty-normal-idle_work", "no work without a contact before"},
    {"faulty-normal-direction", "same physics in every direction"},
    {"faulty-normal-energy", "normal force = -d energy/d overlap"},
    {"faulty-normal-stiffness", "reported normal stiffness"},
    {"faulty-normal-damping", "reported normal damping"},
    {"faulty-normal-gain", "dissipation >= 0 over a closed cycle"},
    {"faulty-normal-left", "nothing is left after a contact"},
    {"faulty-normal-books", "work in = stored + dissipated"},
    {"faulty-normal-refuses", "typical values are accepted"},
    {"faulty-normal-velocity", "forces use velocities only if declared"},
    {"broken-none", "contacts act"},
    {"faulty-tangential-limit", "|ft| <= mu |fn|"},
    {"faulty-tangential-slope", "reported tangential stiffness and damping"},
    {"faulty-tangential-gain", "dissipation >= 0 over a closed cycle"},
    {"faulty-tangential-direction", "same physics in every direction"},
    {"faulty-tangential-keeps", "no force without overlap"},
    {"faulty-condition-range", "conditions have a solution"},
    {"faulty-condition-one_sided", "the same from both bodies"},
    {"faulty-condition-beyond", "pulls end within the declared gap"},
    {"faulty-condition-nothing", "contacts are pulled"},
    {"faulty-condition-velocity", "undeclared columns are unused"},
    {"faulty-condition-pieces", "same bits in pieces"},
    {"faulty-condition-infinite", "finite at every bound of the parameters"},
    {"faulty-conductance-apart", "no conductance without overlap"},
    {"faulty-conductance-negative", "conductance is not negative"},
    {"faulty-conductance-nothing", "contacts conduct"},
    {"faulty-conductance-one_sided", "the same from both bodies"},
    {"faulty-conductance-undeclared", "undeclared columns are unused"},
    {"faulty-conductance-infinite", "finite at every bound of the parameters"},
    {"faulty-motion-order", "order of motion as declared"},
    {"faulty-motion-spin", "order of spin as declared"},
    {"faulty-motion-lag", "velocities lag as declared"},
    {"faulty-motion-limit", "stability limit as declared"},
    {"faulty-motion-back", "comes back when velocities are turned"},
    {"faulty-motion-period", "may be moved by a period"},
    {"faulty-motion-lanes", "lanes without a step and rows of others stay"},
    {"faulty-motion-pieces", "same bits in pieces"},
    {"faulty-motion-beyond", "lanes without a step and rows of others stay"},
    {"faulty-motion-drift", "no drift of energy in 1e5 periods"},
    {"faulty-motion-damping", "damping limit as declared"},
    {"faulty-motion-damped", "stable below the limit for damped springs"},
    {"faulty-motion-drifts", "bodies drift with their velocities as declared"},
    {"faulty-motion-start", "the start moves nobody"},
    {"faulty-motion-moment", "trials are at the moments declared"},
    {"faulty-motion-shown", "the descriptor is that of the defaults"},
    {"faulty-motion-idle", "each evaluation is used"},
    {"faulty-motion-whole", "whole rows are the same as their halves"},
    {"faulty-motion-between", "two steps' kernels in one are the same"},
    {"faulty-motion-kick", "an evaluation is one kick at its moment"},
    {"faulty-global-unkept", "order of motion as declared"},
    {"faulty-global-elapsed", "order of motion as declared"},
    {"faulty-global-longest", "its longest step is stable"},
    {"faulty-temperature-order", "order as declared"},
    {"faulty-temperature-heat", "heat is kept"},
    {"faulty-temperature-rest", "equilibrium stays"},
    {"faulty-temperature-limit", "stability limit as declared"},
    {"faulty-temperature-any_step", "stable for any step"},
    {"faulty-temperature-solver", "heat is kept"},
    {"faulty-temperature-exact", "exact while the network stays"},
};

START_TEST(test_each_check_bites)
{
    struct calx_conformance report;
    run(faults[_i].file, &report);
    for (size_t k = 0; k < report.count; k++)
        if (strcmp(report.checks[k].name, faults[_i].check) == 0) {
            ck_assert_msg(!report.checks[k].passed, "%s passed \"%s\" with %g", faults[_i].file,
                          faults[_i].check, report.checks[k].figure);
            ck_assert_uint_gt(report.failed, 0);
            return;
        }
    ck_abort_msg("%s: no check \"%s\"", faults[_i].file, faults[_i].check);
}
END_TEST

static void assert_passes(const struct calx_conformance *report, const char *name)
{
    ck_assert_uint_gt(report->count, 4);
    for (size_t k = 0; k < report->count; k++)
        ck_assert_msg(report->checks[k].passed, "%s: %s: %g, bound %g (%s)", name,
                      report->checks[k].name, report->checks[k].figure, report->checks[k].bound,
                      report->checks[k].where);
    ck_assert_uint_eq(report->failed, 0);
}

static const char *const right[] = {"faulty-normal-none", "faulty-tangential-none", "faulty-condition-none",
                                    "faulty-conductance-none", "faulty-motion-none",
                                    "faulty-motion-two", "faulty-global-none",
                                    "faulty-temperature-none"};

START_TEST(test_right_variants_pass)
{
    struct calx_conformance report;
    run(right[_i], &report);
    assert_passes(&report, right[_i]);
}
END_TEST

/* The plugins of this issue: the suite runs on them and on whatever else the folders hold. */
enum { PLUGINS = 26 };

START_TEST(test_every_plugin_passes)
{
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_conformance report;
    struct calx_error error = {0};
    size_t count = calx_registry_load_all(r, stderr);
    ck_assert_uint_ge(count, PLUGINS);
    for (size_t i = 0; i < count; i++) {
        const struct calx_plugin *p = calx_registry_at(r, i);
        ck_assert_int_eq(calx_conform_run(p, &report, &error), 0);
        assert_passes(&report, p->name);
    }
    calx_registry_free(r);
}
END_TEST

static char *print_check(const char *file, int *code, struct calx_error *error)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    struct calx_registry *r = calx_registry_create(NULL);
    *code = calx_catalogue_check(out, r, path_of(file), error);
    calx_registry_free(r);
    fclose(out);
    return text;
}

START_TEST(test_printed_report)
{
    struct calx_error error = {0};
    int code;
    char *text = print_check("broken-magic", &code, &error);
    ck_assert_int_eq(code, CALX_ERROR_INPUT);
    free(text);
    text = print_check("faulty-normal-stiffness", &code, &error);
    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
    ck_assert_ptr_nonnull(strstr(text, "FAILED  reported normal stiffness"));
    ck_assert_ptr_nonnull(strstr(error.text, "checks failed"));
    free(text);
    text = print_check("faulty-normal-none", &code, &error);
    ck_assert_int_eq(code, 0);
    ck_assert_ptr_null(strstr(text, "FAILED"));
    ck_assert_ptr_nonnull(strstr(text, "checks passed"));
    free(text);
}
END_TEST

static const struct {
    const char *name; /* NULL: the list */
    int code;
    const char *words[6];
} pages[] = {
    {"linaer", CALX_ERROR_INPUT, {"did you mean \"linear\""}},
    {NULL,
     0,
     {"linear", "velocity-verlet", "heat-theta", "conductance", "integrator (motion)", "template"}},
    {"hertz",
     0,
     {"contact \"hertz\"", "conductance \"hertz\"", "(E, Pa)", "Johnson", "of <material>",
      "must be given"}},
    {"linear",
     0,
     {"stiffness (k, N/m)", "no or yes", "may be left out", "a <pair> may override it"}},
    {"coulomb",
     0,
     {"spring-and-damper or spring", "spring-and-damper if not given",
      "tangential velocity, rotation"}},
    {"verlet", 0, {"order 2, 1 force evaluation per step", "reversible", "no parameters"}},
    {"contact-exact", 0, {"resolves onset and end of contacts", "Navot"}},
    {"cash-karp", 0, {"order 5, sub-steps of its own", "1e-08 if not given"}},
    {"gear", 0, {"order 5, 1 force evaluation per step", "3 or 4 or 5", "Allen and Tildesley"}},
    {"heat-theta", 0, {"stable for any step", "0.5 if not given"}},
    {"heat-exponential", 0, {"exact while the network stays, stable for any step"}},
    {"heat-euler", 0, {"stable for lambda dt < 2"}},
};

START_TEST(test_pages)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_error error = {0};
    int code = pages[_i].name ? calx_catalogue_show(out, r, pages[_i].name, &error)
                              : calx_catalogue_list(out, r, &error);
    fclose(out);
    ck_assert_int_eq(code, pages[_i].code);
    for (size_t k = 0; k < 6 && pages[_i].words[k]; k++)
        ck_assert_msg(strstr(code ? error.text : text, pages[_i].words[k]) != NULL,
                      "no \"%s\" in: %s", pages[_i].words[k], code ? error.text : text);
    free(text);
    calx_registry_free(r);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("conformance");
    TCase *t = tcase_create("all");
    tcase_add_loop_test(t, test_each_check_bites, 0, sizeof faults / sizeof *faults);
    tcase_add_loop_test(t, test_right_variants_pass, 0, sizeof right / sizeof *right);
    tcase_add_test(t, test_every_plugin_passes);
    tcase_add_test(t, test_printed_report);
    tcase_add_loop_test(t, test_pages, 0, sizeof pages / sizeof *pages);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

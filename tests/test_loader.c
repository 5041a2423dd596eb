/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The plugin loader: each kind of failure has its own message, found with a deliberately bad file;
 * then what it finds and where, values against their rows, and the help for prepare of
 * core/plugin.h.
 */
#include <check.h>
#include <libgen.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/loader.h"

static char faulty[PATH_MAX + 16];   /* folder of the bad plugins */
static char folder[2][PATH_MAX / 4]; /* two empty folders for this test */
static char list[PATH_MAX];          /* both, as a search path */

static void find_faulty(void)
{
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    snprintf(faulty, sizeof faulty, "%s/plugins", dirname(program));
}

static void set_up(void)
{
    const char *tmp = getenv("TMPDIR");
    for (int k = 0; k < 2; k++) {
        snprintf(folder[k], sizeof folder[k], "%s/calx-loader-XXXXXX", tmp ? tmp : "/tmp");
        ck_assert_ptr_nonnull(mkdtemp(folder[k]));
    }
    snprintf(list, sizeof list, "%s:%s", folder[0], folder[1]);
}

static void tear_down(void)
{
    char command[PATH_MAX + 16];
    for (int k = 0; k < 2; k++) {
        snprintf(command, sizeof command, "rm -rf '%s'", folder[k]);
        ck_assert_int_eq(system(command), 0);
    }
}

/* Puts a bad plugin into folder k under a name. */
static void put(int k, const char *from, const char *as)
{
    char source[2 * PATH_MAX], target[2 * PATH_MAX], command[5 * PATH_MAX];
    snprintf(source, sizeof source, "%s/%s.so", faulty, from);
    snprintf(target, sizeof target, "%s/%s", folder[k], as);
    snprintf(command, sizeof command, "cp '%s' '%s'", source, target);
    ck_assert_int_eq(system(command), 0);
}

static void assert_words(const char *text, const char *const *words, size_t count)
{
    for (size_t k = 0; k < count && words[k]; k++)
        ck_assert_msg(strstr(text, words[k]) != NULL, "no \"%s\" in: %s", words[k], text);
}

/* ---- bad files ---- */

static const struct {
    const char *file, *words[3];
} bad[] = {
    {"missing", {"cannot load the plugin", "missing.so", "No such file"}},
    {"broken-undefined", {"cannot load the plugin", "calx_test_missing_function"}},
    {"broken-symbol", {"is not a calx plugin", "no symbol calx_plugin"}},
    {"broken-magic", {"is not a calx plugin", "0x12345678"}},
    {"broken-abi", {"ABI 7", "ABI 4", "build it anew"}},
    {"broken-size", {"40 bytes", "build it anew"}},
    {"broken-kind", {"its kind is unknown"}},
    {"broken-name", {"name must be lower-case"}},
    {"broken-summary", {"summary must not be empty"}},
    {"broken-law", {"law must not be NULL"}},
    {"broken-force", {"force must not be NULL"}},
    {"broken-response", {"response must not be NULL"}},
    {"broken-condition", {"condition must not be NULL"}},
    {"faulty-motion-resolves", {"resolves_contacts needs one stage", "velocity_lag of 0.5"}},
    {"broken-provides", {"provides must name parts"}},
    {"broken-history", {"history must name every vector and scalar"}},
    {"broken-table", {"parameters is NULL"}},
    {"broken-row_name", {"row 2", "lower-case"}},
    {"broken-row_twice", {"row 2 (a)", "twice"}},
    {"broken-row_texts", {"row 2 (b)", "must not be NULL"}},
    {"broken-row_scope", {"row 2 (b)", "scope is unknown"}},
    {"broken-row_flags", {"row 2 (b)", "CALX_REQUIRED and CALX_OPTIONAL exclude"}},
    {"broken-row_words", {"row 2 (b)", "CALX_SWITCH and CALX_CHOICE exclude"}},
    {"broken-row_choices", {"row 2 (b)", "choices must come together"}},
    {"broken-row_nan", {"row 2 (b)", "min and max must be numbers"}},
    {"broken-row_crossed", {"row 2 (b)", "min is greater than max"}},
    {"broken-row_range", {"row 2 (b)", "index of its last word"}},
    {"broken-row_default", {"row 2 (b)", "default is outside"}},
    {"broken-row_aligned", {"row 2 (b)", "offset is not that of a double"}},
    {"broken-row_outside", {"row 2 (b)", "outside the plugin's struct"}},
    {"broken-row_overlaps", {"row 2 (b)", "overlaps"}},
};

START_TEST(test_bad_files)
{
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_error error = {0};
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s.so", faulty, bad[_i].file);
    ck_assert_ptr_null(calx_registry_load(r, path, &error));
    ck_assert_int_eq(error.code, CALX_ERROR_INPUT);
    assert_words(error.text, bad[_i].words, 3);
    ck_assert_uint_eq(calx_registry_count(r), 0);
    calx_registry_free(r);
}
END_TEST

START_TEST(test_not_a_shared_object)
{
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/contact-text.so", folder[0]);
    FILE *f = fopen(path, "w");
    for (int k = 0; k < 20; k++)
        fputs("this is text\n", f);
    fclose(f);
    struct calx_registry *r = calx_registry_create(list);
    struct calx_error error = {0};
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "text", &error));
    assert_words(error.text,
                 (const char *const[]){"cannot load the plugin", path, "invalid ELF header"}, 3);
    calx_registry_free(r);
}
END_TEST

START_TEST(test_not_found)
{
    struct calx_registry *r = calx_registry_create(list);
    struct calx_error error = {0};
    put(1, "broken-none", "contact-broken.so");
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "brokem", &error));
    assert_words(error.text,
                 (const char *const[]){"no plugin \"brokem\" of kind contact",
                                       "did you mean \"broken\"", folder[0], folder[1],
                                       "contact-brokem.so"},
                 5);
    ck_assert_ptr_null(calx_registry_find(r, CALX_MOTION, "broken", &error));
    ck_assert_ptr_nonnull(strstr(error.text, "of kind integrator (motion)"));
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "../broken", &error));
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "", &error));
    calx_registry_free(r);
}
END_TEST

START_TEST(test_wrong_kind_and_name)
{
    struct calx_registry *r = calx_registry_create(list);
    struct calx_error error = {0};
    put(0, "broken-none", "conductance-broken.so");
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONDUCTANCE, "broken", &error));
    assert_words(
        error.text,
        (const char *const[]){"wrong kind: contact, expected conductance", "conductance-broken.so"},
        2);
    put(0, "broken-none", "contact-alias.so");
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "alias", &error));
    assert_words(error.text,
                 (const char *const[]){"calls itself \"broken\"", "rename it to contact-broken.so"},
                 2);
    ck_assert_uint_eq(calx_registry_count(r), 0);
    calx_registry_free(r);
}
END_TEST

START_TEST(test_duplicates)
{
    struct calx_registry *r = calx_registry_create(list);
    struct calx_error error = {0};
    char path[2 * PATH_MAX];
    put(0, "broken-none", "contact-broken.so");
    put(1, "broken-other", "contact-broken.so");
    ck_assert_ptr_null(calx_registry_find(r, CALX_CONTACT, "broken", &error));
    assert_words(
        error.text,
        (const char *const[]){"two different plugins", "contact \"broken\"", folder[0], folder[1]},
        4);
    /* the same content twice is no contradiction */
    put(1, "broken-none", "contact-broken.so");
    const struct calx_plugin *p = calx_registry_find(r, CALX_CONTACT, "broken", &error);
    ck_assert_msg(p != NULL, "%s", error.text);
    snprintf(path, sizeof path, "%s/contact-broken.so", folder[1]);
    ck_assert_ptr_eq(calx_registry_load(r, path, &error), p);
    ck_assert_uint_eq(calx_registry_count(r), 1);
    /* but another file that exports the same name is */
    snprintf(path, sizeof path, "%s/faulty-normal-none.so", faulty);
    ck_assert_ptr_nonnull(calx_registry_load(r, path, &error));
    snprintf(path, sizeof path, "%s/faulty-tangential-none.so", faulty);
    ck_assert_ptr_null(calx_registry_load(r, path, &error));
    assert_words(error.text,
                 (const char *const[]){"two different plugins", "faulty-normal-none.so",
                                       "faulty-tangential-none.so"},
                 3);
    calx_registry_free(r);
}
END_TEST

START_TEST(test_load_all_reports_problems)
{
    struct calx_registry *r = calx_registry_create(list);
    char *text = NULL;
    size_t size = 0;
    size_t before = calx_registry_load_all(r, NULL);
    put(0, "broken-none", "contact-broken.so");
    put(0, "broken-abi", "contact-old.so");
    put(0, "broken-none", "readme.so");
    FILE *problems = open_memstream(&text, &size);
    ck_assert_uint_eq(calx_registry_load_all(r, problems), before + 1);
    fclose(problems);
    ck_assert_ptr_nonnull(strstr(text, "ABI 7"));
    ck_assert_ptr_null(strstr(text, "readme"));
    ck_assert_ptr_null(calx_registry_at(r, before + 1));
    free(text);
    calx_registry_free(r);
}
END_TEST

/* ---- what is found ---- */

static const struct {
    enum calx_kind kind;
    const char *name;
} there[] = {
    {CALX_CONTACT, "linear"},    {CALX_CONTACT, "coulomb"},        {CALX_CONTACT, "hertz"},
    {CALX_CONTACT, "mindlin"},   {CALX_CONTACT, "template"},       {CALX_CONDUCTANCE, "overlap"},
    {CALX_CONDUCTANCE, "hertz"}, {CALX_CONDUCTANCE, "constant"},   {CALX_MOTION, "velocity-verlet"},
    {CALX_MOTION, "verlet"},     {CALX_TEMPERATURE, "heat-euler"}, {CALX_TEMPERATURE, "heat-theta"},
};

START_TEST(test_found)
{
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_error error = {0};
    const struct calx_plugin *p = calx_registry_find(r, there[_i].kind, there[_i].name, &error);
    ck_assert_msg(p != NULL, "%s", error.text);
    ck_assert_str_eq(p->name, there[_i].name);
    ck_assert_uint_eq(p->kind, there[_i].kind);
    ck_assert_ptr_nonnull(strstr(calx_registry_path(r, p), there[_i].name));
    ck_assert_ptr_eq(calx_registry_find(r, there[_i].kind, there[_i].name, &error), p);
    ck_assert_uint_eq(calx_registry_count(r), 1);
    calx_registry_free(r);
}
END_TEST

START_TEST(test_kind_names)
{
    ck_assert_str_eq(calx_kind_name(CALX_CONTACT), "contact");
    ck_assert_str_eq(calx_kind_name(CALX_TEMPERATURE), "integrator (temperature)");
    ck_assert_str_eq(calx_kind_name((enum calx_kind)99), "unknown kind");
}
END_TEST

/* ---- values against rows ---- */

static const struct {
    struct calx_parameter row;
    double value;
    const char *words; /* NULL: allowed */
} values[] = {
    {{.name = "e", .unit = "1", .min = 0, .max = 1},
     NAN,
     "e must be at least 0 and at most 1, not nan"},
    {{.name = "e", .unit = "1", .min = 0, .max = 1}, -0.1, "not -0.1"},
    {{.name = "e", .unit = "1", .min = 0, .max = 1}, 1.1, "at most 1"},
    {{.name = "k", .unit = "N/m", .min = 0, .max = INFINITY}, INFINITY, "not inf"},
    {{.name = "k", .unit = "N/m", .min = 0, .max = 9, .flags = CALX_OPEN_MIN},
     0,
     "greater than 0 N/m"},
    {{.name = "k", .unit = "N/m", .min = 0, .max = 9, .flags = CALX_OPEN_MAX},
     9,
     "less than 9 N/m"},
    {{.name = "clip", .unit = "1", .min = 0, .max = 1, .flags = CALX_SWITCH},
     0.5,
     "one of no, yes"},
    {{.name = "cap", .unit = "1", .min = 0, .max = 1, .flags = CALX_CHOICE, .choices = "a|b"},
     0.5,
     "one of a|b"},
    {{.name = "cap", .unit = "1", .min = 0, .max = 1, .flags = CALX_CHOICE, .choices = "a|b"},
     2,
     "at most 1"},
    {{.name = "e", .unit = "1", .min = 0, .max = 1}, 0, NULL},
    {{.name = "e", .unit = "1", .min = 0, .max = 1}, 1, NULL},
    {{.name = "k", .unit = "N/m", .min = 0, .max = 9, .flags = CALX_OPEN_MIN}, 1e-300, NULL},
    {{.name = "cap", .unit = "1", .min = 0, .max = 1, .flags = CALX_CHOICE, .choices = "a|b"},
     1,
     NULL},
};

START_TEST(test_values)
{
    struct calx_error error = {0};
    int code = calx_parameter_check(&values[_i].row, values[_i].value, &error);
    ck_assert_int_eq(code, values[_i].words ? CALX_ERROR_INPUT : 0);
    if (values[_i].words)
        ck_assert_msg(strstr(error.text, values[_i].words) != NULL, "no \"%s\" in: %s",
                      values[_i].words, error.text);
}
END_TEST

/* Every row of every plugin refuses what no parameter may be. */
START_TEST(test_impossible_values)
{
    static const double impossible[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
    struct calx_registry *r = calx_registry_create(NULL);
    size_t rows = 0;
    calx_registry_load_all(r, stderr);
    for (size_t i = 0; i < calx_registry_count(r); i++) {
        const struct calx_plugin *p = calx_registry_at(r, i);
        for (size_t k = 0; k < p->parameter_count; k++, rows++) {
            ck_assert_ptr_eq(calx_plugin_parameter(p, p->parameters[k].name), &p->parameters[k]);
            for (size_t v = 0; v < sizeof impossible / sizeof *impossible; v++)
                ck_assert_msg(calx_parameter_check(&p->parameters[k], impossible[v], NULL) ==
                                  CALX_ERROR_INPUT,
                              "%s %s takes %g", p->name, p->parameters[k].name, impossible[v]);
        }
        ck_assert_ptr_null(calx_plugin_parameter(p, "nonsense"));
    }
    ck_assert_uint_gt(rows, 25);
    calx_registry_free(r);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("loader");
    TCase *t = tcase_create("all");
    find_faulty();
    tcase_add_checked_fixture(t, set_up, tear_down);
    tcase_add_loop_test(t, test_bad_files, 0, sizeof bad / sizeof *bad);
    tcase_add_test(t, test_not_a_shared_object);
    tcase_add_test(t, test_not_found);
    tcase_add_test(t, test_wrong_kind_and_name);
    tcase_add_test(t, test_duplicates);
    tcase_add_test(t, test_load_all_reports_problems);
    tcase_add_loop_test(t, test_found, 0, sizeof there / sizeof *there);
    tcase_add_test(t, test_kind_names);
    tcase_add_loop_test(t, test_values, 0, sizeof values / sizeof *values);
    tcase_add_test(t, test_impossible_values);
    suite_add_tcase(s, t);
    SRunner *r = srunner_create(s);
    srunner_run_all(r, CK_ENV);
    int failed = srunner_ntests_failed(r);
    srunner_free(r);
    return failed != 0;
}

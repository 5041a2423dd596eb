/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx verify`: runs cases without output and judges their expectations.
 * Input: cases. Output: a table of expected, got, error, tolerance, verdict; exit status 1 if
 * anything failed, 2 if a case cannot be read.
 */
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/commands.h"
#include "io/run.h"

struct score {
    size_t cases, passed, failed;
    int status; /* the worst */
};

static void count_verdicts(struct score *score, const struct calx_run *run)
{
    size_t failures = calx_verify_failures(run->verify);
    score->failed += failures;
    score->passed += calx_verify_count(run->verify) - failures;
    if (failures && score->status == 0)
        score->status = calx_error_exit(CALX_ERROR_PHYSICS);
}

static void print_refusal(const struct calx_run *run, const char *part, bool passed)
{
    printf("%-22s %-34s %14s %14s %10s %10s  %-7s %s\n", run->name, "refusal", "", "", "", "text",
           passed ? "passed" : "FAILED", part);
}

/* The case expects to be refused: each part of the message counts as one expectation. */
static void judge_refusal(struct score *score, const struct calx_run *run, int code,
                          const char *said)
{
    for (size_t i = 0; i < run->problems.refusal_count; ++i) {
        bool passed = code != CALX_OK && strstr(said, run->problems.refusals[i]);
        print_refusal(run, run->problems.refusals[i], passed);
        score->passed += passed;
        score->failed += !passed;
        if (!passed && score->status == 0)
            score->status = calx_error_exit(CALX_ERROR_PHYSICS);
    }
    if (code == CALX_OK)
        printf("%-22s was not refused\n", run->name);
}

static void judge_results(struct score *score, const struct calx_run *run)
{
    calx_verify_print(run->verify, run->name, stdout);
    if (calx_verify_count(run->verify) == 0)
        printf("%-22s expects nothing\n", run->name);
    count_verdicts(score, run);
}

static void report_failure(struct score *score, const struct calx_run *run, const char *path,
                           const struct calx_error *error)
{
    int status = calx_options_report(error);
    printf("%-22s FAILED: did not come to its end\n", run->name ? run->name : path);
    score->failed += 1;
    score->status = status > score->status ? status : score->status;
}

static void verify_case(struct score *score, const char *path, const struct calx_arguments *a)
{
    score->cases++;
    const struct calx_run_options options = {
        .case_path = path,
        .threads = a->threads,
        .settings = a->settings,
        .setting_count = a->setting_count,
    };
    struct calx_run run;
    struct calx_error error = {0};
    char *said = NULL;
    size_t size = 0;
    FILE *messages = open_memstream(&said, &size);
    int code = calx_run_open(&run, &options, messages ? messages : stderr, &error);
    if (code == CALX_OK)
        code = calx_run_go(&run, &error);
    if (messages)
        fprintf(messages, "%s", error.text);
    if (messages && fclose(messages) == 0 && run.problems.refusal_count) {
        judge_refusal(score, &run, code, said);
    } else {
        if (size > strlen(error.text)) /* mistakes and warnings; the error follows by itself */
            fprintf(stderr, "%.*s", (int)(size - strlen(error.text)), said);
        if (code == CALX_OK)
            judge_results(score, &run);
        else
            report_failure(score, &run, path, &error);
    }
    free(said);
    fflush(stdout);
    calx_run_close(&run);
}

/* ---- folders ---- */

static bool ends_in_xml(const char *name)
{
    size_t n = strlen(name);
    return n > 4 && strcmp(name + n - 4, ".xml") == 0;
}

static int is_case(const struct dirent *entry)
{
    return ends_in_xml(entry->d_name) && entry->d_name[0] != '.';
}

static mode_t type_of(const char *path)
{
    struct stat what;
    return stat(path, &what) == 0 ? what.st_mode & S_IFMT : 0;
}

static bool holds(const char *folder, const char *name)
{
    char path[PATH_MAX];
    return snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path && access(path, F_OK) == 0;
}

/* A folder without case.xml: each case file in it, in the order of the alphabet. */
static void verify_folder(struct score *score, const char *folder, const struct calx_arguments *a)
{
    struct dirent **names = NULL;
    int count = scandir(folder, &names, is_case, alphasort);
    if (count <= 0) {
        fprintf(stderr, "calx: %s holds no case: neither case.xml nor another .xml file\n", folder);
        score->status = calx_error_exit(CALX_ERROR_INPUT);
    }
    for (int k = 0; k < count; k++) {
        char path[PATH_MAX];
        snprintf(path, sizeof path, "%s/%s", folder, names[k]->d_name);
        verify_case(score, path, a);
        free(names[k]);
    }
    free(names);
}

static int verify_cases(const struct calx_arguments *a)
{
    struct score score = {0};
    calx_verify_print_header(stdout);
    for (size_t i = 0; i < a->operand_count; ++i) {
        const char *path = a->operands[i];
        if (type_of(path) == S_IFDIR && !holds(path, "case.xml"))
            verify_folder(&score, path, a);
        else if (type_of(path) == S_IFREG && !ends_in_xml(path)) /* as `cases/...` of a shell brings them */
            fprintf(stderr, "calx: %s: skipped, no case file (.xml)\n", path);
        else
            verify_case(&score, path, a);
    }
    if (score.cases == 0)
        score.status = calx_error_exit(CALX_ERROR_INPUT);
    printf("%zu case%s: %zu expectations passed, %zu failed\n", score.cases,
           score.cases == 1 ? "" : "s", score.passed, score.failed);
    return score.status;
}

#define OPTIONS 2
static const struct calx_option *const used[OPTIONS] = {&calx_option_set, &calx_option_threads};

const struct calx_command calx_command_verify = {
    "verify",
    "CASE... [options]",
    "run cases and compare with what they expect",
    "Writes no files. An expectation is judged at the instants of the CSV, at its own time, or at "
    "the end. A case may expect to be refused with a message. Of a folder without case.xml every .xml file is a case.\n\n"
    "examples:\n"
    "  calx verify cases/04-two-spheres\n"
    "  calx verify cases/0*\n"
    "  calx verify cases/extreme\n",
    OPTIONS,
    used,
    1,
    (size_t)-1,
    verify_cases,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx run`: runs a case with progress, a summary and its expectations.
 * Input: the command line. Output: the files of io/run.c; exit status, 128 plus the number of a
 * signal that ended the run. Ctrl-C and SIGTERM let the step finish and leave a restart point; a
 * second one ends the program at once.
 */
#include <stdio.h>
#include <string.h>

#include "io/commands.h"
#include "io/run.h"

static volatile sig_atomic_t caught; /* written by the handler only */

static void catch (int signal)
{
    caught = signal;
}

static void catch_signals(void)
{
    struct sigaction action = {.sa_handler = catch, .sa_flags = SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* In quotes for a shell, if it needs them. */
static void print_word(const char *word, FILE *file)
{
    if (*word && !strpbrk(word, " \t\n'\"\\$`*?[]{}()<>|&;#~!")) {
        fputs(word, file);
        return;
    }
    fputc('\'', file);
    for (; *word; ++word)
        if (*word == '\'')
            fputs("'\\''", file);
        else
            fputc(*word, file);
    fputc('\'', file);
}

static void print_how_to_resume(const struct calx_run *run, const struct calx_arguments *a)
{
    fprintf(stderr,
            "calx: stopped by %s at t = %.9g s; frame and restart point are written. To go on:\n  "
            "calx run ",
            caught == SIGINT ? "Ctrl-C" : "SIGTERM", calx_sim_time(run->sim));
    print_word(a->operands[0], stderr);
    for (size_t i = 0; i < a->setting_count; ++i) {
        fprintf(stderr, " --set ");
        print_word(a->settings[i].path, stderr);
        fputc('=', stderr);
        print_word(a->settings[i].value, stderr);
    }
    if (a->out) {
        fprintf(stderr, " --out ");
        print_word(a->out, stderr);
    }
    fprintf(stderr, "%s --resume\n", a->force ? " --force" : "");
}

static void print_end(const struct calx_run *run)
{
    calx_run_print_summary(run, stdout);
    if (calx_verify_count(run->verify) > 0) {
        putchar('\n');
        calx_verify_print_header(stdout);
        calx_verify_print(run->verify, run->name, stdout);
        putchar('\n');
    }
    printf("open in ParaView: %s   (paraview/view %s)\n", calx_series_path(run->series),
           calx_series_path(run->series));
}

static int finish(const struct calx_run *run, const struct calx_arguments *a)
{
    if (run->interrupted) {
        print_how_to_resume(run, a);
        return 128 + (int)caught;
    }
    if (!a->quiet)
        print_end(run);
    size_t failures = calx_verify_failures(run->verify);
    if (failures)
        fprintf(stderr, "calx: %zu of %zu expectations failed\n", failures,
                calx_verify_count(run->verify));
    return failures ? calx_error_exit(CALX_ERROR_PHYSICS) : 0;
}

static int run_case(const struct calx_arguments *a)
{
    const struct calx_run_options options = {
        .case_path = a->operands[0],
        .out = a->out,
        .files = true,
        .resume = a->resume,
        .force = a->force,
        .threads = a->threads,
        .progress = a->quiet ? NULL : stderr,
        .settings = a->settings,
        .setting_count = a->setting_count,
        .stop = &caught,
    };
    struct calx_run run;
    struct calx_error error;
    catch_signals();
    int code = calx_run_open(&run, &options, stderr, &error);
    if (code == CALX_OK)
        code = calx_run_go(&run, &error);
    int status = code == CALX_OK ? finish(&run, a) : calx_options_report(&error);
    calx_run_close(&run);
    return status;
}

#define OPTIONS 6
static const struct calx_option *const used[OPTIONS] = {
    &calx_option_set,    &calx_option_out,   &calx_option_threads,
    &calx_option_resume, &calx_option_quiet, &calx_option_force,
};

const struct calx_command calx_command_run = {
    "run",
    "CASE [options]",
    "run a case: frames for ParaView, a CSV, a restart point",
    "CASE is a case file or a folder that holds case.xml. Output goes to results/NAME unless --out "
    "says else.\n\n"
    "examples:\n"
    "  calx run cases/04-two-spheres\n"
    "  calx run case.xml --set 'stage[turn]/for=1 s' --set integrator/dt=1e-5 --out /tmp/try\n"
    "  calx run cases/07-drum-with-flights --resume\n",
    OPTIONS,
    used,
    1,
    1,
    run_case,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The command line as data: each subcommand has a table of its options, from which it is parsed and
 * its help printed.
 */
#ifndef CALX_IO_OPTIONS_H
#define CALX_IO_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "core/error.h"
#include "io/case.h"

enum { CALX_OPTIONS_THREADS = 16 };

/* What was given; strings belong to argv. */
struct calx_arguments {
    const char *out, *check;
    int threads; /* 0: all cores */
    size_t thread_count;
    int thread_list[CALX_OPTIONS_THREADS]; /* of --threads 1,2 */
    int64_t steps, warm;                   /* 0 and -1: not given */
    bool force, resume, quiet, reference, json, help;
    const char *integrators, *step_range, *heat_range, *soften, *quantities, *tolerance_range, *points; /* of report */
    double target, budget; /* 0: not given; budget in s */
    int seeds, again;      /* 0: not given */
    bool stability;
    size_t setting_count;
    struct calx_setting *settings; /* owned; the paths are copies */
    size_t operand_count;
    const char **operands; /* owned */
};

struct calx_option {
    const char *name;     /* "--out" */
    const char *argument; /* name of its value in the help; NULL: a switch */
    const char *doc;
    int (*set)(struct calx_arguments *, const char *value, struct calx_error *);
};

struct calx_command {
    const char *name, *operands, *summary, *details; /* details: examples */
    size_t option_count;
    const struct calx_option *const *options;
    size_t least, most;                        /* operands */
    int (*run)(const struct calx_arguments *); /* returns the exit status */
};

/* The options that commands share. */
extern const struct calx_option calx_option_set, calx_option_out, calx_option_threads,
    calx_option_resume, calx_option_quiet, calx_option_force, calx_option_check, calx_option_reference,
    calx_option_thread_list, calx_option_steps, calx_option_warm, calx_option_json;

/* Those of calx report (options_report.c). */
extern const struct calx_option calx_option_integrators, calx_option_step_range,
    calx_option_heat_range, calx_option_soften, calx_option_tolerances, calx_option_points, calx_option_again, calx_option_quantity, calx_option_target,
    calx_option_seeds, calx_option_stability, calx_option_budget, calx_option_report_json;

/* Fills *arguments from argv[1..]. CALX_ERROR_INPUT for what the command does not know, with the
 * nearest name. The caller clears *arguments in any case. */
int calx_options_parse(const struct calx_command *, int argc, char **argv, struct calx_arguments *,
                       struct calx_error *);
void calx_options_clear(struct calx_arguments *);

/* Prints the error with its place on stderr; returns the exit status for it. */
int calx_options_report(const struct calx_error *);

/* Prints the help of a command. */
void calx_options_print_help(const struct calx_command *, FILE *);

#endif

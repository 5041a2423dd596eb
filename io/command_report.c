/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx report`: error against run time, and which integrator and step to use.
 */
#include <stdlib.h>

#include "io/commands.h"
#include "io/report.h"

static const double default_target = 1e-3, default_budget = 180; /* s */

static int report_case(const struct calx_arguments *a)
{
    const struct calx_report_options options = {
        .case_path = a->operands[0],
        .out = a->out,
        .integrators = a->integrators,
        .steps = a->step_range,
        .heat_steps = a->heat_range,
        .soften = a->soften,
        .tolerances = a->tolerance_range,
        .points = a->points,
        .quantities = a->quantities,
        .target = a->target > 0 ? a->target : default_target,
        .budget = a->budget > 0 ? a->budget : default_budget,
        .seeds = a->seeds,
        .again = a->again,
        .threads = a->threads,
        .stability = a->stability,
        .json = a->json,
        .progress = a->quiet ? NULL : stderr,
        .settings = a->settings,
        .setting_count = a->setting_count,
    };
    struct calx_error error = {0};
    return calx_report_make(&options, &error) ? calx_options_report(&error) : 0;
}

static const struct calx_option *const used[] = {
    &calx_option_integrators, &calx_option_step_range, &calx_option_heat_range, &calx_option_soften, &calx_option_tolerances,
    &calx_option_quantity,    &calx_option_target,     &calx_option_seeds,      &calx_option_again,  &calx_option_points,
    &calx_option_stability,   &calx_option_budget,     &calx_option_out,        &calx_option_threads, &calx_option_set,
    &calx_option_report_json, &calx_option_quiet,
};

const struct calx_command calx_command_report = {
    "report",
    "CASE [options]",
    "error against run time; which integrator and step to use",
    "Runs the case with every integrator and a ladder of steps, and measures errors against the case's <exact> solutions, else "
    "a reference run, else (chaotic) statistics over seeds. Writes report.md, report.csv, report.svg and report.png to "
    "results/NAME-report unless --out says else. Interrupted, it goes on when called again.\n\n"
    "examples:\n"
    "  calx report cases/accuracy/oscillator\n"
    "  calx report case.xml --quantity mean --target 0.01 --budget 1min\n"
    "  calx report case.xml --integrators velocity-verlet,rk4 --steps 1e-6..1e-4\n",
    sizeof used / sizeof *used,
    used,
    1,
    1,
    report_case,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Makes a report: study, plan, runs, analysis, output, in this order.
 */
#include "io/report.h"

#include <stdlib.h>

#include "io/report_parts.h"

static int write_all(struct calx_report_job *job, const struct calx_report_analysis *a, struct calx_error *error)
{
    bool drawn;
    CALX_TRY(calx_report_write_csv(job, a, error));
    CALX_TRY(calx_report_write_plot(job, a, &drawn, error));
    if (!drawn)
        fprintf(stderr, "calx: there is no gnuplot: no picture (install gnuplot-nox, then: gnuplot %s/report.gp)\n",
                job->study.folder);
    return calx_report_write_page(job, a, drawn, error);
}

static void tell(const struct calx_report_job *job, const struct calx_report_analysis *a)
{
    if (job->study.options->json)
        calx_report_print_json(job, a, stdout);
    if (job->study.options->json || !job->study.options->progress) /* quiet */
        return;
    for (size_t q = 0; q < job->study.quantity_count; q++)
        calx_report_print_verdict(job, a, calx_report_ranked(job, a, q), stdout);
    printf("\nthe report: %s/report.md\n", job->study.folder);
}

static int make(struct calx_report_job *job, const struct calx_report_options *o, struct calx_report_analysis *a,
                struct calx_error *error)
{
    CALX_TRY(calx_report_study_open(&job->study, o, error));
    CALX_TRY(calx_report_fingerprint(&job->study, error));
    CALX_TRY(calx_report_store_open(&job->store, &job->study, error));
    if (job->store.found)
        calx_report_progress_say(&job->progress, "going on with %zu runs of an interrupted report", job->store.found);
    if (o->stability)
        return calx_report_stability(job, error);
    CALX_TRY(calx_report_plan_make(job, error));
    CALX_TRY(calx_report_points_read(job, error));
    CALX_TRY(calx_report_analyse(job, a, error));
    CALX_TRY(calx_report_measure_again(job, a, a->again, error));
    calx_report_progress_end(&job->progress);
    CALX_TRY(write_all(job, a, error));
    tell(job, a);
    return CALX_OK;
}

int calx_report_make(const struct calx_report_options *o, struct calx_error *error)
{
    struct calx_report_job job = {.store = {.file = -1}, .begin = calx_terminal_clock()};
    struct calx_report_analysis analysis = {0};
    calx_report_progress_begin(&job.progress, o->progress);
    int code = make(&job, o, &analysis, error);
    calx_report_progress_end(&job.progress);
    calx_report_analysis_clear(&analysis);
    calx_report_plan_clear(&job.plan);
    free(job.peers);
    calx_report_store_close(&job.store);
    calx_report_study_clear(&job.study);
    return code;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A run of the report's list: from the store if an interrupted report has made it, else made now, as
 * long as the budget lasts.
 */
#include <math.h>

#include "io/report_parts.h"

/* Runs that would go on past this share of the budget are stopped: an estimate can be wrong by a factor. The rest is for the output. */
static const double DEADLINE = 0.98;

double calx_report_job_left(const struct calx_report_job *job)
{
    return job->study.options->budget - job->before - (calx_terminal_clock() - job->begin);
}

double calx_report_job_seconds(const struct calx_report_job *job, const struct calx_report_recipe *r)
{
    const struct calx_report_candidate *c = &job->study.candidates[r->candidate];
    return job->setup + r->window / r->dt * c->evaluations * job->cost;
}

int calx_report_job_run(struct calx_report_job *job, const struct calx_report_recipe *recipe,
                        const struct calx_report_run **run, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    struct calx_report_run made;
    double begin = calx_terminal_clock(),
           deadline = job->beyond ? INFINITY : job->begin + DEADLINE * s->options->budget - job->before;
    *run = calx_report_store_find(&job->store, recipe, s->width);
    if (*run)
        return CALX_OK;
    if (begin + 0.8 * calx_report_job_seconds(job, recipe) > deadline) {
        job->skipped++;
        return CALX_OK;
    }
    calx_report_progress_update(&job->progress, s->candidates[recipe->candidate].name, recipe->dt);
    int code = calx_report_run_go(s, recipe, deadline, &made, error);
    job->progress.spent += calx_terminal_clock() - begin;
    job->progress.runs++;
    if (code == CALX_ERROR_INPUT && calx_terminal_clock() > deadline) {
        job->skipped++;
        code = CALX_OK;
    } else if (!code) {
        code = calx_report_store_add(&job->store, &made, error);
    }
    calx_report_run_clear(&made);
    if (!code)
        *run = calx_report_store_find(&job->store, recipe, s->width);
    return code;
}

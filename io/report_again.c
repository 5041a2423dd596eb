/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Whether what a verdict promises holds: the same steps, of the point and of the reference, with seeds that the report has not seen.
 * Input: verdicts from statistics. Output: per quantity the mean difference to the reference over those seeds, and whether it is
 * within what was promised. Runs are kept with the others, so that an interrupted report goes on here too.
 */
#include <math.h>

#include "io/report_parts.h"

struct sum {
    double n, sum, squares;
};

/* One seed of a point, as the plan would make it; *mean: of the quantity, NaN if the run did not come to its end. */
static int mean_of(struct calx_report_job *job, const struct calx_report_point *point, int seed, size_t q, double *mean,
                   struct calx_error *error)
{
    const struct calx_report_run *run;
    const struct calx_report_recipe recipe = calx_report_replica(job, point, seed);
    CALX_TRY(calx_report_job_run(job, &recipe, &run, error));
    *mean = run && run->status == CALX_REPORT_GOOD ? calx_report_mean_of(&job->study, run, q) : NAN;
    return CALX_OK;
}

static int measure(struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, struct calx_report_again *again,
                   struct calx_error *error)
{
    const struct calx_report_recipe *r = &job->plan.references[0];
    const struct calx_report_point reference = {.candidate = r->candidate, .dt = r->dt, .heat_dt = r->heat_dt,
                                                .tolerance = r->tolerance, .stiffness = r->stiffness};
    const struct calx_report_verdict *v = &a->verdicts[q];
    struct sum s = {0, 0, 0};
    for (int k = 0; k < job->study.options->again; k++) {
        double got, wanted;
        CALX_TRY(mean_of(job, v->best->point, job->plan.replicas + k, q, &got, error));
        CALX_TRY(mean_of(job, &reference, job->plan.replicas + k, q, &wanted, error));
        double d = (got - wanted) / a->scales[q].scale;
        if (isnan(d))
            continue;
        s.n += 1;
        s.sum += d;
        s.squares += d * d;
    }
    if (s.n < 2)
        return CALX_OK;
    double mean = s.sum / s.n, variance = fmax(0, (s.squares - s.n * mean * mean) / (s.n - 1));
    again->seeds = (size_t)s.n;
    again->mean = fabs(mean);
    again->confidence = calx_report_student((size_t)s.n - 1) * sqrt(variance / s.n);
    again->holds = again->mean <= calx_report_upper(&job->plan, &v->best->errors[q]);
    return CALX_OK;
}

int calx_report_measure_again(struct calx_report_job *job, const struct calx_report_analysis *a, struct calx_report_again *again,
                              struct calx_error *error)
{
    if (!job->study.options->again || job->plan.reference != CALX_REPORT_STATISTICS)
        return CALX_OK;
    calx_report_progress_say(&job->progress, "measuring again with %d other seeds", job->study.options->again);
    job->beyond = true;
    for (size_t q = 0; q < job->study.quantity_count; q++)
        if (a->verdicts[q].best)
            CALX_TRY(measure(job, a, q, &again[q], error));
    return CALX_OK;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Whether paths can be compared at all: two runs whose starts differ by a millionth of a radius.
 * Output: the time at which they are a hundredth of a radius apart (rms over bodies), from which on a
 * difference says nothing about integrators, and how much the difference has grown until then.
 */
#include <math.h>

#include "io/report_parts.h"

static const double PERTURBATION = 1e-6, APART = 1e-2; /* of a radius */
static const double SHORTEST = 1. / 64; /* of the window: the first look; most chaotic scenes part soon */

/* The rms distance of two runs at sample k, in radii. */
static double distance(const struct calx_report_study *s, const struct calx_report_run *a,
                       const struct calx_report_run *b, size_t k)
{
    double sum = 0;
    for (size_t w = 0; w < s->width; w++) {
        double d = a->values[k * s->width + w] - b->values[k * s->width + w];
        sum += d * d;
    }
    return sqrt(sum / (double)s->body_count) / s->radius;
}

static int complain(const struct calx_report_job *job, const struct calx_report_run *const runs[2], struct calx_error *error)
{
    if (!runs[0] || !runs[1])
        return calx_error_set(error, CALX_ERROR_INPUT, "the budget of %g s does not suffice for two short runs of the case: give more with "
                              "--budget", job->study.options->budget);
    const char *why = runs[0]->why[0] ? runs[0]->why : runs[1]->why;
    return calx_error_set(error, CALX_ERROR_PHYSICS, "the case does not come to its end as it stands: %s",
                          why[0] ? why : "its step is too long");
}

/* Two runs over the first `window` s; sets the plan's decorrelation and growth. */
static int compare(struct calx_report_job *job, double window, struct calx_error *error)
{
    struct calx_report_plan *plan = &job->plan;
    struct calx_report_study *s = &job->study;
    const struct calx_report_run *runs[2];
    struct calx_report_recipe recipe = {.candidate = s->own < 0 ? 0 : s->own, .dt = s->own_dt, .stiffness = 1,
                                        .damping = 1, .window = window, .samples = CALX_REPORT_SAMPLES};
    CALX_TRY(calx_report_job_run(job, &recipe, &runs[0], error));
    recipe.perturb = PERTURBATION;
    CALX_TRY(calx_report_job_run(job, &recipe, &runs[1], error));
    recipe.perturb = 0;
    runs[0] = calx_report_store_find(&job->store, &recipe, s->width); /* adding a run may have moved it */
    if (!runs[0] || !runs[1] || runs[0]->status || runs[1]->status)
        return complain(job, runs, error);
    size_t count = runs[0]->count < runs[1]->count ? runs[0]->count : runs[1]->count;
    plan->decorrelation = INFINITY;
    for (size_t k = 0; k < count && !isfinite(plan->decorrelation); k++) {
        double d = distance(s, runs[0], runs[1], k);
        plan->growth = d / PERTURBATION;
        if (d > APART)
            plan->decorrelation = k ? runs[0]->times[k - 1] : 0;
    }
    return CALX_OK;
}

int calx_report_chaos(struct calx_report_job *job, struct calx_error *error)
{
    struct calx_report_plan *plan = &job->plan;
    const double *noted = calx_report_store_noted(&job->store, "chaos");
    if (noted) {
        plan->decorrelation = noted[0];
        plan->growth = noted[1];
        return CALX_OK;
    }
    calx_report_quantities_paths(&job->study);
    plan->decorrelation = INFINITY;
    for (double share = SHORTEST; share <= 1 && !isfinite(plan->decorrelation); share *= 4)
        CALX_TRY(compare(job, share * plan->window, error));
    return calx_report_store_note(&job->store, "chaos", (const double[8]){plan->decorrelation, plan->growth}, error);
}

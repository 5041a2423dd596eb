/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Plans a report: what a step costs, how much of the case there is time for, what errors are measured
 * against. Whatever depends on the clock is noted in the store: a report that goes on decides nothing
 * anew.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

/* Shares of the budget. */
static const double TRIAL = 0.02, CHAOS = 0.3, PILOT = 0.1;
enum { MANY = 20 }; /* bodies from which on means say something where paths do not */

void calx_report_plan_clear(struct calx_report_plan *plan)
{
    free(plan->points);
    free(plan->recipes);
    free(plan->references);
    *plan = (struct calx_report_plan){0};
}

/* ---- the trial ---- */

/* The case as it stands for a short while: the cost of an evaluation. The window grows until the clock can tell. */
static int try_out(struct calx_report_job *job, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    struct calx_report_recipe recipe = {.candidate = s->own < 0 ? 0 : s->own, .dt = s->own_dt, .stiffness = 1,
                                        .damping = 1, .samples = 1};
    calx_report_quantities_paths(s);
    for (double steps = 64;; steps *= 4) {
        struct calx_report_run run;
        recipe.window = fmin(s->duration, steps * s->own_dt);
        int code = calx_report_run_go(s, &recipe, INFINITY, &run, error);
        job->setup = run.setup;
        job->cost = run.wall / (double)(run.evaluations ? run.evaluations : 1);
        bool enough = run.seconds > TRIAL * s->options->budget || recipe.window >= s->duration || steps > 1e7;
        bool stopped = run.status != CALX_REPORT_GOOD;
        snprintf(error->text, sizeof error->text, "%s", run.why);
        calx_report_run_clear(&run);
        if (stopped && !code)
            return calx_error_set(error, CALX_ERROR_PHYSICS, "the case does not run as it stands: %.255s",
                                  recipe.window > 0 ? error->text : "");
        if (code || enough)
            return code;
    }
}

int calx_report_cost(struct calx_report_job *job, struct calx_error *error)
{
    const double *noted = calx_report_store_noted(&job->store, "trial");
    if (noted) {
        job->cost = noted[0];
        job->setup = noted[1];
        return CALX_OK;
    }
    CALX_TRY(try_out(job, error));
    return calx_report_store_note(&job->store, "trial", (const double[8]){job->cost, job->setup}, error);
}

/* ---- what errors are measured against ---- */

static double last_start(const struct calx_report_study *s)
{
    double from = 0;
    for (size_t q = 0; q < s->quantity_count; q++)
        if (s->quantities[q].exact)
            from = fmax(from, s->quantities[q].exact->from);
    return from;
}

static bool all_exact(const struct calx_report_study *s)
{
    for (size_t q = 0; q < s->quantity_count; q++)
        if (!s->quantities[q].exact)
            return false;
    return true;
}

static bool wants_paths_only(const struct calx_report_options *o)
{
    return o->quantities && strcmp(o->quantities, "paths") == 0;
}

/* As much of the case as two runs have time for. */
static double affordable(const struct calx_report_job *job, double share)
{
    const struct calx_report_study *s = &job->study;
    double evaluations = s->own < 0 ? 1 : s->candidates[s->own].evaluations;
    double per_time = job->cost * evaluations / s->own_dt;
    return fmin(s->duration, share * s->options->budget / per_time / 2);
}

static int find_reference(struct calx_report_job *job, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    struct calx_report_plan *plan = &job->plan;
    plan->decorrelation = NAN;
    CALX_TRY(calx_report_quantities_choose(s, false, error));
    if (all_exact(s)) {
        plan->reference = CALX_REPORT_EXACT;
        plan->window = fmin(s->duration, fmax(affordable(job, 2), 1.05 * last_start(s)));
        return CALX_OK;
    }
    plan->reference = CALX_REPORT_CONVERGED;
    plan->window = affordable(job, CHAOS);
    if (s->axis != CALX_MOTION)
        return CALX_OK;
    CALX_TRY(calx_report_chaos(job, error));
    bool chaotic = plan->decorrelation < plan->window;
    if (chaotic && s->particles >= MANY && !wants_paths_only(s->options))
        plan->reference = CALX_REPORT_STATISTICS;
    else if (chaotic)
        plan->window = plan->decorrelation;
    if (!(plan->window > 0))
        return calx_error_set(error, CALX_ERROR_PHYSICS, "two starts that differ by 1e-6 of a radius part at once: there "
                              "is nothing to compare");
    return calx_report_quantities_choose(s, plan->reference == CALX_REPORT_STATISTICS, error);
}

/* The trial sees the start only, and grains that still fall cost less than grains that lie: a run of all that will be compared, or of
 * what there is time for, tells what the plan must reckon with. */
static int pilot(struct calx_report_job *job, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    const struct calx_report_run *run;
    struct calx_report_recipe recipe = {.candidate = s->own < 0 ? 0 : s->own, .dt = s->own_dt, .stiffness = 1, .damping = 1, .samples = 1,
                                        .window = fmin(job->plan.window, affordable(job, PILOT))};
    CALX_TRY(calx_report_job_run(job, &recipe, &run, error));
    if (run && run->status == CALX_REPORT_GOOD && run->evaluations > 0)
        job->cost = fmax(job->cost, run->wall / (double)run->evaluations);
    return CALX_OK;
}

static void say_reference(struct calx_report_job *job)
{
    const struct calx_report_plan *plan = &job->plan;
    static const char *const words[] = {"the exact solution", "a reference run, extrapolated",
                                        "statistics over seeds"};
    calx_report_progress_say(&job->progress, "%s: %zu integrators, errors against %s", job->study.run.name,
                             job->study.candidate_count, words[plan->reference]);
    if (plan->decorrelation < INFINITY)
        calx_report_progress_say(&job->progress,
                                 "paths decorrelate at t = %.3g s: they are not compared past that", plan->decorrelation);
}

int calx_report_plan_make(struct calx_report_job *job, struct calx_error *error)
{
    for (size_t k = 0; k < job->store.count; k++)
        job->before += job->store.runs[k].wall + job->store.runs[k].setup;
    CALX_TRY(calx_report_cost(job, error));
    CALX_TRY(find_reference(job, error));
    say_reference(job);
    if (job->plan.reference == CALX_REPORT_STATISTICS)
        CALX_TRY(pilot(job, error));
    return calx_report_fit(job, error);
}

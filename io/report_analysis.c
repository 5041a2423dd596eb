/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From runs to results: makes the runs of the plan, then errors, costs, orders, the Pareto front.
 * The time of a point is its counted evaluations times the cost of an evaluation of its integrator, the median over all
 * runs of that integrator, weighted with their work: a disturbance of the machine during one run moves no point.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

static const double USELESS = 0.3; /* errors above it say nothing about an order */
static const double RESOLVED = 0.3; /* of the critical step: above it a contact has fewer than five steps */
static const double ROUNDING = 1e-13;

static int out_of_memory(struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

/* ---- the runs ---- */

/* A seed without its reference says nothing. */
static bool has_reference(const struct calx_report_job *job, const struct calx_report_truth *t, size_t replica)
{
    bool any = job->plan.reference != CALX_REPORT_STATISTICS;
    for (size_t q = 0; q < job->study.quantity_count && !any && replica < t->seeds; q++)
        any = !isnan(t->means[replica * job->study.quantity_count + q]);
    return any;
}

/* Replicas from `first` up to before `end` of one point. */
static int make_replicas(struct calx_report_job *job, const struct calx_report_truth *t, const struct calx_report_point *p, size_t first,
                         size_t end, struct calx_error *error)
{
    const struct calx_report_run *unused;
    for (size_t k = first; k < end && k < p->count; k++)
        if (has_reference(job, t, k))
            CALX_TRY(calx_report_job_run(job, &job->plan.recipes[p->first + k], &unused, error));
    return CALX_OK;
}

/* First replicas of all points first, coarse steps before fine ones: what the budget does not allow is missed least. One seed of a point
 * has no confidence: with statistics the first ones are enough to have one. */
static int make_runs(struct calx_report_job *job, const struct calx_report_truth *t, const struct calx_report_analysis *a,
                     struct calx_error *error)
{
    const struct calx_report_plan *plan = &job->plan;
    size_t most = 0, least = plan->reference == CALX_REPORT_STATISTICS ? (a->seeds < 3 ? a->seeds : 3) : 1;
    for (size_t p = 0; p < plan->point_count; p++)
        most = plan->points[p].count > most ? plan->points[p].count : most;
    for (size_t k = 0; k < most; k = k ? k + 1 : least)
        for (size_t p = 0; p < plan->point_count; p++)
            CALX_TRY(make_replicas(job, t, &plan->points[p], k, k ? k + 1 : least, error));
    return CALX_OK;
}

static const struct calx_report_run *run_of(const struct calx_report_job *job, const struct calx_report_point *p,
                                            size_t k)
{
    return calx_report_store_find(&job->store, &job->plan.recipes[p->first + k], job->study.width);
}

/* ---- costs ---- */

/* Solvers whose work is not in the count of evaluations go another way: the clock alone tells. */
static bool has_other_work(const struct calx_report_recipe *r)
{
    return r->heat_dt > 0 || r->tolerance > 0;
}

/* Runs count by their work: those of a few steps measure caches and the clock. */
static void measure_costs(struct calx_report_job *job, struct calx_report_weighted *room)
{
    for (size_t c = 0; c < job->study.candidate_count; c++) {
        struct calx_report_candidate *candidate = &job->study.candidates[c];
        size_t n = 0;
        double steps = 0, evaluations = 0;
        for (size_t k = 0; k < job->store.count; k++) {
            const struct calx_report_run *run = &job->store.runs[k];
            double work = (double)run->evaluations;
            if (run->recipe.candidate != (int)c || !(work > 0) || has_other_work(&run->recipe))
                continue;
            steps += (double)run->steps;
            evaluations += work;
            room[n++] = (struct calx_report_weighted){run->seconds / work, work};
        }
        if (!n)
            continue;
        candidate->evaluations = evaluations / steps;
        candidate->cost = calx_report_weighted_quantile(room, n, 0.5);
        candidate->spread = 0.5 *
                            (calx_report_weighted_quantile(room, n, 0.75) - calx_report_weighted_quantile(room, n, 0.25)) /
                            candidate->cost;
    }
}

/* ---- one point ---- */

static void gather(const struct calx_report_job *job, const struct calx_report_point *p, double *room,
                   struct calx_report_result *r)
{
    size_t n = 0;
    double steps = 0, evaluations = 0;
    *r = (struct calx_report_result){.point = p};
    for (size_t k = 0; k < p->count; k++) {
        const struct calx_report_run *run = run_of(job, p, k);
        if (!run)
            continue;
        r->residual = fmax(r->residual, run->residual);
        if (run->status != CALX_REPORT_GOOD && r->status == CALX_REPORT_GOOD) {
            r->status = run->status;
            memcpy(r->why, run->why, sizeof r->why);
        }
        if (run->status != CALX_REPORT_GOOD)
            continue;
        steps += (double)run->steps;
        evaluations += (double)run->evaluations;
        room[n++] = run->seconds;
    }
    r->runs = n;
    if (!n)
        return;
    r->steps = steps / (double)n;
    r->evaluations = evaluations / (double)n;
    r->measured = calx_report_median(room, n);
    r->spread = calx_report_scatter(room, n);
    r->seconds = p->heat_dt > 0 || p->tolerance > 0 ? r->measured : r->evaluations * job->study.candidates[p->candidate].cost;
}

/* ---- curves ---- */

/* Coarse to fine; the last is the one with the smallest error: below it is the uncertainty of the reference, or rounding. */
static size_t collect_curve(const struct calx_report_job *job, const struct calx_report_analysis *a, int candidate,
                            size_t q, double *x, double *y)
{
    const double limit = RESOLVED * job->study.candidates[candidate].critical;
    double floor = fmax(3 * a->scales[q].floor, ROUNDING), least = INFINITY;
    size_t n = 0, last = 0;
    bool seeds = job->plan.reference == CALX_REPORT_STATISTICS; /* an error within its confidence follows no order */
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        double error = r->errors[q].error;
        if (r->point->candidate != candidate || !calx_report_is_plain(r->point) || r->point->dt > limit || !(error > floor) ||
            error > USELESS || (seeds && error < r->errors[q].confidence))
            continue;
        x[n] = log(r->point->dt);
        y[n++] = log(error);
        last = error < least ? n : last;
        least = fmin(least, error);
    }
    return last;
}

static struct calx_report_curve fit_curve(const struct calx_report_job *job, const struct calx_report_analysis *a,
                                          int candidate, size_t q, double *x, double *y)
{
    struct calx_report_curve curve = {NAN, NAN, collect_curve(job, a, candidate, q, x, y)};
    if (curve.fitted >= 3)
        curve.order = calx_report_slope(x, y, curve.fitted, &curve.order_error);
    return curve;
}

/* Nobody else has both a smaller error and less time. */
static void mark_front(const struct calx_report_plan *plan, struct calx_report_analysis *a, size_t q)
{
    for (size_t i = 0; i < a->count; i++) {
        struct calx_report_result *r = &a->results[i];
        r->front[q] = r->errors[q].error >= 0;
        for (size_t k = 0; k < a->count && r->front[q]; k++)
            if (calx_report_upper(plan, &a->results[k].errors[q]) < calx_report_upper(plan, &r->errors[q]) &&
                a->results[k].seconds <= r->seconds)
                r->front[q] = false;
    }
}

/* ---- the whole ---- */

static int analyse(struct calx_report_job *job, struct calx_report_analysis *a, const struct calx_report_truth *t,
                   double *room, struct calx_error *error)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_plan *plan = &job->plan;
    a->results = calloc(plan->point_count + 1, sizeof *a->results);
    a->curves = calloc(s->candidate_count * s->quantity_count + 1, sizeof *a->curves);
    if (!a->results || !a->curves)
        return out_of_memory(error);
    measure_costs(job, (struct calx_report_weighted *)(void *)room);
    calx_report_pool(job, t, a, room);
    for (a->count = 0; a->count < plan->point_count; a->count++) {
        gather(job, &plan->points[a->count], room, &a->results[a->count]);
        calx_report_errors(job, t, a, &a->results[a->count]);
    }
    for (size_t q = 0; q < s->quantity_count; q++) {
        for (size_t c = 0; c < s->candidate_count; c++)
            a->curves[c * s->quantity_count + q] = fit_curve(job, a, (int)c, q, room, room + plan->point_count);
        mark_front(plan, a, q);
    }
    calx_report_judge(job, a);
    return CALX_OK;
}

int calx_report_analyse(struct calx_report_job *job, struct calx_report_analysis *a, struct calx_error *error)
{
    struct calx_report_truth truth = {0};
    int code = calx_report_truth_find(job, &truth, a, error);
    if (!code)
        code = make_runs(job, &truth, a, error);
    double *room = malloc((2 * job->store.count + 2 * job->plan.point_count + 64) * sizeof *room);
    if (!code)
        code = room ? analyse(job, a, &truth, room, error) : out_of_memory(error);
    free(room);
    calx_report_truth_clear(&truth);
    return code;
}

void calx_report_analysis_clear(struct calx_report_analysis *a)
{
    free(a->results);
    free(a->curves);
    *a = (struct calx_report_analysis){0};
}

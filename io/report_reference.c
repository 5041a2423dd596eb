/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What errors are measured against where no exact solution is known.
 * Converged: three runs with the finest step h, h/2 and h/4. For each quantity the order p follows from their
 * differences, log2(|f(h/2) - f(h)|/|f(h/4) - f(h/2)|), and the limit is f(h/4) + (f(h/4) - f(h/2))/(2^p - 1)
 * (Richardson). Where p is not between 0.5 and 8 the differences are not those of a series and f(h/4) itself is
 * taken. What the last step changed is the uncertainty of the reference.
 * Statistics: for each seed the mean over the samples, with half the finest step.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

static const double LEAST_ORDER = 0.5, LARGEST_ORDER = 8;
static const double ROUNDING = 1e-12; /* of the size: what changes by less does not change */
static const double HALF = 0.5; /* of the budget: the rest is for the points */

void calx_report_truth_clear(struct calx_report_truth *t)
{
    free(t->times);
    free(t->values);
    free(t->means);
    *t = (struct calx_report_truth){0};
}

double calx_report_mean_of(const struct calx_report_study *s, const struct calx_report_run *run, size_t q)
{
    double sum = 0, n = 0;
    for (size_t k = 0; k < run->count; k++) {
        double v = run->values[k * run->width + s->quantities[q].first];
        sum += isnan(v) ? 0 : v;
        n += !isnan(v);
    }
    return n > 0 ? sum / n : NAN;
}

/* ---- the scale of a quantity ---- */

struct range {
    double low, high, largest;
};

static void widen(struct range *r, double v)
{
    if (isnan(v))
        return;
    r->low = fmin(r->low, v);
    r->high = fmax(r->high, v);
    r->largest = fmax(r->largest, fabs(v));
}

/* How much it changes; its size if it hardly changes; 1 if it is zero. Paths: the mean radius. */
static struct calx_report_scale scale_of(const struct calx_report_study *s, const struct calx_report_quantity *q,
                                         const struct range *r)
{
    struct calx_report_scale scale = {.order = NAN};
    double change = r->high - r->low;
    scale.scale = q->form == CALX_REPORT_PATHS ? s->radius : change > 1e-3 * r->largest ? change : r->largest;
    scale.still = !(change > ROUNDING * r->largest) && !q->exact;
    scale.absolute = !(scale.scale > 0) || !isfinite(scale.scale);
    if (scale.absolute)
        scale.scale = 1;
    return scale;
}

static struct calx_report_scale exact_scale(const struct calx_report_job *job, const struct calx_report_quantity *q)
{
    enum { INSTANTS = 256 };
    const double nowhere[3] = {0, 0, 0};
    struct range r = {INFINITY, -INFINITY, 0};
    double from = q->exact->from, step = (job->plan.window - from) / INSTANTS;
    for (int k = 0; k <= INSTANTS; k++)
        widen(&r, calx_evaluate(&q->exact->value, from + k * step, nowhere));
    return scale_of(&job->study, q, &r);
}

/* Of a run, its start included. */
static struct calx_report_scale run_scale(const struct calx_report_job *job, const struct calx_report_quantity *q,
                                          const double *start, const double *values, size_t samples)
{
    struct range r = {INFINITY, -INFINITY, 0};
    for (size_t w = q->first; w < q->first + q->width; w++) {
        widen(&r, start[w]);
        for (size_t k = 0; k < samples; k++)
            widen(&r, values[k * job->study.width + w]);
    }
    return scale_of(&job->study, q, &r);
}

/* ---- the limit of three runs ---- */

static double difference(const struct calx_report_study *s, const struct calx_report_quantity *q,
                         const struct calx_report_run *a, const struct calx_report_run *b)
{
    double sum = 0, n = 0;
    for (size_t k = 0; k < b->count; k++)
        for (size_t w = q->first; w < q->first + q->width; w++) {
            double d = a->values[k * s->width + w] - b->values[k * s->width + w];
            sum += isnan(d) ? 0 : d * d;
            n += !isnan(d);
        }
    return n > 0 ? sqrt(sum / n) : NAN;
}

static void extrapolate(const struct calx_report_study *s, const struct calx_report_quantity *q,
                        const struct calx_report_run *run[3], struct calx_report_truth *t,
                        struct calx_report_scale *scale)
{
    double d1 = difference(s, q, run[0], run[1]), d2 = difference(s, q, run[1], run[2]), p = log2(d1 / d2);
    bool series = p >= LEAST_ORDER && p <= LARGEST_ORDER;
    double factor = series ? 1 / (exp2(p) - 1) : 0;
    for (size_t k = 0; series && k < t->samples; k++)
        for (size_t w = k * s->width + q->first; w < k * s->width + q->first + q->width; w++)
            t->values[w] += factor * (run[2]->values[w] - run[1]->values[w]);
    scale->order = series ? p : NAN;
    scale->floor = (series ? factor : 1) * d2 / scale->scale;
}

static int fetch(struct calx_report_job *job, size_t k, const struct calx_report_run **run, struct calx_error *error)
{
    CALX_TRY(calx_report_job_run(job, &job->plan.references[k], run, error));
    if (!*run)
        return calx_error_set(error, CALX_ERROR_INPUT, "the budget does not suffice for the reference run: give more with "
                              "--budget, or larger steps with --steps");
    if ((*run)->status != CALX_REPORT_GOOD)
        return calx_error_set(error, CALX_ERROR_PHYSICS, "the reference run with step %.3g s failed: %s",
                              job->plan.references[k].dt, (*run)->why);
    return CALX_OK;
}

static int converge(struct calx_report_job *job, const double *start, struct calx_report_truth *t,
                    struct calx_report_analysis *a, struct calx_error *error)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_run *run[3] = {NULL};
    for (size_t k = 0; k < 3; k++)
        CALX_TRY(fetch(job, k, &run[k], error));
    for (size_t k = 0; k < 3; k++) /* adding runs may have moved them */
        CALX_TRY(fetch(job, k, &run[k], error));
    if (run[0]->count != run[2]->count || run[1]->count != run[2]->count)
        return calx_error_set(error, CALX_ERROR_PHYSICS, "the reference runs do not end at the same time");
    t->samples = run[2]->count;
    t->times = malloc(t->samples * sizeof *t->times + 1);
    t->values = malloc(t->samples * s->width * sizeof *t->values + 1);
    if (!t->times || !t->values)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    memcpy(t->times, run[2]->times, t->samples * sizeof *t->times);
    memcpy(t->values, run[2]->values, t->samples * s->width * sizeof *t->values);
    for (size_t q = 0; q < s->quantity_count; q++) {
        if (s->quantities[q].exact)
            continue;
        a->scales[q] = run_scale(job, &s->quantities[q], start, run[2]->values, t->samples);
        extrapolate(s, &s->quantities[q], run, t, &a->scales[q]);
    }
    return CALX_OK;
}

/* ---- statistics ---- */

/* The reference of one seed; NULL if there is no time for it: where two have taken half the budget, points need the rest. */
static int fetch_seed(struct calx_report_job *job, size_t k, size_t good, const struct calx_report_run **run, struct calx_error *error)
{
    *run = calx_report_store_find(&job->store, &job->plan.references[k], job->study.width);
    if (*run || (good >= 2 && calx_report_job_left(job) < HALF * job->study.options->budget))
        return CALX_OK;
    return calx_report_job_run(job, &job->plan.references[k], run, error);
}

/* Seeds whose reference did not end (out of time) are left out everywhere: NaN. */
static int average(struct calx_report_job *job, const double *start, struct calx_report_truth *t,
                   struct calx_report_analysis *a, struct calx_error *error)
{
    const struct calx_report_study *s = &job->study;
    size_t good = 0;
    t->seeds = job->plan.reference_count;
    t->means = malloc(t->seeds * s->quantity_count * sizeof *t->means + 1);
    if (!t->means)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    for (size_t k = 0; k < t->seeds; k++) {
        const struct calx_report_run *run;
        CALX_TRY(fetch_seed(job, k, good, &run, error));
        bool ended = run && run->status == CALX_REPORT_GOOD;
        for (size_t q = 0; q < s->quantity_count; q++) {
            t->means[k * s->quantity_count + q] = ended ? calx_report_mean_of(s, run, q) : NAN;
            if (ended && good == 0)
                a->scales[q] = run_scale(job, &s->quantities[q], start, run->values, run->count);
        }
        good += ended;
    }
    a->seeds = good;
    if (good >= 2)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_PHYSICS, "statistics need reference runs with at least two seeds, and %zu came to "
                          "their end: give more with --budget", good);
}

int calx_report_truth_find(struct calx_report_job *job, struct calx_report_truth *t,
                           struct calx_report_analysis *a, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    double *start = calloc(s->width + 1, sizeof *start);
    int code = CALX_OK;
    if (!start)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    calx_report_quantities_sample(s, s->run.sim, start);
    for (size_t q = 0; q < s->quantity_count; q++)
        if (s->quantities[q].exact)
            a->scales[q] = exact_scale(job, &s->quantities[q]);
    if (job->plan.reference == CALX_REPORT_CONVERGED)
        code = converge(job, start, t, a, error);
    else if (job->plan.reference == CALX_REPORT_STATISTICS)
        code = average(job, start, t, a, error);
    free(start);
    return code;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The errors of one point of the diagram.
 * Input: its runs and what is true. Output: per quantity an error relative to the quantity's scale.
 * Norms: root mean square over samples, bodies and replicas. Statistics: the mean over seeds of the difference to the
 * reference with the same seed, with the half width of its 95 % interval (Student). Once paths have parted, differences scatter alike
 * whatever the step, so no point is taken to scatter less than most do: of many points a verdict would choose the one whose few
 * seeds happen to agree, and promise what other seeds do not hold.
 */
#include <math.h>

#include "io/report_parts.h"

struct sum {
    double squares, n;
};

static void add_difference(struct sum *sum, double got, double wanted)
{
    double d = got - wanted;
    sum->squares += d * d;
    sum->n += 1;
}

/* Exact: at the time that the run had, so that no step needs to end at a given instant. */
static void compare_exact(const struct calx_report_quantity *q, const struct calx_report_run *run, struct sum *sum)
{
    const double nowhere[3] = {0, 0, 0};
    for (size_t k = 0; k < run->count; k++)
        if (run->times[k] >= q->exact->from)
            add_difference(sum, run->values[k * run->width + q->first],
                           calx_evaluate(&q->exact->value, run->times[k], nowhere));
}

static void compare_truth(const struct calx_report_quantity *q, const struct calx_report_run *run,
                          const struct calx_report_truth *t, struct sum *sum)
{
    for (size_t k = 0; k < run->count; k++)
        for (size_t w = k * run->width + q->first; w < k * run->width + q->first + q->width; w++)
            if (!isnan(t->values[w]) && run->count == t->samples)
                add_difference(sum, run->values[w], t->values[w]);
}

/* The scatter over replicas stands beside the root mean square over all of them. */
static struct calx_report_error paths_error(const struct calx_report_job *job, const struct calx_report_truth *t,
                                            const struct calx_report_quantity *q, const struct calx_report_point *p,
                                            double scale)
{
    struct sum all = {0, 0};
    double least = INFINITY, most = 0;
    for (size_t k = 0; k < p->count; k++) {
        const struct calx_report_run *run =
            calx_report_store_find(&job->store, &job->plan.recipes[p->first + k], job->study.width);
        struct sum own = {0, 0};
        if (!run || run->status != CALX_REPORT_GOOD)
            continue;
        if (q->exact)
            compare_exact(q, run, &own);
        else
            compare_truth(q, run, t, &own);
        double error = sqrt(own.squares / own.n) / scale;
        least = fmin(least, error);
        most = fmax(most, error);
        all.squares += own.squares;
        all.n += own.n;
    }
    if (!(all.n > 0))
        return (struct calx_report_error){NAN, NAN};
    return (struct calx_report_error){sqrt(all.squares / all.n) / scale, 0.5 * (most - least)};
}

/* The differences to the reference over the seeds of a point: how many, their mean and standard deviation, in scales. */
struct differences {
    size_t n;
    double mean, deviation;
};

static struct differences differences_of(const struct calx_report_job *job, const struct calx_report_truth *t, size_t q,
                                         const struct calx_report_point *p, double scale)
{
    double sum = 0, squares = 0;
    struct differences s = {0, NAN, NAN};
    for (size_t k = 0; k < p->count && k < t->seeds; k++) {
        const struct calx_report_run *run =
            calx_report_store_find(&job->store, &job->plan.recipes[p->first + k], job->study.width);
        double wanted = t->means[k * job->study.quantity_count + q];
        if (!run || run->status != CALX_REPORT_GOOD || isnan(wanted))
            continue;
        double d = (calx_report_mean_of(&job->study, run, q) - wanted) / scale;
        sum += d;
        squares += d * d;
        s.n++;
    }
    if (s.n < 2)
        return s;
    s.mean = sum / (double)s.n;
    s.deviation = sqrt(fmax(0, (squares - sum * s.mean) / (double)(s.n - 1)));
    return s;
}

void calx_report_pool(const struct calx_report_job *job, const struct calx_report_truth *t, struct calx_report_analysis *a,
                      double *room)
{
    for (size_t q = 0; q < job->study.quantity_count; q++) {
        size_t n = 0, most = 2; /* seeds: points with fewer than others were broken off */
        for (size_t p = 0; p < job->plan.point_count && job->plan.reference == CALX_REPORT_STATISTICS; p++) {
            const struct differences s = differences_of(job, t, q, &job->plan.points[p], a->scales[q].scale);
            n = s.n > most ? 0 : n;
            most = s.n > most ? s.n : most;
            if (s.n == most)
                room[n++] = s.deviation;
        }
        a->pooled[q] = n ? calx_report_median(room, n) : 0;
    }
}

static struct calx_report_error means_error(const struct calx_report_job *job, const struct calx_report_truth *t,
                                            const struct calx_report_analysis *a, size_t q, const struct calx_report_point *p)
{
    const struct differences s = differences_of(job, t, q, p, a->scales[q].scale);
    if (s.n < 2)
        return (struct calx_report_error){NAN, NAN};
    double deviation = fmax(s.deviation, a->pooled[q]);
    return (struct calx_report_error){fabs(s.mean), calx_report_student(s.n - 1) * deviation / sqrt((double)s.n)};
}

void calx_report_errors(const struct calx_report_job *job, const struct calx_report_truth *t,
                        const struct calx_report_analysis *a, struct calx_report_result *r)
{
    for (size_t q = 0; q < job->study.quantity_count; q++) {
        const struct calx_report_quantity *quantity = &job->study.quantities[q];
        double scale = a->scales[q].scale;
        r->errors[q] = job->plan.reference == CALX_REPORT_STATISTICS
                           ? means_error(job, t, a, q, r->point)
                           : paths_error(job, t, quantity, r->point, scale);
        if (r->status != CALX_REPORT_GOOD)
            r->errors[q] = (struct calx_report_error){NAN, NAN};
    }
}

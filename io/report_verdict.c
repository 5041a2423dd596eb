/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Which integrator and step to use.
 * Input: results. Output: per quantity the cheapest point whose error, and that of every finer step of its
 * integrator, is within the target: a step that is right by luck is not taken. Times are counted
 * work times a measured cost; costs that differ by less than a tenth, or by their scatter, count as equal, and
 * among equals the case's own integrator is taken, then fewer evaluations, then the alphabet: what
 * the clock cannot tell apart does not change the verdict.
 */
#include <math.h>
#include <string.h>

#include "io/report_parts.h"

static const double EQUAL = 0.1;

/* With statistics the end of the confidence interval. */
double calx_report_upper(const struct calx_report_plan *plan, const struct calx_report_error *e)
{
    return plan->reference == CALX_REPORT_STATISTICS ? e->error + e->confidence : e->error;
}

static bool same_ladder(const struct calx_report_point *a, const struct calx_report_point *b)
{
    bool heat = a->heat_dt > 0 && b->heat_dt > 0 && a->dt == b->dt, tolerance = a->tolerance > 0 && b->tolerance > 0;
    return a->candidate == b->candidate && a->stiffness == b->stiffness && (heat || a->heat_dt == b->heat_dt) &&
           (tolerance || a->tolerance == b->tolerance);
}

bool calx_report_is_plain(const struct calx_report_point *p)
{
    return p->stiffness == 1 && p->heat_dt == 0 && p->tolerance == 0;
}

/* What gets smaller along a ladder. */
static double step_of(const struct calx_report_point *p)
{
    return p->tolerance > 0 ? p->tolerance : p->heat_dt > 0 ? p->heat_dt : p->dt;
}

/* calx run would take the step. */
static bool allowed(const struct calx_report_study *s, const struct calx_report_point *p)
{
    double soft = p->stiffness < 1 ? 1 / sqrt(p->stiffness) : 1;
    return !s->candidates[p->candidate].unsafe && p->dt <= s->candidates[p->candidate].critical * soft;
}

/* The error that can be promised: no less than the reference is uncertain. */
static double promised(const struct calx_report_job *job, const struct calx_report_analysis *a,
                       const struct calx_report_result *r, size_t q)
{
    double upper = calx_report_upper(&job->plan, &r->errors[q]);
    bool good = r->status == CALX_REPORT_GOOD && allowed(&job->study, r->point) && !isnan(upper) && !a->scales[q].still;
    return good ? fmax(upper, a->scales[q].floor) : NAN;
}

static bool within(const struct calx_report_job *job, const struct calx_report_analysis *a,
                   const struct calx_report_result *r, size_t q)
{
    return promised(job, a, r, q) <= a->verdicts[q].target;
}

static bool holds(const struct calx_report_job *job, const struct calx_report_analysis *a,
                  const struct calx_report_result *r, size_t q)
{
    if (!within(job, a, r, q))
        return false;
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *other = &a->results[k];
        if (same_ladder(other->point, r->point) && step_of(other->point) < step_of(r->point) && other->runs &&
            !within(job, a, other, q))
            return false;
    }
    return true;
}

/* Negative if a is to be preferred among equals. */
static int prefer(const struct calx_report_study *s, const struct calx_report_result *a,
                  const struct calx_report_result *b)
{
    bool own_a = s->candidates[a->point->candidate].own, own_b = s->candidates[b->point->candidate].own;
    if (own_a != own_b)
        return own_a ? -1 : 1;
    if (a->evaluations != b->evaluations)
        return a->evaluations < b->evaluations ? -1 : 1;
    return a->point->candidate - b->point->candidate;
}

static double tolerance(const struct calx_report_study *s, const struct calx_report_result *a,
                        const struct calx_report_result *b)
{
    return fmax(EQUAL, fmax(s->candidates[a->point->candidate].spread, s->candidates[b->point->candidate].spread));
}

static const struct calx_report_result *cheapest(const struct calx_report_job *job,
                                                 const struct calx_report_analysis *a, size_t q, int candidate)
{
    const struct calx_report_result *best = NULL;
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        bool wanted = candidate < 0 || (r->point->candidate == candidate && r->point->stiffness == 1 && r->point->tolerance == 0);
        if (wanted && holds(job, a, r, q) && (!best || r->seconds < best->seconds))
            best = r;
    }
    return best;
}

/* Among those that cost as much as the cheapest, for all that the clock can tell. */
static const struct calx_report_result *choose(const struct calx_report_job *job,
                                               const struct calx_report_analysis *a, size_t q, size_t *equals)
{
    const struct calx_report_result *first = cheapest(job, a, q, -1), *best = first;
    *equals = 0;
    for (size_t k = 0; first && k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        if (r == first || !holds(job, a, r, q) ||
            r->seconds > (1 + tolerance(&job->study, first, r)) * first->seconds)
            continue;
        *equals += 1;
        if (prefer(&job->study, r, best) < 0)
            best = r;
    }
    return best;
}

/* Where the target is out of reach the verdict is on the least error that can be promised, doubled at most twice:
 * the confidence of neighbouring points differs by chance. The standard deviation of four seeds is itself known to 1/sqrt(2 (4 - 1)) = 41 %,
 * so that with statistics intervals up to twice the narrowest are alike: the narrowest alone would be chosen by luck, at any price. */
static void relax(const struct calx_report_job *job, struct calx_report_analysis *a, size_t q)
{
    struct calx_report_verdict *v = &a->verdicts[q];
    double first = job->plan.reference == CALX_REPORT_STATISTICS ? 2 : 1;
    for (double factor = first; !v->best && factor <= 4 && isfinite(v->reached); factor *= 2) {
        v->target = fmax(job->study.options->target, factor * v->reached);
        v->best = choose(job, a, q, &v->equals);
    }
    double sure = v->best ? promised(job, a, v->best, q) : v->target;
    for (size_t k = 0; v->best && k < a->count; k++)
        if (same_ladder(a->results[k].point, v->best->point) && step_of(a->results[k].point) < step_of(v->best->point) &&
            a->results[k].runs)
            sure = fmax(sure, promised(job, a, &a->results[k], q));
    v->target = fmax(job->study.options->target, sure);
}

const struct calx_report_result *calx_report_nearest(const struct calx_report_analysis *a, int candidate,
                                                     double dt)
{
    const struct calx_report_result *best = NULL;
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        if (r->point->candidate == candidate && calx_report_is_plain(r->point) && r->runs &&
            (!best || fabs(log(r->point->dt / dt)) < fabs(log(best->point->dt / dt))))
            best = r;
    }
    return best;
}

void calx_report_judge(const struct calx_report_job *job, struct calx_report_analysis *a)
{
    const struct calx_report_study *s = &job->study;
    for (size_t q = 0; q < s->quantity_count; q++) {
        struct calx_report_verdict *v = &a->verdicts[q];
        *v = (struct calx_report_verdict){.own_factor = NAN, .reached = INFINITY, .whole = NAN};
        for (size_t k = 0; k < a->count; k++)
            v->reached = fmin(v->reached, promised(job, a, &a->results[k], q));
        v->target = s->options->target;
        v->best = choose(job, a, q, &v->equals);
        if (!v->best)
            relax(job, a, q);
        v->own = s->own >= 0 ? cheapest(job, a, q, s->own) : NULL;
        if (v->own && v->own->point->heat_dt == 0)
            v->own_factor = v->own->point->dt / s->own_dt;
        if (v->best && isfinite(s->duration))
            v->whole = v->best->seconds * s->duration / job->plan.window;
    }
}

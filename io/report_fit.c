/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Fits a report into its budget: ladder of steps, replicas of each point, window.
 * Input: cost of an evaluation, limits of the integrators. Output: the list of runs. Method: levels
 * from rich to poor; the first whose estimated time is within what is left is taken; if not even the
 * poorest is, the window is halved. All steps are powers of the ratio times the case's critical step, from 1.4
 * times an integrator's own limit (one point beyond the edge) down.
 * Replicas of a point differ by a few per cent in their step, so that onset and end of contacts fall
 * everywhere within a step: at a single step errors of both may cancel by chance. With statistics
 * replicas are seeds.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

static const double SHARE = 0.85;   /* of what is left of the budget: estimates are not exact */
static const double BEYOND = 1.45;  /* the coarsest step, in limits */
static const double JITTER = 0.12;  /* width of the band of steps of one point */
static const double GOLDEN = 0.618033988749894848;

struct level {
    int replicas;
    double ratio, finest; /* of neighbouring steps; the finest, in critical steps */
    size_t most;          /* integrators */
    bool own;             /* down to the case's own step, however fine */
};
enum { ALL = 1000 };
static const struct level converging[] = {
    {8, M_SQRT2, 1. / 512, ALL, true}, {8, 2, 1. / 512, ALL, true}, {5, 2, 1. / 256, ALL, true}, {5, 2, 1. / 128, ALL, true},
    {4, 2, 1. / 64, ALL, true},        {3, 2, 1. / 64, ALL, true},  {5, 2, 1. / 128, ALL, false}, {3, 2, 1. / 64, ALL, false},
    {2, 2, 1. / 32, ALL, false},       {1, 2, 1. / 32, ALL, false}, {1, 2, 1. / 16, ALL, false},  {1, 2, 1. / 16, 4, false}};
static const struct level averaging[] = {
    {12, 2, 1. / 16, ALL, true}, {8, 2, 1. / 16, ALL, true}, {6, 2, 1. / 16, ALL, true}, {5, 2, 1. / 8, ALL, true},
    {4, 2, 1. / 8, ALL, true},   {4, 2, 1. / 8, 6, true},    {4, 2, 1. / 8, 4, true},    {4, 2, 1. / 8, 2, true},
    {3, 2, 1. / 8, 2, true},     {3, 2, 1. / 8, 1, true},    {3, 4, 1. / 8, 1, true},    {3, 2, 1. / 8, 1, false}};
enum { HALVINGS = 12, MOST_POINTS = 4096 };

/* ---- building the list ---- */

static bool append(void *array_pointer, size_t *count, const void *entry, size_t size)
{
    void **array = array_pointer;
    if ((*count & (*count - 1)) == 0) {
        char *grown = realloc(*array, (*count ? 2 * *count : 1) * size);
        if (!grown)
            return false;
        *array = grown;
    }
    memcpy((char *)*array + size * (*count)++, entry, size);
    return true;
}

/* A whole number of steps fits into the grain; NaN if even one does not. */
static double rounded(const struct calx_report_plan *plan, double dt)
{
    if (!(plan->grain > 0))
        return dt;
    double steps = rint(plan->grain / dt);
    return steps >= 1 ? plan->grain / steps : NAN;
}

static bool has_recipe(const struct calx_report_plan *plan, size_t first, double dt)
{
    for (size_t k = first; k < plan->recipe_count; k++)
        if (plan->recipes[k].dt == dt)
            return true;
    return false;
}

static struct calx_report_recipe recipe_of(const struct calx_report_job *job, int candidate, double dt)
{
    return (struct calx_report_recipe){.candidate = candidate, .dt = dt, .stiffness = 1, .damping = 1, .forced = true,
                                       .window = job->plan.window, .samples = job->plan.samples};
}

/* A draw that the case does not make is a start that differs a little. */
struct calx_report_recipe calx_report_replica(const struct calx_report_job *job, const struct calx_report_point *point, int k)
{
    const struct calx_report_plan *plan = &job->plan;
    struct calx_report_recipe r = recipe_of(job, point->candidate, point->dt);
    r.heat_dt = point->heat_dt;
    r.tolerance = point->tolerance;
    r.stiffness = point->stiffness;
    r.draw = plan->reference == CALX_REPORT_STATISTICS ? k : 0;
    r.perturb = r.draw && !job->study.random ? 1e-3 : 0;
    if (plan->reference != CALX_REPORT_STATISTICS)
        r.dt = rounded(plan, point->dt * (1 + (k ? JITTER * (fmod(k * GOLDEN, 1) - 0.5) : 0)));
    return r;
}

static bool add_point(struct calx_report_job *job, struct calx_report_point point)
{
    struct calx_report_plan *plan = &job->plan;
    point.dt = rounded(plan, point.dt);
    point.first = plan->recipe_count;
    if (isnan(point.dt))
        return true;
    for (size_t k = 0; k < plan->point_count; k++)
        if (plan->points[k].candidate == point.candidate && plan->points[k].dt == point.dt &&
            plan->points[k].heat_dt == point.heat_dt && plan->points[k].tolerance == point.tolerance &&
            plan->points[k].stiffness == point.stiffness)
            return true;
    for (int k = 0; k < plan->replicas; k++) {
        struct calx_report_recipe r = calx_report_replica(job, &point, k);
        bool twin = plan->reference != CALX_REPORT_STATISTICS && has_recipe(plan, point.first, r.dt);
        if (!isnan(r.dt) && !twin && !append(&plan->recipes, &plan->recipe_count, &r, sizeof r))
            return false;
    }
    point.count = plan->recipe_count - point.first;
    return plan->point_count < MOST_POINTS && append(&plan->points, &plan->point_count, &point, sizeof point);
}

/* ---- the ladder ---- */

/* The step that the ladder hangs from, and its ends for one integrator. */
struct ladder {
    double from, low, high, ratio;
};

static double critical_of(const struct calx_report_study *s, size_t c)
{
    double own = s->own >= 0 ? s->candidates[s->own].critical : INFINITY;
    return isfinite(s->candidates[c].critical) ? s->candidates[c].critical : own;
}

static struct ladder ladder_of(const struct calx_report_study *s, size_t c, const struct level *level)
{
    double critical = critical_of(s, c), own = critical_of(s, s->own < 0 ? c : (size_t)s->own);
    struct ladder l = {.ratio = level->ratio, .from = s->own_dt};
    l.high = isfinite(critical) ? BEYOND * critical : 64 * s->own_dt;
    l.low = isfinite(own) ? level->finest * own : s->own_dt * fmax(1. / 16, level->finest * 4);
    if (s->own_dt < l.high && level->own)
        l.low = fmin(l.low, s->own_dt);
    if (!isnan(s->low)) {
        l.from = l.low = s->low;
        l.high = s->high;
    }
    return l;
}

static bool add_ladder(struct calx_report_job *job, size_t c, const struct level *level, double stiffness)
{
    struct ladder l = ladder_of(&job->study, c, level);
    double soft = stiffness < 1 ? 1 / sqrt(stiffness) : 1, end = 1e-9;
    int first = (int)ceil(log(l.low / l.from) / log(l.ratio) - end),
        last = (int)floor(log(l.high * soft / l.from) / log(l.ratio) + end);
    for (int k = last; k >= first; k--)
        if (!add_point(job, (struct calx_report_point){.candidate = (int)c, .dt = l.from * pow(l.ratio, k),
                                                       .stiffness = stiffness}))
            return false;
    return true;
}

/* Heat steps beside the case's own step of motion. */
static bool add_heat_ladder(struct calx_report_job *job, const struct level *level)
{
    const struct calx_report_study *s = &job->study;
    for (double dt = s->heat_high; dt >= s->heat_low * (1 - 1e-9); dt /= level->ratio)
        if (!add_point(job, (struct calx_report_point){.candidate = s->own < 0 ? 0 : s->own, .dt = s->own_dt,
                                                       .heat_dt = dt, .stiffness = 1}))
            return false;
    return true;
}

/* Tolerances of the solvers, a decade apart, at the case's own step. */
static bool add_tolerances(struct calx_report_job *job, size_t c)
{
    const double DECADE = 10;
    const struct calx_report_study *s = &job->study;
    for (double tolerance = s->loose; tolerance >= s->tight * (1 - 1e-9); tolerance /= DECADE)
        if (!add_point(job, (struct calx_report_point){.candidate = (int)c, .dt = s->own_dt, .tolerance = tolerance,
                                                       .stiffness = 1}))
            return false;
    return true;
}

/* ---- the reference ---- */

static double finest_step(const struct calx_report_job *job)
{
    double finest = INFINITY;
    for (size_t k = 0; k < job->plan.point_count; k++)
        finest = fmin(finest, job->plan.points[k].dt);
    return finest;
}

static bool add_references(struct calx_report_job *job)
{
    struct calx_report_plan *plan = &job->plan;
    const struct calx_report_study *s = &job->study;
    double finest = finest_step(job);
    int candidate = s->own < 0 ? 0 : s->own, count = plan->reference == CALX_REPORT_STATISTICS ? plan->replicas : 3;
    for (int k = 0; k < count && plan->reference != CALX_REPORT_EXACT; k++) {
        struct calx_report_point point = {.candidate = candidate, .stiffness = 1,
                                          .tolerance = isnan(job->study.tight) ? 0 : job->study.tight};
        bool seeds = plan->reference == CALX_REPORT_STATISTICS;
        point.dt = rounded(plan, seeds ? 0.5 * finest : finest / (1 << k));
        struct calx_report_recipe r = calx_report_replica(job, &point, seeds ? k : 0);
        if (!append(&plan->references, &plan->reference_count, &r, sizeof r))
            return false;
    }
    return true;
}

/* ---- the samples ---- */

/* At common instants only if errors are against a run: an exact solution is known at any time. */
static void choose_samples(struct calx_report_job *job, double window)
{
    struct calx_report_plan *plan = &job->plan;
    const struct calx_report_study *s = &job->study;
    double coarse = isfinite(critical_of(s, 0)) ? 0.5 * critical_of(s, 0) : 8 * s->own_dt;
    if (!isnan(s->high))
        coarse = s->high;
    bool exact = plan->reference == CALX_REPORT_EXACT, seeds = plan->reference == CALX_REPORT_STATISTICS;
    double samples = window / (coarse * (exact || seeds ? 1 : 8));
    plan->window = window;
    plan->samples = samples > CALX_REPORT_SAMPLES ? CALX_REPORT_SAMPLES : samples > 1 ? (int)samples : 1;
    plan->grain = exact ? 0 : window / plan->samples;
    if (!exact && s->common > 0) {
        double parts = fmax(1, rint(s->common / plan->grain));
        plan->grain = s->common / parts;
        plan->samples = (int)fmax(1, floor(window / plan->grain + 1e-9));
        plan->window = plan->grain * plan->samples;
    }
    if (seeds)
        plan->grain = 0;
}

/* ---- fitting ---- */

static void add_estimate(struct calx_report_job *job, const struct calx_report_recipe *r)
{
    job->plan.seconds += calx_report_job_seconds(job, r);
    job->plan.evaluations += r->window / r->dt * job->study.candidates[r->candidate].evaluations;
}

static void estimate(struct calx_report_job *job)
{
    job->plan.seconds = job->plan.evaluations = 0;
    for (size_t k = 0; k < job->plan.recipe_count; k++)
        add_estimate(job, &job->plan.recipes[k]);
    for (size_t k = 0; k < job->plan.reference_count; k++)
        add_estimate(job, &job->plan.references[k]);
    if (job->plan.reference == CALX_REPORT_STATISTICS)
        job->plan.seconds += job->plan.replicas * job->study.drawing;
}

static void clear_lists(struct calx_report_plan *plan)
{
    free(plan->points);
    free(plan->recipes);
    free(plan->references);
    plan->points = NULL;
    plan->recipes = plan->references = NULL;
    plan->point_count = plan->recipe_count = plan->reference_count = 0;
}

static int build(struct calx_report_job *job, const struct level *level, double window, struct calx_error *error)
{
    struct calx_report_plan *plan = &job->plan;
    const struct calx_report_study *s = &job->study;
    bool whole = true;
    clear_lists(plan);
    choose_samples(job, window);
    plan->ratio = level->ratio;
    plan->replicas = s->options->seeds > 0 && plan->reference == CALX_REPORT_STATISTICS ? s->options->seeds
                                                                                       : level->replicas;
    size_t most = s->options->integrators ? s->candidate_count : level->most;
    for (size_t c = 0, taken = 0; whole && c < s->candidate_count && taken < most; c++) {
        if (s->candidates[c].refused[0])
            continue;
        whole = add_ladder(job, c, level, 1);
        if (whole && !isnan(s->tight) && calx_report_variant_has_tolerance(s, (int)c))
            whole = add_tolerances(job, c);
        taken++;
    }
    for (size_t k = 0; whole && s->own >= 0 && k < s->soften_count; k++)
        whole = add_ladder(job, (size_t)s->own, level, s->soften[k]);
    if (whole && !isnan(s->heat_low))
        whole = add_heat_ladder(job, level);
    if (!whole || !add_references(job))
        return calx_error_set(error, CALX_ERROR_MEMORY, "too many points, or out of memory");
    estimate(job);
    return CALX_OK;
}

static double last_from(const struct calx_report_study *s)
{
    double from = 0;
    for (size_t q = 0; q < s->quantity_count; q++)
        from = s->quantities[q].exact ? fmax(from, s->quantities[q].exact->from) : from;
    return from;
}

/* The first level that fits; then shorter windows, as long as every quantity is seen. */
static int search(struct calx_report_job *job, double budget, double chosen[8], struct calx_error *error)
{
    struct calx_report_plan *plan = &job->plan;
    bool seeds = plan->reference == CALX_REPORT_STATISTICS;
    const struct level *levels = seeds ? averaging : converging;
    size_t count = seeds ? sizeof averaging / sizeof *averaging : sizeof converging / sizeof *converging;
    double window = plan->window;
    for (int halving = 0;; halving++) {
        bool last = halving == HALVINGS || 0.5 * window <= 1.05 * last_from(&job->study);
        for (size_t k = halving ? count - 1 : 0; k < count; k++) {
            CALX_TRY(build(job, &levels[k], window, error));
            chosen[0] = (double)k;
            chosen[1] = window;
            if (plan->seconds <= budget || (last && k + 1 == count))
                return CALX_OK;
        }
        window *= 0.5;
    }
}

int calx_report_fit(struct calx_report_job *job, struct calx_error *error)
{
    const double *noted = calx_report_store_noted(&job->store, "fit");
    const struct level *levels = job->plan.reference == CALX_REPORT_STATISTICS ? averaging : converging;
    double chosen[8] = {0};
    if (noted)
        CALX_TRY(build(job, &levels[(size_t)noted[0]], noted[1], error));
    else
        CALX_TRY(search(job, SHARE * calx_report_job_left(job), chosen, error));
    if (!noted)
        CALX_TRY(calx_report_store_note(&job->store, "fit", chosen, error));
    if (!job->plan.point_count)
        return calx_error_set(error, CALX_ERROR_INPUT, "no step of the range divides the time that is compared (%g s): "
                              "ask for smaller ones with --steps", job->plan.window);
    job->progress.all = job->plan.seconds;
    job->progress.spent = 0;
    return CALX_OK;
}

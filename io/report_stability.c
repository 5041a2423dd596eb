/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx report --stability`: the step through and past the stability limit, over stiffness and damping.
 * Each integrator with each stiffness and damping makes a ladder of steps from 1/16 of its limit to
 * twice, and one run at 1/64, its own reference. At each step:
 * - bounds hold if the run came to its end without a guard, and temperatures stayed within 1 % of the range that they had at
 *   the finest step;
 * - energy holds if the ledger's worst imbalance is within (w dt)^2/4, w dt = 2 dt/limit: what velocity Verlet shows while a
 *   linear contact lasts (it conserves v^2/2 + w^2 x^2/2 (1 - (w dt)^2/4)), and a hundredth at least;
 * - the order holds if the error in paths falls from dt to dt/2 by 2^p, with p not more than 1/2 below that at small steps.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

static const double stiffnesses[] = {1, 0.1, 10}, dampings[] = {1, 0};
static const double FINEST = 1. / 64, LOWEST = 1. / 16, ENERGY = 0.01, MARGIN = 0.01, LOST = 0.5, SHARE = 0.8;
enum { VARIANTS = 6, SAMPLES = 8, HALF = 2 /* places in the ladder */ };

/* ---- one run ---- */

/* A whole number of steps between samples, so that runs are compared at the same instants. */
static double whole_steps(const struct calx_report_plan *plan, double dt)
{
    double grain = plan->window / SAMPLES;
    return grain / fmax(1, rint(grain / dt));
}

static struct calx_report_recipe recipe_of(const struct calx_report_job *job, const struct calx_report_sweep *w,
                                           double share)
{
    return (struct calx_report_recipe){.candidate = w->candidate, .dt = whole_steps(&job->plan, share * w->limit),
                                       .stiffness = w->stiffness, .damping = w->damping, .forced = true,
                                       .window = job->plan.window, .samples = SAMPLES};
}

static double distance(const struct calx_report_study *s, const struct calx_report_run *run,
                       const struct calx_report_run *finest)
{
    double sum = 0;
    size_t n = run->count * s->width;
    if (run->count != finest->count)
        return NAN;
    for (size_t k = 0; k < n; k++)
        sum += (run->values[k] - finest->values[k]) * (run->values[k] - finest->values[k]);
    return sqrt(sum / (double)n) / s->radius;
}

static bool within_bounds(const struct calx_report_run *run, const struct calx_report_run *finest, bool thermal)
{
    double range = finest->hottest - finest->coldest, margin = MARGIN * (range > 0 ? range : 1);
    return run->status == CALX_REPORT_GOOD &&
           (!thermal || (run->coldest >= finest->coldest - margin && run->hottest <= finest->hottest + margin));
}

static unsigned judge(const struct calx_report_study *s, const struct calx_report_run *run,
                      const struct calx_report_run *finest, double share)
{
    double bound = fmax(ENERGY, share * share);
    unsigned holds = CALX_REPORT_SEEN;
    if (within_bounds(run, finest, s->temperature))
        holds |= CALX_REPORT_BOUNDS;
    if (run->status == CALX_REPORT_GOOD && run->residual <= bound)
        holds |= CALX_REPORT_ENERGY;
    return holds;
}

/* ---- one ladder ---- */

static int run_ladder(struct calx_report_job *job, struct calx_report_sweep *w, struct calx_error *error)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_recipe fine = recipe_of(job, w, FINEST);
    const struct calx_report_run *finest, *run;
    CALX_TRY(calx_report_job_run(job, &fine, &finest, error));
    for (int k = 0; k < CALX_REPORT_LADDER; k++) {
        const struct calx_report_recipe recipe = recipe_of(job, w, LOWEST * pow(2, 0.5 * k));
        CALX_TRY(calx_report_job_run(job, &recipe, &run, error));
        finest = calx_report_store_find(&job->store, &fine, s->width); /* adding a run may have moved it */
        w->share[k] = recipe.dt / w->limit;
        w->error[k] = w->residual[k] = w->order[k] = NAN;
        if (finest && finest->status != CALX_REPORT_GOOD)
            memcpy(w->why, finest->why, sizeof w->why);
        if (!run || !finest || finest->status != CALX_REPORT_GOOD)
            continue;
        w->holds[k] = judge(s, run, finest, w->share[k]);
        w->residual[k] = run->residual;
        w->error[k] = run->status == CALX_REPORT_GOOD ? distance(s, run, finest) : NAN;
    }
    return CALX_OK;
}

/* The order at small steps is the median of the three finest: a contact's onset makes single ones scatter. */
static void find_orders(struct calx_report_sweep *w)
{
    double small[3] = {NAN, NAN, NAN};
    for (int k = HALF; k < CALX_REPORT_LADDER; k++) {
        w->order[k] = log(w->error[k] / w->error[k - HALF]) / log(w->share[k] / w->share[k - HALF]);
        if (k - HALF < 3)
            small[k - HALF] = w->order[k];
    }
    double usual = calx_report_median(small, 3);
    for (int k = 0; k < CALX_REPORT_LADDER; k++)
        if (k < HALF ? w->error[k] >= 0 : w->order[k] >= usual - LOST)
            w->holds[k] |= CALX_REPORT_ORDER;
}

double calx_report_holds_to(const struct calx_report_sweep *w, unsigned what)
{
    double share = 0;
    for (int k = 0; k < CALX_REPORT_LADDER && (w->holds[k] & what) == what; k++)
        share = w->share[k];
    return share;
}

/* ---- the sweep ---- */

/* Whether damping changes anything: the limit depends on it, or the work dissipated does. */
static bool has_damping(const struct calx_scene *scene)
{
    for (size_t m = 0; m < scene->models_count; m++)
        for (size_t k = 0; k < scene->models[m].count; k++)
            for (size_t v = 0; v < scene->models[m].list[k].value_count; v++) {
                const char *name = scene->models[m].list[k].values[v].name;
                static const char *const names[] = {"restitution", "damping", "damping-rate", "drag"};
                for (size_t n = 0; n < sizeof names / sizeof *names; n++)
                    if (strcmp(name, names[n]) == 0)
                        return true;
            }
    return false;
}

static bool has_contacts(const struct calx_scene *scene)
{
    for (size_t m = 0; m < scene->models_count; m++)
        for (size_t k = 0; k < scene->models[m].count; k++)
            if (scene->models[m].list[k].kind == CALX_CONTACT)
                return true;
    return false;
}

static int add_sweep(struct calx_report_job *job, int candidate, double stiffness, double damping,
                     struct calx_report_sweep *w, size_t *count, struct calx_error *error)
{
    struct calx_report_study *s = &job->study;
    const struct calx_report_recipe recipe = {.candidate = candidate, .stiffness = stiffness, .damping = damping};
    char why[256];
    w[*count] = (struct calx_report_sweep){.candidate = candidate, .stiffness = stiffness, .damping = damping};
    CALX_TRY(calx_report_limit(s, &recipe, &w[*count].limit, why, sizeof why, error));
    if (!isfinite(w[*count].limit)) /* without a limit of its own: that of the case's integrator, scaled */
        w[*count].limit = s->own >= 0 && isfinite(s->candidates[s->own].critical)
                              ? s->candidates[s->own].critical / sqrt(stiffness)
                              : s->own_dt;
    *count += !why[0];
    return CALX_OK;
}

static int list_sweeps(struct calx_report_job *job, struct calx_report_sweep *w, size_t *count,
                       struct calx_error *error)
{
    const struct calx_report_study *s = &job->study;
    size_t soft = has_contacts(s->run.scene) ? 3 : 1, damped = has_damping(s->run.scene) ? 2 : 1;
    for (size_t c = 0; c < s->candidate_count; c++)
        for (size_t k = 0; k < soft && !s->candidates[c].refused[0]; k++)
            for (size_t d = 0; d < damped; d++)
                CALX_TRY(add_sweep(job, (int)c, stiffnesses[k], dampings[d], w, count, error));
    return CALX_OK;
}

/* The window that fits: the whole case if there is time for it. */
static int choose_window(struct calx_report_job *job, const struct calx_report_sweep *w, size_t count,
                         struct calx_error *error)
{
    const double *noted = calx_report_store_noted(&job->store, "window");
    double rate = 0, shares = 1 / FINEST, setups = 0; /* s of work per s of the case */
    for (int k = 0; k < CALX_REPORT_LADDER; k++)
        shares += 1 / (LOWEST * pow(2, 0.5 * k));
    for (size_t k = 0; k < count; k++) {
        rate += shares / w[k].limit * job->study.candidates[w[k].candidate].evaluations * job->cost;
        setups += (CALX_REPORT_LADDER + 1) * job->setup;
    }
    job->plan.window = fmin(job->study.duration, fmax(0.1, SHARE - setups / job->study.options->budget) *
                                                     job->study.options->budget / rate);
    if (noted) {
        job->plan.window = noted[0];
        return CALX_OK;
    }
    job->progress.all = rate * job->plan.window + setups;
    return calx_report_store_note(&job->store, "window", (const double[8]){job->plan.window}, error);
}

static int sweep(struct calx_report_job *job, struct calx_report_sweep *w, struct calx_error *error)
{
    size_t count = 0;
    CALX_TRY(list_sweeps(job, w, &count, error));
    CALX_TRY(choose_window(job, w, count, error));
    calx_report_quantities_paths(&job->study);
    for (size_t k = 0; k < count; k++) {
        CALX_TRY(run_ladder(job, &w[k], error));
        find_orders(&w[k]);
    }
    calx_report_progress_end(&job->progress);
    return calx_report_write_stability(job, w, count, error);
}

int calx_report_stability(struct calx_report_job *job, struct calx_error *error)
{
    if (job->study.axis != CALX_MOTION)
        return calx_error_set(error, CALX_ERROR_INPUT, "--stability: nothing moves in this case");
    for (size_t k = 0; k < job->store.count; k++)
        job->before += job->store.runs[k].wall + job->store.runs[k].setup;
    CALX_TRY(calx_report_cost(job, error));
    struct calx_report_sweep *w = calloc(job->study.candidate_count * VARIANTS + 1, sizeof *w);
    int code = w ? sweep(job, w, error) : calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    free(w);
    return code;
}

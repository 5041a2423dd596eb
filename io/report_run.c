/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One run of a report, in this process.
 * Input: a recipe. Output: samples of the quantities at the first steps that reach evenly spaced
 * instants, the work counted as evaluations of forces, and the time of the step loop without the samples.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io/report_parts.h"

/* Steps between looks at the clock of the deadline: few enough for large scenes. */
enum { AT_ONCE = 256 };

/* What is watched beside the quantities. */
struct watch {
    struct calx_probe residual, coldest, hottest;
    bool mechanical, thermal;
};

static struct calx_probe plain(const char *quantity, const char *reduce)
{
    struct calx_probe p = {.particle = -1, .material = -1, .wall = -1};
    snprintf(p.quantity, sizeof p.quantity, "%s", quantity);
    snprintf(p.reduce, sizeof p.reduce, "%s", reduce);
    return p;
}

static struct watch watch_of(const struct calx_report_study *s)
{
    return (struct watch){plain("residual-relative", ""), plain("temperature", "min"), plain("temperature", "max"),
                          s->axis == CALX_MOTION, s->temperature};
}

static void look(const struct watch *w, struct calx_sim *sim, struct calx_report_run *run)
{
    if (w->mechanical) {
        double residual = calx_sim_measure(sim, &w->residual);
        run->residual = fmax(run->residual, fabs(residual));
        run->gain = fmax(run->gain, residual);
    }
    if (w->thermal) {
        run->coldest = fmin(run->coldest, calx_sim_measure(sim, &w->coldest));
        run->hottest = fmax(run->hottest, calx_sim_measure(sim, &w->hottest));
    }
}

static void take_sample(const struct calx_report_study *s, const struct watch *w, struct calx_sim *sim,
                        struct calx_report_run *run)
{
    double *values = run->values + run->count * run->width;
    run->times[run->count++] = calx_sim_time(sim);
    calx_report_quantities_sample(s, sim, values);
    look(w, sim, run);
}

/* Processor time of this process per working thread: what the clock of the wall shows when nobody else has the machine. */
static double processor_clock(const struct calx_sim *sim)
{
    struct timespec now;
    int threads = calx_sim_timing(sim).threads;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return ((double)now.tv_sec + 1e-9 * (double)now.tv_nsec) / (threads > 1 ? threads : 1);
}

/* Steps until the time reaches `instant` (within the rounding of summed steps) or the case ends. */
static int go_to(struct calx_sim *sim, double instant, double deadline, struct calx_report_run *run,
                 struct calx_error *error)
{
    double begin = calx_terminal_clock(), busy = processor_clock(sim), slack = 1e-6 * calx_sim_dt(sim),
           looked = calx_sim_peak_seconds(sim);
    while (!calx_sim_done(sim) && calx_sim_time(sim) < instant - slack) {
        double left = (instant - slack - calx_sim_time(sim)) / calx_sim_dt(sim);
        int64_t made, quiet = left > AT_ONCE ? AT_ONCE : (int64_t)left;
        if (quiet > 1)
            CALX_TRY(calx_sim_advance(sim, quiet - 1, &made, error));
        CALX_TRY(calx_sim_step(sim, error));
        if (calx_terminal_clock() > deadline)
            return calx_error_set(error, CALX_ERROR_INPUT, "out of time");
    }
    double wall = calx_terminal_clock() - begin, looks = calx_sim_peak_seconds(sim) - looked;
    run->wall += wall;
    run->seconds += fmax(0, fmin(wall, processor_clock(sim) - busy) - looks);
    return CALX_OK;
}

static int run_through(const struct calx_report_study *s, struct calx_sim *sim, double deadline,
                       struct calx_report_run *run, struct calx_error *error)
{
    const struct watch w = watch_of(s);
    const struct calx_report_recipe *r = &run->recipe;
    int64_t begin = calx_sim_evaluation_count(sim);
    int code = CALX_OK;
    for (size_t q = 0; q < s->quantity_count; q++)
        if (s->quantities[q].form == CALX_REPORT_NUMBER && calx_measure_is_peak(&s->quantities[q].probe))
            calx_sim_watch_peak(sim);
    for (int k = 1; k <= r->samples && !code && run->status == CALX_REPORT_GOOD; k++) {
        double instant = r->window * k / r->samples;
        int64_t before = calx_sim_step_count(sim);
        code = go_to(sim, instant, deadline, run, error);
        if (!code && calx_sim_step_count(sim) > before)
            take_sample(s, &w, sim, run);
    }
    run->steps = calx_sim_step_count(sim);
    run->evaluations = calx_sim_evaluation_count(sim) - begin;
    run->reached = calx_sim_time(sim);
    if (code != CALX_ERROR_PHYSICS)
        return code;
    run->status = CALX_REPORT_UNSTABLE;
    calx_report_shorten(run->why, sizeof run->why, error->text);
    return CALX_OK;
}

static int allocate(const struct calx_report_study *s, struct calx_report_run *run, struct calx_error *error)
{
    size_t samples = (size_t)run->recipe.samples;
    run->width = s->width;
    run->times = calloc(samples + 1, sizeof *run->times);
    run->values = calloc(samples * s->width + 1, sizeof *run->values);
    if (run->times && run->values)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

int calx_report_run_go(struct calx_report_study *s, const struct calx_report_recipe *recipe,
                       double deadline, struct calx_report_run *run, struct calx_error *error)
{
    *run = (struct calx_report_run){.recipe = *recipe, .coldest = INFINITY, .hottest = -INFINITY};
    CALX_TRY(allocate(s, run, error));
    double begin = calx_terminal_clock();
    const struct calx_scene *from = calx_report_study_scene(s, recipe->draw, error);
    if (!from)
        return error->code;
    struct calx_scene *scene = calx_report_variant_create(s, from, recipe);
    if (!scene)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    struct calx_error why = {0};
    struct calx_sim *sim = calx_sim_create(scene, s->run.registry, s->options->threads, &why);
    run->setup = calx_terminal_clock() - begin;
    int code = CALX_OK;
    if (sim) {
        code = run_through(s, sim, deadline, run, error);
    } else {
        run->status = why.code == CALX_ERROR_PHYSICS ? CALX_REPORT_UNSTABLE : CALX_REPORT_REFUSED;
        calx_report_shorten(run->why, sizeof run->why, why.text);
        if (why.code == CALX_ERROR_MEMORY)
            code = calx_error_set(error, why.code, "%s", why.text);
    }
    calx_sim_free(sim);
    calx_report_variant_free(scene);
    return code;
}

void calx_report_run_clear(struct calx_report_run *run)
{
    free(run->times);
    free(run->values);
    *run = (struct calx_report_run){0};
}

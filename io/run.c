/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One run of one case: steps it and writes what is due.
 * Input: an opened run. Output: NAME.pvd and its frames, NAME.csv, files of profiles, NAME.restart,
 * verdicts on the expectations. Method: an output is due at the first step whose time reaches a multiple of its
 * interval, at the end of a stage, and at the end. This needs no memory but the time before the
 * step, so that a resumed run writes what a straight one writes. A frame is written before its row,
 * the row before the restart point: whatever comes after the restart point is redone.
 */
#include "io/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "core/measure.h"
#include "io/file.h"
#include "io/restart.h"
#include "io/vtk.h"

static int out_of_memory(struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

/* ---- restart points ---- */

struct schedule {
    double frame, row;
};

static int write_restart(struct calx_run *run, struct calx_error *error)
{
    struct schedule schedule = {run->scheduled_frame, run->scheduled_row};
    struct calx_block *blocks = NULL;
    size_t count = 0;
    CALX_TRY(calx_sim_save(run->sim, &blocks, &count, error));
    struct calx_block *all = realloc(blocks, (count + 2) * sizeof *all);
    if (!all) {
        free(blocks);
        return out_of_memory(error);
    }
    all[count++] = calx_verify_save(run->verify);
    all[count++] = (struct calx_block){"schedule", &schedule, sizeof schedule};
    int code = calx_restart_write(run->restart_path, run->case_hash, all, count, error);
    free(all);
    return code;
}

static int take_restart(struct calx_run *run, const struct calx_restart *restart,
                        struct calx_error *error)
{
    struct schedule schedule;
    const struct calx_block *expectations = calx_restart_find(restart, "expectations");
    const struct calx_block *times = calx_restart_find(restart, "schedule");
    if (!expectations || !times || times->bytes != sizeof schedule || restart->count < 2)
        return calx_error_set(error, CALX_ERROR_INPUT, "%s lacks the times of the output",
                              run->restart_path);
    memcpy(&schedule, times->data, sizeof schedule);
    run->scheduled_frame = schedule.frame;
    run->scheduled_row = schedule.row;
    CALX_TRY(calx_verify_restore(run->verify, expectations, error));
    return calx_sim_restore(run->sim, restart->blocks, restart->count - 2, error);
}

/* Takes up the restart point. Without one (stopped before the first frame) the run begins anew:
 * *resumed stays false. */
static int resume(struct calx_run *run, bool *resumed, struct calx_error *error)
{
    char backup[4096];
    struct calx_restart restart = {0};
    snprintf(backup, sizeof backup, "%s.bak", run->restart_path);
    if (access(run->restart_path, F_OK) != 0 && access(backup, F_OK) != 0) {
        calx_terminal_say(&run->terminal, "no restart point %s: starting from the beginning",
                          run->restart_path);
        return CALX_OK;
    }
    CALX_TRY(calx_restart_read(run->restart_path, run->case_hash, &restart, error));
    int code = take_restart(run, &restart, error);
    calx_restart_clear(&restart);
    *resumed = code == CALX_OK;
    return code;
}

/* ---- records ---- */

/* What an earlier run left must not be taken for this one's, should this one be killed before its
 * first frame. */
static void remove_leftovers(const struct calx_run *run)
{
    char path[4096];
    unlink(run->restart_path);
    snprintf(path, sizeof path, "%s.bak", run->restart_path);
    unlink(path);
    snprintf(path, sizeof path, "%s/%s_failed.vtu", run->folder, run->name);
    unlink(path);
}

static int open_output(struct calx_run *run, bool resumed, struct calx_error *error)
{
    char *path = NULL;
    struct calx_table_column *columns = calloc(run->column_count, sizeof *columns);
    const struct calx_output *output = &run->scene->output;
    if (!resumed)
        remove_leftovers(run);
    run->series =
        resumed ? calx_series_resume(run->folder, run->name, output, run->scheduled_frame, error)
                : calx_series_create(run->folder, run->name, output, error);
    int length = columns ? asprintf(&path, "%s/%s.csv", run->folder, run->name) : -1;
    for (size_t i = 0; columns && i < run->column_count; ++i)
        columns[i] = (struct calx_table_column){run->columns[i]->name,
                                                calx_measure_find(run->columns[i]->quantity)->unit};
    if (length < 0)
        calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    else if (run->series)
        run->table =
            resumed ? calx_table_resume(path, columns, run->column_count, run->scheduled_row, error)
                    : calx_table_create(path, columns, run->column_count, error);
    if (run->table)
        run->profiles = calx_profiles_open(run->folder, run->name, run->sim, resumed, error);
    if (run->profiles)
        run->slabs = calx_slab_files_open(run->folder, run->name, run->sim,
                                          resumed ? run->scheduled_frame : -INFINITY, error);
    if (length >= 0)
        free(path);
    free(columns);
    return run->slabs ? CALX_OK : error->code;
}

static int write_frame(struct calx_run *run, struct calx_error *error)
{
    const struct calx_frame *frame = calx_measure_frame(run->sim);
    if (!frame)
        return out_of_memory(error);
    CALX_TRY(calx_series_write(run->series, frame, error));
    CALX_TRY(calx_slab_files_write(run->slabs, error));
    calx_measure_mark_written(run->sim);
    run->frames += 1;
    return CALX_OK;
}

static int write_row(struct calx_run *run, struct calx_error *error)
{
    for (size_t i = 0; i < run->column_count; ++i)
        run->row[i] = calx_sim_measure(run->sim, run->columns[i]);
    run->rows += 1;
    return calx_table_write(run->table, run->row, error);
}

enum due { FRAME = 1, ROW = 2, JUDGE = 4, SCHEDULED = 8 };

/* Whether a multiple of `every` lies in the step; the slack forgives the rounding of summed steps.
 */
static bool multiple_in(double every, double before, double now)
{
    double slack = 0.5e-6 * (now - before);
    return every > 0 && floor((now + slack) / every) > floor((before + slack) / every);
}

/* What a step, or many, from `before` to `now` makes due. */
static unsigned what_is_due(const struct calx_run *run, double before, double now, int stage)
{
    double rows = run->scene->output.csv_every;
    bool frame = calx_sim_stage_began(run->sim) || calx_sim_done(run->sim) ||
                 multiple_in(run->scene->stages[stage].output_every, before, now);
    bool row = frame || multiple_in(rows, before, now);
    bool judge = row || calx_verify_is_due(run->verify, before, now);
    return (frame ? FRAME : 0) | (row ? ROW : 0) | (judge ? JUDGE : 0) | SCHEDULED;
}

/* What a power cut may cost; not a kill, which costs nothing that was written. */
static const double SYNC_EVERY = 10.0; /* s, wall clock */

static void sync_now_and_then(struct calx_run *run)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    double seconds = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
    if (run->last_sync > 0 && seconds - run->last_sync < SYNC_EVERY)
        return;
    if (run->last_sync > 0)
        calx_file_sync(run->folder);
    run->last_sync = seconds;
}

static int record(struct calx_run *run, unsigned due, double before, int stage,
                  struct calx_error *error)
{
    double now = calx_sim_time(run->sim);
    if ((due & FRAME) && run->series)
        CALX_TRY(write_frame(run, error));
    if ((due & ROW) && run->table)
        CALX_TRY(write_row(run, error));
    if (due & JUDGE)
        calx_verify_record(run->verify, run->sim, before, stage);
    if ((due & SCHEDULED) && (due & FRAME))
        run->scheduled_frame = now;
    if ((due & SCHEDULED) && (due & ROW))
        run->scheduled_row = now;
    if (!(due & FRAME) || !run->series)
        return CALX_OK;
    CALX_TRY(write_restart(run, error));
    sync_now_and_then(run);
    return CALX_OK;
}

/* ---- the run ---- */

/* Keeps the broken state to look at, and says what is left of the run. */
static int fail(struct calx_run *run, struct calx_error *error)
{
    if (error->code != CALX_ERROR_PHYSICS || !run->series)
        return error->code;
    char path[4096];
    struct calx_error second;
    struct calx_frame *frame = calx_frame_create(run->sim, false);
    snprintf(path, sizeof path, "%s/%s_failed.vtu", run->folder, run->name);
    bool kept = frame && calx_vtk_write(path, CALX_VTK_PARTICLES, frame, &run->scene->output,
                                        &second) == CALX_OK;
    calx_frame_free(frame);
    size_t used = strlen(error->text);
    snprintf(error->text + used, sizeof error->text - used,
             "\nkept: frames and restart point up to t = %.6g s in %s%s%s", run->scheduled_frame,
             run->folder, kept ? "; the state that failed: " : "", kept ? path : "");
    return CALX_ERROR_PHYSICS;
}

static void announce_stage(struct calx_run *run)
{
    int stage = calx_sim_stage(run->sim);
    if (calx_sim_stage_began(run->sim) && !calx_sim_done(run->sim) &&
        (size_t)stage < run->scene->stage_count)
        calx_terminal_say(&run->terminal, "stage %d%s%s begins at t = %.6g s", stage + 1,
                          run->scene->stages[stage].name[0] ? " " : "",
                          run->scene->stages[stage].name, calx_sim_time(run->sim));
}

static bool asked_to_stop(const struct calx_run *run)
{
    return run->options.stop && *run->options.stop;
}

/* Steps after which nothing is due are made without a look at the state in between, which is
 * faster. Few at a time, so that the terminal and Ctrl-C do not wait. */
static int pass_quiet_steps(struct calx_run *run, struct calx_error *error)
{
    enum { MOST = 64 };
    int64_t quiet = MOST, made;
    double now = calx_sim_time(run->sim), dt = calx_sim_dt(run->sim);
    int stage = calx_sim_stage(run->sim);
    if (calx_sim_stage_began(run->sim))
        return CALX_OK;
    while (quiet > 0 && what_is_due(run, now, now + ((double)quiet + 1.5) * dt, stage) != SCHEDULED)
        quiet /= 2;
    return calx_sim_advance(run->sim, quiet, &made, error);
}

static int step_to_the_end(struct calx_run *run, struct calx_error *error)
{
    while (!calx_sim_done(run->sim) && !run->interrupted) {
        if (pass_quiet_steps(run, error) != CALX_OK)
            return fail(run, error);
        double before = calx_sim_time(run->sim);
        int stage = calx_sim_stage(run->sim);
        if (calx_sim_step(run->sim, error) != CALX_OK)
            return fail(run, error);
        unsigned due = what_is_due(run, before, calx_sim_time(run->sim), stage);
        if (run->profiles)
            CALX_TRY(calx_profiles_write(run->profiles, error));
        if ((due & FRAME) && calx_sim_guard(run->sim, error) != CALX_OK) /* what is kept is sound */
            return fail(run, error);
        run->interrupted = asked_to_stop(run) && !calx_sim_done(run->sim);
        if (run->interrupted && !(due & FRAME)) { /* not on schedule: dropped again when resumed */
            if (due & (ROW | JUDGE))
                CALX_TRY(record(run, due, before, stage, error));
            due = FRAME | ROW;
        }
        if (due != SCHEDULED)
            CALX_TRY(record(run, due, before, stage, error));
        announce_stage(run);
        calx_terminal_update(&run->terminal, run->sim);
    }
    return CALX_OK;
}

static void announce_run(struct calx_run *run, bool resumed)
{
    const char *title = run->scene->title;
    if (resumed)
        calx_terminal_say(&run->terminal, "resumed at t = %.6g s, step %lld",
                          calx_sim_time(run->sim), (long long)run->first_step);
    else
        calx_terminal_say(&run->terminal, "%s: %zu particles, step %.3g s",
                          title && *title ? title : run->name, calx_sim_particle_count(run->sim),
                          calx_sim_dt(run->sim));
}

int calx_run_go(struct calx_run *run, struct calx_error *error)
{
    bool resumed = false;
    run->began = calx_terminal_clock();
    calx_terminal_begin(&run->terminal, run->options.progress, run->sim);
    if (run->options.resume)
        CALX_TRY(resume(run, &resumed, error));
    if (run->options.files)
        CALX_TRY(open_output(run, resumed, error));
    calx_terminal_begin(&run->terminal, run->options.progress, run->sim);
    run->first_step = calx_sim_step_count(run->sim);
    announce_run(run, resumed);
    if (!resumed)
        CALX_TRY(record(run, FRAME | ROW | JUDGE | SCHEDULED, calx_sim_time(run->sim),
                        calx_sim_stage(run->sim), error));
    int code = step_to_the_end(run, error);
    if (run->series)
        calx_file_sync(run->folder);
    calx_terminal_end(&run->terminal, run->sim);
    return code;
}

/* Whether a signal that is watched has become stationary: "steady: friction since t = 8e-06 s: 0.38 +- 0.01 (95 %)". */
static void print_steady(const struct calx_run *run, size_t watch, FILE *file)
{
    const struct calx_steady *w = &run->scene->steady[watch];
    const struct calx_steady_view *v = calx_sim_steady(run->sim, watch);
    const char *unit = calx_measure_find(w->signal.quantity)->unit;
    char layer[32] = "";
    if (w->signal.profile >= 0)
        snprintf(layer, sizeof layer, ", layer %zu", v->layer + 1);
    unit = strcmp(unit, "1") ? unit : "";
    if (v->drift <= 1)
        fprintf(file, "steady: %s since t = %.6g s: %.4g +- %.2g %s%s(95 %%%s)\n", w->name, v->since, v->mean, v->error, unit,
                *unit ? " " : "", layer);
    else if (v->drift > 1)
        fprintf(file, "not steady: %s changes by %.2g +- %.2g %s%s(95 %%%s) in %.4g s, more than %.4g\n", w->name, v->change, v->doubt,
                unit, *unit ? " " : "", layer, 0.5 * (double)w->blocks * w->over, w->within);
    else
        fprintf(file, "not steady: %s has no complete window of %.4g s\n", w->name, (double)w->blocks * w->over);
}

void calx_run_print_summary(const struct calx_run *run, FILE *file)
{
    char text[3][32];
    double wall = calx_terminal_clock() - run->began;
    double steps = (double)(calx_sim_step_count(run->sim) - run->first_step);
    double particle_steps = steps * (double)calx_sim_particle_count(run->sim);
    struct calx_features features = calx_sim_features(run->sim);
    struct calx_ledger l = calx_sim_ledger(run->sim);
    fprintf(file, "%s: t = %.9g s, %.0f steps in %s, %s particle-steps/s\n", run->name,
            calx_sim_time(run->sim), steps, calx_terminal_duration(wall, text[0], sizeof text[0]),
            calx_terminal_number(wall > 0 ? particle_steps / wall : 0, text[1], sizeof text[1]));
    if (features.ledger)
        fprintf(file, "energy balance: residual %.3e J, %.2e of the largest energy\n", l.residual,
                l.scale > 0 ? l.residual / l.scale : 0);
    if (features.temperature)
        fprintf(file, "heat balance: residual %.3e J, %.2e of the largest heat\n", l.heat_residual,
                l.heat_scale > 0 ? l.heat_residual / l.heat_scale : 0);
    for (size_t k = 0; k < run->scene->steady_count; ++k)
        print_steady(run, k, file);
    fprintf(file, "warnings: %zu\nstate hash: %016llx\n", run->problems.warning_count,
            (unsigned long long)calx_sim_hash(run->sim));
    if (run->series)
        fprintf(file, "files in %s: %zu frames, %s.csv (%zu rows), %s.restart\n", run->folder,
                run->frames, run->name, run->rows, run->name);
}

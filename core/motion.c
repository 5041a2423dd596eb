/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One step of a staged integrator of motion: for each stage the kernels before, gravity and walls
 * at the moment of its positions, all forces, the kernels after. The last stage is at the end of
 * the step, keeps contact history and books work; those before it are trials from the history at
 * the start of the step. Also the stages that an integrator goes through once, to find what it
 * needs of the motion before its first step.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/state.h"

/* Nobody came farther than speed*dt in this stage. */
static void take_speed(struct calx_sim *s, double speed2, bool first)
{
    double speed = sqrt(speed2);
    s->speed = first ? speed : fmax(s->speed, speed);
    s->drift += speed * s->dt;
    s->moved += speed * s->dt;
}

/* The kernels before this step's evaluation have run at the end of the last. */
static double gone_ahead(const struct calx_sim *s)
{
    double largest = 0.0;
    for (size_t b = 0; b < s->block_count; b++)
        largest = fmax(largest, s->tallies[b].speed2);
    return largest;
}

static double go_before(struct calx_sim *s, size_t stage)
{
    double largest = 0.0;
    if (s->team <= 1) {
        for (size_t b = 0; b < s->block_count; b++)
            largest = fmax(largest, s->engine->block_before(s, b, stage));
        return largest;
    }
#pragma omp parallel for schedule(static) num_threads(s->team) reduction(max : largest)
    for (size_t b = 0; b < s->block_count; b++) {
        double speed2 = s->engine->block_before(s, b, stage);
        largest = speed2 > largest ? speed2 : largest;
    }
    return largest;
}

/* What the kernels after the evaluation have moved. */
static void take_moved(struct calx_sim *s)
{
    double moved2 = 0.0;
    if (s->plan->motion_law->drifts)
        return;
    for (size_t b = 0; b < s->block_count; b++)
        moved2 = fmax(moved2, s->tallies[b].moved2);
    s->drift += sqrt(moved2);
    s->moved += sqrt(moved2);
}

/* A trial at time t, `elapsed` after the history: entry `stage` of the tables; `walls`: how long
 * after the evaluation before. */
static int try_stage(struct calx_sim *s, size_t stage, double t, double elapsed, double walls,
                     bool first, struct calx_error *e)
{
    s->trial = true;
    s->lag = s->plan->motion_law->translation[stage].lag * s->dt;
    calx_step_set_gravity(s, t);
    take_speed(s, go_before(s, stage), first);
    calx_walls_move(s, t, walls);
    CALX_TRY(calx_step_forces(s, &(struct calx_pass){.dt = elapsed, .stage = (int)stage}, e));
    take_moved(s);
    return calx_guard_finite(s, e);
}

static int last_stage(struct calx_sim *s, size_t stage, double t, double walls, bool ahead,
                      bool first, struct calx_error *e)
{
    s->trial = false;
    s->lag = s->plan->motion_law->velocity_lag * s->dt;
    calx_step_set_gravity(s, t);
    take_speed(s, s->ahead ? gone_ahead(s) : go_before(s, stage), first);
    s->ahead = ahead;
    calx_walls_move(s, t, walls);
    struct calx_pass pass = calx_step_end_pass(s, s->dt, (int)stage, ahead);
    CALX_TRY(calx_step_forces(s, &pass, e));
    take_moved(s);
    return 0;
}

static int stages(struct calx_sim *s, double t, bool ahead, struct calx_error *e)
{
    const struct calx_motion_integrator *law = s->plan->motion_law;
    double dt = s->dt, before = 0.0;
    size_t end = law->start + law->stages;
    for (size_t stage = law->start; stage + 1 < end; stage++) {
        double at = law->translation[stage].time;
        CALX_TRY(try_stage(s, stage, t - (1.0 - at) * dt, at * dt, (at - before) * dt,
                           stage == law->start, e));
        before = at;
    }
    return last_stage(s, end - 1, t, (1.0 - before) * dt, ahead, law->stages == 1, e);
}

static void end_evaluations(struct calx_sim *s)
{
    s->trial = false;
    s->lag = 0.0;
}

int calx_motion_step(struct calx_sim *s, double t, bool ahead, struct calx_error *e)
{
    if (!s->plan->motion_law->stages)
        return calx_motion_step_global(s, t, e);
    s->dt_now = s->rows_dt = s->dt;
    int failed = stages(s, t, ahead, e);
    end_evaluations(s);
    CALX_TRY(failed);
    calx_ledger_step(s, s->dt);
    return 0;
}

/* ---- the start ---- */

static int start_stages(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_motion_integrator *law = s->plan->motion_law;
    double dt = s->dt, before = 0.0;
    for (size_t stage = 0; stage < law->start; stage++) {
        double at = law->translation[stage].time;
        CALX_TRY(
            try_stage(s, stage, s->time + at * dt, at * dt, (at - before) * dt, stage == 0, e));
        before = at;
    }
    return 0;
}

/* Walls and gravity go back to where they were, and forces are evaluated anew there. */
int calx_motion_start(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_motion_integrator *law = s->plan->motion_law;
    size_t walls = s->scene->wall_count;
    if (!law || !law->start)
        return 0;
    double *angle = calx_memory_zeroed(walls, sizeof *angle);
    double(*shift)[3] = calx_memory_zeroed(walls, sizeof *shift);
    long double outside = s->outside_work;
    int failed = !angle || !shift;
    if (failed)
        calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory to start the integrator");
    s->rows_dt = s->dt;
    if (!failed) {
        memcpy(angle, s->wall_angle, walls * sizeof *angle);
        memcpy(shift, s->wall_shift, walls * sizeof *shift);
        failed = start_stages(s, e);
        end_evaluations(s);
        memcpy(s->wall_angle, angle, walls * sizeof *angle);
        memcpy(s->wall_shift, shift, walls * sizeof *shift);
        calx_walls_move(s, s->time, 0.0);
        calx_step_set_gravity(s, s->time);
        s->outside_work = outside;
    }
    free(angle);
    free(shift);
    struct calx_pass pass = {.conduct = s->plan->conductance != NULL, .stage = -1};
    return failed ? failed : calx_step_forces(s, &pass, e);
}

void calx_motion_forget(struct calx_sim *s)
{
    memset(s->memory, 0, sizeof s->memory);
    for (size_t k = 0; k < 2 * CALX_EXTRA_MAX; k++)
        if (s->r.extra[k])
            memset(s->r.extra[k], 0, 4 * s->r.rows * sizeof(double));
}

/* ---- onset and end of contacts ---- */

/* Laws that act at a distance begin and end elsewhere than at touch: they are left as they are. */
int calx_motion_resolve(struct calx_plan *p, struct calx_error *e)
{
    p->resolves = p->law_count && p->motion_law && p->motion_law->resolves_contacts &&
                  p->gap == 0.0;
    if (!p->resolves)
        return 0;
    if (p->history + 2 > CALX_HISTORY_MAX)
        return calx_error_at(e, CALX_ERROR_INPUT, p->motion_model->place,
                             "the contact laws and integrator '%s' keep more than %d "
                             "numbers per contact",
                             p->motion->name, CALX_HISTORY_MAX);
    p->owed = p->history++;
    p->past = p->history++;
    for (size_t l = 0; l < p->law_count; l++)
        p->normal = p->laws[l].law->provides & CALX_NORMAL ? l : p->normal;
    return 0;
}

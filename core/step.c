/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One time step, as the algorithm reads. A global integrator would drive these same services itself.
 */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "core/timing.h"

static void swap_wall_contacts(struct calx_sim *s)
{
    struct calx_wall_contact *contacts = s->wall_contacts;
    double *history = s->wall_history;
    s->wall_contacts = s->wall_contacts_next;
    s->wall_history = s->wall_history_next;
    s->wall_contacts_next = contacts;
    s->wall_history_next = history;
    memset(s->wall_force, 0, s->scene->wall_count * sizeof *s->wall_force);
    for (size_t b = 0; b < s->block_count; b++) {
        s->blocks[b].wall_count = s->blocks[b].wall_next;
        for (size_t w = 0; w < s->scene->wall_count; w++)
            for (int k = 0; k < 3; k++)
                s->wall_force[w][k] += s->block_wall_force[b * s->scene->wall_count + w][k];
    }
}

/* The blocks of one thread, in order. A block is finished while it is in cache, as soon as the blocks that add to it are done; those that
 * wait for another thread's blocks come after the barrier. Nobody reads a block's rows once the blocks that add to it are done:
 * they are the ones that keep copies of it. */
static void sweep_part(struct calx_sim *s, double dt, bool conduct, int stage, bool ahead, size_t me,
                       size_t team)
{
    size_t first = s->block_count * me / team, last = s->block_count * (me + 1) / team;
    for (size_t b = first; b < last; b++) {
        s->engine->block_forces(s, b, dt, conduct);
        if (s->blocks[b].earliest >= first)
            s->engine->block_finish(s, b, stage, ahead);
    }
    if (team == 1)
        return;
#pragma omp barrier
    for (size_t b = first; b < last; b++)
        if (s->blocks[b].earliest < first)
            s->engine->block_finish(s, b, stage, ahead);
}

/* A parallel region costs microseconds even for one thread: a scene of one block does without. */
static void sweep(struct calx_sim *s, double dt, bool conduct, int stage, bool ahead)
{
    if (s->team <= 1) {
        sweep_part(s, dt, conduct, stage, ahead, 0, 1);
        return;
    }
#pragma omp parallel num_threads(s->team)
    sweep_part(s, dt, conduct, stage, ahead, (size_t)omp_get_thread_num(), (size_t)omp_get_num_threads());
}

int calx_step_forces(struct calx_sim *s, double dt, bool conduct, int stage, bool ahead,
                     struct calx_error *e)
{
    if (calx_neighbours_stale(s))
        CALX_TRY(calx_neighbours_build(s, e));
    sweep(s, dt, conduct, stage, ahead);
    s->evaluations++;
    if (s->features.wall_contacts)
        swap_wall_contacts(s);
    return 0;
}

/* Gravity at time t; what a change of it does to the potential energy is work from outside. */
static void set_gravity(struct calx_sim *s, double t)
{
    static const double nowhere[3];
    double change[3];
    bool changed = false;
    for (int k = 0; k < 3; k++) {
        double g = calx_evaluate(&s->scene->stages[s->stage].gravity[k], t, nowhere);
        change[k] = g - s->gravity[k];
        s->gravity[k] = g;
        changed |= change[k] != 0.0;
    }
    for (size_t b = 0; changed && s->built && b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            const double *x = calx_row_x(s, row), inverse_mass = calx_row_v(s, row)[3];
            for (int k = 0; k < 3 && inverse_mass > 0.0; k++) {
                double turns = s->scene->periodic[k] ? s->r.image[row][k] * (s->scene->high[k] - s->scene->low[k])
                                                     : 0.0;
                s->outside_work -= change[k] * (x[k] + turns) / inverse_mass;
            }
        }
}

static void take_speed(struct calx_sim *s, double speed2)
{
    s->speed = sqrt(speed2);
    s->drift += s->speed * s->plan->dt;
}

/* The kernels before this step's evaluation have run at the end of the last. */
static void go_ahead(struct calx_sim *s)
{
    double largest = 0.0;
    for (size_t b = 0; b < s->block_count; b++)
        largest = fmax(largest, s->tallies[b].speed2);
    take_speed(s, largest);
}

static void go_before(struct calx_sim *s, size_t stage)
{
    double largest = 0.0;
    if (s->team <= 1) {
        for (size_t b = 0; b < s->block_count; b++)
            largest = fmax(largest, s->engine->block_before(s, b, stage));
    } else {
#pragma omp parallel for schedule(static) num_threads(s->team) reduction(max : largest)
        for (size_t b = 0; b < s->block_count; b++) {
            double speed2 = s->engine->block_before(s, b, stage);
            largest = speed2 > largest ? speed2 : largest;
        }
    }
    take_speed(s, largest);
}

static bool heat_due(const struct calx_sim *s)
{
    return s->plan->conductance && (s->stage_step + 1) % s->plan->heat_every == 0;
}

static int advance_motion(struct calx_sim *s, double t, bool ahead, struct calx_error *e)
{
    double dt = s->plan->dt;
    for (size_t stage = 0; stage < s->plan->motion_law->stages; stage++) {
        if (s->ahead)
            go_ahead(s);
        else
            go_before(s, stage);
        s->ahead = ahead;
        if (stage == 0)
            calx_walls_move(s, t, dt);
        CALX_TRY(calx_step_forces(s, stage == 0 ? dt : 0.0, heat_due(s), (int)stage, ahead, e));
        if (stage == 0)
            calx_ledger_step(s, dt);
    }
    return 0;
}

/* Bodies at rest for ever: contacts serve the conduction of heat alone. */
static int advance_frozen(struct calx_sim *s, double t, struct calx_error *e)
{
    calx_walls_move(s, t, s->plan->dt);
    CALX_TRY(calx_step_forces(s, 0.0, heat_due(s), -1, false, e));
    return 0;
}

static bool condition_holds(struct calx_sim *s)
{
    const struct calx_stage_spec *stage = &s->scene->stages[s->stage];
    struct calx_probe probe = {.particle = -1, .material = -1, .wall = -1};
    if (!stage->condition[0] || s->stage_step % 64)
        return false;
    memcpy(probe.quantity, stage->condition, sizeof probe.quantity);
    double v = calx_sim_measure(s, &probe);
    bool holds = stage->relation == CALX_BELOW ? v < stage->bound : v > stage->bound;
    s->held = holds ? s->held + 64.0 * s->plan->dt : 0.0;
    return holds && s->held > stage->hold;
}

static int end_stage(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_stage_spec *stage = &s->scene->stages[s->stage];
    double rounding = 1e-9 * s->plan->dt;
    s->stage_began = false;
    if (s->time - s->stage_start < stage->duration - rounding - 0.5 * s->plan->dt && !condition_holds(s))
        return 0;
    s->stage_began = true;
    if ((size_t)s->stage + 1 == s->scene->stage_count) {
        s->done = true;
        return 0;
    }
    return calx_step_begin_stage(s, s->stage + 1, e);
}

/* New laws start with contacts that have no past; the energy they find or lose is work from outside. */
static int change_models(struct calx_sim *s, const struct calx_plan *plan, struct calx_error *e)
{
    double before = calx_ledger_mechanical(s);
    s->plan = plan;
    memset(s->pairs.touching, 0, s->pairs.count);
    for (size_t b = 0; b < s->block_count; b++)
        s->blocks[b].wall_count = 0;
    free(s->pairs.history);
    s->pairs.history = calx_memory_zeroed(s->pairs.count * plan->history_stride, sizeof(double));
    s->built = false;
    if (!s->pairs.history)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for contact history");
    CALX_TRY(calx_step_forces(s, 0.0, false, -1, false, e));
    s->outside_work += calx_ledger_mechanical(s) - before;
    return 0;
}

int calx_step_begin_stage(struct calx_sim *s, int stage, struct calx_error *e)
{
    const struct calx_plan *plan = &s->plans[s->scene->stages[stage].models];
    s->stage = stage;
    s->stage_step = 0;
    s->stage_start = s->time;
    s->held = 0.0;
    calx_walls_begin_stage(s);
    set_gravity(s, s->time);
    if (plan != s->plan && s->built)
        CALX_TRY(change_models(s, plan, e));
    s->plan = plan;
    if (stage > 0)
        calx_measure_begin_stage(s, stage);
    return 0;
}

static int step(struct calx_sim *s, bool ahead, struct calx_error *e)
{
    double t = s->stage_start + (double)(s->stage_step + 1) * s->plan->dt;
    s->dt_now = s->plan->motion ? s->plan->dt : 0.0;
    set_gravity(s, t);
    CALX_TRY(s->plan->motion ? advance_motion(s, t, ahead, e) : advance_frozen(s, t, e));
    s->step++;
    s->stage_step++;
    s->time = t;
    struct calx_clock *clock = calx_timing_clock(s);
    calx_timing_restart(clock);
    CALX_TRY(calx_heat_step(s, e));
    calx_timing_lap(clock, CALX_PHASE_HEAT);
    CALX_TRY(calx_guard_step(s, e));
    calx_timing_lap(clock, CALX_PHASE_OTHER);
    return end_stage(s, e);
}

int calx_sim_step(struct calx_sim *s, struct calx_error *e)
{
    return s->done ? 0 : step(s, false, e);
}

/* Whether the step after the next `steps` may end the stage, or looks at the state by itself. */
static bool looked_at(const struct calx_sim *s, int64_t steps)
{
    const struct calx_stage_spec *stage = &s->scene->stages[s->stage];
    double end = (double)(s->stage_step + steps) * s->plan->dt;
    return end >= stage->duration - 0.75 * s->plan->dt || (s->step + steps) % CALX_SELDOM == 0 ||
           (stage->condition[0] && (s->stage_step + steps) % 64 == 0);
}

int calx_sim_advance(struct calx_sim *s, int64_t steps, int64_t *made, struct calx_error *e)
{
    bool one_stage = s->plan->motion_law && s->plan->motion_law->stages == 1;
    for (*made = 0; *made < steps && !s->done && !looked_at(s, 1); ++*made) {
        bool last = *made + 1 == steps || looked_at(s, 2);
        CALX_TRY(step(s, one_stage && !last, e));
    }
    return 0;
}

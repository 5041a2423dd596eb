/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One time step, as the algorithm reads: motion (motion.c), heat, guards, the end of stages. And what motion is made of: one force
 * evaluation over all blocks, gravity.
 */
#include <math.h>
#include <omp.h>
#include <sched.h>
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

/* Whether all blocks that add to block b have their forces. */
static bool is_ready(const struct calx_sim *s, size_t b)
{
    const struct calx_row_block *block = &s->blocks[b];
    for (size_t k = block->adder_first; k < block->adder_first + block->adder_count; k++)
        if (s->adders[k] != (int32_t)b &&
            __atomic_load_n(&s->passed[s->adders[k]], __ATOMIC_ACQUIRE) != s->pass_number)
            return false;
    return true;
}

/* Finishes those of the waiting blocks whose turn has come; returns how many still wait. */
static size_t finish_waiting(struct calx_sim *s, const struct calx_pass *pass, int32_t *waiting, size_t count)
{
    size_t left = 0;
    for (size_t k = 0; k < count; k++) {
        size_t b = (size_t)waiting[k];
        if (is_ready(s, b))
            s->engine->block_finish(s, b, pass, calx_row_a(s, s->blocks[b].first));
        else
            waiting[left++] = waiting[k];
    }
    return left;
}

/* The blocks of one thread. A block is finished while it is in cache if the blocks that add to it are done, else when they are. Nobody reads a
 * block's rows once the blocks that add to it are done: they are the ones that keep copies of it. Returns how many blocks still wait. */
static size_t sweep_part(struct calx_sim *s, const struct calx_pass *pass, size_t me)
{
    /* a global integrator of temperature reads the heat of dissipation in the rows */
    bool passing = pass->ahead && !s->plan->global_heat;
    int32_t *waiting = s->waiting + s->share[me];
    size_t count = 0;
    for (size_t k = s->share[me]; k < s->share[me + 1]; k++) {
        size_t b = (size_t)s->order[k];
        bool ready = is_ready(s, b);
        double *a = ready && passing ? s->forces[me] : calx_row_a(s, s->blocks[b].first);
        s->engine->block_forces(s, b, pass, a);
        __atomic_store_n(&s->passed[b], s->pass_number, __ATOMIC_RELEASE);
        if (ready)
            s->engine->block_finish(s, b, pass, a);
        else
            waiting[count++] = (int32_t)b;
        count = finish_waiting(s, pass, waiting, count);
    }
    return count;
}

/* A parallel region costs microseconds even for one thread: a scene of one block does without. There may be fewer threads than were asked for. */
static void sweep(struct calx_sim *s, const struct calx_pass *pass)
{
    s->pass_number++;
    if (s->team <= 1) {
        sweep_part(s, pass, 0);
        return;
    }
#pragma omp parallel num_threads(s->team)
    {
        int first = omp_get_thread_num(), there = omp_get_num_threads();
        for (int me = first; me < s->team; me += there)
            s->left[me] = sweep_part(s, pass, (size_t)me);
        for (int me = first; me < s->team; me += there)
            while ((s->left[me] = finish_waiting(s, pass, s->waiting + s->share[me], s->left[me])) > 0)
                sched_yield();
    }
}

/* Sorts out which of the pairs that are apart may touch soon; false if they find no room. */
static bool sift(struct calx_sim *s)
{
    bool room = true;
    double inner = CALX_INNER_SHARE * s->skin;
    s->sifted = s->drift;
    if (s->team <= 1) {
        for (size_t b = 0; b < s->block_count; b++)
            room &= s->engine->block_sift(s, b, inner);
        return room;
    }
#pragma omp parallel for schedule(static) num_threads(s->team) reduction(&& : room)
    for (size_t b = 0; b < s->block_count; b++)
        room = s->engine->block_sift(s, b, inner) && room;
    return room;
}

/* A list whose room for pairs that come to touch is used up is built again; the next ones then have room for all. */
int calx_step_lists(struct calx_sim *s, struct calx_error *e)
{
    bool built = calx_neighbours_stale(s);
    if (built)
        CALX_TRY(calx_neighbours_build(s, e));
    if (!s->features.search || (!built && 2.0 * (s->drift - s->sifted) <= CALX_INNER_SHARE * s->skin))
        return 0;
    for (; !sift(s); built = true) {
        s->roomy = built;
        CALX_TRY(calx_neighbours_build(s, e));
        s->roomy = false;
    }
    return 0;
}

int calx_step_forces(struct calx_sim *s, const struct calx_pass *pass, struct calx_error *e)
{
    CALX_TRY(calx_step_lists(s, e));
    s->heat_interval = pass->conduct || pass->heats ? s->heat_dt : pass->dt;
    sweep(s, pass);
    s->evaluations++;
    if (s->features.wall_contacts && !s->trial)
        swap_wall_contacts(s);
    if (!s->trial)
        calx_plates_take(s, s->evaluated);
    return 0;
}

/* What a change of gravity does to the potential energy is work from outside. */
void calx_step_set_gravity(struct calx_sim *s, double t)
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
    for (size_t w = 0; changed && s->built && w < s->scene->wall_count; w++) {
        const struct calx_motion *m = &s->scene->stages[s->stage].motion[w];
        if (m->free)
            s->outside_work -= change[m->free_axis] * m->mass * (s->plates[w].shift + s->plates[w].risen);
    }
}

struct calx_pass calx_step_end_pass(const struct calx_sim *s, double dt, int stage, bool ahead)
{
    const struct calx_plan *p = s->plan;
    bool due = (s->stage_step + 1 - s->pace_step) % s->heat_every == 0, staged = p->heat_law && !p->global_heat;
    return (struct calx_pass){.dt = dt, .conduct = p->conductance && due, .heats = p->heat_law && due, .stage = stage, .ahead = ahead,
                              .warm = staged && due, .store = p->heat_law && !due && s->scene->from_dissipation > 0.0};
}

/* Bodies at rest for ever: contacts serve the conduction of heat alone. */
static int advance_frozen(struct calx_sim *s, double t, struct calx_error *e)
{
    calx_step_set_gravity(s, t);
    calx_walls_move(s, t, s->dt);
    s->dt_now = 0.0;
    struct calx_pass pass = calx_step_end_pass(s, 0.0, -1, false);
    return calx_step_forces(s, &pass, e);
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
    s->held = holds ? s->held + (s->time - s->checked) : 0.0;
    s->checked = s->time;
    return holds && s->held > stage->hold;
}

static int end_stage(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_stage_spec *stage = &s->scene->stages[s->stage];
    double rounding = 1e-9 * s->dt;
    s->stage_began = false;
    if (s->time - s->stage_start < stage->duration - rounding - 0.5 * s->dt && !condition_holds(s))
        return 0;
    s->stage_began = true;
    if ((size_t)s->stage + 1 == s->scene->stage_count) {
        s->done = true;
        return 0;
    }
    return calx_step_begin_stage(s, s->stage + 1, e);
}

/* Whether contacts mean the same to both: the same laws keep the same of them. Parameters may differ. */
static bool same_contacts(const struct calx_plan *a, const struct calx_plan *b)
{
    bool same = a->law_count == b->law_count && a->history == b->history && a->nonsmooth == b->nonsmooth && a->resolves == b->resolves &&
                memcmp(a->history_is_vector, b->history_is_vector, sizeof a->history_is_vector) == 0;
    for (size_t l = 0; same && l < a->law_count; l++)
        same = a->laws[l].plugin == b->laws[l].plugin && a->laws[l].first_history == b->laws[l].first_history &&
               a->laws[l].demand.history_vectors == b->laws[l].demand.history_vectors;
    return same;
}

static int forget_contacts(struct calx_sim *s, struct calx_error *e)
{
    memset(s->pairs.touching, 0, s->pairs.places / 8);
    for (size_t b = 0; b < s->block_count; b++)
        s->blocks[b].wall_count = 0;
    free(s->pairs.history);
    s->pairs.history = calx_memory_zeroed(s->pairs.places * s->plan->history, sizeof(double));
    return s->pairs.history ? 0 : calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for contact history");
}

/* Contacts go on if they mean the same to the models before and after, else new laws start with contacts that have no past. The energy they find
 * or lose is work from outside. Impulses stay those of the last step. */
static int change_models(struct calx_sim *s, const struct calx_plan *plan, struct calx_error *e)
{
    double before = calx_ledger_mechanical(s);
    bool go_on = same_contacts(s->plan, plan);
    s->built = go_on && plan->gap <= s->plan->gap;
    s->plan = plan;
    s->trusted = 0.0;
    s->look_due = s->step;
    calx_motion_forget(s);
    if (!go_on)
        CALX_TRY(forget_contacts(s, e));
    CALX_TRY(go_on && plan->nonsmooth ? calx_step_lists(s, e) : calx_step_forces(s, &(struct calx_pass){.stage = -1}, e));
    CALX_TRY(calx_motion_start(s, e));
    s->outside_work += calx_ledger_mechanical(s) - before;
    return 0;
}

int calx_step_begin_stage(struct calx_sim *s, int stage, struct calx_error *e)
{
    const struct calx_plan *plan = &s->plans[s->scene->stages[stage].models], *before = s->plan;
    s->stage = stage;
    s->stage_step = 0;
    s->stage_start = s->time;
    s->held = 0.0;
    s->checked = s->time;
    calx_plates_begin_stage(s, s->built ? &s->scene->stages[stage - 1] : NULL);
    calx_walls_begin_stage(s);
    calx_step_set_gravity(s, s->time);
    if (plan != s->plan && s->built)
        CALX_TRY(change_models(s, plan, e));
    s->plan = plan;
    calx_pace_begin_stage(s, before);
    if (stage > 0)
        calx_measure_begin_stage(s, stage);
    return 0;
}

/* When the step ends that comes `steps` after the present state. */
static double end_of(const struct calx_sim *s, int64_t steps)
{
    return s->pace_time + (double)(s->stage_step + steps - s->pace_step) * s->dt;
}

static int step(struct calx_sim *s, bool ahead, struct calx_error *e)
{
    double t = end_of(s, 1);
    s->wall_step = s->moved = 0.0;
    CALX_TRY(s->plan->motion ? calx_motion_step(s, t, ahead, e) : advance_frozen(s, t, e));
    s->step++;
    s->stage_step++;
    s->time = t;
    struct calx_clock *clock = calx_timing_clock(s);
    calx_timing_restart(clock);
    CALX_TRY(calx_heat_step(s, e));
    calx_timing_lap(clock, CALX_PHASE_HEAT);
    calx_pace_watch(s);
    if (!ahead)
        CALX_TRY(calx_pace_step(s, e));
    CALX_TRY(calx_guard_step(s, e));
    if (s->peak.watched)
        calx_peak_look(s);
    CALX_TRY(calx_profile_step(s, e));
    calx_steady_step(s);
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
    return calx_pace_elapsed(s, steps) >= stage->duration - 0.75 * s->dt || (s->step + steps) % CALX_SELDOM == 0 ||
           (stage->condition[0] && (s->stage_step + steps) % 64 == 0) || calx_profile_due(s, end_of(s, steps)) ||
           calx_steady_due(s, end_of(s, steps));
}

int calx_sim_advance(struct calx_sim *s, int64_t steps, int64_t *made, struct calx_error *e)
{
    bool one_stage = s->plan->motion_law && s->plan->motion_law->stages == 1 && !s->peak.watched;
    for (*made = 0; *made < steps && !s->done && !looked_at(s, 1); ++*made) {
        bool last = *made + 1 == steps || s->pace_due >= 0 || looked_at(s, 2);
        CALX_TRY(step(s, one_stage && !last, e));
    }
    return 0;
}

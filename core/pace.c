/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The time step and the contacts there are. A fixed step above their limit is refused. An automatic one is the longest on a ladder
 * (halved by every two rungs) that is at most the plan's, resolves the stiffest single contact as the plan asks, and keeps to a share of the stability
 * limit of all contacts. It is chosen again every CALX_SELDOM steps, and in the step after overlaps have grown by half
 * since the last choice; only between heat steps. A step chosen within a stage divides what is left of it.
 * All this follows from the state and is saved with it: the bits do not depend on threads, stops, or who looks.
 */
#include <math.h>

#include "core/stability.h"

/* What a refused step is told to be: this share of the limit resolves a contact by 16 steps. */
static const double ADVISED = 0.1;
static const double SAFETY = 0.5;        /* if the case does not say */
static const double DEEPER = 1.5;
static const double RUNG = 0.7071067811865476, ROOM = 1.1; /* up only if this much room is left */
static const double MOST_STEPS = 1e9;    /* of a stage whose end a step is fitted to */

static double share_of(const struct calx_plan *p)
{
    return p->models->dt_fraction > 0.0 ? p->models->dt_fraction : 0.05;
}

bool calx_pace_resolves(const struct calx_plan *p, double steps)
{
    return p->adapts && steps * share_of(p) * p->motion_law->stability <= M_PI;
}

double calx_sim_step_share(struct calx_sim *s, int64_t *id)
{
    struct calx_stability now;
    if (id)
        *id = -1;
    if (!s->plan->motion)
        return 0.0;
    if (calx_stability_look(s, CALX_BOUND, &now, NULL))
        return NAN;
    if (id && now.limit < s->plan->critical_dt)
        *id = now.id;
    double limit = fmin(now.limit, s->plan->critical_dt);
    return isfinite(limit) ? s->dt / limit : 0.0;
}

/* ---- setting it ---- */

static void set_heat(struct calx_sim *s)
{
    const struct calx_models *m = s->plan->models;
    double ratio = m->heat_dt > 0.0 && !m->frozen ? m->heat_dt / s->dt : 1.0;
    s->heat_every = ratio > 1.5 ? (int64_t)llround(ratio) : 1;
    s->heat_dt = (double)s->heat_every * s->dt;
}

/* Steps of this length begin now. The force of walls at the present evaluation acts for half of the step before and half of the next. */
static void set_step(struct calx_sim *s, double dt)
{
    if (s->plan->motion && s->dt_now > 0.0) {
        s->wall_work += 0.5L * (long double)s->wall_power * ((long double)dt - (long double)s->dt_now);
        s->dt_now = dt;
    }
    s->dt = dt;
    s->pace_time = s->time;
    s->pace_step = s->stage_step;
    set_heat(s);
}

static double rung(const struct calx_sim *s, int64_t level)
{
    return level ? s->plan->dt * pow(RUNG, (double)level) : s->plan->dt;
}

/* The rung, or a little less, so that the stage ends with a step. */
static double fitted(const struct calx_sim *s, int64_t level)
{
    double dt = rung(s, level), left = s->scene->stages[s->stage].duration - (s->time - s->stage_start);
    double steps = ceil(left / dt * (1.0 - 1e-12));
    return level && steps >= 1.0 && steps < MOST_STEPS ? left / steps : dt;
}

void calx_pace_begin_stage(struct calx_sim *s, const struct calx_plan *before)
{
    if (s->plan != before || !(s->dt > 0.0)) {
        s->pace_level = 0;
        s->pace_due = s->plan->adapts && s->built ? s->step : -1;
        set_step(s, s->plan->dt);
        return;
    }
    if (s->pace_level && s->plan->adapts) {
        set_step(s, fitted(s, s->pace_level));
        return;
    }
    s->pace_time = s->time;
    s->pace_step = 0;
}

void calx_pace_resume(struct calx_sim *s)
{
    if (!s->plan->adapts && s->dt != s->plan->dt)
        set_step(s, s->plan->dt);
}

/* ---- choosing it ---- */

/* The longest step that the present contacts allow. */
static int longest(struct calx_sim *s, double *step, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    struct calx_stability now;
    double safety = p->models->safety > 0.0 ? p->models->safety : SAFETY;
    CALX_TRY(calx_stability_look(s, CALX_QUICK, &now, e));
    double resolved = share_of(p) * p->motion_law->stability * now.shortest / M_PI;
    *step = fmin(p->dt, resolved);
    if (safety * now.limit < *step) /* the quick bound may be too low */
        CALX_TRY(calx_stability_look(s, CALX_BOUND, &now, e));
    *step = fmin(*step, safety * now.limit);
    return 0;
}

static int64_t level_for(const struct calx_sim *s, double step)
{
    int64_t level = s->pace_level;
    while (rung(s, level) > step && level < 200)
        level++;
    while (level > 0 && rung(s, level - 1) * (level - 1 ? ROOM : 1.0) <= step)
        level--;
    return level;
}

static double deepest(const struct calx_sim *s)
{
    double depth = 0.0;
    for (size_t b = 0; b < s->block_count; b++)
        depth = fmax(depth, s->tallies[b].overlap);
    return depth;
}

static int choose(struct calx_sim *s, struct calx_error *e)
{
    double step;
    CALX_TRY(longest(s, &step, e));
    int64_t level = level_for(s, step);
    s->pace_overlap = deepest(s);
    s->pace_due = -1;
    if (level != s->pace_level) {
        s->pace_level = level;
        set_step(s, fitted(s, level));
    }
    return 0;
}

static int refuse_fixed(struct calx_sim *s, struct calx_error *e)
{
    struct calx_stability now;
    CALX_TRY(calx_stability_look(s, CALX_BOUND, &now, e));
    if (s->dt <= now.limit)
        return 0;
    CALX_TRY(calx_stability_look(s, CALX_SHARP, &now, e)); /* not refused for the slack of the bound */
    if (s->dt <= now.limit)
        return 0;
    char whose[64] = "a loaded plate";
    if (now.id >= 0)
        snprintf(whose, sizeof whose, "particle %lld with its %d contacts", (long long)now.id, now.contacts);
    return calx_error_at(e, CALX_ERROR_INPUT, s->plan->motion_model->place,
        "dt = %g s is above the stability limit %g s of the contacts at the start, set by %s: use "
        "dt=\"%.2g s\" or dt=\"auto\"; force=\"yes\" runs it all the same", s->dt, now.limit, whose, ADVISED * now.limit);
}

int calx_pace_begin(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    if (!p->motion || p->models->forced)
        return 0;
    return p->models->dt > 0.0 ? refuse_fixed(s, e) : choose(s, e);
}

void calx_pace_watch(struct calx_sim *s)
{
    if (s->plan->adapts && s->pace_due < 0 && deepest(s) > DEEPER * s->pace_overlap)
        s->pace_due = s->step;
}

int calx_pace_step(struct calx_sim *s, struct calx_error *e)
{
    bool due = s->step % CALX_SELDOM == 0 || (s->pace_due >= 0 && s->step > s->pace_due);
    double left = s->scene->stages[s->stage].duration - (s->time - s->stage_start);
    if (!s->plan->adapts || !due)
        return 0;
    if ((s->stage_step - s->pace_step) % s->heat_every || left < 1.5 * s->dt) { /* as soon as may be */
        s->pace_due = s->pace_due >= 0 ? s->pace_due : s->step;
        return 0;
    }
    return choose(s, e);
}

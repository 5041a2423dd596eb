/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What must not happen, checked in each step from figures that the step already has: a state that is not finite, overlaps
 * and displacements beyond what the method can mean; every sixteenth step temperatures beyond what can be; and, every CALX_SELDOM steps
 * and before a state is kept, energy from nothing, and contacts that the step does not resolve or that make it unstable.
 * A trip stops the run with time, particles, contact, laws, reason and remedy.
 */
#include <math.h>
#include <stdio.h>

#include "core/guard.h"

static const double DISPLACEMENT_BOUND = 0.5; /* of the smallest radius, per step */
static const double ENERGY_BOUND = 0.5;       /* of the largest energy that took part */
static const double ROUNDING = 1e-12;         /* of the potential energy, where nothing moves */

enum { TEMPERATURE_EVERY = 16 };

static int not_finite(struct calx_sim *s, struct calx_error *e)
{
    char contact[CALX_GUARD_TEXT];
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            const double *a = calx_row_a(s, row), *x = calx_row_x(s, row), *v = calx_row_v(s, row);
            double sum = a[0] + a[1] + a[2] + x[0] + x[1] + x[2] + v[0] + v[1] + v[2];
            for (size_t lane = 4; lane < s->r.stride; lane++)
                sum += a[lane] + v[lane];
            if (isfinite(sum))
                continue;
            calx_guard_contact(s, row, contact);
            return calx_error_set(e, CALX_ERROR_PHYSICS,
                "at t = %g s the force on particle %lld at (%g, %g, %g) m, or its motion or temperature, is not finite; %.200s. The "
                "step is probably too long for this stiffness: dt = %g s, stability limit %g s; reduce dt", s->time,
                (long long)s->r.id[row], x[0], x[1], x[2], contact, s->dt, s->plan->critical_dt);
        }
    return 0;
}

static const char SOFT[] = "The contact is too soft for the forces on it, or bodies overlap at the start: raise the stiffness, lower the speeds, or "
                           "start without overlap";
static const char RIGID[] = "Impulses do not hold these bodies apart: the solver went on with conditions unmet (solver-residual shows it; allow more sweeps), "
                            "something closes in on them, or they come too far in a step: reduce dt, or start without overlap";

static int too_deep(const struct calx_sim *s, const struct calx_tally *t, struct calx_error *e)
{
    char partner[CALX_GUARD_TEXT], laws[CALX_GUARD_TEXT];
    calx_guard_name(s, t->overlap_rows[1], partner);
    calx_guard_laws(s->plan, laws);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s particle %lld overlaps %.80s by %.0f %% of the smaller radius (laws %.120s). %s", s->time,
        (long long)calx_row_id(s, t->overlap_rows[0]), partner, 100.0 * t->overlap, laws[0] ? laws : "none", s->plan->nonsmooth ? RIGID : SOFT);
}

static int32_t fastest_row(const struct calx_sim *s)
{
    int32_t fastest = s->block_count ? s->blocks[0].first : 0;
    double largest = -1.0;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            const double *v = calx_row_v(s, row);
            double speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            fastest = speed2 > largest ? row : fastest;
            largest = speed2 > largest ? speed2 : largest;
        }
    return fastest;
}

static int too_fast(struct calx_sim *s, struct calx_error *e)
{
    int32_t fastest = fastest_row(s);
    char contact[CALX_GUARD_TEXT];
    calx_guard_contact(s, fastest, contact);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s particle %lld moves %g m in one step, more than half the smallest radius (%g m): it could pass through a "
        "wall unseen; %.200s. Reduce dt below %.2g s, or look for what accelerates it", s->time, (long long)s->r.id[fastest],
        s->speed * s->dt, s->radius_min, contact, 0.1 * s->radius_min / s->speed);
}

static int wall_too_fast(const struct calx_sim *s, struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s wall '%s' moves %g m in one step, more than half the smallest radius (%g m): it could pass grains "
        "unseen. Reduce dt below %.2g s, or its speed", s->time, s->scene->walls[s->wall_fastest].name, s->wall_step,
        s->radius_min, 0.1 * s->radius_min / s->wall_step * s->dt);
}

static int energy_created(struct calx_sim *s, struct calx_error *e)
{
    struct calx_ledger l = calx_sim_ledger(s);
    char contact[CALX_GUARD_TEXT];
    if (!(l.residual > ENERGY_BOUND * l.scale + ROUNDING * fabs(l.potential)) || !s->n)
        return 0;
    int32_t fastest = fastest_row(s);
    calx_guard_contact(s, fastest, contact);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s energy came from nothing: %g J more than went in, of %g J that took part. The fastest is particle %lld, %g m/s; "
        "%.200s. The step is too long for the stiffness or damping (dt = %g s, stability limit of one pair %g s, less in a dense packing): reduce "
        "dt; or a law gives energy: `calx plugins --check` finds it", s->time, l.residual, l.scale,
        (long long)s->r.id[fastest], s->speed, contact, s->dt, s->plan->critical_dt);
}

/* Looks at all bodies, and notes how far the nearest one is from leaving: until somebody can have come that far, no look is needed. */
static int outside(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_scene *scene = s->scene;
    s->clearance = INFINITY;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            for (int k = 0; k < 3; k++) {
                double x = calx_row_x(s, row)[k], left = fmin(x - scene->low[k], scene->high[k] - x);
                if (!scene->bounded[k] || scene->periodic[k])
                    continue;
                if (left < 0.0)
                    return calx_guard_left(s, row, k, e);
                s->clearance = fmin(s->clearance, left);
            }
    return 0;
}

int calx_guard_left(const struct calx_sim *s, int32_t row, int axis, struct calx_error *e)
{
    const double *x = calx_row_x(s, row);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s particle %lld left the domain along %c: its centre is at (%g, %g, %g) m, the domain reaches from "
        "%g to %g m. Close the walls there, make <domain> larger, or reduce the time step if it was thrown out",
        s->time, (long long)s->r.id[row], "xyz"[axis], x[0], x[1], x[2], s->scene->low[axis],
        s->scene->high[axis]);
}

int calx_guard_all(struct calx_sim *s, struct calx_error *e)
{
    CALX_TRY(not_finite(s, e));
    CALX_TRY(calx_heat_check(s, e));
    CALX_TRY(calx_guard_temperature(s, e));
    if (!s->plan->motion)
        return 0;
    CALX_TRY(energy_created(s, e));
    return calx_guard_contacts(s, e);
}

int calx_sim_guard(struct calx_sim *s, struct calx_error *e)
{
    double depth = s->overlap_seen, trusted = s->trusted;
    int64_t contacts = s->contacts_seen, due = s->look_due;
    s->look_due = s->step;
    int code = calx_guard_all(s, e);
    s->overlap_seen = depth; /* who looks, and when, changes nothing */
    s->contacts_seen = contacts;
    s->look_due = due;
    s->trusted = trusted;
    return code;
}

/* From figures that the step has. */
static int motion_step(struct calx_sim *s, struct calx_error *e)
{
    for (size_t b = 0; b < s->block_count; b++)
        if (s->tallies[b].overlap > CALX_OVERLAP_BOUND)
            return too_deep(s, &s->tallies[b], e);
    if (s->speed * s->dt > DISPLACEMENT_BOUND * s->radius_min && s->features.contacts)
        return too_fast(s, e);
    if (s->wall_step > DISPLACEMENT_BOUND * s->radius_min && s->features.wall_contacts)
        return wall_too_fast(s, e);
    s->clearance -= s->moved;
    if (s->clearance <= s->moved) /* a block that went ahead is one step further */
        CALX_TRY(outside(s, e));
    return calx_guard_contacts_step(s, e);
}

int calx_guard_finite(struct calx_sim *s, struct calx_error *e)
{
    for (size_t b = 0; b < s->block_count; b++)
        if (isnan(s->tallies[b].finite))
            return not_finite(s, e);
    return 0;
}

int calx_guard_step(struct calx_sim *s, struct calx_error *e)
{
    CALX_TRY(calx_guard_finite(s, e));
    if (s->features.temperature)
        calx_guard_walls(s);
    if (s->plan->motion)
        CALX_TRY(motion_step(s, e));
    if (s->features.temperature && s->step % TEMPERATURE_EVERY == 0)
        CALX_TRY(calx_guard_temperature(s, e));
    return s->step % CALX_SELDOM ? 0 : calx_guard_all(s, e);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Guards that look at contacts: each must be resolved by some steps, and the step must be stable in the network that they form. A look
 * costs as much as ten steps, so it is made every CALX_SELDOM steps, more seldom where the step is far below the limit, and when contacts may
 * have become stiffer than any seen: when overlaps reach half as much again as at the last look (stiffness grows with the overlap or not at all), and, if a contact that is to be
 * expected would be too short, when contacts come, but for that not in each of many steps. A step that follows the contacts (pace.c) needs no look.
 */
#include "core/guard.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/columns.h"
#include "core/stability.h"

static const double LEAST_STEPS = 10.0; /* in half a period of a contact */
static const double DEEPER = 1.5;
enum { LOOK_EVERY = 128 }; /* steps: a quick look costs as much as one or two of them, iterations a hundred times that */
/* At the limit a look is due every CALX_SELDOM steps. Below it, the stiffness on a body must first grow with the square of what the step is short
 * of it, contact by contact if overlaps do not grow: so many times, up to this many, are left out. */
static const double MOST_LEFT_OUT = 16.0;
/* Of what the iterations found of the limit beyond its quick bound, for the looks that follow: the shape of the network decides it. */
static const double TRUSTED = 0.9;
static const double ADVISED_STEPS = 20.0, ADVISED_SHARE = 0.5;

/* ---- names ---- */

void calx_guard_name(const struct calx_sim *s, int32_t row, char text[CALX_GUARD_TEXT])
{
    if (row < 0)
        snprintf(text, CALX_GUARD_TEXT, "wall '%s'", s->scene->walls[-1 - row].name);
    else
        snprintf(text, CALX_GUARD_TEXT, "particle %lld", (long long)calx_row_id(s, row));
}

void calx_guard_laws(const struct calx_plan *p, char text[CALX_GUARD_TEXT])
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t l = 0; l < p->law_count && used + 1 < CALX_GUARD_TEXT; l++)
        used += (size_t)snprintf(text + used, CALX_GUARD_TEXT - used, "%s%s", l ? ", " : "", p->laws[l].plugin->name);
}

struct deepest {
    const struct calx_sim *s;
    int64_t id;
    double depth;
    int32_t other;
};

static void take_deepest(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct deepest *d = context;
    double depth = c->overlap[lane] * fmax(c->curvature[0][lane], c->curvature[1][lane]);
    bool first = calx_row_id(d->s, row_i) == d->id, second = row_j >= 0 && calx_row_id(d->s, row_j) == d->id;
    if ((!first && !second) || depth < d->depth)
        return;
    d->depth = depth;
    d->other = first ? row_j : row_i;
}

void calx_guard_contact(struct calx_sim *s, int32_t row, char text[CALX_GUARD_TEXT])
{
    struct deepest d = {s, calx_row_id(s, row), 0.0, row};
    struct calx_sink sink = {&d, take_deepest};
    char name[CALX_GUARD_TEXT], laws[CALX_GUARD_TEXT];
    for (size_t b = 0; b < s->block_count && s->features.contacts; b++)
        s->engine->block_network(s, b, &sink);
    if (d.other == row) {
        snprintf(text, CALX_GUARD_TEXT, "it touches nothing");
        return;
    }
    calx_guard_name(s, d.other, name);
    calx_guard_laws(s->plan, laws);
    snprintf(text, CALX_GUARD_TEXT, "its deepest contact is with %.80s, overlap %.2g %% of the smaller radius%s%.80s", name,
             100.0 * d.depth, s->plan->law_count ? ", laws " : "", laws);
}

/* ---- resolution and stability ---- */

static void name_of(const struct calx_sim *s, int64_t id, char text[CALX_GUARD_TEXT])
{
    if (id < 0)
        snprintf(text, CALX_GUARD_TEXT, "wall '%s'", s->scene->walls[-1 - id].name);
    else
        snprintf(text, CALX_GUARD_TEXT, "particle %lld", (long long)id);
}

static int too_short(const struct calx_sim *s, const struct calx_stability *now, struct calx_error *e)
{
    char name[2][CALX_GUARD_TEXT], laws[CALX_GUARD_TEXT];
    for (int k = 0; k < 2; k++)
        name_of(s, now->pair[k], name[k]);
    calx_guard_laws(s->plan, laws);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s the contact of %.80s with %.80s (%.120s) is resolved by %.2g steps, fewer than %g: it lasts %.3g s and dt = %g s. "
        "Its impulse is not to be trusted. Use dt=\"%.2g s\" or less, or softer contacts; force=\"yes\" on the integrator runs it all "
        "the same",
        s->time, name[0], name[1], laws, now->shortest / s->dt, LEAST_STEPS, now->shortest, s->dt,
        now->shortest / ADVISED_STEPS);
}

static int unstable(const struct calx_sim *s, const struct calx_stability *now, struct calx_error *e)
{
    char laws[CALX_GUARD_TEXT], whose[64] = "a loaded plate";
    calx_guard_laws(s->plan, laws);
    if (now->id >= 0)
        snprintf(whose, sizeof whose, "particle %lld with %d contacts", (long long)now->id, now->contacts);
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s dt = %g s is above the stability limit of the contacts, %g s, which %s sets (%.120s): "
        "motion would blow up. Use dt=\"%.2g s\" or less, or dt=\"auto\"", s->time, s->dt, now->sharp, whose, laws,
        ADVISED_SHARE * now->limit);
}

static void note_contacts(struct calx_sim *s, double *depth, int64_t *contacts)
{
    *depth = 0.0;
    *contacts = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        *depth = fmax(*depth, s->tallies[b].overlap);
        *contacts += s->tallies[b].contacts + s->tallies[b].wall_contacts;
    }
}

int calx_guard_contacts(struct calx_sim *s, struct calx_error *e)
{
    struct calx_stability now;
    double depth, dt = s->dt;
    int64_t contacts;
    if (!s->plan->motion || !s->plan->law_count || s->plan->nonsmooth || s->plan->models->forced || calx_pace_resolves(s->plan, LEAST_STEPS))
        return 0;
    note_contacts(s, &depth, &contacts);
    if (s->step < s->look_due && depth <= DEEPER * s->overlap_seen)
        return 0;
    s->contacts_seen = contacts;
    s->overlap_seen = fmax(s->overlap_seen, depth);
    CALX_TRY(calx_stability_look(s, CALX_QUICK, &now, e));
    if (now.shortest < LEAST_STEPS * dt)
        return too_short(s, &now, e);
    double quick = now.limit, room = fmin(fmax(quick / dt * (quick / dt), 1.0), MOST_LEFT_OUT);
    s->look_due = s->step + CALX_SELDOM * (int64_t)room;
    if (dt <= quick * fmax(s->trusted, 1.0))
        return 0;
    CALX_TRY(calx_stability_look(s, CALX_SHARP, &now, e));
    s->trusted = TRUSTED * fmax(now.limit, now.sharp) / quick;
    return dt > now.limit && dt > now.sharp ? unstable(s, &now, e) : 0;
}

int calx_guard_contacts_step(struct calx_sim *s, struct calx_error *e)
{
    double depth;
    int64_t contacts;
    if (s->plan->models->forced || !s->plan->law_count || s->plan->nonsmooth || calx_pace_resolves(s->plan, LEAST_STEPS))
        return 0;
    note_contacts(s, &depth, &contacts);
    bool come = contacts != s->contacts_seen && s->plan->shortest < LEAST_STEPS * s->dt && s->step >= s->look_from;
    if (come) { /* in a bed contacts come in every step */
        s->look_from = s->step + LOOK_EVERY;
        s->look_due = s->step;
    }
    return come || depth > DEEPER * s->overlap_seen ? calx_guard_contacts(s, e) : 0;
}

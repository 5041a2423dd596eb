/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Temperatures stay within what can be. Conduction alone makes no new extremes (discrete maximum principle): temperatures stay between
 * the coldest and the hottest of the start and of the walls so far. Dissipation adds heat Q in all; the heat above the hottest, sum of C (T -
 * T_hot)+, is convex in the temperatures, so that conduction cannot raise it: it is at most Q. The same below the coldest, with 0.
 */
#include <math.h>

#include "core/guard.h"

static const double ROUNDING = 1e-10; /* of the heat content, and */
static const double SOLVER = 1e-7;    /* of the heat that could flow: what an implicit solver may leave */
static const double TRAPEZOID = 0.01; /* of the mechanical energy: dissipated work of a step is booked to second order */

struct excess {
    double above, below, capacity, worst;
    int32_t row;
};

static void add_row(const struct calx_sim *s, int32_t row, struct excess *x)
{
    double c = 1.0 / s->r.inverse_capacity[row], t = calx_row_v(s, row)[7];
    double over = t - s->hottest, under = s->coldest - t, out = fmax(over, under);
    if (!isfinite(c)) /* its temperature is given */
        return;
    x->capacity += c;
    x->above += over > 0.0 ? c * over : 0.0;
    x->below += under > 0.0 ? c * under : 0.0;
    if (!(out <= x->worst)) { /* a temperature that is no number is the worst */
        x->worst = isnan(out) ? INFINITY : out;
        x->row = row;
    }
}

void calx_guard_walls(struct calx_sim *s)
{
    for (size_t w = 0; w < s->scene->wall_count; w++)
        if (s->scene->walls[w].isothermal) {
            s->coldest = fmin(s->coldest, s->wall_temperature[w]);
            s->hottest = fmax(s->hottest, s->wall_temperature[w]);
        }
}

void calx_guard_begin(struct calx_sim *s)
{
    s->coldest = INFINITY;
    s->hottest = -INFINITY;
    if (!s->features.temperature)
        return;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            s->coldest = fmin(s->coldest, calx_row_v(s, row)[7]);
            s->hottest = fmax(s->hottest, calx_row_v(s, row)[7]);
        }
    for (size_t w = 0; w < s->scene->wall_count; w++) {
        const struct calx_slab *b = &s->scene->walls[w].slab;
        if (!calx_wall_has_slab(s, (int)w))
            continue;
        s->coldest = fmin(s->coldest, b->far_isothermal ? fmin(b->start, b->far) : b->start);
        s->hottest = fmax(s->hottest, b->far_isothermal ? fmax(b->start, b->far) : b->start);
    }
    calx_guard_walls(s);
}

static int out_of_bounds(struct calx_sim *s, const struct excess *x, double heat, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    char contact[CALX_GUARD_TEXT];
    double limit;
    int64_t id;
    calx_guard_contact(s, x->row, contact);
    if (calx_heat_limit(s, &limit, &id, NULL))
        limit = NAN;
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s particle %lld has %.9g K, which conduction cannot bring about: start and walls lie between %.9g and %.9g K, and "
        "dissipation gave %.3g J; %.160s, conductance %s. The heat step of %g s is probably too long for %s (explicit "
        "limit %.3g s): shorten the dt of that integrator, or use heat-theta with monotone=\"yes\"", s->time,
        (long long)s->r.id[x->row], calx_row_v(s, x->row)[7], s->coldest, s->hottest, heat, contact,
        p->conductance ? p->conductance->name : "none", s->heat_dt, p->heat ? p->heat->name : "none", limit);
}

int calx_guard_temperature(struct calx_sim *s, struct calx_error *e)
{
    struct excess x = {.worst = 0.0};
    if (!s->features.temperature || !s->n)
        return 0;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            add_row(s, row, &x);
    double heat = fmax((double)s->dissipation_heat, 0.0), trapezoid = TRAPEZOID * s->scene->from_dissipation * s->scale;
    double slack = x.capacity * (SOLVER * (s->hottest - s->coldest) + ROUNDING * s->hottest) + trapezoid;
    if (isfinite(x.worst) && x.above <= heat + slack && x.below <= slack)
        return 0;
    return out_of_bounds(s, &x, heat, e);
}

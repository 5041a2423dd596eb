/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The time step and the contacts there are: a fixed step above their limit is refused.
 */
#include <math.h>

#include "core/stability.h"

/* What a refused step is told to be: this share of the limit resolves a contact by 30 steps. */
static const double ADVISED = 0.1;

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
    return isfinite(limit) ? s->plan->dt / limit : 0.0;
}

int calx_pace_begin(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    struct calx_stability now;
    if (!p->motion || p->models->forced)
        return 0;
    CALX_TRY(calx_stability_look(s, CALX_BOUND, &now, e));
    if (p->dt <= now.limit)
        return 0;
    CALX_TRY(calx_stability_look(s, CALX_SHARP, &now, e)); /* not refused for the slack of the bound */
    if (p->dt <= now.limit)
        return 0;
    return calx_error_set(e, CALX_ERROR_INPUT,
        "dt = %g s is above the stability limit %g s of the contacts at the start, set by particle %lld with its %d contacts: use "
        "dt=\"%.2g s\" or dt=\"auto\"; force=\"yes\" runs it all the same", p->dt, now.limit, (long long)now.id,
        now.contacts, ADVISED * now.limit);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The skin of the neighbour list. A wide one holds pairs that are looked at in vain, a narrow one is used up soon: at each rebuild the width is
 * moved towards the least work by what was counted since the last (pairs held, steps it lasted), never by the clock, so
 * that the bits do not depend on the machine.
 * Work per step in units of one look at a pair: P(s) + REBUILD n/T(s), with P growing like the volume within reach, (2R + s)^d,
 * and the life T of a list proportional to s.
 */
#include <math.h>

#include "core/state.h"

/* A rebuild costs as much per particle as this many looks at a pair: measured on a drum, a bed and a gas (0.6 us against 2.5 ns). */
static const double REBUILD = 240.0;
static const double FIRST = 0.3, LEAST = 0.02, MOST = 4.0; /* of the mean radius */
static const double LADDER = 1.1;                          /* between the widths that are compared */

static double mean_radius(const struct calx_scene *scene)
{
    double mean = 0.0;
    for (size_t i = 0; i < scene->particles.count; i++)
        mean += scene->particles.radius[i] / (double)scene->particles.count;
    return mean;
}

int calx_skin_choose(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_scene *scene = s->scene;
    double mean = mean_radius(scene);
    s->skin_tuned = !(scene->skin > 0.0) && s->features.search;
    s->skin = scene->skin > 0.0 ? scene->skin : FIRST * mean;
    s->skin_least = LEAST * mean;
    s->skin_most = s->skin_tuned ? MOST * mean : INFINITY;
    if (!s->features.search && !s->features.periodic)
        s->skin = INFINITY; /* without a search, everything is always near */
    for (int k = 0; k < 3 && s->features.search; k++) {
        double length = scene->high[k] - scene->low[k], cutoff = 2.0 * s->radius_max + s->plan->gap;
        if (!scene->periodic[k])
            continue;
        s->skin_most = fmin(s->skin_most, 0.499 * length - cutoff);
        if (0.5 * length <= cutoff * 1.001)
            return calx_error_set(e, CALX_ERROR_INPUT,
                "the periodic length along %c, %g m, is too short for particles of radius %g m: a particle could touch two "
                "images of another; it must be above %g m", "xyz"[k], length, s->radius_max, 2.002 * cutoff);
    }
    s->skin = s->features.search ? fmin(s->skin, fmax(s->skin_most, 0.0)) : s->skin;
    return 0;
}

void calx_skin_tune(struct calx_sim *s)
{
    int64_t life = s->step - s->built_step;
    double reach = s->radius_min + s->radius_max, best = s->skin, least = INFINITY;
    double used = 2.0 * s->drift / (double)(life > 0 ? life : 1); /* m of skin per step */
    s->built_step = s->step;
    if (!s->skin_tuned || !s->built || life < 1 || !(used > 0.0))
        return;
    for (double width = s->skin_least; width <= s->skin_most; width *= LADDER) {
        double pairs = (double)s->pairs.reach * pow((reach + width) / (reach + s->skin), s->scene->dimension);
        double work = pairs + REBUILD * (double)s->n * used / width;
        best = work < least ? width : best;
        least = work < least ? work : least;
    }
    s->skin = sqrt(s->skin * best); /* half of the way: what was counted is of one list */
}

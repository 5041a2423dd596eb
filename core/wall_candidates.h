/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: which of the primitives near a particle count as something to touch.
 * A joint counts once: an end of a segment is dropped where another segment that contains it is at least as near; of several
 * primitives of one smooth surface that push the same way, only the deepest acts.
 */
#ifndef CALX_WALL_CANDIDATES_H
#define CALX_WALL_CANDIDATES_H

#include <math.h>

#include "core/state.h"
#include "core/surface.h"

enum { NEAR_MAX = 64 }; /* primitives near one grain */

struct candidate {
    struct calx_touch touch;
    int32_t primitive, surface;
    bool dropped;
};

/* Whether point p lies on the segment, to rounding. */
static inline bool on_segment(const struct calx_primitive *s, const double p[3])
{
    struct calx_touch t;
    double scale = fabs(s->a[0]) + fabs(s->a[1]) + fabs(s->b[0]) + fabs(s->b[1]);
    calx_surface_nearest(s, 2, p, &t);
    return t.distance <= 1e-9 * scale;
}

/* Drops ends that another candidate covers, then all but the deepest of one smooth surface that push the same way. */
static inline void drop_duplicates(const struct calx_sim *s, struct candidate *list, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        if (!list[k].touch.end || s->posed[list[k].primitive].p.shape != CALX_SEGMENT)
            continue;
        for (size_t q = 0; q < n && !list[k].dropped; q++)
            list[k].dropped = q != k && !list[q].dropped &&
                              s->posed[list[q].primitive].p.shape == CALX_SEGMENT &&
                              list[q].touch.distance <= list[k].touch.distance &&
                              on_segment(&s->posed[list[q].primitive].p, list[k].touch.point);
    }
    for (size_t k = 0; k < n; k++)
        for (size_t q = 0; q < n && !list[k].dropped; q++) {
            const double *a = list[k].touch.normal, *b = list[q].touch.normal;
            bool deeper = list[q].touch.distance < list[k].touch.distance ||
                          (list[q].touch.distance == list[k].touch.distance && q < k);
            list[k].dropped = q != k && !list[q].dropped && deeper &&
                              list[q].surface == list[k].surface &&
                              a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.5;
        }
}

/* Surfaces are numbered within a wall; this makes the number unique in the scene. */
static inline int32_t surface_of(const struct calx_sim *s, int32_t primitive)
{
    return s->posed[primitive].wall * 65536 + s->posed[primitive].p.surface;
}

/* Which of a full list is farthest. */
static inline size_t farthest(const struct candidate *list)
{
    size_t most = 0;
    for (size_t k = 1; k < NEAR_MAX; k++)
        if (list[k].touch.distance > list[most].touch.distance)
            most = k;
    return most;
}

/* The candidates of the particle whose near list starts at `at`; returns where the next particle's starts. */
static inline size_t collect(const struct calx_sim *s, const struct calx_row_block *b, size_t at,
                      struct candidate *list, size_t *count)
{
    int32_t row = s->near_row[at];
    const double *x = calx_row_x(s, row);
    *count = 0;
    for (; at < b->near_first + b->near_count && s->near_row[at] == row; at++) {
        struct candidate extra, *k = *count < NEAR_MAX ? &list[*count] : &extra;
        k->primitive = s->near_primitive[at];
        calx_surface_touch(&s->posed[k->primitive].p, s->scene->dimension, x, &k->touch);
        if (k->touch.distance >= 2.0 * x[3] + s->plan->gap) /* neither touches nor did a step ago */
            continue;
        k->surface = surface_of(s, k->primitive);
        k->dropped = false;
        if (k != &extra)
            ++*count;
        else if (k->touch.distance < list[farthest(list)].touch.distance)
            list[farthest(list)] = extra;
    }
    return at;
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: solids behind walls. slab.c steps the temperatures of one; slabs.c joins them to the contacts on their faces; here is where
 * on the face a contact is, which is worked out for each in every step.
 * Cells lie in rows along the face, the row at the face first: cell i + along*k is the i-th along the face, k rows deep.
 */
#ifndef CALX_SLAB_H
#define CALX_SLAB_H

#include <math.h>

#include "core/state.h"

/* What one step needs and leaves. */
struct calx_slab_step {
    double dt;             /* s */
    double *temperature;   /* K, per cell, in/out */
    const double *heat;    /* J, per cell of the face: into the slab during the step */
    double *scratch;       /* calx_slab_scratch() doubles */
    double far_heat;       /* J, out: through the far face into the slab */
};

size_t calx_slab_scratch(const struct calx_slab *);

/* One step of the theta scheme, split by axis. Cannot fail. */
void calx_slab_advance(const struct calx_slab *, struct calx_slab_step *);

/* J/K, of one cell. */
static inline double calx_slab_capacity(const struct calx_slab *b)
{
    return b->capacity * b->length / (double)b->along * b->depth / (double)b->deep * b->width;
}

/* The two cells of the face between whose middles a point is, and the share of the second. */
struct calx_slab_spot {
    size_t cell[2];
    double share;
};

static inline struct calx_slab_spot calx_slab_find(const struct calx_slab *b, const struct calx_pose *pose, const double point[3])
{
    double from[3], s = 0.0;
    for (int k = 0; k < 3; k++)
        from[k] = point[k] - pose->shift[k];
    for (int k = 0; k < 3; k++) /* back into the pose at the start: the transpose turns back */
        s += b->axis[0][k] * (pose->turn[k] * from[0] + pose->turn[3 + k] * from[1] + pose->turn[6 + k] * from[2] - b->corner[k]);
    double n = (double)b->along, at = s / b->length * n - 0.5;
    if (b->periodic)
        at -= n * floor(at / n);
    else
        at = fmin(fmax(at, 0.0), n - 1.0);
    size_t i = (size_t)at < b->along ? (size_t)at : b->along - 1;
    size_t next = i + 1 < b->along ? i + 1 : b->periodic ? 0 : i;
    return (struct calx_slab_spot){{i, next}, at - (double)i};
}

#endif

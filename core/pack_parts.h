/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files of the packing share. Private to core/pack*.c.
 */
#ifndef CALX_PACK_PARTS_H
#define CALX_PACK_PARTS_H

#include "core/pack.h"
#include "core/pack_grid.h"
#include "core/random.h"

/* Bodies being placed: 0 ... count-1 may move, count ... total-1 are the ones that were there. */
struct calx_pack_set {
    const struct calx_region *region;
    size_t count, total;
    double (*position)[3];
    double *radius;
    double least, largest; /* radii, m */
    struct calx_pack_grid grid;
};

/* ---- pack_sizes.c ---- */

/* Area (2D) or volume (3D) of a body. */
double calx_pack_sizes_solid(uint32_t dimension, double radius);

/* NULL, or what is wrong with a distribution. */
const char *calx_pack_sizes_mistake(const struct calx_sizes *sizes);

/* Draws `count` radii, or (count = 0) as many as make the solid area or volume `solid`, in random
 * order; *radius is to be freed. Fails on too many bodies, or a distribution that its truncation
 * leaves nothing of. */
int calx_pack_sizes_draw(const struct calx_sizes *sizes, uint32_t dimension, size_t count,
                         double solid, struct calx_random *random, double **radius, size_t *drawn,
                         struct calx_error *error);

/* ---- pack_relax.c ---- */

/* Pushes overlapping bodies apart until none overlap or no progress is made. *shrink becomes the
 * share by which all radii would have to shrink to end the overlaps that are left (0: none are).
 * Fails only without memory. */
int calx_pack_relax(struct calx_pack_set *set, double *shrink, struct calx_error *error);

#endif

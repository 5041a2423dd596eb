/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Neighbours of spheres of any size ratio, for packing: a hash of cells with one level of cell size
 * per factor of two in radius.
 */
#ifndef CALX_PACK_GRID_H
#define CALX_PACK_GRID_H

#include "core/region.h"

enum { CALX_PACK_LEVELS = 32 };

struct calx_pack_grid {
    uint32_t dimension;
    double low[3], period[3];           /* period 0: not periodic */
    double top;                         /* m: largest radius */
    int64_t cells[CALX_PACK_LEVELS][3]; /* around a periodic axis, else 0 */
    double width[CALX_PACK_LEVELS][3];  /* m */
    size_t population[CALX_PACK_LEVELS];
    const double (*position)[3]; /* borrowed; positions may lie in any periodic image */
    const double *radius;
    size_t mask; /* of the hash: buckets - 1 */
    int32_t *head, *next;
    uint64_t *key;
};

/* Prepares an empty grid for up to `count` bodies with radii up to `top`; false without memory. The
 * arrays are borrowed. */
bool calx_pack_grid_create(struct calx_pack_grid *grid, const struct calx_region *region,
                           size_t count, double top, const double (*position)[3],
                           const double *radius);
void calx_pack_grid_free(struct calx_pack_grid *grid);

/* Empties the grid. */
void calx_pack_grid_reset(struct calx_pack_grid *grid);

/* Puts body i where position[i] is. */
void calx_pack_grid_insert(struct calx_pack_grid *grid, int32_t i);

/* The level of a radius: 0 for the largest. */
int calx_pack_grid_level(const struct calx_pack_grid *grid, double radius);

/* Calls visit(context, j) for every body j on levels 0 ... deepest that may be nearer to x than
 * radius + radius[j] + margin, each once, until one call returns false; returns false then. */
bool calx_pack_grid_visit(const struct calx_pack_grid *grid, const double x[3], double radius,
                          double margin, int deepest, bool (*visit)(void *context, int32_t j),
                          void *context);

/* The vector from body j (its nearest image) to x; returns its square. */
double calx_pack_grid_between(const struct calx_pack_grid *grid, const double x[3], int32_t j,
                              double d[3]);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Random packings of spheres (in 2D: discs) without overlap inside a region: sizes from a
 * distribution, to a count or to a solid fraction.
 */
#ifndef CALX_PACK_H
#define CALX_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "core/error.h"
#include "core/region.h"

enum calx_sizes_kind {
    CALX_SIZES_FIXED,     /* all a */
    CALX_SIZES_UNIFORM,   /* a to b */
    CALX_SIZES_NORMAL,    /* mean a, standard deviation b, drawn again until within min ... max */
    CALX_SIZES_LOGNORMAL, /* mean a, standard deviation b of the radius itself; likewise */
    CALX_SIZES_MASSES,    /* classes of radius list[i] with the share weight[i] of the solid mass */
    CALX_SIZES_NUMBERS,   /* the same, weight[i] its share of the number of bodies */
    CALX_SIZES_LIST       /* exactly the radii list[0 ... count-1], once each */
};

/* Radii in m. The arrays belong to the caller. max = 0 is no upper bound; a normal distribution is
 * then cut at 3 deviations, and below too if min = 0. */
struct calx_sizes {
    enum calx_sizes_kind kind;
    double a, b;
    double min, max; /* normal, lognormal */
    size_t count;    /* masses, numbers, list */
    const double *list;
    const double *weight; /* masses, numbers: any positive scale */
};

/* The largest radius that can come, m; infinite if there is no bound. */
double calx_pack_largest(const struct calx_sizes *sizes);

/* Radii (m) of `count` bodies, or (count = 0) of as many as make the solid area (in 3D: volume)
 * `solid`, in random order; the same seed gives the same. *radius, of *drawn numbers, is to be
 * freed. Fails on a distribution that is empty and on too many bodies. */
int calx_pack_radii(const struct calx_sizes *sizes, uint32_t dimension, size_t count, double solid,
                    uint64_t seed, double **radius, size_t *drawn, struct calx_error *error);

/* What was placed, in the order in which the sizes were drawn (so ids are not sorted by size); free
 * with calx_packing_free(). */
struct calx_packing {
    size_t count;
    double (*position)[3]; /* m */
    double *radius;        /* m */
    double fraction;       /* solid area or volume over that of the region */
};
void calx_packing_free(struct calx_packing *packing);

/* Bodies that are already there; the arrays belong to the caller. May be NULL where used. */
struct calx_bodies_at {
    size_t count;
    const double (*position)[3];
    const double *radius;
};

/* Packs `count` bodies, or (count = 0) as many as make the solid fraction `fill`, or (both 0) as
 * many as random trials place. The same seed gives the same packing. Fails with CALX_ERROR_INPUT on
 * contradictory or non-finite arguments and when they do not fit: the text then says how many did
 * and which solid fraction that is. *out is then empty. */
int calx_pack_region(const struct calx_region *region, const struct calx_sizes *sizes, size_t count,
                     double fill, uint64_t seed, const struct calx_bodies_at *avoid,
                     struct calx_packing *out, struct calx_error *error);

#endif

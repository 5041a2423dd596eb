/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Regions that bodies are packed into: boxes, circles, spheres, cylinders and the inside of closed
 * outlines, cut by a box.
 */
#ifndef CALX_REGION_H
#define CALX_REGION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"
#include "core/scene.h"

enum calx_region_kind {
    CALX_REGION_BOX,      /* what the box low ... high bounds; in 2D a rectangle */
    CALX_REGION_BALL,     /* sphere about centre; in 2D a circle */
    CALX_REGION_CYLINDER, /* about the line through centre along axis; 3D only */
    CALX_REGION_OUTLINE   /* inside (even-odd) of closed outlines in x-y; in 3D swept along z */
};

/* Where centres and their radii must fit. Every kind is also cut by the box low ... high: set a
 * bound to -INFINITY or INFINITY where there is none, and lower high[1] to fill only up to a level.
 * On a periodic axis low and high are the two images. Set by calx_region_init(). */
struct calx_region {
    enum calx_region_kind kind;
    uint32_t dimension;     /* 2 or 3; in 2D positions get z = 0 and low, high of z are ignored */
    double low[3], high[3]; /* m */
    bool periodic[3];
    double centre[3]; /* m; ball, cylinder */
    double axis[3];   /* direction, any length > 0; cylinder */
    double radius;    /* m; ball, cylinder */
    double length;    /* m; cylinder, half to each side of centre; 0, infinite: the box ends it */
    double clearance; /* m >= 0: kept free between bodies and walls */
    size_t edge_count;
    double (*edges)[4]; /* ax, ay, bx, by in m: segments of closed outlines, owned */
    size_t obstacle_count;
    double (*obstacles)[4]; /* likewise: thin walls (flights, baffles), in any kind of region */
};

/* A box without bounds and walls, of 2 or 3 dimensions. */
void calx_region_init(struct calx_region *region, uint32_t dimension);

/* Frees edges and obstacles. */
void calx_region_clear(struct calx_region *region);

/* Makes `region` (initialised, bounds set by the caller before or after) the inside of a wall:
 * closed chains of segments are outlines and open chains obstacles; or the inside of its one
 * cylinder or sphere, with its segments as obstacles. Fails, naming the wall, if it has no inside.
 */
int calx_region_of_wall(struct calx_region *region, const struct calx_wall *wall,
                        struct calx_error *error);

/* Area (2D) or volume (3D) in m2 or m3, to about 1e-4 relative for curved and cut regions, exact
 * for boxes; obstacles are thin. */
double calx_region_volume(const struct calx_region *region);

/* True if a body of that radius at x lies inside, clear of all walls by its radius and the
 * clearance. */
bool calx_region_holds(const struct calx_region *region, const double x[3], double radius);

/* ---- for the packing (core/pack*.c) ---- */

/* A box that holds the region; fails, naming the axis, if it is endless, and if a number is not
 * finite or a size not positive. */
int calx_region_bounds(const struct calx_region *region, double low[3], double high[3],
                       struct calx_error *error);

/* Adds to push[3] the overlaps of a body of that radius at x with the walls that are no segments,
 * along their normals; returns the deepest overlap (<= 0: none). */
double calx_region_push(const struct calx_region *region, const double x[3], double radius,
                        double push[3]);

/* The vector from the nearest point of a segment to x, in the x-y plane; returns its length. */
double calx_region_edge(const double edge[4], const double x[3], double away[2]);

#endif

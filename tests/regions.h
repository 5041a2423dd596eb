/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Regions that the tests pack.
 */
#ifndef CALX_TESTS_REGIONS_H
#define CALX_TESTS_REGIONS_H

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/pack.h"
#include "core/random.h"

static struct calx_error error;
static struct calx_packing packing;

static inline void begin(void)
{
    error = (struct calx_error){0};
    packing = (struct calx_packing){0};
}

static inline void end(void)
{
    calx_packing_free(&packing);
}

/* ---- regions of the tables ---- */

static inline struct calx_region box(uint32_t dimension, double x, double y, double z)
{
    struct calx_region region;
    calx_region_init(&region, dimension);
    const double size[3] = {x, y, z};
    for (uint32_t k = 0; k < dimension; k++) {
        region.low[k] = -size[k] / 2;
        region.high[k] = size[k] / 2;
    }
    return region;
}

static inline struct calx_region make_rectangle(void)
{
    return box(2, 0.1, 0.1, 0);
}

static inline struct calx_region make_box(void)
{
    return box(3, 0.05, 0.05, 0.05);
}

static inline struct calx_region make_periodic_box(void)
{
    struct calx_region region = box(3, 0.04, 0.04, 0.04);
    region.periodic[0] = region.periodic[1] = region.periodic[2] = true;
    return region;
}

static inline struct calx_region make_slab(void) /* one body thick */
{
    struct calx_region region = box(3, 0.1, 0.1, 0.0045);
    region.periodic[2] = true;
    return region;
}

static inline struct calx_region make_circle(void)
{
    struct calx_region region;
    calx_region_init(&region, 2);
    region.kind = CALX_REGION_BALL;
    region.radius = 0.05;
    region.centre[0] = 0.3;
    return region;
}

static inline struct calx_region make_ball(void)
{
    struct calx_region region = make_circle();
    region.dimension = 3;
    region.centre[2] = -0.1;
    region.radius = 0.03;
    return region;
}

static inline struct calx_region make_drum(void) /* case 8 */
{
    struct calx_region region;
    calx_region_init(&region, 3);
    region.kind = CALX_REGION_CYLINDER;
    region.radius = 0.0762;
    region.low[2] = -0.025;
    region.high[2] = 0.025;
    region.periodic[2] = true;
    return region;
}

static inline struct calx_region make_half_drum(void) /* below the axis */
{
    struct calx_region region = make_drum();
    region.high[1] = 0;
    return region;
}

static inline struct calx_region make_tilted(void)
{
    struct calx_region region;
    calx_region_init(&region, 3);
    region.kind = CALX_REGION_CYLINDER;
    region.radius = 0.02;
    region.length = 0.05;
    region.axis[0] = 1;
    region.axis[1] = 2;
    region.axis[2] = -2;
    region.clearance = 0.0005;
    return region;
}

static inline void add_edge(double (**edges)[4], size_t *count, double ax, double ay, double bx,
                            double by)
{
    *edges = realloc(*edges, (*count + 1) * sizeof **edges);
    memcpy((*edges)[(*count)++], (double[]){ax, ay, bx, by}, sizeof **edges);
}

static inline void add_ring(struct calx_region *region, double radius, int count)
{
    for (int i = 0; i < count; i++) {
        double a = 2 * M_PI * i / count, b = 2 * M_PI * ((i + 1) % count) / count;
        add_edge(&region->edges, &region->edge_count, radius * cos(a), radius * sin(a),
                 radius * cos(b), radius * sin(b));
    }
}

/* A drum with a hub and four straight flights, the flights as obstacles. */
static inline struct calx_region make_outline(void)
{
    struct calx_region region;
    calx_region_init(&region, 2);
    region.kind = CALX_REGION_OUTLINE;
    add_ring(&region, 0.06, 90);
    add_ring(&region, 0.015, 30);
    for (int i = 0; i < 4; i++) {
        double c = cos(M_PI / 2 * i + 0.2), s = sin(M_PI / 2 * i + 0.2);
        add_edge(&region.obstacles, &region.obstacle_count, 0.06 * c, 0.06 * s, 0.045 * c,
                 0.045 * s);
    }
    return region;
}

static inline struct calx_region make_clear_outline(void)
{
    struct calx_region region = make_outline();
    region.clearance = 0.001;
    return region;
}

static inline struct calx_region make_prism(void)
{
    struct calx_region region = make_outline();
    region.dimension = 3;
    region.low[2] = 0;
    region.high[2] = 0.02;
    return region;
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The inside of a wall as a region to pack: from the primitives of the wall (core/scene.h), in
 * their pose at the start, to a region. Segments that follow each other bit by bit form chains;
 * closed chains are outlines, open ones obstacles.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/region.h"

static bool joined(const struct calx_primitive *one, const struct calx_primitive *next)
{
    return next->shape == CALX_SEGMENT && memcmp(one->b, next->a, 2 * sizeof(double)) == 0;
}

/* One past the last segment of the chain that starts at `first`. */
static size_t chain_end(const struct calx_wall *wall, size_t first)
{
    size_t i = first;
    while (i + 1 < wall->primitive_count &&
           joined(&wall->primitives[i], &wall->primitives[i + 1]) &&
           !(i > first && joined(&wall->primitives[i], &wall->primitives[first])))
        i++;
    return i + 1;
}

static void add_chain(double (*edges)[4], size_t *count, const struct calx_primitive *p, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        double *edge = edges[(*count)++];
        memcpy(edge, p[i].a, 2 * sizeof(double));
        memcpy(edge + 2, p[i].b, 2 * sizeof(double));
    }
}

static void add_segments(struct calx_region *region, const struct calx_wall *wall)
{
    for (size_t i = 0, end; i < wall->primitive_count; i = end) {
        end = i + 1;
        const struct calx_primitive *p = &wall->primitives[i];
        if (p->shape != CALX_SEGMENT)
            continue;
        end = chain_end(wall, i);
        if (end - i > 2 && joined(&wall->primitives[end - 1], p))
            add_chain(region->edges, &region->edge_count, p, end - i);
        else
            add_chain(region->obstacles, &region->obstacle_count, p, end - i);
    }
}

static void add_round(struct calx_region *region, const struct calx_primitive *p)
{
    bool flat = p->shape == CALX_CYLINDER && region->dimension == 2;
    region->kind = p->shape == CALX_SPHERE || flat ? CALX_REGION_BALL : CALX_REGION_CYLINDER;
    memcpy(region->centre, p->a, sizeof region->centre);
    memcpy(region->axis, p->n, sizeof region->axis);
    region->radius = p->radius;
    region->length = p->length;
}

/* The one cylinder or sphere whose inside is meant, or NULL; *count says how many there are. */
static const struct calx_primitive *find_round(const struct calx_wall *wall, size_t *count)
{
    const struct calx_primitive *found = NULL;
    *count = 0;
    for (size_t i = 0; i < wall->primitive_count; i++) {
        const struct calx_primitive *p = &wall->primitives[i];
        if ((p->shape == CALX_CYLINDER || p->shape == CALX_SPHERE) && p->inside) {
            found = p;
            ++*count;
        }
    }
    return found;
}

int calx_region_of_wall(struct calx_region *region, const struct calx_wall *wall,
                        struct calx_error *error)
{
    size_t rounds;
    const struct calx_primitive *p = find_round(wall, &rounds);
    calx_region_clear(region);
    region->edges = malloc((wall->primitive_count + 1) * sizeof *region->edges);
    region->obstacles = malloc((wall->primitive_count + 1) * sizeof *region->obstacles);
    if (!region->edges || !region->obstacles)
        return calx_error_set(error, CALX_ERROR_MEMORY, "no memory for the inside of wall %s",
                              wall->name);
    add_segments(region, wall);
    if (rounds == 1 && region->edge_count == 0)
        add_round(region, p);
    else if (rounds == 0 && region->edge_count > 0)
        region->kind = CALX_REGION_OUTLINE;
    else
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "wall %s does not bound one inside: expected closed chains of "
                              "segments, or one cylinder or "
                              "sphere with side=\"inside\"; found %zu segments in closed chains, "
                              "%zu in open ones and %zu "
                              "cylinders or spheres",
                              wall->name, region->edge_count, region->obstacle_count, rounds);
    return CALX_OK;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <grid>: bodies on a rectangular grid, x fastest, z slowest. All places are taken, or, to make a
 * solid fraction, the first of them; sizes of several classes are in random order.
 */
#include "io/case_bodies.h"

#include <math.h>
#include <stdlib.h>

struct grid {
    double from[3], spacing[3];
    size_t count[3];
};

/* As the case gives it, or such that the largest bodies touch. */
static bool read_spacing(struct calx_reader *r, const xmlNode *node, const struct calx_sizes *sizes,
                         struct grid *g)
{
    size_t count = calx_case_list(r, node, "spacing", g->spacing, 3);
    if (!calx_case_given(node, "spacing")) {
        g->spacing[0] = 2 * calx_pack_largest(sizes);
        if (!isfinite(g->spacing[0])) {
            calx_case_fail(r, node, NULL,
                           "attribute 'spacing' is missing: the radii have no upper bound");
            return false;
        }
    } else if (count != 1 && count != r->scene->dimension) {
        if (count)
            calx_case_fail(r, node, "spacing", "%zu numbers, expected 1 or %u", count,
                           r->scene->dimension);
        return false;
    }
    for (size_t k = count > 1 ? count : 1; k < 3; k++)
        g->spacing[k] = g->spacing[0];
    return true;
}

static bool count_to(struct calx_reader *r, const xmlNode *node, struct grid *g)
{
    double to[3];
    if (!calx_case_vector(r, node, "to", to))
        return false;
    for (size_t k = 0; k < r->scene->dimension; k++) {
        double steps = floor((to[k] - g->from[k]) / g->spacing[k] +
                             1e-9); /* a corner on the grid is reached despite rounding */
        if (steps < 0 || steps >= CALX_MOST_BODIES) {
            calx_case_fail(r, node, "to",
                           "expected a corner above 'from' with at most %d bodies between",
                           CALX_MOST_BODIES);
            return false;
        }
        g->count[k] = (size_t)steps + 1;
    }
    return true;
}

static bool read_counts(struct calx_reader *r, const xmlNode *node, struct grid *g)
{
    const char *text = calx_case_given(node, "count"), *words[4];
    char *copy;
    size_t count = calx_case_split(text, "", &copy, words, 4);
    bool right = count == r->scene->dimension;
    for (size_t k = 0; right && k < count; k++) {
        char *end;
        g->count[k] = strtoul(words[k], &end, 10);
        right =
            *end == '\0' && *words[k] != '-' && g->count[k] >= 1 && g->count[k] <= CALX_MOST_BODIES;
    }
    if (!right)
        calx_case_fail(r, node, "count", "'%.80s', expected %u whole numbers from 1 to %d", text,
                       r->scene->dimension, CALX_MOST_BODIES);
    free(copy);
    return right;
}

/* How many places there are; 0 and a problem if too many. */
static size_t count_places(struct calx_reader *r, const xmlNode *node, const struct grid *g)
{
    size_t layer = g->count[0] * g->count[1];
    if (layer <= CALX_MOST_BODIES && layer * g->count[2] <= CALX_MOST_BODIES)
        return layer * g->count[2];
    calx_case_fail(r, node, NULL, "more than %d bodies", CALX_MOST_BODIES);
    return 0;
}

static void place_all(struct calx_bed *bed, struct calx_group *group, const struct grid *g,
                      const double *radius, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t place[3] = {i % g->count[0], i / g->count[0] % g->count[1],
                           i / (g->count[0] * g->count[1])};
        double at[3];
        for (size_t k = 0; k < 3; k++)
            at[k] = g->from[k] + (double)place[k] * g->spacing[k];
        if (calx_case_place_body(bed, group, at, radius[i]) < 0)
            return;
    }
}

/* The area, in 3D volume, of the grid: that of all its cells. */
static double grid_extent(const struct grid *g, uint32_t dimension)
{
    double extent = 1;
    for (size_t k = 0; k < dimension; k++)
        extent *= (double)g->count[k] * g->spacing[k];
    return extent;
}

static void place_grid(struct calx_bed *bed, struct calx_group *group, const struct grid *g,
                       const struct calx_radii *radii)
{
    struct calx_reader *r = bed->reader;
    const xmlNode *node = group->node;
    size_t places = count_places(r, node, g), count = 0;
    bool fills = calx_case_given(node, "fill") != NULL;
    double fill = calx_case_number(r, node, "fill"), *radius = NULL;
    struct calx_error e = {0};
    if (!places || (fills && isnan(fill)))
        return;
    double solid = fills ? fill * grid_extent(g, r->scene->dimension) : 0;
    if (calx_pack_radii(&radii->sizes, r->scene->dimension, fills ? 0 : places, solid, group->seed,
                        &radius, &count, &e))
        calx_case_fail_with(r, node, "radius", &e);
    else if (count > places)
        calx_case_fail(r, node, "fill", "takes %zu bodies, but the grid has %zu places", count,
                       places);
    else
        place_all(bed, group, g, radius, count);
    free(radius);
}

void calx_case_read_grid(struct calx_bed *bed, struct calx_group *group)
{
    struct calx_reader *r = bed->reader;
    const xmlNode *node = group->node;
    struct grid g = {.count = {1, 1, 1}};
    struct calx_radii radii = {0};
    bool has_to = calx_case_given(node, "to") != NULL,
         has_count = calx_case_given(node, "count") != NULL;
    bool good = calx_case_read_radii(r, node, &radii) &&
                calx_case_vector(r, node, "from", g.from) &&
                read_spacing(r, node, &radii.sizes, &g);
    if (has_to == has_count)
        calx_case_fail(r, node, NULL, "has %s, expected either 'to' or 'count'",
                       has_to ? "both 'to' and 'count'" : "neither end nor number");
    else if (good && (has_to ? count_to(r, node, &g) : read_counts(r, node, &g)))
        place_grid(bed, group, &g, &radii);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <row> and <ring>: bodies at equal distances on a straight line, a circle or an arc. A row and an
 * arc have a body at either end; a spacing is the largest that neighbours may have, the next that
 * fits is taken.
 */
#include "io/case_bodies.h"

#include <math.h>

static const double whole_turn = 6.283185307179586;
static const double rounding = 1e-9; /* of a number of spaces: what just fits, fits */

/* Largest distance of neighbours: as given, or such that they touch. NaN if it is not to be known.
 */
static double read_spacing(struct calx_reader *r, const xmlNode *node, double radius)
{
    return calx_case_given(node, "spacing") ? calx_case_number(r, node, "spacing") : 2 * radius;
}

/* Bodies on a line of `length` with spaces of at most `spacing`, in the same unit; 0 and a problem
 * if they cannot be counted. `ends`: 1 if both ends are occupied, 0 if they are one. */
static size_t read_count(struct calx_reader *r, const xmlNode *node, double length, double spacing,
                         size_t ends)
{
    double spaces = ceil(length / spacing - rounding);
    int64_t count = calx_case_whole(r, node, "count");
    bool given = calx_case_given(node, "count") != NULL;
    if (given && calx_case_given(node, "spacing"))
        calx_case_fail(r, node, NULL, "has both 'count' and 'spacing', expected one");
    else if (given && count > CALX_MOST_BODIES)
        calx_case_fail(r, node, "count", "more than %d bodies", CALX_MOST_BODIES);
    else if (given)
        return count > 0 ? (size_t)count : 0;
    else if (!(spaces < CALX_MOST_BODIES))
        calx_case_fail(r, node, "spacing", "more than %d bodies", CALX_MOST_BODIES);
    else
        return (size_t)fmax(spaces, 1) + ends;
    return 0;
}

void calx_case_read_row(struct calx_bed *bed, struct calx_group *group)
{
    struct calx_reader *r = bed->reader;
    const xmlNode *node = group->node;
    double from[3], to[3], radius = calx_case_radius(r, node), length2 = 0;
    if (!calx_case_vector(r, node, "from", from) || !calx_case_vector(r, node, "to", to) ||
        isnan(radius))
        return;
    for (size_t k = 0; k < 3; k++)
        length2 += (to[k] - from[k]) * (to[k] - from[k]);
    double spacing = read_spacing(r, node, radius);
    size_t count = isnan(spacing) ? 0 : read_count(r, node, sqrt(length2), spacing, 1);
    for (size_t i = 0; i < count; i++) {
        double at[3], share = count > 1 ? (double)i / (double)(count - 1) : 0;
        for (size_t k = 0; k < 3; k++)
            at[k] = from[k] + share * (to[k] - from[k]);
        if (calx_case_place_body(bed, group, at, radius) < 0)
            return;
    }
}

struct ring {
    double center[3], distance, from, turn; /* turn: rad, of the arc */
    double u[3], v[3];                      /* unit vectors at angle 0 and a quarter turn on */
    bool closed;
};

/* Across the axis n: u nearest to x, or to y where n is x. */
static void span(const double n[3], double u[3], double v[3])
{
    int along = hypot(n[1], n[2]) > rounding * fabs(n[0]) ? 0 : 1;
    double size2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], length = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = (k == along) - n[along] * n[k] / size2;
        length += u[k] * u[k];
    }
    for (int k = 0; k < 3; k++)
        u[k] /= sqrt(length);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        v[k] = (n[a] * u[b] - n[b] * u[a]) / sqrt(size2);
    }
}

static bool read_axis(struct calx_reader *r, const xmlNode *node, struct ring *ring)
{
    double axis[3] = {0, 0, 1};
    bool given = calx_case_given(node, "axis") != NULL;
    if (given && r->scene->dimension == 2) {
        calx_case_fail(r, node, "axis", "is for 3D");
        return false;
    }
    if (given && !calx_case_vector(r, node, "axis", axis))
        return false;
    if (axis[0] == 0 && axis[1] == 0 && axis[2] == 0) {
        calx_case_fail(r, node, "axis", "has no direction");
        return false;
    }
    span(axis, ring->u, ring->v);
    return true;
}

static bool read_arc(struct calx_reader *r, const xmlNode *node, struct ring *ring)
{
    bool from = calx_case_given(node, "from") != NULL, to = calx_case_given(node, "to") != NULL;
    double first = from ? calx_case_number(r, node, "from") : 0,
           last = to ? calx_case_number(r, node, "to") : 0;
    ring->closed = !from && !to;
    ring->from = first;
    ring->turn = ring->closed ? whole_turn : last - first;
    if (from != to)
        calx_case_fail(r, node, from ? "from" : "to", "'from' and 'to' are given together");
    else if (!ring->closed && !(ring->turn > 0 && ring->turn < whole_turn))
        calx_case_fail(r, node, "to",
                       "%g rad after 'from', expected more than 0 and less than a whole turn",
                       ring->turn);
    else
        return !isnan(first) && !isnan(last);
    return false;
}

/* Angle between neighbours whose centres are `spacing` apart, NaN and a problem if they cannot be.
 */
static double angle_of(struct calx_reader *r, const xmlNode *node, const struct ring *ring,
                       double spacing)
{
    if (spacing > 2 * ring->distance)
        calx_case_fail(r, node, calx_case_given(node, "spacing") ? "spacing" : "distance",
                       "neighbours %g m apart do not lie on a circle of radius %g m", spacing,
                       ring->distance);
    return spacing > 2 * ring->distance ? NAN : 2 * asin(spacing / (2 * ring->distance));
}

static void place_ring(struct calx_bed *bed, struct calx_group *group, const struct ring *ring,
                       double radius, size_t count)
{
    double spaces = ring->closed ? (double)count : (double)count - 1;
    for (size_t i = 0; i < count; i++) {
        double at[3], angle = ring->from + (spaces > 0 ? (double)i / spaces : 0) * ring->turn;
        for (size_t k = 0; k < 3; k++)
            at[k] = ring->center[k] +
                    ring->distance * (cos(angle) * ring->u[k] + sin(angle) * ring->v[k]);
        if (calx_case_place_body(bed, group, at, radius) < 0)
            return;
    }
}

void calx_case_read_ring(struct calx_bed *bed, struct calx_group *group)
{
    struct calx_reader *r = bed->reader;
    const xmlNode *node = group->node;
    struct ring ring = {.distance = calx_case_number(r, node, "distance")};
    double radius = calx_case_radius(r, node);
    calx_case_vector(r, node, "center", ring.center);
    if (!read_axis(r, node, &ring) || !read_arc(r, node, &ring) || isnan(radius) ||
        isnan(ring.distance))
        return;
    double spacing = read_spacing(r, node, radius);
    bool counted = calx_case_given(node, "count") != NULL;
    double angle = isnan(spacing) || counted ? ring.turn : angle_of(r, node, &ring, spacing);
    size_t count = isnan(angle) ? 0 : read_count(r, node, ring.turn, angle, !ring.closed);
    place_ring(bed, group, &ring, radius, count);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Geometry of the regions that bodies are packed into: inside or not, distance to the walls,
 * volume. Inputs: the region (core/region.h), points, radii; output: gaps and overlaps in m. Inside
 * an outline: even-odd rule along a ray in x. Volumes of cut and curved regions: midpoint rule over
 * lines along x, whose length inside is exact.
 */
#include "core/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char axis_name[3] = {'x', 'y', 'z'};

void calx_region_init(struct calx_region *region, uint32_t dimension)
{
    *region =
        (struct calx_region){.kind = CALX_REGION_BOX, .dimension = dimension, .axis = {0, 0, 1}};
    for (int k = 0; k < 3; k++) {
        region->low[k] = -INFINITY;
        region->high[k] = INFINITY;
    }
}

void calx_region_clear(struct calx_region *region)
{
    free(region->edges);
    free(region->obstacles);
    region->edges = region->obstacles = NULL;
    region->edge_count = region->obstacle_count = 0;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- distances ---- */

static double push_box(const struct calx_region *region, const double x[3], double radius,
                       double push[3])
{
    double deepest = -INFINITY;
    for (uint32_t k = 0; k < region->dimension; k++) {
        if (region->periodic[k])
            continue;
        double below = region->low[k] + radius - x[k], above = x[k] + radius - region->high[k];
        push[k] += fmax(0, below) - fmax(0, above);
        deepest = fmax(deepest, fmax(below, above));
    }
    return deepest;
}

/* Overlap with the inner side of a curved wall: `out` is the vector from its centre or axis to x.
 */
static double push_curved(double wall, const double out[3], double radius, double push[3])
{
    double distance = sqrt(dot(out, out)), overlap = distance + radius - wall;
    if (overlap > 0 && distance > 0)
        for (int k = 0; k < 3; k++)
            push[k] -= overlap * out[k] / distance;
    return overlap;
}

static double push_ball(const struct calx_region *region, const double x[3], double radius,
                        double push[3])
{
    double out[3] = {0};
    for (uint32_t k = 0; k < region->dimension; k++)
        out[k] = x[k] - region->centre[k];
    return push_curved(region->radius, out, radius, push);
}

static bool has_ends(const struct calx_region *region)
{
    return region->length > 0 && isfinite(region->length);
}

static double push_cylinder(const struct calx_region *region, const double x[3], double radius,
                            double push[3])
{
    double out[3], axis[3], size = sqrt(dot(region->axis, region->axis));
    for (int k = 0; k < 3; k++) {
        out[k] = x[k] - region->centre[k];
        axis[k] = region->axis[k] / size;
    }
    double along = dot(out, axis);
    for (int k = 0; k < 3; k++)
        out[k] -= along * axis[k];
    double deepest = push_curved(region->radius, out, radius, push);
    if (!has_ends(region))
        return deepest;
    double overlap = fabs(along) + radius - region->length / 2;
    for (int k = 0; k < 3; k++)
        push[k] -= fmax(0, overlap) * copysign(1, along) * axis[k];
    return fmax(deepest, overlap);
}

static double push_nothing(const struct calx_region *region, const double x[3], double radius,
                           double push[3])
{
    (void)region;
    (void)x;
    (void)radius;
    (void)push;
    return -INFINITY;
}

static double (*const push_kind[])(const struct calx_region *, const double[3], double,
                                   double[3]) = {
    [CALX_REGION_BOX] = push_nothing,
    [CALX_REGION_BALL] = push_ball,
    [CALX_REGION_CYLINDER] = push_cylinder,
    [CALX_REGION_OUTLINE] = push_nothing,
};

double calx_region_push(const struct calx_region *region, const double x[3], double radius,
                        double push[3])
{
    double reach = radius + region->clearance;
    double box = push_box(region, x, reach, push);
    return fmax(box, push_kind[region->kind](region, x, reach, push));
}

double calx_region_edge(const double edge[4], const double x[3], double away[2])
{
    double dx = edge[2] - edge[0], dy = edge[3] - edge[1], px = x[0] - edge[0], py = x[1] - edge[1];
    double square = dx * dx + dy * dy, t = square > 0 ? (px * dx + py * dy) / square : 0;
    t = fmin(1, fmax(0, t));
    away[0] = px - t * dx;
    away[1] = py - t * dy;
    return hypot(away[0], away[1]);
}

static bool clear_of(const double (*edges)[4], size_t count, const double x[3], double reach)
{
    double away[2];
    for (size_t e = 0; e < count; e++)
        if (calx_region_edge(edges[e], x, away) < reach)
            return false;
    return true;
}

/* Where the line y = level crosses an edge, if it does. An end on the line counts for the edge
 * above only. */
static bool crosses(const double edge[4], double level, double *x)
{
    if ((edge[1] > level) == (edge[3] > level))
        return false;
    *x = edge[0] + (level - edge[1]) / (edge[3] - edge[1]) * (edge[2] - edge[0]);
    return true;
}

static bool inside_outlines(const struct calx_region *region, const double x[3])
{
    bool inside = false;
    double at;
    for (size_t e = 0; e < region->edge_count; e++)
        if (crosses(region->edges[e], x[1], &at) && at > x[0])
            inside = !inside;
    return inside;
}

bool calx_region_holds(const struct calx_region *region, const double x[3], double radius)
{
    double push[3] = {0}, reach = radius + region->clearance;
    if (calx_region_push(region, x, radius, push) > 0)
        return false;
    if (region->kind == CALX_REGION_OUTLINE &&
        !(clear_of(region->edges, region->edge_count, x, reach) && inside_outlines(region, x)))
        return false;
    return clear_of(region->obstacles, region->obstacle_count, x, reach);
}

/* ---- bounds and volume ---- */

/* Cuts low ... high by the extent of the kind. */
static void cut_by_kind(const struct calx_region *region, double low[3], double high[3])
{
    double size = sqrt(dot(region->axis, region->axis));
    for (uint32_t k = 0; k < region->dimension; k++) {
        double half = INFINITY, a = region->axis[k] / size;
        bool across = fabs(a) < 1e-9; /* but for rounding, the axis is normal to k */
        if (region->kind == CALX_REGION_BALL)
            half = region->radius;
        if (region->kind == CALX_REGION_CYLINDER && (has_ends(region) || across))
            half = region->radius * sqrt(fmax(0, 1 - a * a)) +
                   (across ? 0 : region->length / 2 * fabs(a));
        low[k] = fmax(low[k], region->centre[k] - half);
        high[k] = fmin(high[k], region->centre[k] + half);
    }
    if (region->kind != CALX_REGION_OUTLINE)
        return;
    for (int k = 0; k < 2; k++) {
        double least = INFINITY, most = -INFINITY;
        for (size_t e = 0; e < region->edge_count; e++) {
            least = fmin(least, region->edges[e][k]);
            most = fmax(most, region->edges[e][k]);
        }
        low[k] = fmax(low[k], least);
        high[k] = fmin(high[k], most);
    }
}

static bool finite_edges(double (*edges)[4], size_t count)
{
    for (size_t e = 0; e < count; e++)
        for (int k = 0; k < 4; k++)
            if (!isfinite(edges[e][k]))
                return false;
    return true;
}

static const char *find_mistake(const struct calx_region *region)
{
    bool round = region->kind == CALX_REGION_BALL || region->kind == CALX_REGION_CYLINDER;
    double middle = region->centre[0] + region->centre[1] + region->centre[2];
    if (region->dimension != 2 && region->dimension != 3)
        return "has no dimension 2 or 3";
    if (region->kind == CALX_REGION_CYLINDER && region->dimension == 2)
        return "is a cylinder, which exists in 3D only (a circle is meant)";
    if (round && !(region->radius > 0 && isfinite(region->radius) && isfinite(middle)))
        return "needs a finite centre and a positive radius";
    if (region->kind == CALX_REGION_CYLINDER &&
        !(dot(region->axis, region->axis) > 0 && region->length >= 0))
        return "needs an axis and a length that is not negative";
    if (!(region->clearance >= 0) || !isfinite(region->clearance))
        return "has a negative clearance";
    if (region->kind == CALX_REGION_OUTLINE && region->edge_count < 3)
        return "has no closed outline";
    if (!finite_edges(region->edges, region->edge_count) ||
        !finite_edges(region->obstacles, region->obstacle_count))
        return "has a segment that is not finite";
    return NULL;
}

int calx_region_bounds(const struct calx_region *region, double low[3], double high[3],
                       struct calx_error *error)
{
    const char *mistake = find_mistake(region);
    if (mistake)
        return calx_error_set(error, CALX_ERROR_INPUT, "the region to fill %s", mistake);
    memcpy(low, region->low, sizeof region->low);
    memcpy(high, region->high, sizeof region->high);
    cut_by_kind(region, low, high);
    for (uint32_t k = 0; k < region->dimension; k++) {
        if (region->periodic[k] && !(isfinite(region->low[k]) && isfinite(region->high[k])))
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "the region to fill is periodic in %c but has no extent there",
                                  axis_name[k]);
        if (!isfinite(low[k]) || !isfinite(high[k]))
            return calx_error_set(error, CALX_ERROR_INPUT, "the region to fill is endless in %c",
                                  axis_name[k]);
        if (!(high[k] > low[k]))
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "the region to fill is empty: %c from %g to %g m", axis_name[k],
                                  low[k], high[k]);
    }
    if (region->dimension == 2)
        low[2] = high[2] = 0;
    return CALX_OK;
}

/* Cuts the interval span of x to where |p + x q|^2 <= r^2. */
static void cut_quadratic(double pp, double pq, double qq, double r, double span[2])
{
    double square = pq * pq - qq * (pp - r * r);
    if (qq <= 0) { /* the line runs along the axis */
        if (pp > r * r)
            span[1] = span[0];
        return;
    }
    double middle = -pq / qq, half = square > 0 ? sqrt(square) / qq : 0;
    span[0] = fmax(span[0], middle - half);
    span[1] = fmin(span[1], middle + half);
}

static void cut_span(const struct calx_region *region, double y, double z, double span[2])
{
    double p[3] = {-region->centre[0], y - region->centre[1], z - region->centre[2]},
           q[3] = {1, 0, 0};
    if (region->kind == CALX_REGION_CYLINDER) {
        double size = sqrt(dot(region->axis, region->axis)), axis[3];
        for (int k = 0; k < 3; k++)
            axis[k] = region->axis[k] / size;
        double pa = dot(p, axis), qa = axis[0];
        if (has_ends(region) && qa != 0) {
            double one = (-region->length / 2 - pa) / qa, two = (region->length / 2 - pa) / qa;
            span[0] = fmax(span[0], fmin(one, two));
            span[1] = fmin(span[1], fmax(one, two));
        } else if (has_ends(region) && fabs(pa) > region->length / 2) {
            span[1] = span[0];
        }
        for (int k = 0; k < 3; k++) {
            p[k] -= pa * axis[k];
            q[k] -= qa * axis[k];
        }
    }
    cut_quadratic(dot(p, p), dot(p, q), dot(q, q), region->radius, span);
}

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Length of the line at y inside the outlines and between low and high; `room` holds one number per
 * edge. */
static double length_inside(const struct calx_region *region, double y, double low, double high,
                            double *room)
{
    size_t count = 0;
    for (size_t e = 0; e < region->edge_count; e++)
        count += crosses(region->edges[e], y, &room[count]);
    qsort(room, count, sizeof *room, compare_numbers);
    double length = 0;
    for (size_t i = 0; i + 1 < count; i += 2)
        length += fmax(0, fmin(high, room[i + 1]) - fmax(low, room[i]));
    return length;
}

static double outline_volume(const struct calx_region *region, const double low[3],
                             const double high[3])
{
    const int lines = 8192;
    double *room = malloc((region->edge_count + 1) * sizeof *room), sum = 0;
    if (!room)
        return NAN;
    for (int i = 0; i < lines; i++)
        sum += length_inside(region, low[1] + (high[1] - low[1]) * (i + 0.5) / lines, low[0],
                             high[0], room);
    free(room);
    return sum * (high[1] - low[1]) / lines;
}

static double round_volume(const struct calx_region *region, const double low[3],
                           const double high[3])
{
    const int rows = region->dimension == 2 ? 16384 : 1024,
              layers = region->dimension == 2 ? 1 : 1024;
    double sum = 0;
    for (int j = 0; j < layers; j++) {
        for (int i = 0; i < rows; i++) {
            double y = low[1] + (high[1] - low[1]) * (i + 0.5) / rows,
                   z = low[2] + (high[2] - low[2]) * (j + 0.5) / layers;
            double span[2] = {low[0], high[0]};
            cut_span(region, y, region->dimension == 2 ? region->centre[2] : z, span);
            sum += fmax(0, span[1] - span[0]);
        }
    }
    return sum * (high[1] - low[1]) / rows *
           (region->dimension == 2 ? 1 : (high[2] - low[2]) / layers);
}

double calx_region_volume(const struct calx_region *region)
{
    double low[3], high[3];
    if (calx_region_bounds(region, low, high, NULL))
        return NAN;
    double depth = region->dimension == 2 ? 1 : high[2] - low[2];
    if (region->kind == CALX_REGION_BOX)
        return (high[0] - low[0]) * (high[1] - low[1]) * depth;
    if (region->kind == CALX_REGION_OUTLINE)
        return outline_volume(region, low, high) * depth;
    return round_volume(region, low, high);
}

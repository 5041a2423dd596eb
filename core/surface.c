/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The nearest point of a wall primitive to a centre: signed distance (negative behind a plane, a cylinder's or a sphere's surface), the
 * unit normal towards the grain, and whether the point is an end (of a segment, the rim of a cylinder).
 */
#include <math.h>

#include "core/state.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Away from `point` to x; `fallback` where they coincide. */
static void point_normal(struct calx_touch *t, const double x[3], const double fallback[3])
{
    double d[3] = {x[0] - t->point[0], x[1] - t->point[1], x[2] - t->point[2]};
    t->distance = sqrt(dot(d, d));
    for (int k = 0; k < 3; k++)
        t->normal[k] = t->distance > 0.0 ? d[k] / t->distance : fallback[k];
}

static void nearest_segment(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    double ux = p->b[0] - p->a[0], uy = p->b[1] - p->a[1];
    double length2 = ux * ux + uy * uy, length = sqrt(length2);
    double s = ((x[0] - p->a[0]) * ux + (x[1] - p->a[1]) * uy) / length2;
    t->end = s <= 0.0 || s >= 1.0;
    const double side[3] = {-uy / length, ux / length, 0.0};
    t->point[2] = x[2];
    if (s <= 0.0 || s >= 1.0) {
        t->point[0] = s <= 0.0 ? p->a[0] : p->b[0];
        t->point[1] = s <= 0.0 ? p->a[1] : p->b[1];
        point_normal(t, x, side);
        return;
    }
    double off = (x[0] - p->a[0]) * side[0] + (x[1] - p->a[1]) * side[1], sign = off < 0.0 ? -1.0 : 1.0;
    t->distance = fabs(off);
    for (int k = 0; k < 2; k++) {
        t->normal[k] = sign * side[k];
        t->point[k] = x[k] - off * side[k];
    }
    t->normal[2] = 0.0;
}

static void nearest_plane(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    const double d[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]};
    t->distance = dot(d, p->n);
    for (int k = 0; k < 3; k++) {
        t->normal[k] = p->n[k];
        t->point[k] = x[k] - t->distance * p->n[k];
    }
    t->end = false;
}

/* From radial offset `out` (length rho) of the axis or centre `foot`. */
static void nearest_round(const struct calx_primitive *p, const double foot[3], const double out[3],
                          struct calx_touch *t)
{
    double rho = sqrt(dot(out, out)), sign = p->inside ? -1.0 : 1.0;
    t->distance = sign * (rho - p->radius);
    for (int k = 0; k < 3; k++) {
        double radial = rho > 0.0 ? out[k] / rho : (k == 0);
        t->normal[k] = sign * radial;
        t->point[k] = foot[k] + p->radius * radial;
    }
    t->end = false;
}

static void nearest_cylinder(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    double d[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]}, h = dot(d, p->n), foot[3], out[3];
    double half = 0.5 * p->length, clamped = p->length > 0.0 && fabs(h) > half ? copysign(half, h) : h;
    for (int k = 0; k < 3; k++) {
        out[k] = d[k] - h * p->n[k];
        foot[k] = p->a[k] + clamped * p->n[k];
    }
    nearest_round(p, foot, out, t);
    if (clamped != h) {
        const double fallback[3] = {t->normal[0], t->normal[1], t->normal[2]};
        t->end = true;
        point_normal(t, x, fallback);
    }
}

static void nearest_sphere(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    const double out[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]};
    nearest_round(p, p->a, out, t);
}

void calx_surface_nearest(const struct calx_primitive *p, uint32_t dimension, const double x[3],
                          struct calx_touch *t)
{
    static void (*const nearest[])(const struct calx_primitive *, const double *, struct calx_touch *) = {
        [CALX_SEGMENT] = nearest_segment, [CALX_PLANE] = nearest_plane,
        [CALX_CYLINDER] = nearest_cylinder, [CALX_SPHERE] = nearest_sphere};
    nearest[p->shape](p, x, t);
    if (dimension == 2)
        t->normal[2] = 0.0;
}

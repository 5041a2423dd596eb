/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the nearest point of a wall primitive to a centre: signed distance (negative behind a plane, a cylinder's or a sphere's
 * surface), the unit normal towards the grain, and whether the point is an end (of a segment, the rim of a cylinder); and the velocity of
 * that point. In a header, because it is worked out for each grain near a wall in every step: surface.c has the functions that others call.
 */
#ifndef CALX_SURFACE_H
#define CALX_SURFACE_H

#include <math.h>

#include "core/state.h"

static inline double calx_surface_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Away from `point` to x; `fallback` where they coincide. */
static inline void calx_surface_point_normal(struct calx_touch *t, const double x[3], const double fallback[3])
{
    double d[3] = {x[0] - t->point[0], x[1] - t->point[1], x[2] - t->point[2]};
    t->distance = sqrt(calx_surface_dot(d, d));
    for (int k = 0; k < 3; k++)
        t->normal[k] = t->distance > 0.0 ? d[k] / t->distance : fallback[k];
}

static inline void calx_surface_segment(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
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
        calx_surface_point_normal(t, x, side);
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

static inline void calx_surface_plane(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    const double d[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]};
    t->distance = calx_surface_dot(d, p->n);
    for (int k = 0; k < 3; k++) {
        t->normal[k] = p->n[k];
        t->point[k] = x[k] - t->distance * p->n[k];
    }
    t->end = false;
}

/* From radial offset `out` (length rho) of the axis or centre `foot`. */
static inline void calx_surface_round(const struct calx_primitive *p, const double foot[3], const double out[3],
                          struct calx_touch *t)
{
    double rho = sqrt(calx_surface_dot(out, out)), sign = p->inside ? -1.0 : 1.0;
    t->distance = sign * (rho - p->radius);
    for (int k = 0; k < 3; k++) {
        double radial = rho > 0.0 ? out[k] / rho : (k == 0);
        t->normal[k] = sign * radial;
        t->point[k] = foot[k] + p->radius * radial;
    }
    t->end = false;
}

static inline void calx_surface_cylinder(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    double d[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]}, h = calx_surface_dot(d, p->n), foot[3], out[3];
    double half = 0.5 * p->length, clamped = p->length > 0.0 && fabs(h) > half ? copysign(half, h) : h;
    for (int k = 0; k < 3; k++) {
        out[k] = d[k] - h * p->n[k];
        foot[k] = p->a[k] + clamped * p->n[k];
    }
    calx_surface_round(p, foot, out, t);
    if (clamped != h) {
        const double fallback[3] = {t->normal[0], t->normal[1], t->normal[2]};
        t->end = true;
        calx_surface_point_normal(t, x, fallback);
    }
}

static inline void calx_surface_sphere(const struct calx_primitive *p, const double x[3], struct calx_touch *t)
{
    const double out[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]};
    calx_surface_round(p, p->a, out, t);
}

/* A switch, not a table: each case is to be inlined. */
static inline void calx_surface_touch(const struct calx_primitive *p, uint32_t dimension, const double x[3],
                                      struct calx_touch *t)
{
    switch (p->shape) {
    case CALX_SEGMENT: calx_surface_segment(p, x, t); break;
    case CALX_PLANE: calx_surface_plane(p, x, t); break;
    case CALX_CYLINDER: calx_surface_cylinder(p, x, t); break;
    default: calx_surface_sphere(p, x, t);
    }
    if (dimension == 2)
        t->normal[2] = 0.0;
}

/* speed + spin x at */
static inline void calx_surface_velocity(const double speed[3], const double spin[3], const double at[3], double out[3])
{
    out[0] = speed[0] + (spin[1] * at[2] - spin[2] * at[1]);
    out[1] = speed[1] + (spin[2] * at[0] - spin[0] * at[2]);
    out[2] = speed[2] + (spin[0] * at[1] - spin[1] * at[0]);
}

/* At the moment that the velocities of the grains belong to, of what was then under the grain that now touches `at` and moves with
 * `carried`. */
static inline void calx_surface_past_velocity(const struct calx_pose *p, const double at[3], const double carried[3],
                                              double out[3])
{
    const double there[3] = {at[0] - p->ago * carried[0], at[1] - p->ago * carried[1], at[2] - p->ago * carried[2]};
    calx_surface_velocity(p->past_speed, p->past_spin, there, out);
}

#endif

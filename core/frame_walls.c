/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Walls as points and flat cells at their present pose: segments as they are, planes as squares around the scene, circles and cylinders
 * as facets, spheres as a net of latitude and longitude.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/frame.h"

enum { FACETS = 96, RINGS = 24 };

static void extent(const struct calx_sim *s, double centre[3], double *half)
{
    double lo[3] = {0}, hi[3] = {0};
    bool first = true;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            for (int k = 0; k < 3; k++) {
                const double *x = calx_row_x(s, row);
                lo[k] = first || x[k] - x[3] < lo[k] ? x[k] - x[3] : lo[k];
                hi[k] = first || x[k] + x[3] > hi[k] ? x[k] + x[3] : hi[k];
                first = first && k < 2;
            }
    *half = 0.0;
    for (int k = 0; k < 3; k++) {
        if (s->scene->periodic[k] || s->scene->bounded[k]) {
            lo[k] = s->scene->low[k];
            hi[k] = s->scene->high[k];
        }
        centre[k] = 0.5 * (lo[k] + hi[k]);
        *half = fmax(*half, 0.5 * (hi[k] - lo[k]));
    }
}

/* Two unit vectors that complete n to a right-handed frame. */
static void complete(const double n[3], double u[3], double v[3])
{
    int least = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0 : fabs(n[1]) <= fabs(n[2]) ? 1 : 2;
    double a[3] = {0};
    a[least] = 1.0;
    u[0] = a[1] * n[2] - a[2] * n[1];
    u[1] = a[2] * n[0] - a[0] * n[2];
    u[2] = a[0] * n[1] - a[1] * n[0];
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++)
        u[k] /= length;
    v[0] = n[1] * u[2] - n[2] * u[1];
    v[1] = n[2] * u[0] - n[0] * u[2];
    v[2] = n[0] * u[1] - n[1] * u[0];
}

struct mesh {
    const struct calx_sim *s;
    struct calx_frame *f;
    double centre[3], half;
};

static int32_t add_point(struct mesh *m, int32_t wall, double x, double y, double z)
{
    double *p = m->f->wall_position[m->f->wall_points];
    p[0] = x;
    p[1] = y;
    p[2] = z;
    calx_walls_velocity(m->s, wall, p, m->f->wall_velocity[m->f->wall_points]);
    return (int32_t)m->f->wall_points++;
}

static void add_cell(struct mesh *m, int32_t wall, int32_t a, int32_t b, int32_t c, int32_t d)
{
    size_t k = m->f->wall_cells++;
    const int32_t corner[4] = {a, b, c, d};
    for (int q = 0; q < 4; q++)
        m->f->wall_cell[k][q] = corner[q];
    m->f->wall_of_cell[k] = wall;
}

/* A line in 2D; in 3D the strip between two heights. */
static void add_line(struct mesh *m, int32_t wall, const double a[3], const double b[3])
{
    if (m->f->dimension == 2) {
        int32_t p = add_point(m, wall, a[0], a[1], 0.0), q = add_point(m, wall, b[0], b[1], 0.0);
        add_cell(m, wall, p, q, -1, -1);
        return;
    }
    double lo = m->centre[2] - m->half, hi = m->centre[2] + m->half;
    if (m->s->scene->periodic[2]) {
        lo = m->s->scene->low[2];
        hi = m->s->scene->high[2];
    }
    int32_t p = add_point(m, wall, a[0], a[1], lo), q = add_point(m, wall, b[0], b[1], lo);
    int32_t r = add_point(m, wall, b[0], b[1], hi), t = add_point(m, wall, a[0], a[1], hi);
    add_cell(m, wall, p, q, r, t);
}

static void mesh_segment(struct mesh *m, int32_t wall, const struct calx_primitive *p)
{
    add_line(m, wall, p->a, p->b);
}

static void mesh_plane(struct mesh *m, int32_t wall, const struct calx_primitive *p)
{
    double u[3], v[3], foot[3], h = 0.0, size = 1.2 * m->half;
    for (int k = 0; k < 3; k++)
        h += (m->centre[k] - p->a[k]) * p->n[k];
    for (int k = 0; k < 3; k++)
        foot[k] = m->centre[k] - h * p->n[k];
    if (m->f->dimension == 2) {
        double a[3] = {foot[0] - size * p->n[1], foot[1] + size * p->n[0], 0.0};
        double b[3] = {foot[0] + size * p->n[1], foot[1] - size * p->n[0], 0.0};
        add_line(m, wall, a, b);
        return;
    }
    complete(p->n, u, v);
    int32_t corner[4];
    for (int q = 0; q < 4; q++) {
        double su = q == 1 || q == 2 ? size : -size, sv = q >= 2 ? size : -size;
        corner[q] = add_point(m, wall, foot[0] + su * u[0] + sv * v[0], foot[1] + su * u[1] + sv * v[1],
                              foot[2] + su * u[2] + sv * v[2]);
    }
    add_cell(m, wall, corner[0], corner[1], corner[2], corner[3]);
}

/* A ring of facets of radius `radius` around the axis point; returns its first point. */
static int32_t add_ring(struct mesh *m, int32_t wall, const double at[3], const double u[3], const double v[3],
                        double radius)
{
    int32_t first = (int32_t)m->f->wall_points;
    for (int k = 0; k < FACETS; k++) {
        double c = radius * cos(2.0 * M_PI * k / FACETS), s = radius * sin(2.0 * M_PI * k / FACETS);
        add_point(m, wall, at[0] + c * u[0] + s * v[0], at[1] + c * u[1] + s * v[1],
                  at[2] + c * u[2] + s * v[2]);
    }
    return first;
}

static void join_rings(struct mesh *m, int32_t wall, int32_t a, int32_t b)
{
    for (int k = 0; k < FACETS; k++) {
        int next = (k + 1) % FACETS;
        if (a == b)
            add_cell(m, wall, a + k, a + next, -1, -1);
        else
            add_cell(m, wall, a + k, a + next, b + next, b + k);
    }
}

static void mesh_cylinder(struct mesh *m, int32_t wall, const struct calx_primitive *p)
{
    double u[3], v[3], from[3], to[3], middle = 0.0, half = p->length > 0.0 ? 0.5 * p->length : m->half;
    complete(p->n, u, v);
    for (int k = 0; k < 3 && !(p->length > 0.0); k++)
        middle += (m->centre[k] - p->a[k]) * p->n[k];
    for (int k = 0; k < 3 && !(p->length > 0.0); k++)
        if (m->s->scene->periodic[k] && fabs(p->n[k]) > 0.999)
            half = 0.5 * (m->s->scene->high[k] - m->s->scene->low[k]);
    for (int k = 0; k < 3; k++) {
        from[k] = p->a[k] + (middle - half) * p->n[k];
        to[k] = p->a[k] + (middle + half) * p->n[k];
    }
    if (m->f->dimension == 2) {
        int32_t ring = add_ring(m, wall, p->a, u, v, p->radius);
        join_rings(m, wall, ring, ring);
        return;
    }
    int32_t a = add_ring(m, wall, from, u, v, p->radius), b = add_ring(m, wall, to, u, v, p->radius);
    join_rings(m, wall, a, b);
}

static void mesh_sphere(struct mesh *m, int32_t wall, const struct calx_primitive *p)
{
    static const double u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
    int32_t before = -1;
    for (int k = 0; k <= RINGS; k++) {
        double polar = M_PI * k / RINGS, at[3] = {p->a[0], p->a[1], p->a[2] + p->radius * cos(polar)};
        if (m->f->dimension == 2) {
            int32_t ring = add_ring(m, wall, p->a, u, v, p->radius);
            join_rings(m, wall, ring, ring);
            return;
        }
        int32_t ring = add_ring(m, wall, at, u, v, p->radius * sin(polar));
        if (before >= 0)
            join_rings(m, wall, before, ring);
        before = ring;
    }
}

static int allocate(struct calx_sim *s, struct calx_frame *f)
{
    static const size_t most[] = {[CALX_SEGMENT] = 4, [CALX_PLANE] = 4, [CALX_CYLINDER] = 2 * FACETS,
                                  [CALX_SPHERE] = (RINGS + 1) * FACETS};
    size_t points = 0;
    for (size_t p = 0; p < s->primitive_count; p++)
        points += most[s->posed[p].p.shape];
    f->wall_position = calx_memory_zeroed(points, sizeof *f->wall_position);
    f->wall_velocity = calx_memory_zeroed(points, sizeof *f->wall_velocity);
    f->wall_cell = calx_memory_zeroed(points, sizeof *f->wall_cell);
    f->wall_of_cell = calx_memory_zeroed(points, sizeof *f->wall_of_cell);
    f->wall_force = calx_memory_zeroed(points, sizeof *f->wall_force);
    f->wall_temperature = s->features.temperature ? calx_memory_zeroed(points, sizeof(double)) : NULL;
    return !f->wall_position || !f->wall_velocity || !f->wall_cell || !f->wall_of_cell || !f->wall_force ||
           (s->features.temperature && !f->wall_temperature);
}

static int copy_totals(const struct calx_sim *s, struct calx_frame *f)
{
    f->walls = s->scene->wall_count;
    f->force_on_wall = calx_memory_zeroed(f->walls, sizeof *f->force_on_wall);
    f->displacement_of_wall = calx_memory_zeroed(f->walls, sizeof *f->displacement_of_wall);
    f->velocity_of_wall = calx_memory_zeroed(f->walls, sizeof *f->velocity_of_wall);
    f->temperature_of_wall = s->features.temperature ? calx_memory_zeroed(f->walls, sizeof(double)) : NULL;
    if (!f->force_on_wall || !f->displacement_of_wall || !f->velocity_of_wall || (s->features.temperature && !f->temperature_of_wall))
        return 1;
    memcpy(f->force_on_wall, s->wall_force, f->walls * sizeof *f->force_on_wall);
    for (size_t w = 0; w < f->walls; w++) {
        memcpy(f->displacement_of_wall[w], s->poses[w].shift, sizeof f->displacement_of_wall[w]);
        calx_walls_velocity(s, (int)w, s->poses[w].shift, f->velocity_of_wall[w]);
    }
    for (size_t w = 0; f->temperature_of_wall && w < f->walls; w++)
        f->temperature_of_wall[w] = s->scene->walls[w].isothermal       ? s->wall_temperature[w]
                                    : calx_wall_has_slab(s, (int)w) ? calx_slabs_mean(s, (int)w, true)
                                                                    : NAN;
    return 0;
}

int calx_frame_walls(struct calx_sim *s, struct calx_frame *f)
{
    static void (*const mesh_of[])(struct mesh *, int32_t, const struct calx_primitive *) = {
        [CALX_SEGMENT] = mesh_segment, [CALX_PLANE] = mesh_plane, [CALX_CYLINDER] = mesh_cylinder,
        [CALX_SPHERE] = mesh_sphere};
    struct mesh m = {.s = s, .f = f};
    f->walls_changed = s->walls_changed;
    s->walls_changed = false;
    if (copy_totals(s, f))
        return 1;
    if (!s->primitive_count)
        return 0;
    if (allocate(s, f))
        return 1;
    extent(s, m.centre, &m.half);
    for (size_t p = 0; p < s->primitive_count; p++)
        mesh_of[s->posed[p].p.shape](&m, s->posed[p].wall, &s->posed[p].p);
    for (size_t c = 0; c < f->wall_cells; c++) {
        int32_t wall = f->wall_of_cell[c];
        for (int k = 0; k < 3; k++)
            f->wall_force[c][k] = f->force_on_wall[wall][k];
        if (f->wall_temperature)
            f->wall_temperature[c] = f->temperature_of_wall[wall];
    }
    return 0;
}

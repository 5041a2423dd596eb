/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The sink of the SVG reader: lines, cubic Beziers and elliptical arcs become chains of segments in
 * metres. A chord over the parameter step h leaves a curve by at most h^2/8 max|B''| (error of
 * linear interpolation), and one over the angle h of an ellipse by at most s (1 - cos(h/2)) with s
 * its half long axis (the unit circle's sagitta, stretched by at most s); the number of equal steps
 * follows from the tolerance.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/region.h"
#include "io/svg_parts.h"

static const size_t most_segments = 1000000;
static const double most_steps = 100000; /* of one curve */
static const double shortest = 1e-3; /* of the tolerance: below it is rounding in the file */
static const double cos_smooth = 0.9659258262890683; /* 15 degrees: more is a corner */

static void transform(const struct calx_svg_matrix *m, const double p[2], double out[2])
{
    double x = p[0], y = p[1];
    out[0] = m->a * x + m->c * y + m->e;
    out[1] = m->b * x + m->d * y + m->f;
}

static double distance(const double a[2], const double b[2])
{
    return hypot(b[0] - a[0], b[1] - a[1]);
}

/* Makes room for one more element; false without memory. */
static bool grow(void **array, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return true;
    size_t wanted = *room ? 2 * *room : 64;
    void *more = realloc(*array, wanted * size);
    if (!more)
        return false;
    *array = more;
    *room = wanted;
    return true;
}

static int no_memory(struct calx_svg_sink *sink)
{
    return calx_error_set(sink->error, CALX_ERROR_MEMORY, "no memory for the shapes of %s",
                          sink->place.file);
}

static struct calx_svg_chain *begin_chain(struct calx_svg_sink *sink)
{
    struct calx_svg *svg = sink->svg;
    if (!grow((void **)&svg->chains, svg->chain_count, &sink->chain_room, sizeof *svg->chains))
        return NULL;
    struct calx_svg_chain *chain = &svg->chains[svg->chain_count++];
    *chain = (struct calx_svg_chain){.first = svg->segment_count, .line = sink->place.line};
    sink->open = true;
    return chain;
}

static bool grow_segments(struct calx_svg_sink *sink)
{
    struct calx_svg *svg = sink->svg;
    size_t room = sink->segment_room; /* both arrays have the same room */
    return grow((void **)&svg->segments, svg->segment_count, &room, sizeof *svg->segments) &&
           grow((void **)&sink->tangents, svg->segment_count, &sink->segment_room,
                sizeof *sink->tangents);
}

/* Adds the segment from where the chain is to p (in m), with the directions of the curve that it
 * stands for. */
static int add(struct calx_svg_sink *sink, const double p[2], const double start[2],
               const double end[2])
{
    struct calx_svg *svg = sink->svg;
    if (!isfinite(p[0]) || !isfinite(p[1]))
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "a coordinate is too large");
    if (distance(sink->at, p) <= shortest * sink->tolerance)
        return CALX_OK;
    if (svg->segment_count >= most_segments)
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "more than %zu segments: raise the tolerance", most_segments);
    if (!sink->open && !begin_chain(sink))
        return no_memory(sink);
    if (!grow_segments(sink))
        return no_memory(sink);
    sink->tangents[svg->segment_count] =
        (struct calx_svg_tangents){{start[0], start[1]}, {end[0], end[1]}};
    svg->segments[svg->segment_count++] = (struct calx_svg_segment){
        .a = {sink->at[0], sink->at[1]}, .b = {p[0], p[1]}, .chain = (int32_t)svg->chain_count - 1};
    svg->chains[svg->chain_count - 1].count++;
    memcpy(sink->at, p, sizeof sink->at);
    return CALX_OK;
}

static int add_line(struct calx_svg_sink *sink, const double p[2])
{
    double direction[2] = {p[0] - sink->at[0], p[1] - sink->at[1]};
    return add(sink, p, direction, direction);
}

int calx_svg_flatten_move(struct calx_svg_sink *sink, const double p[2])
{
    CALX_TRY(calx_svg_flatten_end(sink, false));
    transform(&sink->matrix, p, sink->start);
    memcpy(sink->at, sink->start, sizeof sink->at);
    if (!isfinite(sink->at[0]) || !isfinite(sink->at[1]))
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "a coordinate is too large");
    return CALX_OK;
}

int calx_svg_flatten_line(struct calx_svg_sink *sink, const double p[2])
{
    double q[2];
    transform(&sink->matrix, p, q);
    return add_line(sink, q);
}

static int count_steps(struct calx_svg_sink *sink, double wanted, int *steps)
{
    if (!(wanted <= most_steps))
        return calx_error_at(
            sink->error, CALX_ERROR_INPUT, sink->place,
            "a curve would need more than %g segments: raise the tolerance of %g m", most_steps,
            sink->tolerance);
    *steps = wanted > 1 ? (int)ceil(wanted) : 1;
    return CALX_OK;
}

static void cubic_at(const double p[4][2], double t, double point[2], double tangent[2])
{
    double s = 1 - t;
    for (int k = 0; k < 2; k++) {
        point[k] = s * s * s * p[0][k] + 3 * s * s * t * p[1][k] + 3 * s * t * t * p[2][k] +
                   t * t * t * p[3][k];
        tangent[k] = s * s * (p[1][k] - p[0][k]) + 2 * s * t * (p[2][k] - p[1][k]) +
                     t * t * (p[3][k] - p[2][k]);
    }
}

/* Direction from `from` to the first control point that differs: the tangent where handles have
 * length zero. */
static void end_tangent(const double from[2], const double *const to[3], double sign,
                        double tangent[2])
{
    for (int k = 0; k < 3; k++) {
        tangent[0] = sign * (to[k][0] - from[0]);
        tangent[1] = sign * (to[k][1] - from[1]);
        if (tangent[0] != 0 || tangent[1] != 0)
            return;
    }
}

/* The curve lies in the hull of its control points: with both handles near the chord it is a line.
 */
static bool is_straight(double p[4][2], double tolerance)
{
    const double chord[4] = {p[0][0], p[0][1], p[3][0], p[3][1]};
    const double one[3] = {p[1][0], p[1][1]}, two[3] = {p[2][0], p[2][1]};
    double away[2];
    return calx_region_edge(chord, one, away) <= tolerance &&
           calx_region_edge(chord, two, away) <= tolerance;
}

int calx_svg_flatten_cubic(struct calx_svg_sink *sink, const double user[4][2])
{
    double p[4][2];
    for (int k = 0; k < 4; k++)
        transform(&sink->matrix, user[k], p[k]);
    double bend = 0; /* max|B''| is 6 times the largest second difference of the control points */
    for (int k = 0; k < 2; k++)
        bend = fmax(bend, hypot(p[k][0] - 2 * p[k + 1][0] + p[k + 2][0],
                                p[k][1] - 2 * p[k + 1][1] + p[k + 2][1]));
    int steps = 1;
    if (!is_straight(p, sink->tolerance))
        CALX_TRY(count_steps(sink, sqrt(6 * bend / (8 * sink->tolerance)), &steps));
    double before[2], after[2], point[2];
    end_tangent(p[0], (const double *const[3]){p[1], p[2], p[3]}, 1, before);
    for (int i = 1; i < steps; i++) {
        cubic_at(p, (double)i / steps, point, after);
        CALX_TRY(add(sink, point, before, after));
        memcpy(before, after, sizeof before);
    }
    end_tangent(p[3], (const double *const[3]){p[2], p[1], p[0]}, -1, after);
    return add(sink, p[3], before, after);
}

/* The half long axis of the ellipse with the conjugate half diameters u and v: the larger singular
 * value of [u v]. */
static double long_axis(const double u[2], const double v[2])
{
    double sum = hypot(u[0] + v[1], u[1] - v[0]), difference = hypot(u[0] - v[1], u[1] + v[0]);
    return (sum + difference) / 2;
}

int calx_svg_flatten_arc(struct calx_svg_sink *sink, const double centre[2], const double u[2],
                         const double v[2], double from, double sweep, const double end[2])
{
    const struct calx_svg_matrix *m = &sink->matrix;
    const struct calx_svg_matrix turn = {m->a, m->b, m->c, m->d, 0, 0};
    double c[2], p[2], q[2], last[2];
    transform(m, centre, c);
    transform(&turn, u, p);
    transform(&turn, v, q);
    double axis = long_axis(p, q), cosine = fmax(0, 1 - sink->tolerance / axis);
    int steps = 1;
    CALX_TRY(count_steps(sink, fabs(sweep) / (2 * acos(cosine)), &steps));
    if (!end)
        steps = (steps + 3) / 4 * 4; /* whole ellipses are symmetric */
    else
        transform(m, end, last);
    double sign = sweep < 0 ? -1 : 1, before[2];
    for (int i = 0; i <= steps; i++) {
        double angle = from + sweep * i / steps, cs = cos(angle), sn = sin(angle);
        double point[2] = {c[0] + p[0] * cs + q[0] * sn, c[1] + p[1] * cs + q[1] * sn};
        double after[2] = {sign * (q[0] * cs - p[0] * sn), sign * (q[1] * cs - p[1] * sn)};
        if (i > 0)
            CALX_TRY(add(sink, i == steps && end ? last : point, before, after));
        memcpy(before, after, sizeof before);
    }
    return CALX_OK;
}

/* Moves the end of the last segment onto the start of the chain; segments that would vanish go. */
static void join(struct calx_svg_sink *sink, struct calx_svg_chain *chain)
{
    struct calx_svg *svg = sink->svg;
    while (chain->count > 1 && distance(svg->segments[svg->segment_count - 1].a, sink->start) <=
                                   shortest * sink->tolerance) {
        chain->count--;
        svg->segment_count--;
    }
    memcpy(svg->segments[svg->segment_count - 1].b, sink->start, sizeof sink->start);
}

int calx_svg_flatten_end(struct calx_svg_sink *sink, bool closed)
{
    struct calx_svg *svg = sink->svg;
    if (sink->open) {
        struct calx_svg_chain *chain = &svg->chains[svg->chain_count - 1];
        bool back = distance(sink->at, sink->start) <= shortest * sink->tolerance;
        if (closed && !back && chain->count > 1)
            CALX_TRY(add_line(sink, sink->start));
        if (back && chain->count > 1)
            join(sink, chain);
        /* there and back along one line bounds nothing, and would be two walls in one place */
        if ((closed || back) && chain->count == 2) {
            chain->count--;
            svg->segment_count--;
        }
        chain->closed = (closed || back) && chain->count > 2;
    }
    sink->open = false;
    memcpy(sink->at, sink->start, sizeof sink->at);
    return CALX_OK;
}

static bool is_corner(const double a[2], const double b[2])
{
    return a[0] * b[0] + a[1] * b[1] < cos_smooth * hypot(a[0], a[1]) * hypot(b[0], b[1]);
}

void calx_svg_flatten_surfaces(struct calx_svg_sink *sink)
{
    struct calx_svg *svg = sink->svg;
    for (size_t c = 0; c < svg->chain_count; c++) {
        const struct calx_svg_chain *chain = &svg->chains[c];
        struct calx_svg_segment *s = svg->segments + chain->first;
        const struct calx_svg_tangents *t = sink->tangents + chain->first;
        int32_t first = svg->surface_count;
        for (size_t i = 0; i < chain->count; i++)
            s[i].surface = i > 0 && is_corner(t[i - 1].end, t[i].start) ? ++svg->surface_count
                                                                        : svg->surface_count;
        int32_t last = svg->surface_count++;
        if (last > first && chain->closed && !is_corner(t[chain->count - 1].end, t[0].start)) {
            for (size_t i = chain->count; i-- > 0 && s[i].surface == last;)
                s[i].surface = first; /* the smooth surface runs through the start of the chain */
            svg->surface_count--;
        }
    }
}

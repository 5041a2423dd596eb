/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The walls of a case: primitives from elements and from SVG drawings. Output: scene->walls.
 * Surfaces are numbered over the whole scene; neighbouring segments that turn by at most 15 degrees
 * are one surface, as in io/svg.h.
 */
#include "io/case_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg.h"

#define SMOOTH_COSINE 0.9659258262890683 /* of 15 degrees */
#define MOST_POINTS 100000

static struct calx_primitive *add_primitive(struct calx_reader *r, struct calx_wall *wall,
                                            enum calx_shape shape)
{
    struct calx_primitive *p =
        calx_case_append(r, &wall->primitives, &wall->primitive_count, sizeof *wall->primitives);
    if (p)
        p->shape = shape;
    return p;
}

/* Scales to unit length; false (and a problem) for a vector of no length. */
static bool normalise(struct calx_reader *r, const xmlNode *node, const char *name, double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0) || !isfinite(length)) {
        calx_case_fail(r, node, name, "has no direction");
        return false;
    }
    for (size_t k = 0; k < 3; k++)
        v[k] /= length;
    return true;
}

/* ---- segments
 * ------------------------------------------------------------------------------------------ */

static bool is_smooth(const struct calx_primitive *p, const struct calx_primitive *q)
{
    double px = p->b[0] - p->a[0], py = p->b[1] - p->a[1], qx = q->b[0] - q->a[0],
           qy = q->b[1] - q->a[1];
    return px * qx + py * qy >= SMOOTH_COSINE * hypot(px, py) * hypot(qx, qy);
}

static bool add_segment(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall,
                        const double a[2], const double b[2])
{
    if (a[0] == b[0] && a[1] == b[1]) {
        calx_case_fail(r, node, NULL, "a segment at (%g, %g) m has no length", a[0], a[1]);
        return false;
    }
    struct calx_primitive *p = add_primitive(r, wall, CALX_SEGMENT);
    if (!p)
        return false;
    memcpy(p->a, a, 2 * sizeof *a);
    memcpy(p->b, b, 2 * sizeof *b);
    return true;
}

static bool read_end(struct calx_reader *r, const xmlNode *node, const char *name, double end[3])
{
    size_t count = calx_case_list(r, node, name, end, 3);
    if (count == 1)
        calx_case_fail(r, node, name, "one number, expected two");
    return count >= 2;
}

static void read_segment(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    double a[3], b[3];
    bool has_a = read_end(r, node, "from", a), has_b = read_end(r, node, "to", b);
    if (has_a && has_b && add_segment(r, node, wall, a, b))
        wall->primitives[wall->primitive_count - 1].surface = r->surface_count++;
}

/* Numbers the surfaces of a chain of segments; in a closed one the last may go on in the first. */
static void number_surfaces(struct calx_reader *r, struct calx_primitive *chain, size_t count,
                            bool closed)
{
    if (!count)
        return;
    for (size_t k = 0; k < count; k++)
        chain[k].surface =
            k && is_smooth(&chain[k - 1], &chain[k]) ? chain[k - 1].surface : r->surface_count++;
    int32_t last = chain[count - 1].surface;
    if (closed && is_smooth(&chain[count - 1], &chain[0]))
        for (size_t k = count; k-- && chain[k].surface == last;)
            chain[k].surface = chain[0].surface;
}

static void add_polyline(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall,
                         double (*points)[2], size_t count)
{
    size_t first = wall->primitive_count;
    bool closed = calx_case_yes(r, node, "closed");
    if (closed && count > 2 && points[0][0] == points[count - 1][0] &&
        points[0][1] == points[count - 1][1])
        count--;
    for (size_t k = 0; k + 1 < count + closed; k++)
        if (!add_segment(r, node, wall, points[k], points[(k + 1) % count]))
            return;
    number_surfaces(r, wall->primitives + first, wall->primitive_count - first, closed);
    wall->closed |= closed;
}

static void read_polyline(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    double(*points)[2] = malloc(MOST_POINTS * sizeof *points);
    size_t count = points ? calx_case_list(r, node, "points", &points[0][0], 2 * MOST_POINTS) : 0;
    size_t least = calx_case_yes(r, node, "closed") ? 6 : 4;
    if (count && (count % 2 || count < least))
        calx_case_fail(r, node, "points", "%zu numbers, expected x and y of at least %zu points",
                       count, least / 2);
    else if (count)
        add_polyline(r, node, wall, points, count / 2);
    free(points);
}

/* ---- round and endless walls
 * --------------------------------------------------------------------------- */

static void read_plane(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    struct calx_primitive *p = add_primitive(r, wall, CALX_PLANE);
    if (!p || !calx_case_vector(r, node, "point", p->a) ||
        !calx_case_vector(r, node, "normal", p->n))
        return;
    normalise(r, node, "normal", p->n);
    p->surface = r->surface_count++;
}

static struct calx_primitive *read_round(struct calx_reader *r, const xmlNode *node,
                                         struct calx_wall *wall, enum calx_shape shape)
{
    struct calx_primitive *p = add_primitive(r, wall, shape);
    if (!p)
        return NULL;
    calx_case_vector(r, node, "center", p->a);
    p->radius = calx_case_number(r, node, "radius");
    p->inside = calx_case_word(r, node, "side") == 0;
    p->surface = r->surface_count++;
    return p;
}

static void read_cylinder(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    struct calx_primitive *p = read_round(r, node, wall, CALX_CYLINDER);
    double length = calx_case_number(r, node, "length");
    if (!p)
        return;
    p->length = isnan(length) ? 0.0 : length;
    p->n[2] = 1.0;
    if (r->scene->dimension == 3 && calx_case_vector(r, node, "axis", p->n))
        normalise(r, node, "axis", p->n);
    if (r->scene->dimension == 2 &&
        (calx_case_given(node, "axis") || calx_case_given(node, "length")))
        calx_case_fail(r, node, NULL, "axis and length are for 3D, in 2D a cylinder is a circle");
}

static void read_sphere(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    read_round(r, node, wall, CALX_SPHERE);
}

/* ---- drawings
 * ------------------------------------------------------------------------------------------ */

static void take_drawing(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall,
                         const struct calx_svg *svg)
{
    for (size_t k = 0; k < svg->segment_count; k++) {
        const struct calx_svg_segment *segment = &svg->segments[k];
        if (!add_segment(r, node, wall, segment->a, segment->b))
            return;
        wall->primitives[wall->primitive_count - 1].surface = r->surface_count + segment->surface;
    }
    r->surface_count += svg->surface_count;
    for (size_t k = 0; k < svg->chain_count; k++)
        wall->closed |= svg->chains[k].closed;
    for (size_t k = 0; k < svg->warning_count; k++)
        calx_problems_warn(r->problems, calx_case_place(r, node), "walls '%s': svg: %s", wall->name,
                           svg->warnings[k]);
}

static void read_drawing(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    double scale = calx_case_number(r, node, "scale"),
           tolerance = calx_case_number(r, node, "tolerance");
    struct calx_svg_options options = {.tolerance = tolerance,
                                       .scale = isnan(scale) ? 0.0 : scale,
                                       .id = calx_case_given(node, "id")};
    struct calx_svg svg = {0};
    struct calx_error e = {0};
    char *path = calx_case_path(r, node, "svg");
    if (!calx_case_given(node, "svg") && (calx_case_given(node, "scale") || options.id))
        calx_case_fail(r, node, NULL, "scale and id are for walls from an svg");
    if (path && !isnan(tolerance)) {
        if (calx_svg_read(path, &options, &svg, &e))
            calx_case_fail(r, node, "svg", "%s%s%.0d%s%.1400s", e.file, *e.file ? ":" : "", e.line,
                           *e.file ? ": " : "", e.text);
        else
            take_drawing(r, node, wall, &svg);
        calx_svg_free(&svg);
    }
    free(path);
}

/* ---- walls
 * --------------------------------------------------------------------------------------------- */

static void read_primitives(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    static const struct {
        const char *id;
        void (*read)(struct calx_reader *, const xmlNode *, struct calx_wall *);
    } readers[] = {{"segment", read_segment},
                   {"polyline", read_polyline},
                   {"plane", read_plane},
                   {"cylinder", read_cylinder},
                   {"sphere", read_sphere}};
    for (size_t k = 0; k < sizeof readers / sizeof *readers; k++)
        for (const xmlNode *child = calx_case_first(node, readers[k].id); child;
             child = calx_case_next(child, readers[k].id))
            readers[k].read(r, child, wall);
}

/* A new wall with its name; NULL without memory. */
static struct calx_wall *append_wall(struct calx_reader *r, const xmlNode *node)
{
    const char *name = calx_case_given(node, "name");
    int other = name ? calx_scene_wall(r->scene, name) : -1;
    if (other >= 0)
        calx_case_fail(r, node, NULL, "there are already walls of this name on line %d",
                       r->scene->walls[other].place.line);
    struct calx_wall *wall =
        calx_case_append(r, &r->scene->walls, &r->scene->wall_count, sizeof *r->scene->walls);
    if (!wall)
        return NULL;
    snprintf(wall->name, sizeof wall->name, "%.47s", name ? name : "");
    wall->place = calx_case_place(r, node);
    wall->material = -1;
    return wall;
}

static void read_wall(struct calx_reader *r, const xmlNode *node)
{
    struct calx_wall *wall = append_wall(r, node);
    if (!wall)
        return;
    wall->material = calx_case_material(r, node, "material");
    if (wall->material >= 0 && r->uses)
        r->uses[wall->material] |= CALX_BY_WALLS;
    wall->isothermal = calx_case_function(r, node, "temperature", &wall->temperature);
    read_drawing(r, node, wall);
    read_primitives(r, node, wall);
    if (!wall->primitive_count && !calx_case_given(node, "svg") &&
        !xmlFirstElementChild((xmlNode *)(uintptr_t)node))
        calx_case_fail(r, node, NULL,
                       "has no wall, expected svg or <segment>, <polyline>, <plane>, <cylinder>, "
                       "<sphere> inside");
}

/* Its bodies, with their materials, are read with the other particles. */
static void read_group(struct calx_reader *r, const xmlNode *node)
{
    struct calx_wall *wall = append_wall(r, node);
    const xmlNode *bearer =
        calx_case_given(node, "temperature") ? node : node->parent; /* <particles> */
    if (!wall)
        return;
    wall->carries = true;
    wall->isothermal = calx_case_yes(r, node, "isothermal");
    if (wall->isothermal && !calx_case_function(r, bearer, "temperature", &wall->temperature))
        calx_case_fail(r, node, "isothermal", "needs a temperature, here or on <particles>");
    if (wall->isothermal && wall->temperature.eval)
        calx_case_fail(r, node, "isothermal",
                       "its temperature varies in space, expected one number; stages may give it as "
                       "an expression of t");
    if (!xmlFirstElementChild((xmlNode *)(uintptr_t)node))
        calx_case_fail(
            r, node, NULL,
            "has no body, expected <ring>, <row>, <grid>, <particle>, <csv> or <pack> inside");
}

void calx_case_read_walls(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "walls"); node;
         node = calx_case_next(node, "walls"))
        read_wall(r, node);
    for (const xmlNode *node = calx_case_first(r->root, "particles"); node;
         node = calx_case_next(node, "particles"))
        for (const xmlNode *group = calx_case_first(node, "group"); group;
             group = calx_case_next(group, "group"))
            read_group(r, group);
}

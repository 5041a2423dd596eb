/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The basic shapes of SVG and the path element: attributes to lines and curves in a sink. Rules:
 * SVG 1.1 (W3C, 2011), chapter 9. Ellipses and round corners go in as exact arcs, not as Beziers.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_parts.h"

static const double pi = 3.14159265358979323846;

char *calx_svg_shape_attribute(const xmlNode *node, const char *name)
{
    xmlChar *value = xmlGetNoNsProp(node, (const xmlChar *)name);
    char *copy = value ? strdup((const char *)value) : NULL; /* xmlFree need not be free */
    xmlFree(value);
    return copy;
}

int calx_svg_shape_length(struct calx_svg_sink *sink, const xmlNode *node, const char *name,
                          double whole, double missing, double *value)
{
    char *text = calx_svg_shape_attribute(node, name);
    *value = missing;
    int code = CALX_OK;
    if (text && strcmp(text, "auto") != 0 && !calx_svg_text_length(text, whole, value))
        code = calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "%s: %s=\"%.40s\": expected a length (a number with px, mm, cm, in, "
                             "pt, pc, Q, %% or no unit)",
                             (const char *)node->name, name, text);
    free(text);
    return code;
}

/* What a length attribute is a percentage of: the viewport's width, its height, or the diagonal
 * over sqrt 2. */
enum whole { WHOLE_X, WHOLE_Y, WHOLE_DIAGONAL };

struct length {
    const char *name;
    enum whole whole;
    bool size; /* must not be negative */
    double missing;
};

static int read_lengths(struct calx_svg_sink *sink, const xmlNode *node, const double view[2],
                        const struct length *table, size_t count, double *v)
{
    const double wholes[] = {view[0], view[1], hypot(view[0], view[1]) / sqrt(2)};
    for (size_t i = 0; i < count; i++) {
        CALX_TRY(calx_svg_shape_length(sink, node, table[i].name, wholes[table[i].whole],
                                       table[i].missing, &v[i]));
        if (table[i].size && v[i] < 0)
            return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place, "%s: %s is negative",
                                 (const char *)node->name, table[i].name);
    }
    return CALX_OK;
}

#define READ_LENGTHS(table, v)                                                                     \
    CALX_TRY(read_lengths(sink, node, view, table, sizeof table / sizeof *table, v))

static int draw_line(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    static const struct length table[] = {{"x1", WHOLE_X, false, 0},
                                          {"y1", WHOLE_Y, false, 0},
                                          {"x2", WHOLE_X, false, 0},
                                          {"y2", WHOLE_Y, false, 0}};
    double v[4];
    READ_LENGTHS(table, v);
    CALX_TRY(calx_svg_flatten_move(sink, v));
    CALX_TRY(calx_svg_flatten_line(sink, v + 2));
    return calx_svg_flatten_end(sink, false);
}

static int draw_whole_ellipse(struct calx_svg_sink *sink, double cx, double cy, double rx,
                              double ry)
{
    if (rx == 0 || ry == 0)
        return calx_svg_style_warn(sink, "an ellipse or circle of radius 0 draws nothing");
    CALX_TRY(calx_svg_flatten_move(sink, (double[]){cx + rx, cy}));
    CALX_TRY(calx_svg_flatten_arc(sink, (double[]){cx, cy}, (double[]){rx, 0}, (double[]){0, ry}, 0,
                                  2 * pi, NULL));
    return calx_svg_flatten_end(sink, true);
}

static int draw_circle(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    static const struct length table[] = {
        {"cx", WHOLE_X, false, 0}, {"cy", WHOLE_Y, false, 0}, {"r", WHOLE_DIAGONAL, true, 0}};
    double v[3];
    READ_LENGTHS(table, v);
    return draw_whole_ellipse(sink, v[0], v[1], v[2], v[2]);
}

static int draw_ellipse(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    static const struct length table[] = {{"cx", WHOLE_X, false, 0},
                                          {"cy", WHOLE_Y, false, 0},
                                          {"rx", WHOLE_X, true, NAN},
                                          {"ry", WHOLE_Y, true, NAN}};
    double v[4];
    READ_LENGTHS(table, v);
    double rx = isnan(v[2]) ? v[3] : v[2], ry = isnan(v[3]) ? v[2] : v[3]; /* one alone is both */
    return draw_whole_ellipse(sink, v[0], v[1], isnan(rx) ? 0 : rx, isnan(ry) ? 0 : ry);
}

/* A corner of a rectangle: the line to it, then a quarter turn about (cx, cy) that starts at angle
 * `from`. */
static int draw_corner(struct calx_svg_sink *sink, double cx, double cy, double rx, double ry,
                       double from)
{
    const double c = round(cos(from)), s = round(sin(from)); /* a multiple of a right angle */
    const double begin[2] = {cx + rx * c, cy + ry * s}, end[2] = {cx - rx * s, cy + ry * c};
    CALX_TRY(calx_svg_flatten_line(sink, begin));
    if (rx == 0 || ry == 0)
        return CALX_OK;
    return calx_svg_flatten_arc(sink, (double[]){cx, cy}, (double[]){rx, 0}, (double[]){0, ry},
                                from, pi / 2, end);
}

static int draw_rect(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    static const struct length table[] = {{"x", WHOLE_X, false, 0},    {"y", WHOLE_Y, false, 0},
                                          {"width", WHOLE_X, true, 0}, {"height", WHOLE_Y, true, 0},
                                          {"rx", WHOLE_X, true, NAN},  {"ry", WHOLE_Y, true, NAN}};
    double v[6];
    READ_LENGTHS(table, v);
    double x = v[0], y = v[1], w = v[2], h = v[3];
    if (w == 0 || h == 0)
        return calx_svg_style_warn(sink, "a rect of width or height 0 draws nothing");
    double rx = isnan(v[4]) ? v[5] : v[4], ry = isnan(v[5]) ? v[4] : v[5];
    rx = isnan(rx) ? 0 : fmin(rx, w / 2);
    ry = isnan(ry) ? 0 : fmin(ry, h / 2);
    CALX_TRY(calx_svg_flatten_move(sink, (double[]){x + rx, y}));
    CALX_TRY(draw_corner(sink, x + w - rx, y + ry, rx, ry, -pi / 2));
    CALX_TRY(draw_corner(sink, x + w - rx, y + h - ry, rx, ry, 0));
    CALX_TRY(draw_corner(sink, x + rx, y + h - ry, rx, ry, pi / 2));
    CALX_TRY(draw_corner(sink, x + rx, y + ry, rx, ry, pi));
    return calx_svg_flatten_end(sink, true);
}

/* Reads pairs of coordinates as a chain; *text stays before what is no pair. */
static int draw_pairs(struct calx_svg_sink *sink, const char **text, bool closed)
{
    double p[2];
    calx_svg_text_skip(text, false);
    for (bool first = true; **text; first = false) {
        const char *pair = *text;
        if (!calx_svg_text_number(&pair, &p[0]))
            return CALX_OK;
        calx_svg_text_skip(&pair, true);
        if (!calx_svg_text_number(&pair, &p[1]))
            return CALX_OK;
        calx_svg_text_skip(&pair, true);
        *text = pair;
        CALX_TRY(first ? calx_svg_flatten_move(sink, p) : calx_svg_flatten_line(sink, p));
    }
    return calx_svg_flatten_end(sink, closed);
}

static int draw_points(struct calx_svg_sink *sink, const xmlNode *node, bool closed)
{
    char *points = calx_svg_shape_attribute(node, "points");
    const char *text = points ? points : "";
    int code = draw_pairs(sink, &text, closed);
    if (code == CALX_OK && *text)
        code = calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "%s: points: expected a pair of numbers, found \"%.16s\"",
                             (const char *)node->name, text);
    free(points);
    return code;
}

static int draw_polyline(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    (void)view;
    return draw_points(sink, node, false);
}

static int draw_polygon(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    (void)view;
    return draw_points(sink, node, true);
}

static int draw_path(struct calx_svg_sink *sink, const xmlNode *node, const double view[2])
{
    (void)view;
    char *data = calx_svg_shape_attribute(node, "d");
    int code = calx_svg_path_draw(sink, data ? data : "");
    free(data);
    return code;
}

static const struct shape {
    const char *name;
    int (*draw)(struct calx_svg_sink *sink, const xmlNode *node, const double view[2]);
} shapes[] = {
    {"path", draw_path},         {"rect", draw_rect},       {"circle", draw_circle},
    {"ellipse", draw_ellipse},   {"polygon", draw_polygon}, {"line", draw_line},
    {"polyline", draw_polyline},
};

int calx_svg_shape_draw(struct calx_svg_sink *sink, const xmlNode *node, const double view[2],
                        bool *known)
{
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        *known = strcmp((const char *)node->name, shapes[i].name) == 0;
        if (*known)
            return shapes[i].draw(sink, node, view);
    }
    return CALX_OK;
}

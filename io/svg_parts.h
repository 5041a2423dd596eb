/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files of the SVG reader share: numbers and transforms in attributes, the sink that turns
 * lines and curves into segments, path data, basic shapes, the walk over the elements. Private to
 * io/svg*.c.
 */
#ifndef CALX_SVG_PARTS_H
#define CALX_SVG_PARTS_H

#include <libxml/hash.h>
#include <libxml/tree.h>
#include <stdbool.h>

#include "io/svg.h"

/* x' = a x + c y + e, y' = b x + d y + f, as in SVG's matrix(a b c d e f). */
struct calx_svg_matrix {
    double a, b, c, d, e, f;
};

/* ---- svg_text.c: numbers, lengths, transforms ---- */

/* First `inner`, then `outer`. */
struct calx_svg_matrix calx_svg_text_compose(struct calx_svg_matrix outer,
                                             struct calx_svg_matrix inner);

/* Skips white space, and one comma within it if `comma`. */
void calx_svg_text_skip(const char **text, bool comma);

/* Reads one number in SVG's syntax and moves *text behind it; false (and *text kept) if none stands
 * there or it overflows. */
bool calx_svg_text_number(const char **text, double *value);

/* A length in user units (px), its unit included; percentages are of `whole`. False if it is none.
 */
bool calx_svg_text_length(const char *text, double whole, double *value);

/* A transform list. Returns NULL, or what is wrong with it. */
const char *calx_svg_text_transform(const char *text, struct calx_svg_matrix *matrix);

/* The four numbers of a viewBox; false unless both sizes are positive. */
bool calx_svg_text_view_box(const char *text, double box[4]);

/* Maps a viewBox into the viewport {x, y, width, height}; `aspect` is preserveAspectRatio or NULL.
 */
struct calx_svg_matrix calx_svg_text_viewport(const double viewport[4], const double box[4],
                                              const char *aspect);

/* ---- svg_flatten.c: the sink ---- */

/* Directions of the true curve at both ends of a segment: they tell a corner from a coarse chord.
 */
struct calx_svg_tangents {
    double start[2], end[2];
};

struct calx_svg_sink {
    struct calx_svg *svg;
    size_t segment_room, chain_room;
    struct calx_svg_tangents *tangents; /* one per segment */
    double tolerance;                   /* m */
    struct calx_svg_matrix matrix;      /* user units of the element to m */
    struct calx_place place;            /* the element */
    struct calx_error *error;
    double start[2], at[2]; /* m: of the subpath, and where the last segment ended */
    bool open;              /* a subpath has begun */
};

/* Points are in user units of the element. They fail on too many segments, non-finite points or no
 * memory. */
int calx_svg_flatten_move(struct calx_svg_sink *sink, const double p[2]);
int calx_svg_flatten_line(struct calx_svg_sink *sink, const double p[2]);
int calx_svg_flatten_cubic(struct calx_svg_sink *sink, const double p[4][2]);
/* The ellipse centre + u cos(angle) + v sin(angle) from angle `from` through `sweep`, ending
 * exactly in `end` (NULL: computed). */
int calx_svg_flatten_arc(struct calx_svg_sink *sink, const double centre[2], const double u[2],
                         const double v[2], double from, double sweep, const double end[2]);
/* Ends the subpath; closed: with a line back to its start. */
int calx_svg_flatten_end(struct calx_svg_sink *sink, bool closed);
/* Numbers the surfaces of all chains. */
void calx_svg_flatten_surfaces(struct calx_svg_sink *sink);

/* ---- svg_path.c, svg_shape.c, svg_tree.c ---- */

/* Draws path data; fails at the character that breaks the grammar. */
int calx_svg_path_draw(struct calx_svg_sink *sink, const char *data);

/* Draws an element that is a basic shape or a path; `view` is the size of the viewport (for
 * percentages). *known is false if it is no shape. */
int calx_svg_shape_draw(struct calx_svg_sink *sink, const xmlNode *node, const double view[2],
                        bool *known);

/* An attribute without namespace, to be freed with free(); NULL if absent. */
char *calx_svg_shape_attribute(const xmlNode *node, const char *name);

/* A length attribute in user units, `missing` if absent; fails if it is none. */
int calx_svg_shape_length(struct calx_svg_sink *sink, const xmlNode *node, const char *name,
                          double whole, double missing, double *value);

/* Draws everything below the root, whose matrix the sink holds; `view` is the size of the page in
 * user units. */
int calx_svg_tree_draw(struct calx_svg_sink *sink, const xmlNode *root, const double view[2],
                       const char *id);

/* ---- svg_style.c: what style says ---- */

/* Notes "file:line: ..." once in svg->warnings; fails only without memory. */
int calx_svg_style_warn(struct calx_svg_sink *sink, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* True if the element with all that it holds is not shown; *visible becomes what its visibility
 * says, if it says anything. */
bool calx_svg_style_hides(const xmlNode *node, bool *visible);

/* Warns about properties of an element that are not applied; by_id finds the elements that they
 * refer to. */
int calx_svg_style_check(struct calx_svg_sink *sink, xmlHashTable *by_id, const xmlNode *node);

/* Warns if a <style> element may hide or move things. */
int calx_svg_style_check_sheet(struct calx_svg_sink *sink, const xmlNode *node);

#endif

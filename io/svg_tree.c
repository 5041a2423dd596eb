/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The walk over the elements of an SVG file: groups and layers, transforms, nested viewports, use,
 * what is hidden, and what is not read (a warning each). Input: an XML tree; output: shapes drawn
 * into a sink. Rules: SVG 1.1 (W3C, 2011), chapters 5 and 7. A table says what becomes of each
 * element name.
 */
#include <libxml/hash.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_parts.h"

static const size_t most_nodes = 1000000; /* visited, each use counting again */
enum { MOST_DEPTH = 200, MOST_IDS = 200 };

struct walk {
    struct calx_svg_sink *sink;
    xmlHashTable *by_id; /* nodes, for use: without a DTD libxml2 knows no ids */
    const char *id;      /* what to read, or NULL */
    bool found;          /* it exists */
    size_t nodes;
    size_t id_count; /* for the message when it does not exist */
    char *ids[MOST_IDS];
};

/* What an element inherits. */
struct inherited {
    struct calx_svg_matrix matrix;
    double view[2]; /* size of the nearest viewport, for percentages */
    bool drawing;   /* inside what `id` names, or id is NULL */
    bool visible;
    bool copy; /* reached through use: ids are not matched */
    int depth;
};

static int walk_node(struct walk *walk, const xmlNode *node, struct inherited in);

static const xmlNode *next_node(const xmlNode *root, const xmlNode *node)
{
    if (node->type == XML_ELEMENT_NODE && node->children)
        return node->children;
    while (node != root && !node->next)
        node = node->parent;
    return node == root ? NULL : node->next;
}

/* Of elements with the same id the first counts. */
static void index_ids(struct walk *walk, const xmlNode *root)
{
    walk->by_id = xmlHashCreate(64);
    for (const xmlNode *node = root; node && walk->by_id; node = next_node(root, node)) {
        char *id = node->type == XML_ELEMENT_NODE ? calx_svg_shape_attribute(node, "id") : NULL;
        if (id)
            xmlHashAddEntry(walk->by_id, (const xmlChar *)id, (void *)node);
        free(id);
    }
}

static const xmlNode *find_id(const struct walk *walk, const char *id)
{
    return walk->by_id ? xmlHashLookup(walk->by_id, (const xmlChar *)id) : NULL;
}

/* ---- transforms, viewports, selection ---- */

static int apply_transform(struct walk *walk, const xmlNode *node, struct inherited *in)
{
    char *text = calx_svg_shape_attribute(node, "transform");
    struct calx_svg_matrix own = {1, 0, 0, 1, 0, 0};
    const char *wrong = text ? calx_svg_text_transform(text, &own) : NULL;
    int code = CALX_OK;
    if (wrong)
        code = calx_error_at(walk->sink->error, CALX_ERROR_INPUT, walk->sink->place,
                             "%s: transform=\"%.60s\": %s", (const char *)node->name, text, wrong);
    in->matrix = calx_svg_text_compose(in->matrix, own);
    free(text);
    return code;
}

/* The viewport of a nested svg, or of a symbol shown by a use (which then gives the sizes). */
static int apply_viewport(struct walk *walk, const xmlNode *node, const double viewport[4],
                          struct inherited *in)
{
    char *text = calx_svg_shape_attribute(node, "viewBox"),
         *aspect = calx_svg_shape_attribute(node, "preserveAspectRatio");
    double box[4] = {0, 0, viewport[2], viewport[3]};
    int code = CALX_OK;
    if (text && !calx_svg_text_view_box(text, box))
        code = calx_error_at(
            walk->sink->error, CALX_ERROR_INPUT, walk->sink->place,
            "viewBox=\"%.60s\": expected four numbers, x y width height, with positive sizes",
            text);
    else if (text && viewport[2] > 0 && viewport[3] > 0)
        in->matrix =
            calx_svg_text_compose(in->matrix, calx_svg_text_viewport(viewport, box, aspect));
    else
        in->matrix = calx_svg_text_compose(
            in->matrix, (struct calx_svg_matrix){1, 0, 0, 1, viewport[0], viewport[1]});
    in->view[0] = box[2];
    in->view[1] = box[3];
    free(text);
    free(aspect);
    return code;
}

static int read_viewport(struct walk *walk, const xmlNode *node, const struct inherited *in,
                         double viewport[4])
{
    struct calx_svg_sink *sink = walk->sink;
    CALX_TRY(calx_svg_shape_length(sink, node, "x", in->view[0], 0, &viewport[0]));
    CALX_TRY(calx_svg_shape_length(sink, node, "y", in->view[1], 0, &viewport[1]));
    CALX_TRY(calx_svg_shape_length(sink, node, "width", in->view[0], in->view[0], &viewport[2]));
    return calx_svg_shape_length(sink, node, "height", in->view[1], in->view[1], &viewport[3]);
}

/* Remembers the names that could have been asked for, and starts drawing at the one that was. */
static void select_node(struct walk *walk, const xmlNode *node, struct inherited *in)
{
    if (!walk->id || in->drawing || in->copy)
        return;
    char *id = calx_svg_shape_attribute(node, "id");
    xmlChar *label = xmlGetNsProp(node, (const xmlChar *)"label",
                                  (const xmlChar *)"http://www.inkscape.org/namespaces/inkscape");
    if ((id && strcmp(id, walk->id) == 0) || (label && strcmp((const char *)label, walk->id) == 0))
        in->drawing = in->visible = walk->found = true;
    if (id && walk->id_count < MOST_IDS) {
        walk->ids[walk->id_count++] = id;
        id = NULL;
    }
    if (label && walk->id_count < MOST_IDS)
        walk->ids[walk->id_count++] = strdup((const char *)label);
    free(id);
    xmlFree(label);
}

/* ---- elements ---- */

static int walk_children(struct walk *walk, const xmlNode *node, struct inherited in)
{
    for (const xmlNode *child = node->children; child; child = child->next)
        CALX_TRY(walk_node(walk, child, in));
    return CALX_OK;
}

static int walk_group(struct walk *walk, const xmlNode *node, struct inherited in)
{
    return walk_children(walk, node, in);
}

static int walk_svg(struct walk *walk, const xmlNode *node, struct inherited in)
{
    double viewport[4];
    CALX_TRY(read_viewport(walk, node, &in, viewport));
    CALX_TRY(apply_viewport(walk, node, viewport, &in));
    return walk_children(walk, node, in);
}

static char *use_target(const xmlNode *node)
{
    char *href = calx_svg_shape_attribute(node, "href");
    if (href)
        return href;
    xmlChar *old = xmlGetNsProp(node, (const xmlChar *)"href",
                                (const xmlChar *)"http://www.w3.org/1999/xlink");
    href = old ? strdup((const char *)old) : NULL;
    xmlFree(old);
    return href;
}

static int walk_use(struct walk *walk, const xmlNode *node, struct inherited in)
{
    if (!in.drawing)
        return CALX_OK;
    double viewport[4];
    CALX_TRY(read_viewport(walk, node, &in, viewport));
    char *href = use_target(node);
    const xmlNode *target = href && *href == '#' ? find_id(walk, href + 1) : NULL;
    int code = CALX_OK;
    if (!target)
        code = calx_svg_style_warn(
            walk->sink, "use of \"%.80s\" is not drawn: no element of this file has that id",
            href ? href : "");
    free(href);
    if (!target || code)
        return code;
    in.copy = true;
    const struct calx_svg_matrix moved = {1, 0, 0, 1, viewport[0], viewport[1]};
    if (strcmp((const char *)target->name, "symbol") != 0) {
        in.matrix = calx_svg_text_compose(in.matrix, moved);
        return walk_node(walk, target, in);
    }
    CALX_TRY(apply_viewport(walk, target, viewport, &in));
    return walk_children(walk, target, in);
}

/* Things that draw nothing by themselves. */
static int walk_nothing(struct walk *walk, const xmlNode *node, struct inherited in)
{
    (void)walk;
    (void)node;
    (void)in;
    return CALX_OK;
}

static int walk_style(struct walk *walk, const xmlNode *node, struct inherited in)
{
    (void)in;
    return calx_svg_style_check_sheet(walk->sink, node);
}

static int walk_unsupported(struct walk *walk, const xmlNode *node, struct inherited in)
{
    return in.drawing && in.visible
               ? calx_svg_style_warn(walk->sink, "<%s> is not read", (const char *)node->name)
               : CALX_OK;
}

/* Inkscape keeps style sheets in defs. */
static int walk_defs(struct walk *walk, const xmlNode *node, struct inherited in)
{
    for (const xmlNode *child = node->children; child; child = child->next)
        if (child->type == XML_ELEMENT_NODE && strcmp((const char *)child->name, "style") == 0)
            CALX_TRY(walk_node(walk, child, in));
    return CALX_OK;
}

static const struct element {
    const char *name;
    int (*walk)(struct walk *walk, const xmlNode *node, struct inherited in);
} elements[] = {
    {"g", walk_group},          {"a", walk_group},
    {"svg", walk_svg},          {"use", walk_use},
    {"style", walk_style},      {"defs", walk_defs},
    {"symbol", walk_nothing},   {"clipPath", walk_nothing},
    {"mask", walk_nothing},     {"marker", walk_nothing},
    {"pattern", walk_nothing},  {"linearGradient", walk_nothing},
    {"filter", walk_nothing},   {"radialGradient", walk_nothing},
    {"title", walk_nothing},    {"desc", walk_nothing},
    {"metadata", walk_nothing}, {"view", walk_nothing},
};

static int draw_shape(struct walk *walk, const xmlNode *node, const struct inherited *in,
                      bool *known)
{
    struct calx_svg_sink *sink = walk->sink;
    *known = false;
    if (!in->drawing || !in->visible)
        return CALX_OK;
    sink->matrix = in->matrix;
    CALX_TRY(calx_svg_shape_draw(sink, node, in->view, known));
    if (!*known)
        return CALX_OK;
    for (const xmlNode *child = node->children; child; child = child->next)
        if (child->type == XML_ELEMENT_NODE &&
            strncmp((const char *)child->name, "animate", 7) == 0)
            CALX_TRY(calx_svg_style_warn(sink, "<%s> is not read: shapes do not move by themselves",
                                         (const char *)child->name));
    return CALX_OK;
}

static int walk_element(struct walk *walk, const xmlNode *node, struct inherited in)
{
    bool known;
    CALX_TRY(apply_transform(walk, node, &in));
    if (in.drawing && in.visible)
        CALX_TRY(calx_svg_style_check(walk->sink, walk->by_id, node));
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (strcmp((const char *)node->name, elements[i].name) == 0)
            return elements[i].walk(walk, node, in);
    CALX_TRY(draw_shape(walk, node, &in, &known));
    return known ? CALX_OK : walk_unsupported(walk, node, in);
}

static bool is_svg(const xmlNode *node)
{
    return !node->ns || strcmp((const char *)node->ns->href, "http://www.w3.org/2000/svg") == 0;
}

static int walk_node(struct walk *walk, const xmlNode *node, struct inherited in)
{
    struct calx_svg_sink *sink = walk->sink;
    if (node->type != XML_ELEMENT_NODE || !is_svg(node))
        return CALX_OK;
    sink->place.line = (int)xmlGetLineNo(node);
    if (++walk->nodes > most_nodes)
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "more than %zu elements are drawn", most_nodes);
    if (++in.depth > MOST_DEPTH)
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "elements are nested deeper than %d, or a use draws itself",
                             MOST_DEPTH);
    bool inside = in.drawing; /* what is asked for by its id is read even if hidden */
    select_node(walk, node, &in);
    if (inside && calx_svg_style_hides(node, &in.visible))
        return CALX_OK;
    return walk_element(walk, node, in);
}

int calx_svg_tree_draw(struct calx_svg_sink *sink, const xmlNode *root, const double view[2],
                       const char *id)
{
    struct walk walk = {.sink = sink, .id = id};
    struct inherited in = {
        .matrix = sink->matrix, .view = {view[0], view[1]}, .drawing = !id, .visible = true};
    index_ids(&walk, root);
    if (!walk.by_id)
        return calx_error_set(sink->error, CALX_ERROR_MEMORY, "no memory for %s", sink->place.file);
    int code = walk_children(&walk, root, in);
    xmlHashFree(walk.by_id, NULL);
    if (!code && id && !walk.found) {
        const char *nearest = calx_error_nearest(id, (const char *const *)walk.ids, walk.id_count);
        code = calx_error_set(sink->error, CALX_ERROR_INPUT,
                              "%s: no element or layer has the id or label \"%s\"%s%s%s",
                              sink->place.file, id, nearest ? "; did you mean \"" : "",
                              nearest ? nearest : "", nearest ? "\"?" : "");
    }
    for (size_t i = 0; i < walk.id_count; i++)
        free(walk.ids[i]);
    return code;
}

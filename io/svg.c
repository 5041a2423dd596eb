/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Reads an SVG file into chains of segments in metres. This file opens it safely (no network, no
 * DTD, no entities, bounded size), finds the size of the page, hands the tree to svg_tree.c and
 * numbers the surfaces. Inputs: path, tolerance, scale, id. Outputs: segments, chains, warnings.
 * Rules: SVG 1.1 (W3C, 2011), section 7.12 on units.
 */
#include "io/svg.h"

#include <errno.h>
#include <libxml/SAX2.h>
#include <libxml/parser.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_parts.h"

static const size_t most_bytes = 64u << 20;
static const double metres_per_px = 0.0254 / 96;

/* The whole file; *text is to be freed. */
static int read_file(const char *path, char **text, size_t *size, struct calx_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return calx_error_set(error, CALX_ERROR_INPUT, "cannot open %s: %s", path, strerror(errno));
    size_t room = 1 << 16, length = 0;
    char *data = malloc(room);
    while (data && length <= most_bytes) {
        length += fread(data + length, 1, room - length, file);
        if (length < room)
            break;
        room *= 2;
        char *more = realloc(data, room);
        if (!more)
            free(data);
        data = more;
    }
    int failed = ferror(file), number = errno, code = CALX_OK;
    fclose(file);
    if (!data)
        code = calx_error_set(error, CALX_ERROR_MEMORY, "no memory to read %s", path);
    else if (failed)
        code =
            calx_error_set(error, CALX_ERROR_INPUT, "cannot read %s: %s", path, strerror(number));
    else if (length > most_bytes)
        code = calx_error_set(error, CALX_ERROR_INPUT, "%s is larger than %zu bytes", path,
                              most_bytes);
    if (code)
        free(data);
    *text = data;
    *size = length;
    return code;
}

/* Entities can make a small file huge; drawings do not need them. The parser stops at the first. */
static void refuse_entity(void *parser, const xmlChar *name, int type, const xmlChar *public_id,
                          const xmlChar *system_id, xmlChar *content)
{
    (void)name;
    (void)type;
    (void)public_id;
    (void)system_id;
    (void)content;
    xmlParserCtxt *context = parser;
    context->_private = context; /* tells parse() why */
    xmlStopParser(context);
}

static int parse(const char *path, struct calx_error *error, xmlDoc **document)
{
    char *text = NULL;
    size_t size = 0;
    CALX_TRY(read_file(path, &text, &size, error));
    xmlParserCtxt *parser = xmlNewParserCtxt();
    if (!parser) {
        free(text);
        return calx_error_set(error, CALX_ERROR_MEMORY, "no memory to read %s", path);
    }
    parser->sax->entityDecl = refuse_entity;
    const int options =
        XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_BIG_LINES;
    *document = xmlCtxtReadMemory(parser, text, (int)size, NULL, NULL, options);
    int code = CALX_OK;
    const xmlError *last = xmlCtxtGetLastError(parser);
    struct calx_place place = {path, parser->_private && parser->input ? parser->input->line
                                     : last                            ? last->line
                                                                       : 0};
    if (parser->_private)
        code = calx_error_at(error, CALX_ERROR_INPUT, place,
                             "declares an entity, which is not read: save it as plain SVG");
    else if (!*document)
        code = calx_error_at(error, CALX_ERROR_INPUT, place, "not well-formed XML: %.*s",
                             last && last->message ? (int)strcspn(last->message, "\n") : 7,
                             last && last->message ? last->message : "no data");
    if (code) {
        xmlFreeDoc(*document);
        *document = NULL;
    }
    xmlFreeParserCtxt(parser);
    free(text);
    return code;
}

/* ---- the page ---- */

struct page {
    double size[2]; /* width and height in px; 0 if not given */
    bool has_box;
    double box[4];
    char *aspect;
};

static int read_page(struct calx_svg_sink *sink, const xmlNode *root, struct page *page)
{
    static const char *const names[2] = {"width", "height"};
    for (int k = 0; k < 2; k++) {
        /* a percentage depends on a window: as if absent */
        CALX_TRY(calx_svg_shape_length(sink, root, names[k], 0, 0, &page->size[k]));
        if (page->size[k] < 0)
            return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place, "svg: %s is negative",
                                 names[k]);
    }
    char *box = calx_svg_shape_attribute(root, "viewBox");
    page->has_box = box != NULL;
    bool good = !box || calx_svg_text_view_box(box, page->box);
    int code = CALX_OK;
    if (!good)
        code = calx_error_at(
            sink->error, CALX_ERROR_INPUT, sink->place,
            "viewBox=\"%.60s\": expected four numbers, x y width height, with positive sizes", box);
    free(box);
    return code;
}

/* Metres per user unit in x and y. One missing size follows from the other. */
static void page_scale(const struct page *page, const char *aspect, double scale, double s[2])
{
    s[0] = s[1] = scale > 0 ? scale : metres_per_px;
    if (scale > 0 || !page->has_box || (page->size[0] == 0 && page->size[1] == 0))
        return;
    double x = page->size[0] / page->box[2], y = page->size[1] / page->box[3];
    x = x > 0 ? x : y;
    y = y > 0 ? y : x;
    if (!aspect || !strstr(aspect, "none"))
        x = y = aspect && strstr(aspect, "slice") ? fmax(x, y) : fmin(x, y);
    s[0] *= x;
    s[1] *= y;
}

/* The matrix from user units to metres about the centre of the page, and the page's size in user
 * units. */
static int place_page(struct calx_svg_sink *sink, const xmlNode *root, double scale, double view[2])
{
    struct page page = {0};
    CALX_TRY(read_page(sink, root, &page));
    if (!page.has_box)
        memcpy(page.box + 2, page.size, sizeof page.size);
    if (page.size[0] == 0 && page.size[1] == 0 && scale <= 0)
        CALX_TRY(calx_svg_style_warn(sink, "no width and height with units: one unit is taken as 1 "
                                           "px = 1/96 inch (give a scale if that is wrong)"));
    char *aspect = calx_svg_shape_attribute(root, "preserveAspectRatio");
    double s[2];
    page_scale(&page, aspect, scale, s);
    free(aspect);
    double x = page.box[0] + page.box[2] / 2, y = page.box[1] + page.box[3] / 2;
    sink->matrix = (struct calx_svg_matrix){s[0], 0, 0, -s[1], -s[0] * x, s[1] * y};
    view[0] = page.box[2];
    view[1] = page.box[3];
    return CALX_OK;
}

static int draw(struct calx_svg_sink *sink, const xmlNode *root,
                const struct calx_svg_options *options)
{
    double view[2];
    sink->place.line = root ? (int)xmlGetLineNo(root) : 0;
    if (!root || strcmp((const char *)root->name, "svg") != 0)
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place,
                             "expected an <svg> element, found <%s>",
                             root ? (const char *)root->name : "");
    CALX_TRY(place_page(sink, root, options->scale, view));
    CALX_TRY(calx_svg_tree_draw(sink, root, view, options->id));
    if (sink->svg->segment_count == 0)
        return calx_error_at(sink->error, CALX_ERROR_INPUT, sink->place, "nothing is drawn%s%s",
                             options->id ? " by " : "", options->id ? options->id : "");
    calx_svg_flatten_surfaces(sink);
    sink->svg->closed = true;
    for (size_t c = 0; c < sink->svg->chain_count; c++)
        sink->svg->closed = sink->svg->closed && sink->svg->chains[c].closed;
    return CALX_OK;
}

/* Numbers are read in the C locale whatever the program's locale is. */
static int draw_in_c_locale(struct calx_svg_sink *sink, const xmlNode *root,
                            const struct calx_svg_options *options)
{
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain)
        return calx_error_set(sink->error, CALX_ERROR_MEMORY, "no memory to read %s",
                              sink->place.file);
    locale_t before = uselocale(plain);
    int code = draw(sink, root, options);
    uselocale(before);
    freelocale(plain);
    return code;
}

int calx_svg_read(const char *path, const struct calx_svg_options *options, struct calx_svg *out,
                  struct calx_error *error)
{
    *out = (struct calx_svg){0};
    if (!(options->tolerance > 0) || !isfinite(options->tolerance) || !(options->scale >= 0) ||
        !isfinite(options->scale))
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s: tolerance must be positive and scale not negative", path);
    xmlDoc *document = NULL;
    CALX_TRY(parse(path, error, &document));
    struct calx_svg_sink sink = {
        .svg = out, .tolerance = options->tolerance, .place = {path, 0}, .error = error};
    int code = draw_in_c_locale(&sink, xmlDocGetRootElement(document), options);
    free(sink.tangents);
    xmlFreeDoc(document);
    if (code)
        calx_svg_free(out);
    return code;
}

void calx_svg_free(struct calx_svg *svg)
{
    for (size_t i = 0; i < svg->warning_count; i++)
        free(svg->warnings[i]);
    free(svg->warnings);
    free(svg->segments);
    free(svg->chains);
    *svg = (struct calx_svg){0};
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What style says about an element of an SVG file: whether it is hidden, and warnings for
 * properties and style sheets that change the drawing in ways that are not read. Properties come
 * from style="..." before attributes. Rules: SVG 1.1 (W3C, 2011), chapter 6.
 */
#include <libxml/hash.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_parts.h"

static const size_t most_warnings = 200;

int calx_svg_style_warn(struct calx_svg_sink *sink, const char *format, ...)
{
    struct calx_svg *svg = sink->svg;
    char text[400], *warning = NULL;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (svg->warning_count > most_warnings)
        return CALX_OK;
    if (svg->warning_count == most_warnings)
        strcpy(text, "and so on: further warnings are left out");
    char **more = realloc(svg->warnings, (svg->warning_count + 1) * sizeof *more);
    size_t size = strlen(sink->place.file) + strlen(text) + 16;
    if (more)
        svg->warnings = more;
    if (!more || !(warning = malloc(size)))
        return calx_error_set(sink->error, CALX_ERROR_MEMORY, "no memory for the warnings of %s",
                              sink->place.file);
    snprintf(warning, size, "%s:%d: %s", sink->place.file, sink->place.line, text);
    for (size_t i = 0; i < svg->warning_count; i++) {
        if (strcmp(svg->warnings[i], warning) == 0) {
            free(warning);
            return CALX_OK;
        }
    }
    svg->warnings[svg->warning_count++] = warning;
    return CALX_OK;
}

/* The value of a property from style="..." (the last one counts), else from the attribute; NULL if
 * absent; to be freed. */
static char *property(const xmlNode *node, const char *name)
{
    char *style = calx_svg_shape_attribute(node, "style"), *value = NULL, *rest = NULL;
    size_t length = strlen(name);
    for (char *item = style ? strtok_r(style, ";", &rest) : NULL; item;
         item = strtok_r(NULL, ";", &rest)) {
        item += strspn(item, " \t\r\n");
        char *colon = item + length +
                      strspn(item + (strlen(item) < length ? strlen(item) : length), " \t\r\n");
        if (strncmp(item, name, length) != 0 || *colon != ':')
            continue;
        colon += 1 + strspn(colon + 1, " \t\r\n");
        free(value);
        value = strndup(colon, strcspn(colon, " \t\r\n!"));
    }
    free(style);
    return value ? value : calx_svg_shape_attribute(node, name);
}

/* True if the element and all that it holds is not shown; `visible` is what its visibility says. */
bool calx_svg_style_hides(const xmlNode *node, bool *visible)
{
    char *display = property(node, "display"), *visibility = property(node, "visibility");
    bool hidden = display && strcmp(display, "none") == 0;
    if (visibility && strcmp(visibility, "inherit") != 0)
        *visible = strcmp(visibility, "visible") == 0;
    free(display);
    free(visibility);
    return hidden;
}

/* The element that url(#id) names, or NULL. */
static const xmlNode *find_paint(xmlHashTable *by_id, const char *paint)
{
    if (!paint || strncmp(paint, "url(#", 5) != 0)
        return NULL;
    char *id = strndup(paint + 5, strcspn(paint + 5, ")"));
    const xmlNode *node = id ? xmlHashLookup(by_id, (const xmlChar *)id) : NULL;
    free(id);
    return node;
}

/* Properties that change what is seen but not what is read here. */
int calx_svg_style_check(struct calx_svg_sink *sink, xmlHashTable *by_id, const xmlNode *node)
{
    static const struct {
        const char *name, *why;
    } table[] = {
        {"clip-path", "is not applied: the whole shape counts"},
        {"mask", "is not applied: the whole shape counts"},
        {"marker", "is not drawn: only the line itself counts"},
        {"marker-start", "is not drawn: only the line itself counts"},
        {"marker-mid", "is not drawn: only the line itself counts"},
        {"marker-end", "is not drawn: only the line itself counts"},
        {"transform-origin", "is not applied"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        char *value = property(node, table[i].name);
        int code = CALX_OK;
        if (value && strcmp(value, "none") != 0)
            code = calx_svg_style_warn(sink, "%s on <%s> %s", table[i].name,
                                       (const char *)node->name, table[i].why);
        free(value);
        CALX_TRY(code);
    }
    char *style = calx_svg_shape_attribute(node, "style"), *fill = property(node, "fill");
    const xmlNode *paint = find_paint(by_id, fill);
    int code = CALX_OK;
    if (style && strstr(style, "transform:"))
        code = calx_svg_style_warn(sink, "transform in style on <%s> is not applied",
                                   (const char *)node->name);
    if (!code && paint && strcmp((const char *)paint->name, "pattern") == 0)
        code = calx_svg_style_warn(sink, "the pattern that fills <%s> is not drawn",
                                   (const char *)node->name);
    free(style);
    free(fill);
    return code;
}

int calx_svg_style_check_sheet(struct calx_svg_sink *sink, const xmlNode *node)
{
    static const char *const hiding[] = {"display", "visibility", "transform"};
    xmlChar *text = xmlNodeGetContent(node);
    int code = CALX_OK;
    for (size_t i = 0; i < sizeof hiding / sizeof *hiding && !code; i++)
        if (text && strstr((const char *)text, hiding[i]))
            code = calx_svg_style_warn(sink,
                                       "the style sheet sets \"%s\", which is not applied: what it "
                                       "hides or moves is read as if it were absent",
                                       hiding[i]);
    xmlFree(text);
    return code;
}

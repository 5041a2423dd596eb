/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Elements of a case file: their places, names in messages, children, and the text of their
 * attributes.
 */
#include "io/case_reader.h"

#include <libxml/parser.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- messages
 * ------------------------------------------------------------------------------------------ */

struct calx_place calx_case_place(const struct calx_reader *r, const xmlNode *node)
{
    long line = xmlGetLineNo(node);
    return (struct calx_place){r->file, line > 0 ? (int)line : 0};
}

/* "stage 'turn': for: ", without the parts that there are not. */
static void label(const xmlNode *node, const char *attribute, char *out, size_t size)
{
    const char *name = calx_case_given(node, "name");
    const char *plugin = calx_case_given(node, "plugin");
    const char *called = name ? name : plugin;
    snprintf(out, size, "%.40s%s%.60s%s: %.60s%s", (const char *)node->name, called ? " '" : "",
             called ? called : "", called ? "'" : "", attribute ? attribute : "",
             attribute && *attribute ? ": " : "");
}

void calx_case_fail(struct calx_reader *r, const xmlNode *node, const char *attribute,
                    const char *format, ...)
{
    char where[256], text[1536];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    label(node, attribute, where, sizeof where);
    calx_problems_add(r->problems, calx_case_place(r, node), "%s%s", where, text);
}

void calx_case_fail_with(struct calx_reader *r, const xmlNode *node, const char *attribute,
                         const struct calx_error *e)
{
    calx_case_fail(r, node, attribute, "%.1500s", e->text);
}

void calx_case_fail_name(struct calx_reader *r, const xmlNode *node, const char *attribute,
                         const char *kind, const char *what, const char *const *names, size_t count)
{
    char list[512] = "";
    const char *nearest = calx_error_nearest(what, names, count);
    for (size_t k = 0, used = 0; k < count && used + 1 < sizeof list; k++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", names[k]);
    calx_case_fail(r, node, attribute, "no %s '%.80s'%s%s%s, expected %s%s", kind, what,
                   nearest ? ", nearest is '" : "", nearest ? nearest : "", nearest ? "'" : "",
                   count > 1 ? "one of " : "", count ? list : "none here");
}

void *calx_case_append(struct calx_reader *r, void *array_pointer, size_t *count, size_t entry_size)
{
    void **array = array_pointer;
    char *grown = realloc(*array, (*count + 1) * entry_size);
    if (!grown) {
        calx_problems_add(r->problems, (struct calx_place){r->file, 0}, "no memory");
        return NULL;
    }
    *array = grown;
    return memset(grown + entry_size * (*count)++, 0, entry_size);
}

/* ---- walking
 * ------------------------------------------------------------------------------------------- */

const struct calx_element *calx_case_element(const xmlNode *node)
{
    return node->_private;
}

static xmlNode *skip_to(xmlNode *node, const char *id)
{
    for (; node; node = node->next)
        if (node->type == XML_ELEMENT_NODE && node->_private &&
            strcmp(calx_case_element(node)->id, id) == 0)
            return node;
    return NULL;
}

xmlNode *calx_case_first(const xmlNode *parent, const char *id)
{
    return skip_to(parent->children, id);
}

xmlNode *calx_case_next(const xmlNode *node, const char *id)
{
    return skip_to(node->next, id);
}

/* ---- text
 * ---------------------------------------------------------------------------------------------- */

const char *calx_case_given(const xmlNode *node, const char *name)
{
    const xmlNode *text = NULL;
    if (*name) {
        const xmlAttr *attribute = xmlHasNsProp((xmlNode *)(uintptr_t)node, BAD_CAST name, NULL);
        if (!attribute)
            return NULL;
        text = attribute->children;
        return text && text->content ? (const char *)text->content : "";
    }
    for (text = node->children; text; text = text->next)
        if ((text->type == XML_TEXT_NODE || text->type == XML_CDATA_SECTION_NODE) &&
            !xmlIsBlankNode(text))
            return (const char *)text->content;
    return NULL;
}

const char *calx_case_text(const xmlNode *node, const char *name)
{
    const char *given = calx_case_given(node, name);
    return given ? given : calx_element_attribute(calx_case_element(node), name)->initial;
}

static char *join(const char *directory, const char *path)
{
    size_t size = strlen(directory) + strlen(path) + 2;
    char *joined = malloc(size);
    if (joined)
        snprintf(joined, size, "%s/%s", directory, path);
    return joined;
}

char *calx_case_path(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_given(node, name);
    struct stat status;
    if (!text)
        return NULL;
    char *path = *text == '/' ? strdup(text) : join(r->scene->directory, text);
    if (path && stat(path, &status) == 0 && S_ISREG(status.st_mode))
        return path;
    calx_case_fail(r, node, name, "no file '%.300s'", path ? path : text);
    free(path);
    return NULL;
}

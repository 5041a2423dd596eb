/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Settings from the command line. Input: "stage[turn]/for" and a value. Output: attributes of the
 * document, set before it is checked, so that they are checked like all others. A step of a path is
 * an element, with [name] or [number from 1] where there are several.
 */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "io/case_reader.h"

#define LONGEST_STEP 128

/* One part of a path. */
struct step {
    char name[LONGEST_STEP], selector[LONGEST_STEP];
};

struct setter {
    struct calx_reader *reader;
    const struct calx_setting *setting;
};

static void fail(const struct setter *s, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void fail(const struct setter *s, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    calx_problems_add(s->reader->problems, (struct calx_place){NULL, 0}, "--set %.200s: %s",
                      s->setting->path, text);
}

/* Takes the part up to the next '/' off the path. */
static bool next_step(const char **path, struct step *step)
{
    size_t length = strcspn(*path, "/"), name = strcspn(*path, "[/");
    size_t selector = name < length ? length - name : 0;
    if (!name || length >= LONGEST_STEP ||
        (selector && (selector < 3 || (*path)[length - 1] != ']')))
        return false;
    snprintf(step->name, sizeof step->name, "%.*s", (int)name, *path);
    snprintf(step->selector, sizeof step->selector, "%.*s", selector ? (int)selector - 2 : 0,
             selector ? *path + name + 1 : "");
    *path += length + ((*path)[length] == '/');
    return true;
}

/* ---- finding an element
 * -------------------------------------------------------------------------------- */

static bool is_called(const xmlNode *node, const char *name)
{
    static const char *const names[] = {"name", "plugin", "of", "walls", "file"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const char *given = calx_case_given(node, names[k]);
        if (given && strcmp(given, name) == 0)
            return true;
    }
    return false;
}

static bool is_chosen(const xmlNode *node, const struct step *step, size_t number)
{
    char *end;
    unsigned long wanted = strtoul(step->selector, &end, 10);
    if (!*step->selector)
        return true;
    return (*end == '\0' && isdigit((unsigned char)*step->selector) && wanted == number) ||
           is_called(node, step->selector);
}

/* An integrator without `of` is that of motion: the plain path means it. */
static bool is_preferred(const xmlNode *node)
{
    return !calx_case_given(node, "of");
}

static void describe(const xmlNode *node, char *out, size_t size)
{
    const char *name = calx_case_given(node, "name"), *plugin = calx_case_given(node, "plugin");
    const char *called = name ? name : plugin;
    snprintf(out, size, " %.40s%s%.47s%s", (const char *)node->name, called ? "[" : "",
             called ? called : "", called ? "]" : "");
}

static void fail_none(const struct setter *s, const xmlNode *parent, const struct step *step)
{
    char list[512] = "";
    size_t used = 0;
    for (const xmlNode *node = parent->children; node; node = node->next)
        if (node->type == XML_ELEMENT_NODE && used + 100 < sizeof list) {
            describe(node, list + used, sizeof list - used);
            used += strlen(list + used);
        }
    fail(s, "no element '%s%s%s%s' in <%.40s>, there are:%s", step->name,
         *step->selector ? "[" : "", step->selector, *step->selector ? "]" : "",
         (const char *)parent->name, used ? list : " none");
}

static xmlNode *find_child(const struct setter *s, xmlNode *parent, const struct step *step)
{
    xmlNode *found = NULL, *preferred = NULL;
    size_t number = 0, count = 0, preferred_count = 0;
    for (xmlNode *node = parent->children; node; node = node->next) {
        if (node->type != XML_ELEMENT_NODE || strcmp((const char *)node->name, step->name) != 0 ||
            !is_chosen(node, step, ++number))
            continue;
        found = node;
        count++;
        if (is_preferred(node)) {
            preferred = node;
            preferred_count++;
        }
    }
    if (!count)
        fail_none(s, parent, step);
    else if (count > 1 && preferred_count != 1)
        fail(s, "%zu elements '%s' fit, choose one: %s[name] or %s[1] to %s[%zu]", count,
             step->name, step->name, step->name, step->name, number);
    else
        return count == 1 ? found : preferred;
    return NULL;
}

/* ---- setting
 * ------------------------------------------------------------------------------------------- */

/* Whether the path ends at an element whose text is its value, as in "gravity". */
static bool ends_at_text(const xmlNode *node, const char *name)
{
    const struct calx_child *child = calx_element_child(calx_elements_root(), name);
    return node->parent && node->parent->type == XML_DOCUMENT_NODE && child &&
           calx_element_attribute(child->element, "");
}

static void set_value(const struct setter *s, xmlNode *node, const struct step *last)
{
    const char *value = s->setting->value;
    if (*last->selector) {
        fail(s, "ends with '%s[%s]', expected an attribute at the end", last->name, last->selector);
    } else if (ends_at_text(node, last->name)) {
        xmlNode *child = find_child(s, node, last);
        xmlChar *escaped = child ? xmlEncodeSpecialChars(node->doc, BAD_CAST value) : NULL;
        if (escaped)
            xmlNodeSetContent(child, escaped);
        xmlFree(escaped);
    } else if (!xmlSetProp(node, BAD_CAST last->name, BAD_CAST value)) {
        fail(s, "cannot be set");
    }
}

static bool is_element_name(const char *name)
{
    const struct calx_element *list[64];
    size_t count = calx_elements_list(list, 64);
    for (size_t k = 0; k < count; k++)
        if (strcmp(list[k]->name, name) == 0)
            return true;
    return false;
}

static void apply(const struct setter *s)
{
    const char *path = s->setting->path;
    xmlNode *node = s->reader->root;
    struct step step;
    while (node && next_step(&path, &step)) {
        if (!*path) {
            if (is_element_name(step.name) && !ends_at_text(node, step.name) &&
                !calx_case_given(node, step.name))
                fail(s, "ends with an element, expected an attribute: %.200s/...",
                     s->setting->path);
            else
                set_value(s, node, &step);
            return;
        }
        node = find_child(s, node, &step);
    }
    if (node)
        fail(s, "expected element/attribute, with [name] or [number] behind an element where there "
                "are several");
}

void calx_case_apply_settings(struct calx_reader *r, const struct calx_setting *settings,
                              size_t count)
{
    for (size_t k = 0; k < count; k++)
        apply(&(struct setter){r, &settings[k]});
}

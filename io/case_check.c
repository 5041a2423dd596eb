/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The first pass over a case file: every element and attribute against the tables of
 * io/element_tables.c and of the plugins. Finds unknown and missing names, elements too often, text
 * where none belongs, values of a wrong form. Marks known elements with their row, so that the
 * other passes skip what this one refused.
 */
#include "io/case_reader.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <stdlib.h>

/* ---- attributes
 * ---------------------------------------------------------------------------------------- */

static void check_name(struct calx_reader *r, const xmlNode *node, const struct calx_attribute *row)
{
    const char *text = calx_case_text(node, row->name);
    if (!*text || strlen(text) > 47)
        calx_case_fail(r, node, row->name, "'%.80s', expected a name of 1 to 47 characters", text);
    for (const char *c = text; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c)) {
            calx_case_fail(r, node, row->name,
                           "'%.80s' has a character that is not a letter, digit, '-', '_' or '.'",
                           text);
            break;
        }
}

static void check_file(struct calx_reader *r, const xmlNode *node, const struct calx_attribute *row)
{
    free(calx_case_path(r, node, row->name));
}

static void check_word(struct calx_reader *r, const xmlNode *node, const struct calx_attribute *row)
{
    calx_case_word(r, node, row->name);
}

static void check_words(struct calx_reader *r, const xmlNode *node,
                        const struct calx_attribute *row)
{
    calx_case_words(r, node, row->name);
}

static void check_switch(struct calx_reader *r, const xmlNode *node,
                         const struct calx_attribute *row)
{
    calx_case_yes(r, node, row->name);
}

static void check_whole(struct calx_reader *r, const xmlNode *node,
                        const struct calx_attribute *row)
{
    calx_case_whole(r, node, row->name);
}

static void check_quantity(struct calx_reader *r, const xmlNode *node,
                           const struct calx_attribute *row)
{
    if (row->unit)
        calx_case_number(r, node, row->name);
}

static void check_vector(struct calx_reader *r, const xmlNode *node,
                         const struct calx_attribute *row)
{
    double vector[3];
    calx_case_vector(r, node, row->name, vector);
}

/* The checks of forms that need no more than the attribute; the others are checked where they are
 * read. */
static void (*const form_checks[])(struct calx_reader *, const xmlNode *,
                                   const struct calx_attribute *) = {
    [CALX_FORM_NAME] = check_name,         [CALX_FORM_FILE] = check_file,
    [CALX_FORM_WORD] = check_word,         [CALX_FORM_WORDS] = check_words,
    [CALX_FORM_SWITCH] = check_switch,     [CALX_FORM_WHOLE] = check_whole,
    [CALX_FORM_QUANTITY] = check_quantity, [CALX_FORM_AUTO] = check_quantity,
    [CALX_FORM_VECTOR] = check_vector,     [CALX_FORM_RESULT] = NULL};

static void check_known_attribute(struct calx_reader *r, const xmlNode *node,
                                  const struct calx_attribute *row)
{
    bool given = calx_case_given(node, row->name) != NULL;
    if (given && form_checks[row->form])
        form_checks[row->form](r, node, row);
    if (!given && row->flags & CALX_ATTRIBUTE_REQUIRED)
        calx_case_fail(r, node, NULL, "attribute '%s' is missing: %s", row->name, row->doc);
}

#define MOST_NAMES 128

static size_t add_parameter_names(const struct calx_plugin *plugin, bool materials,
                                  const char **names, size_t count)
{
    for (size_t k = 0; k < plugin->parameter_count; k++)
        if ((plugin->parameters[k].scope == CALX_MATERIAL) == materials && count < MOST_NAMES)
            names[count++] = plugin->parameters[k].name;
    return count;
}

/* What the attribute could have been. */
static size_t valid_names(struct calx_reader *r, const xmlNode *node, const char **names)
{
    const struct calx_element *element = calx_case_element(node);
    size_t count = 0;
    for (size_t k = 0; k < element->attribute_count; k++)
        if (*element->attributes[k].name)
            names[count++] = element->attributes[k].name;
    if (element->parameters == CALX_TAKES_MATERIAL)
        for (size_t k = 0; k < r->plugin_count; k++)
            count = add_parameter_names(r->plugins[k], true, names, count);
    else if (element->parameters != CALX_TAKES_NONE) {
        const struct calx_plugin *plugin = calx_case_plugin(r, node, NULL);
        count = plugin ? add_parameter_names(plugin, false, names, count) : count;
    }
    return count;
}

/* Whether parameters of this element cannot be known because a plugin is not there. */
static bool excused(struct calx_reader *r, const xmlNode *node)
{
    enum calx_parameters takes = calx_case_element(node)->parameters;
    return takes == CALX_TAKES_MATERIAL
               ? r->plugin_missing
               : takes != CALX_TAKES_NONE && !calx_case_plugin(r, node, NULL);
}

static void check_unknown_attribute(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *names[MOST_NAMES];
    const struct calx_parameter *parameter = calx_case_parameter(r, node, name);
    if (parameter)
        calx_case_parameter_value(r, node, parameter, calx_case_given(node, name));
    else {
        size_t count = valid_names(r, node, names);
        if (!excused(r, node) || calx_error_nearest(name, names, count))
            calx_case_fail_name(r, node, NULL, "attribute", name, names, count);
    }
}

static void check_attributes(struct calx_reader *r, const xmlNode *node)
{
    const struct calx_element *element = calx_case_element(node);
    for (const xmlAttr *a = node->properties; a; a = a->next)
        if (!a->ns && !calx_element_attribute(element, (const char *)a->name))
            check_unknown_attribute(r, node, (const char *)a->name);
    for (size_t k = 0; k < element->attribute_count; k++)
        check_known_attribute(r, node, &element->attributes[k]);
}

/* ---- children
 * ------------------------------------------------------------------------------------------ */

static void fail_unknown_child(struct calx_reader *r, const xmlNode *parent, const xmlNode *child)
{
    const struct calx_element *element = calx_case_element(parent);
    const char *names[32];
    char kind[96];
    for (size_t k = 0; k < element->child_count; k++)
        names[k] = element->children[k].element->name;
    snprintf(kind, sizeof kind, "element inside <%.40s> called", element->name);
    calx_case_fail_name(r, child, NULL, kind, (const char *)child->name, names,
                        element->child_count);
}

static void mark_child(struct calx_reader *r, const xmlNode *parent, xmlNode *child)
{
    const struct calx_element *element = calx_case_element(parent);
    const struct calx_child *known = calx_element_child(element, (const char *)child->name);
    if (known)
        child->_private = (void *)(uintptr_t)known->element;
    else
        fail_unknown_child(r, parent, child);
}

static void check_occurrence(struct calx_reader *r, const xmlNode *parent,
                             const struct calx_child *child)
{
    const xmlNode *first = calx_case_first(parent, child->element->id);
    const xmlNode *second = first ? calx_case_next(first, child->element->id) : NULL;
    if (!first && child->occurs == '+')
        calx_case_fail(r, parent, NULL, "needs at least one <%s>", child->element->name);
    if (second && child->occurs == '?')
        calx_case_fail(r, second, NULL, "there is already a <%s> on line %d, expected one",
                       child->element->name, calx_case_place(r, first).line);
}

static void check_text(struct calx_reader *r, const xmlNode *node, const xmlNode *text)
{
    const char *word = (const char *)text->content;
    word += strspn(word, " \t\r\n");
    if (*word && !calx_element_attribute(calx_case_element(node), ""))
        calx_case_fail(r, node, NULL, "text '%.*s' does not belong here",
                       (int)strcspn(word, "\r\n"), word);
}

static void check_element(struct calx_reader *r, xmlNode *node)
{
    const struct calx_element *element = calx_case_element(node);
    check_attributes(r, node);
    for (xmlNode *child = node->children; child; child = child->next) {
        if (child->type == XML_ELEMENT_NODE)
            mark_child(r, node, child);
        else if (child->type == XML_TEXT_NODE || child->type == XML_CDATA_SECTION_NODE)
            check_text(r, node, child);
    }
    for (size_t k = 0; k < element->child_count; k++)
        check_occurrence(r, node, &element->children[k]);
    for (xmlNode *child = node->children; child; child = child->next)
        if (child->_private)
            check_element(r, child);
}

void calx_case_check(struct calx_reader *r)
{
    r->root->_private = (void *)(uintptr_t)calx_elements_root();
    int dimension = calx_case_word(r, r->root, "dimension");
    r->scene->dimension = dimension == 0 ? 2 : 3;
    calx_case_find_plugins(r);
    check_element(r, r->root);
}

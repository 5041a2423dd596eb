/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The grammar of the case file for editors and validators. Input: the tables of elements and those
 * of all plugins. Output: RELAX NG in XML syntax (ISO/IEC 19757-2). It checks names and words, not
 * units: those are the reader's.
 */
#include "io/schema.h"

#include <libxml/xmlwriter.h>
#include <string.h>

#include "io/elements.h"

#define RELAX_NG "http://relaxng.org/ns/structure/1.0"
#define ANNOTATIONS "http://relaxng.org/ns/compatibility/annotations/1.0"
#define DATATYPES "http://www.w3.org/2001/XMLSchema-datatypes"

#define MOST_ELEMENTS 64

struct schema {
    xmlTextWriter *out;
    struct calx_registry *registry;
};

/* ---- small pieces
 * -------------------------------------------------------------------------------------- */

static void open_element(struct schema *s, const char *name)
{
    xmlTextWriterStartElement(s->out, BAD_CAST name);
}

static void open_named(struct schema *s, const char *element, const char *name)
{
    open_element(s, element);
    xmlTextWriterWriteAttribute(s->out, BAD_CAST "name", BAD_CAST name);
}

static void close_element(struct schema *s)
{
    xmlTextWriterEndElement(s->out);
}

static void write_empty(struct schema *s, const char *element, const char *attribute,
                        const char *value)
{
    open_element(s, element);
    if (attribute)
        xmlTextWriterWriteAttribute(s->out, BAD_CAST attribute, BAD_CAST value);
    close_element(s);
}

static void write_doc(struct schema *s, const char *doc)
{
    xmlTextWriterWriteElement(s->out, BAD_CAST "a:documentation", BAD_CAST doc);
}

static void write_value(struct schema *s, const char *value)
{
    xmlTextWriterWriteElement(s->out, BAD_CAST "value", BAD_CAST value);
}

static void write_choice(struct schema *s, const char *choices)
{
    char word[64];
    open_element(s, "choice");
    for (const char *at = choices; *at;) {
        size_t length = strcspn(at, "|");
        snprintf(word, sizeof word, "%.*s", (int)length, at);
        write_value(s, word);
        at += length + (at[length] == '|');
    }
    close_element(s);
}

/* ---- attributes
 * ---------------------------------------------------------------------------------------- */

static void write_words(struct schema *s, const char *choices)
{
    open_element(s, "list");
    open_element(s, "zeroOrMore");
    write_choice(s, choices);
    close_element(s);
    close_element(s);
}

static void write_switch(struct schema *s, const char *choices)
{
    (void)choices;
    write_choice(s, "yes|no");
}

static void write_whole(struct schema *s, const char *choices)
{
    (void)choices;
    write_empty(s, "data", "type", "nonNegativeInteger");
}

/* Forms with a pattern narrower than text. */
static void (*const patterns[])(struct schema *,
                                const char *choices) = {[CALX_FORM_WORD] = write_choice,
                                                        [CALX_FORM_WORDS] = write_words,
                                                        [CALX_FORM_SWITCH] = write_switch,
                                                        [CALX_FORM_WHOLE] = write_whole,
                                                        [CALX_FORM_RESULT] = NULL};

static void write_attribute(struct schema *s, const struct calx_attribute *row)
{
    bool required = row->flags & CALX_ATTRIBUTE_REQUIRED;
    if (!required)
        open_element(s, "optional");
    open_named(s, "attribute", row->name);
    write_doc(s, row->doc);
    if (patterns[row->form])
        patterns[row->form](s, row->choices);
    else
        write_empty(s, "text", NULL, NULL);
    close_element(s);
    if (!required)
        close_element(s);
}

static void write_parameter(struct schema *s, const struct calx_parameter *row, bool required)
{
    char doc[512];
    snprintf(doc, sizeof doc, "%s [%s]", row->doc, row->unit);
    if (!required)
        open_element(s, "optional");
    open_named(s, "attribute", row->name);
    write_doc(s, doc);
    if (row->flags & CALX_SWITCH)
        write_choice(s, "no|yes");
    else if (row->flags & CALX_CHOICE)
        write_choice(s, row->choices);
    else
        write_empty(s, "text", NULL, NULL);
    close_element(s);
    if (!required)
        close_element(s);
}

/* The element's own attributes except `plugin` and `of`, which come with each plugin. */
static void write_own_attributes(struct schema *s, const struct calx_element *element)
{
    bool model = element->parameters == CALX_TAKES_RUN_AND_PAIR;
    for (size_t k = 0; k < element->attribute_count; k++) {
        const char *name = element->attributes[k].name;
        if (*name && !(model && (strcmp(name, "plugin") == 0 || strcmp(name, "of") == 0)))
            write_attribute(s, &element->attributes[k]);
    }
}

/* ---- models
 * -------------------------------------------------------------------------------------------- */

static void write_pair(struct schema *s, const struct calx_element *pair,
                       const struct calx_plugin *plugin)
{
    open_element(s, "zeroOrMore");
    open_named(s, "element", pair->name);
    write_doc(s, pair->doc);
    write_own_attributes(s, pair);
    for (size_t k = 0; k < plugin->parameter_count; k++)
        if (plugin->parameters[k].scope == CALX_PAIR)
            write_parameter(s, &plugin->parameters[k], false);
    close_element(s);
    close_element(s);
}

/* `of` tells the integrators apart; that of motion may leave it out. */
static void write_of(struct schema *s, enum calx_kind kind)
{
    if (kind == CALX_MOTION)
        open_element(s, "optional");
    open_named(s, "attribute", "of");
    write_value(s, kind == CALX_MOTION ? "motion" : "temperature");
    close_element(s);
    if (kind == CALX_MOTION)
        close_element(s);
}

static void write_model(struct schema *s, const struct calx_element *element,
                        const struct calx_plugin *plugin)
{
    enum calx_kind kind = (enum calx_kind)plugin->kind;
    open_element(s, "group");
    open_named(s, "attribute", "plugin");
    write_doc(s, plugin->summary);
    write_value(s, plugin->name);
    close_element(s);
    if (calx_element_attribute(element, "of"))
        write_of(s, kind);
    for (size_t k = 0; k < plugin->parameter_count; k++) {
        const struct calx_parameter *row = &plugin->parameters[k];
        if (row->scope != CALX_MATERIAL)
            write_parameter(s, row, row->scope == CALX_RUN && row->flags & CALX_REQUIRED);
    }
    for (size_t k = 0; k < element->child_count; k++)
        write_pair(s, element->children[k].element, plugin);
    close_element(s);
}

static bool fits(const struct calx_element *element, const struct calx_plugin *plugin)
{
    static const struct {
        const char *element;
        enum calx_kind kind;
    } kinds[] = {{"contact", CALX_CONTACT},
                 {"conductance", CALX_CONDUCTANCE},
                 {"integrator", CALX_MOTION},
                 {"integrator", CALX_TEMPERATURE}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (strcmp(kinds[k].element, element->name) == 0 && kinds[k].kind == plugin->kind)
            return true;
    return false;
}

static void write_models(struct schema *s, const struct calx_element *element)
{
    size_t written = 0;
    open_element(s, "choice");
    for (size_t k = 0; k < calx_registry_count(s->registry); k++)
        if (fits(element, calx_registry_at(s->registry, k))) {
            write_model(s, element, calx_registry_at(s->registry, k));
            written++;
        }
    if (!written)
        write_empty(s, "notAllowed", NULL, NULL);
    close_element(s);
}

/* Parameters of materials, each once, that the element's own table lacks. */
static void write_material_parameters(struct schema *s, const struct calx_element *element)
{
    const char *done[128];
    size_t count = 0;
    for (size_t k = 0; k < calx_registry_count(s->registry); k++) {
        const struct calx_plugin *plugin = calx_registry_at(s->registry, k);
        for (size_t p = 0; p < plugin->parameter_count && count < 128; p++) {
            const struct calx_parameter *row = &plugin->parameters[p];
            bool known = row->scope != CALX_MATERIAL || calx_element_attribute(element, row->name);
            for (size_t d = 0; d < count && !known; d++)
                known = strcmp(done[d], row->name) == 0;
            if (known)
                continue;
            done[count++] = row->name;
            write_parameter(s, row, false);
        }
    }
}

/* ---- elements
 * ------------------------------------------------------------------------------------------ */

static void write_child(struct schema *s, const struct calx_child *child)
{
    open_element(s, child->occurs == '?'   ? "optional"
                    : child->occurs == '+' ? "oneOrMore"
                                           : "zeroOrMore");
    write_empty(s, "ref", "name", child->element->id);
    close_element(s);
}

static void write_content(struct schema *s, const struct calx_element *element)
{
    write_own_attributes(s, element);
    if (element->parameters == CALX_TAKES_MATERIAL)
        write_material_parameters(s, element);
    if (element->parameters == CALX_TAKES_RUN_AND_PAIR) {
        write_models(s, element);
        return;
    }
    if (element->child_count) {
        open_element(s, "interleave");
        for (size_t k = 0; k < element->child_count; k++)
            write_child(s, &element->children[k]);
        close_element(s);
    }
    if (calx_element_attribute(element, ""))
        write_empty(s, "text", NULL, NULL);
    else if (!element->child_count)
        write_empty(s, "empty", NULL, NULL);
}

static void write_element(struct schema *s, const struct calx_element *element)
{
    open_named(s, "define", element->id);
    open_named(s, "element", element->name);
    write_doc(s, element->doc);
    write_content(s, element);
    close_element(s);
    close_element(s);
}

static void write_grammar(struct schema *s)
{
    const struct calx_element *list[MOST_ELEMENTS];
    size_t count = calx_elements_list(list, MOST_ELEMENTS);
    xmlTextWriterSetIndent(s->out, 1);
    xmlTextWriterStartDocument(s->out, NULL, "UTF-8", NULL);
    open_element(s, "grammar");
    xmlTextWriterWriteAttribute(s->out, BAD_CAST "xmlns", BAD_CAST RELAX_NG);
    xmlTextWriterWriteAttribute(s->out, BAD_CAST "xmlns:a", BAD_CAST ANNOTATIONS);
    xmlTextWriterWriteAttribute(s->out, BAD_CAST "datatypeLibrary", BAD_CAST DATATYPES);
    open_element(s, "start");
    write_empty(s, "ref", "name", calx_elements_root()->id);
    close_element(s);
    for (size_t k = 0; k < count; k++)
        if (list[k]->parameters != CALX_TAKES_PAIR) /* those stand inside each plugin's group */
            write_element(s, list[k]);
    close_element(s);
    xmlTextWriterEndDocument(s->out);
}

int calx_schema_write(FILE *file, struct calx_registry *registry)
{
    struct schema s = {.registry = registry};
    xmlBuffer *buffer = xmlBufferCreate();
    s.out = buffer ? xmlNewTextWriterMemory(buffer, 0) : NULL;
    int code = CALX_ERROR_MEMORY;
    if (s.out) {
        calx_registry_load_all(registry, NULL);
        write_grammar(&s);
        xmlFreeTextWriter(s.out);
        fputs((const char *)xmlBufferContent(buffer), file);
        code = fflush(file) || ferror(file) ? CALX_ERROR_IO : CALX_OK;
    }
    if (buffer)
        xmlBufferFree(buffer);
    return code;
}

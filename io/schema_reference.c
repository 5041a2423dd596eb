/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The reference of the case file for people, cases/FORMAT.md. Input: the tables of elements.
 * Output: Markdown; the text before the tables is here, everything about elements comes from the
 * tables.
 */
#include <math.h>
#include <string.h>

#include "core/measure.h"
#include "io/elements.h"
#include "io/schema.h"

#define MOST_ELEMENTS 64

static const char introduction[] =
    "# The case file\n"
    "\n"
    "<!-- Written by `calx schema --reference > cases/FORMAT.md`; change io/element_tables.c, "
    "io/element_bodies.c. -->\n"
    "\n"
    "A case is an XML file in UTF-8. `calx check CASE` reports all its mistakes with their lines; "
    "`calx schema` prints a RELAX NG\n"
    "grammar for completion in editors; `calx plugins NAME` documents the parameters of a model.\n"
    "\n"
    "```xml\n"
    "<case title=\"A ball falls on a plate\" dimension=\"2\">\n"
    "  <material name=\"steel\" density=\"7800 kg/m3\"/>\n"
    "  <contact plugin=\"linear\" stiffness=\"6000 N/m\" restitution=\"0.8\"/>\n"
    "  <integrator plugin=\"velocity-verlet\"/>\n"
    "  <gravity>0 -9.81 m/s2</gravity>\n"
    "  <walls name=\"plate\" material=\"steel\"><plane normal=\"0 1\"/></walls>\n"
    "  <particles material=\"steel\"><particle at=\"0 20 mm\" radius=\"2 mm\"/></particles>\n"
    "  <stage for=\"1 s\"/>\n"
    "  <output every=\"10 ms\"/>\n"
    "  <probe name=\"height\" of=\"position\" particle=\"0\" component=\"y\"/>\n"
    "  <expect of=\"height\" max=\"yes\" below=\"20.001 mm\" source=\"it cannot rise above its "
    "start\"/>\n"
    "</case>\n"
    "```\n"
    "\n"
    "**Numbers.** A number may carry any unit that UDUNITS-2 knows and that has the dimension "
    "given below: `2 mm`, `20 rpm`,\n"
    "`107 degC`, `30 deg`, `6e3 N/m`, `172 J/(kg K)`. A bare number is SI. An angle is not a pure "
    "number: a frequency is in `Hz`, a\n"
    "rate of rotation in `rad/s`, `deg/s` or `rpm`. Lists share a unit at the end, `0 -9.81 m/s2`, "
    "or have several, `2 mm 0.4 cm`; a unit\n"
    "holds for the numbers before it that have none.\n"
    "\n"
    "**Vectors** have as many components as the case has dimensions. In 2D a third component may "
    "be given if it is 0.\n"
    "\n"
    "**Expressions.** Where the tables say so, a number may be a "
    "[muParser](https://beltoforion.de/en/muparser) expression of the variables named\n"
    "there: `t` is the time of the run in s, `x`, `y`, `z` are in m. A unit stands in brackets at "
    "the end: `25 + 10*t [degC]`; without it the\n"
    "result is SI. Constants are `_pi`, `_e` and those of the attribute `where`. Components of a "
    "vector are expressions without blanks, or have\n"
    "semicolons between them: `0.1*sin(t) 0` or `0.1*sin(t); 1 - t [m/s]`.\n"
    "\n"
    "**Names** are letters, digits, `-`, `_` and `.`, at most 47 of them. **Files** are relative "
    "to the case file.\n"
    "\n"
    "**Settings.** `--set path=value` sets an attribute before the case is read. The path is made "
    "of elements below `case`, with `[name]` or\n"
    "`[number from 1]` where there are several, and ends with an attribute: `--set "
    "\"stage[turn]/for=1 s\"`, `--set particles/pack/count=100`,\n"
    "`--set integrator/dt=1e-5` (that of motion; `integrator[temperature]/dt` is the other), "
    "`--set \"gravity=0 -1.6 m/s2\"`.\n"
    "\n"
    "In the tables below, **bold** attributes are required.\n";

/* What the form of an attribute is called in the tables. */
static const char *const form_names[] = {
    [CALX_FORM_TEXT] = "text",
    [CALX_FORM_NAME] = "name",
    [CALX_FORM_FILE] = "file",
    [CALX_FORM_WORD] = "word",
    [CALX_FORM_WORDS] = "words",
    [CALX_FORM_SWITCH] = "yes or no",
    [CALX_FORM_WHOLE] = "whole number",
    [CALX_FORM_WHOLES] = "whole numbers",
    [CALX_FORM_QUANTITY] = "number",
    [CALX_FORM_AUTO] = "`auto` or number",
    [CALX_FORM_VECTOR] = "vector",
    [CALX_FORM_LIST] = "numbers",
    [CALX_FORM_VARIES] = "number or expression",
    [CALX_FORM_VARYING_VECTOR] = "vector or expressions",
    [CALX_FORM_RANDOM_VECTOR] = "vector or random",
    [CALX_FORM_SIZES] = "radius or distribution",
    [CALX_FORM_CONDITION] = "time or condition",
    [CALX_FORM_RESULT] = "yes, number or expression",
};

/* Text in a cell of a table: a bar would end the cell. */
static void write_cell(FILE *out, const char *text)
{
    for (; *text; text++)
        fprintf(out, *text == '|' ? "\\|" : "%c", *text);
}

static void write_choices(FILE *out, const struct calx_attribute *row)
{
    for (const char *at = row->choices; *at;) {
        size_t length = strcspn(at, "|");
        fprintf(out, "%s`%.*s`", at == row->choices ? "" : ", ", (int)length, at);
        at += length + (at[length] == '|');
    }
}

static bool takes_variables(const struct calx_attribute *row)
{
    return row->form == CALX_FORM_VARIES || row->form == CALX_FORM_VARYING_VECTOR ||
           row->form == CALX_FORM_RESULT;
}

static void write_form(FILE *out, const struct calx_attribute *row)
{
    if (row->form == CALX_FORM_WORD || row->form == CALX_FORM_WORDS) {
        write_choices(out, row);
        return;
    }
    fputs(form_names[row->form], out);
    if (takes_variables(row) && row->choices) {
        fputs(" of ", out);
        for (const char *v = row->choices; *v; v++)
            fprintf(out, "%s`%c`", v == row->choices ? "" : ", ", *v);
    }
}

static void write_unit(FILE *out, const struct calx_attribute *row)
{
    if (row->unit && strcmp(row->unit, "1") != 0)
        fprintf(out, "%s", row->unit);
    else if (takes_variables(row) || row->form == CALX_FORM_QUANTITY)
        fputs(row->unit ? "" : "of the quantity", out);
}

/* Bounds this far out are there to catch mistakes, they tell a reader nothing. */
#define FAR_OUT 1e9

static void write_range(FILE *out, const struct calx_attribute *row)
{
    bool from = row->min > -FAR_OUT, to = row->max < FAR_OUT;
    if (!(row->min < row->max))
        return;
    if (from)
        fprintf(out, "%s %g", row->flags & CALX_ATTRIBUTE_OPEN_MIN ? ">" : ">=", row->min);
    if (to)
        fprintf(out, "%s<= %g", from ? ", " : "", row->max);
}

static void write_row(FILE *out, const struct calx_attribute *row)
{
    const char *bold = row->flags & CALX_ATTRIBUTE_REQUIRED ? "**" : "";
    fprintf(out, "| %s%s%s | ", bold, *row->name ? row->name : "(text)", bold);
    write_form(out, row);
    fputs(" | ", out);
    write_unit(out, row);
    fputs(" | ", out);
    write_range(out, row);
    fprintf(out, " | %s | ", row->initial ? row->initial : "");
    write_cell(out, row->doc);
    fputs(" |\n", out);
}

static void write_children(FILE *out, const struct calx_element *element)
{
    static const struct {
        char occurs;
        const char *text;
    } words[] = {{'?', " (at most one)"}, {'+', " (at least one)"}, {'*', ""}};
    fputs("\nInside: ", out);
    for (size_t k = 0; k < element->child_count; k++) {
        fprintf(out, "%s`%s`", k ? ", " : "", element->children[k].element->name);
        for (size_t w = 0; w < sizeof words / sizeof *words; w++)
            if (words[w].occurs == element->children[k].occurs)
                fputs(words[w].text, out);
    }
    fputs(".\n", out);
}

static void write_element(FILE *out, const struct calx_element *element)
{
    bool renamed = strcmp(element->name, element->id) != 0;
    fprintf(out, "\n## %s%s\n\n%s\n", element->name, renamed ? " (inside stage)" : "",
            element->doc);
    if (element->child_count)
        write_children(out, element);
    fputs("\n| attribute | form | unit | range | default | meaning |\n|---|---|---|---|---|---|\n",
          out);
    for (size_t k = 0; k < element->attribute_count; k++)
        write_row(out, &element->attributes[k]);
}

static void write_quantities(FILE *out)
{
    fputs("\n## Quantities\n\nWhat `probe`, `expect` and the conditions of stages may name; for "
          "those `of particles` a probe chooses one "
          "particle or how to reduce all of them to one number.\n\n| quantity | unit | of | "
          "meaning |\n|---|---|---|---|\n",
          out);
    for (size_t k = 0; k < calx_measure_count(); k++) {
        const struct calx_measure *measure = calx_measure_at(k);
        fprintf(out, "| %s | %s | %s%s | ", measure->name, measure->unit,
                measure->per_particle ? "particles" : "the scene",
                measure->components > 1 ? ", a vector" : "");
        write_cell(out, measure->doc);
        fputs(" |\n", out);
    }
    fprintf(out, "\nClasses for a mixing index: %s.\n", calx_measure_classes());
}

int calx_schema_write_reference(FILE *out)
{
    const struct calx_element *list[MOST_ELEMENTS];
    size_t count = calx_elements_list(list, MOST_ELEMENTS);
    fputs(introduction, out);
    for (size_t k = 0; k < count; k++)
        write_element(out, list[k]);
    write_quantities(out);
    return fflush(out) || ferror(out) ? CALX_ERROR_IO : CALX_OK;
}

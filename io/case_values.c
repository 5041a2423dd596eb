/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Values of attributes. Input: an element and the name of an attribute; form, unit, default and
 * range come from the tables. Output: numbers in SI, functions, indices; what is wrong becomes a
 * problem and NaN, -1 or false.
 */
#include "io/case_reader.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/expression.h"
#include "io/quantity.h"

static const struct calx_attribute *row_of(const xmlNode *node, const char *name)
{
    return calx_element_attribute(calx_case_element(node), name);
}

/* ---- numbers
 * ------------------------------------------------------------------------------------------- */

static bool has_range(const struct calx_attribute *row)
{
    return row->min < row->max;
}

static bool in_range(const struct calx_attribute *row, double v)
{
    bool above = row->flags & CALX_ATTRIBUTE_OPEN_MIN ? v > row->min : v >= row->min;
    return !has_range(row) || (above && v <= row->max);
}

static bool check_range(struct calx_reader *r, const xmlNode *node,
                        const struct calx_attribute *row, double v)
{
    const char *relation = row->flags & CALX_ATTRIBUTE_OPEN_MIN ? "greater than" : "at least";
    char unit[64] = "";
    if (in_range(row, v))
        return true;
    if (row->unit && strcmp(row->unit, "1") != 0)
        snprintf(unit, sizeof unit, " %.60s", row->unit);
    if (isfinite(row->max))
        calx_case_fail(r, node, row->name, "%g is out of range, expected %s %g and at most %g", v,
                       relation, row->min, row->max);
    else
        calx_case_fail(r, node, row->name, "%g%s is out of range, expected %s %g", v, unit,
                       relation, row->min);
    return false;
}

double calx_case_number_in(struct calx_reader *r, const xmlNode *node, const char *name,
                           const char *unit, bool difference)
{
    const struct calx_attribute *row = row_of(node, name);
    const char *text = calx_case_text(node, name);
    struct calx_error e;
    double v;
    if (!text || (row->form == CALX_FORM_AUTO && strcmp(text, "auto") == 0))
        return NAN;
    if (difference ? calx_quantity_parse_difference(text, unit, &v, &e)
                   : calx_quantity_parse(text, unit, &v, &e)) {
        calx_case_fail_with(r, node, name, &e);
        return NAN;
    }
    return check_range(r, node, row, v) ? v : NAN;
}

double calx_case_number(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const struct calx_attribute *row = row_of(node, name);
    return calx_case_number_in(r, node, name, row->unit, row->flags & CALX_ATTRIBUTE_DIFFERENCE);
}

/* The whole number that all of `word` spells, or -1. */
static int64_t whole_of(const char *word)
{
    int64_t n = 0;
    if (!*word)
        return -1;
    for (; *word; word++) {
        if (!isdigit((unsigned char)*word) || n > (INT64_MAX - 9) / 10)
            return -1;
        n = 10 * n + (*word - '0');
    }
    return n;
}

int64_t calx_case_whole(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name);
    if (!text)
        return -1;
    int64_t n = whole_of(text);
    if (n < 0)
        calx_case_fail(r, node, name, "'%.80s', expected a whole number", text);
    else if (!check_range(r, node, row_of(node, name), (double)n))
        return -1;
    return n;
}

size_t calx_case_list(struct calx_reader *r, const xmlNode *node, const char *name, double *values,
                      size_t max)
{
    const struct calx_attribute *row = row_of(node, name);
    const char *text = calx_case_text(node, name);
    struct calx_error e;
    size_t count = 0;
    if (!text)
        return 0;
    if (calx_quantity_parse_list(text, row->unit, values, max, &count, &e)) {
        calx_case_fail_with(r, node, name, &e);
        return 0;
    }
    for (size_t k = 0; k < count; k++)
        if (!check_range(r, node, row, values[k]))
            return 0;
    return count;
}

/* Whether `count` components are those of a vector of this scene; a third in 2D must be 0. */
static bool right_count(struct calx_reader *r, const xmlNode *node, const char *name, size_t count,
                        bool third_is_zero)
{
    size_t wanted = r->scene->dimension;
    if (count == wanted || (wanted == 2 && count == 3 && third_is_zero))
        return true;
    calx_case_fail(r, node, name, "%zu number%s, expected %zu in %zuD", count,
                   count == 1 ? "" : "s", wanted, wanted);
    return false;
}

bool calx_case_vector(struct calx_reader *r, const xmlNode *node, const char *name,
                      double vector[3])
{
    double values[3] = {0, 0, 0};
    size_t count = calx_case_list(r, node, name, values, 3);
    if (!count)
        return false;
    if (calx_case_given(node, name) && !right_count(r, node, name, count, values[2] == 0))
        return false;
    memcpy(vector, values, sizeof values);
    return true;
}

/* ---- functions
 * ----------------------------------------------------------------------------------------- */

static struct calx_expression_options options_of(const xmlNode *node,
                                                 const struct calx_attribute *row)
{
    return (struct calx_expression_options){
        .unit = row->unit,
        .variables = row->choices,
        .where = calx_element_attribute(calx_case_element(node), "where")
                     ? calx_case_given(node, "where")
                     : NULL,
        .difference = row->flags & CALX_ATTRIBUTE_DIFFERENCE};
}

bool calx_case_function_in(struct calx_reader *r, const xmlNode *node, const char *name,
                           const char *unit, bool difference, struct calx_function *f)
{
    const struct calx_attribute *row = row_of(node, name);
    struct calx_expression_options options = options_of(node, row);
    const char *text = calx_case_text(node, name);
    struct calx_error e;
    options.unit = unit;
    options.difference = difference;
    if (!text)
        return false;
    if (calx_expression_read(text, &options, r->scene, f, &e)) {
        calx_case_fail_with(r, node, name, &e);
        return false;
    }
    return f->eval || check_range(r, node, row, f->value);
}

bool calx_case_function(struct calx_reader *r, const xmlNode *node, const char *name,
                        struct calx_function *f)
{
    const struct calx_attribute *row = row_of(node, name);
    return calx_case_function_in(r, node, name, row->unit, row->flags & CALX_ATTRIBUTE_DIFFERENCE,
                                 f);
}

bool calx_case_functions(struct calx_reader *r, const xmlNode *node, const char *name,
                         struct calx_function vector[3])
{
    struct calx_expression_options options = options_of(node, row_of(node, name));
    struct calx_function f[3] = {{0}, {0}, {0}};
    const char *text = calx_case_text(node, name);
    struct calx_error e;
    size_t count;
    if (!text)
        return false;
    if (calx_expression_read_list(text, &options, r->scene, f, &count, &e)) {
        calx_case_fail_with(r, node, name, &e);
        return false;
    }
    if (!right_count(r, node, name, count, !f[2].eval && f[2].value == 0))
        return false;
    memcpy(vector, f, sizeof f);
    return true;
}

/* ---- words
 * --------------------------------------------------------------------------------------------- */

size_t calx_case_split(const char *text, const char *also, char **copy, const char **words,
                       size_t max)
{
    char separators[32] = " \t\r\n", *rest;
    size_t count = 0;
    strncat(separators, also, sizeof separators - strlen(separators) - 1);
    *copy = rest = strdup(text);
    for (char *word; rest && (word = strsep(&rest, separators));)
        if (*word && count < max)
            words[count++] = word;
    return count;
}

static int word_index(struct calx_reader *r, const xmlNode *node, const struct calx_attribute *row,
                      const char *word)
{
    const char *names[16];
    char *copy;
    size_t count = calx_case_split(row->choices, "|", &copy, names, 16);
    int index = -1;
    for (size_t k = 0; k < count; k++)
        if (strcmp(names[k], word) == 0)
            index = (int)k;
    if (index < 0)
        calx_case_fail_name(r, node, row->name, "word", word, names, count);
    free(copy);
    return index;
}

int calx_case_word(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name);
    return text ? word_index(r, node, row_of(node, name), text) : -1;
}

uint32_t calx_case_words(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name), *words[32];
    uint32_t bits = 0;
    char *copy;
    if (!text)
        return 0;
    size_t count = calx_case_split(text, "", &copy, words, 32);
    for (size_t k = 0; k < count; k++) {
        int index = word_index(r, node, row_of(node, name), words[k]);
        bits |= index < 0 ? 0 : 1u << index;
    }
    free(copy);
    return bits;
}

bool calx_case_yes(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name);
    if (text && strcmp(text, "yes") != 0 && strcmp(text, "no") != 0)
        calx_case_fail(r, node, name, "'%.80s', expected yes or no", text);
    return text && strcmp(text, "yes") == 0;
}

/* ---- references
 * ---------------------------------------------------------------------------------------- */

int calx_case_find_material(struct calx_reader *r, const xmlNode *node, const char *attribute,
                            const char *material)
{
    int index = calx_scene_material(r->scene, material);
    if (index >= 0)
        return index;
    const char **names = calloc(r->scene->material_count + 1, sizeof *names);
    for (size_t k = 0; names && k < r->scene->material_count; k++)
        names[k] = r->scene->materials[k].name;
    calx_case_fail_name(r, node, attribute, "material", material, names,
                        names ? r->scene->material_count : 0);
    free(names);
    return -1;
}

int calx_case_find_wall(struct calx_reader *r, const xmlNode *node, const char *attribute,
                        const char *wall)
{
    int index = calx_scene_wall(r->scene, wall);
    if (index >= 0)
        return index;
    const char **names = calloc(r->scene->wall_count + 1, sizeof *names);
    for (size_t k = 0; names && k < r->scene->wall_count; k++)
        names[k] = r->scene->walls[k].name;
    calx_case_fail_name(r, node, attribute, "walls", wall, names, names ? r->scene->wall_count : 0);
    free(names);
    return -1;
}

int calx_case_material(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name);
    return text ? calx_case_find_material(r, node, name, text) : -1;
}

int calx_case_wall(struct calx_reader *r, const xmlNode *node, const char *name)
{
    const char *text = calx_case_text(node, name);
    return text ? calx_case_find_wall(r, node, name, text) : -1;
}

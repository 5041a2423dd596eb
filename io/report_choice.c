/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A choice of --integrators: a plugin's name and, behind colons, parameters other than the case's, as in nscd:solver=apgd:order=bottom-up.
 * Input: its text. Output: a candidate with these values, checked by the plugin's own table, or an error that says what there is.
 */
#include <math.h>
#include <string.h>

#include "io/quantity.h"
#include "io/report_parts.h"

/* Cuts the next part off, which ends before the mark; NULL behind the last. */
static char *cut(char **rest, char mark)
{
    const char marks[2] = {mark, '\0'};
    return strsep(rest, marks);
}

static int unknown_parameter(const struct calx_plugin *plugin, const char *name, struct calx_error *error)
{
    const char *names[64];
    size_t count = 0;
    for (; count < plugin->parameter_count && count < sizeof names / sizeof *names; count++)
        names[count] = plugin->parameters[count].name;
    const char *nearest = calx_error_nearest(name, names, count);
    return calx_error_set(error, CALX_ERROR_INPUT, "--integrators: %s has no parameter '%s'%s%s%s (calx plugins %s lists them)", plugin->name, name,
                          nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "", plugin->name);
}

/* The index of the word among "a|b|c". */
static int read_word(const struct calx_parameter *row, const char *words, const char *text, double *value, struct calx_error *error)
{
    size_t length = strlen(text);
    int index = 0;
    for (const char *at = words; *at; index++) {
        size_t word = strcspn(at, "|");
        if (word == length && strncmp(at, text, word) == 0) {
            *value = index;
            return CALX_OK;
        }
        at += word + (at[word] == '|');
    }
    return calx_error_set(error, CALX_ERROR_INPUT, "--integrators: %s is one of %s, not '%s'", row->name, words, text);
}

static int read_value(const struct calx_parameter *row, const char *text, double *value, struct calx_error *error)
{
    struct calx_error why;
    if (row->flags & (CALX_SWITCH | CALX_CHOICE))
        return read_word(row, row->flags & CALX_SWITCH ? "no|yes" : row->choices, text, value, error);
    if (calx_quantity_parse(text, row->unit, value, &why) || calx_parameter_check(row, *value, &why))
        return calx_error_set(error, CALX_ERROR_INPUT, "--integrators: %s: %.300s", row->name, why.text);
    return CALX_OK;
}

/* NAME=VALUE. */
static int add_parameter(struct calx_report_candidate *c, char *text, struct calx_error *error)
{
    const char *name = cut(&text, '=');
    const struct calx_parameter *row = calx_plugin_parameter(c->plugin, name);
    if (!row)
        return unknown_parameter(c->plugin, name, error);
    if (!text || c->value_count == CALX_REPORT_VALUES)
        return calx_error_set(error, CALX_ERROR_INPUT, "--integrators needs up to %d parameters with a value, as in %s:%s=1, not '%s'",
                              CALX_REPORT_VALUES, c->plugin->name, name, c->name);
    struct calx_value *v = &c->values[c->value_count++];
    *v = (struct calx_value){.pair = {-1, -1}};
    snprintf(v->name, sizeof v->name, "%.47s", name);
    return read_value(row, text, &v->value, error);
}

int calx_report_choice_read(const struct calx_report_study *s, const char *text, struct calx_report_candidate *c, struct calx_error *error)
{
    char copy[sizeof c->name], *rest = copy;
    *c = (struct calx_report_candidate){.critical = INFINITY};
    if (strlen(text) >= sizeof copy)
        return calx_error_set(error, CALX_ERROR_INPUT, "--integrators: '%s' is longer than %zu characters", text, sizeof copy - 1);
    snprintf(copy, sizeof copy, "%s", text);
    snprintf(c->name, sizeof c->name, "%s", text);
    c->plugin = calx_registry_find(s->run.registry, s->axis, cut(&rest, ':'), error);
    if (!c->plugin)
        return error->code;
    while (rest)
        CALX_TRY(add_parameter(c, cut(&rest, ':'), error));
    return CALX_OK;
}

/* What the model gives, or the table. */
static double value_in(const struct calx_model *model, const struct calx_plugin *plugin, const char *name)
{
    for (size_t k = 0; k < model->value_count; k++)
        if (strcmp(model->values[k].name, name) == 0)
            return model->values[k].value;
    return calx_plugin_parameter(plugin, name)->initial;
}

bool calx_report_choice_is(const struct calx_report_candidate *c, const struct calx_model *model)
{
    bool same = model && strcmp(model->plugin, c->plugin->name) == 0;
    for (size_t k = 0; same && k < c->value_count; k++)
        same = value_in(model, c->plugin, c->values[k].name) == c->values[k].value;
    return same;
}

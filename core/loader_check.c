/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Checks the descriptor of a plugin before anything in it is used: the frozen prefix alone, then
 * the members, then each row of the parameter table, then what its kind must provide. The rules are
 * tables; the first that is broken is named. Also checks a value against its row.
 */
#include "core/loader_check.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "core/loader.h"

/* ---- rows of the parameter table ---- */

static bool is_name(const char *s)
{
    return s && *s >= 'a' && *s <= 'z' &&
           strspn(s, "abcdefghijklmnopqrstuvwxyz0123456789-") == strlen(s) && strlen(s) < 48;
}

static size_t field_bytes(const struct calx_parameter *row)
{
    return (row->scope == CALX_MATERIAL ? 2 : 1) * sizeof(double);
}

static bool has_default(const struct calx_parameter *row)
{
    return !(row->flags & (CALX_REQUIRED | CALX_OPTIONAL));
}

static bool in_range(const struct calx_parameter *row, double v)
{
    return (row->flags & CALX_OPEN_MIN ? v > row->min : v >= row->min) &&
           (row->flags & CALX_OPEN_MAX ? v < row->max : v <= row->max);
}

static size_t choice_count(const struct calx_parameter *row)
{
    size_t count = 1;
    for (const char *p = row->choices; p && *p; p++)
        count += *p == '|';
    return count;
}

static bool range_of_words_is_wrong(const struct calx_parameter *row)
{
    double last = row->flags & CALX_CHOICE ? (double)choice_count(row) - 1 : 1;
    return (row->flags & (CALX_SWITCH | CALX_CHOICE)) && (row->min != 0 || row->max != last);
}

static bool row_name_bad(const struct calx_plugin *p, size_t i)
{
    return !is_name(p->parameters[i].name);
}

static bool row_texts_missing(const struct calx_plugin *p, size_t i)
{
    return !p->parameters[i].symbol || !p->parameters[i].unit || !p->parameters[i].doc;
}

static bool row_duplicate(const struct calx_plugin *p, size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (strcmp(p->parameters[k].name, p->parameters[i].name) == 0)
            return true;
    return false;
}

static bool row_scope_unknown(const struct calx_plugin *p, size_t i)
{
    return p->parameters[i].scope > CALX_PAIR;
}

static bool row_flags_clash(const struct calx_plugin *p, size_t i)
{
    const uint32_t both = CALX_REQUIRED | CALX_OPTIONAL;
    return (p->parameters[i].flags & both) == both;
}

static bool row_words_clash(const struct calx_plugin *p, size_t i)
{
    const uint32_t both = CALX_SWITCH | CALX_CHOICE;
    return (p->parameters[i].flags & both) == both;
}

static bool row_choices_missing(const struct calx_plugin *p, size_t i)
{
    const struct calx_parameter *row = &p->parameters[i];
    return !(row->flags & CALX_CHOICE) != !(row->choices && *row->choices);
}

static bool row_bounds_nan(const struct calx_plugin *p, size_t i)
{
    return isnan(p->parameters[i].min) || isnan(p->parameters[i].max);
}

static bool row_bounds_crossed(const struct calx_plugin *p, size_t i)
{
    return p->parameters[i].min > p->parameters[i].max;
}

static bool row_words_range(const struct calx_plugin *p, size_t i)
{
    return range_of_words_is_wrong(&p->parameters[i]);
}

static bool row_default_outside(const struct calx_plugin *p, size_t i)
{
    return has_default(&p->parameters[i]) && !in_range(&p->parameters[i], p->parameters[i].initial);
}

static bool row_misaligned(const struct calx_plugin *p, size_t i)
{
    return p->parameters[i].offset % _Alignof(double) != 0;
}

static bool row_outside(const struct calx_plugin *p, size_t i)
{
    size_t bytes = field_bytes(&p->parameters[i]);
    return p->params_size < bytes || p->parameters[i].offset > p->params_size - bytes;
}

static bool row_overlaps(const struct calx_plugin *p, size_t i)
{
    const struct calx_parameter *a = &p->parameters[i];
    for (size_t k = 0; k < i; k++) {
        const struct calx_parameter *b = &p->parameters[k];
        if (a->offset < b->offset + field_bytes(b) && b->offset < a->offset + field_bytes(a))
            return true;
    }
    return false;
}

static const struct {
    bool (*broken)(const struct calx_plugin *, size_t);
    const char *rule;
} row_rules[] = {
    {row_name_bad, "the name must be lower-case letters, digits and hyphens, at most 47"},
    {row_duplicate, "the name stands in the table twice"},
    {row_texts_missing, "symbol, unit and doc must not be NULL"},
    {row_scope_unknown, "the scope is unknown"},
    {row_flags_clash, "CALX_REQUIRED and CALX_OPTIONAL exclude each other"},
    {row_words_clash, "CALX_SWITCH and CALX_CHOICE exclude each other"},
    {row_choices_missing, "CALX_CHOICE and choices must come together"},
    {row_bounds_nan, "min and max must be numbers"},
    {row_bounds_crossed, "min is greater than max"},
    {row_words_range, "a switch goes from 0 to 1, a choice from 0 to the index of its last word"},
    {row_default_outside, "the default is outside min and max"},
    {row_misaligned, "the offset is not that of a double"},
    {row_outside, "the offset is outside the plugin's struct (params_size)"},
    {row_overlaps, "the field overlaps that of a row before"},
};

static int check_rows(const char *path, const struct calx_plugin *p, struct calx_error *error)
{
    if (p->parameter_count > 0 && !p->parameters)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "the plugin %s is not valid: parameters is NULL", path);
    for (size_t i = 0; i < p->parameter_count; i++)
        for (size_t k = 0; k < sizeof row_rules / sizeof *row_rules; k++)
            if (row_rules[k].broken(p, i))
                return calx_error_set(
                    error, CALX_ERROR_INPUT,
                    "the parameter table of the plugin %s is not valid: row %zu (%s): %s", path,
                    i + 1, p->parameters[i].name ? p->parameters[i].name : "no name",
                    row_rules[k].rule);
    return 0;
}

/* ---- what each kind must provide ---- */

static const char *names_missing(const char *const *names, size_t count, const char *what)
{
    for (size_t k = 0; k < count; k++)
        if (!names || !names[k])
            return what;
    return NULL;
}

static const char *contact_lacks(const void *law)
{
    const struct calx_contact_law *l = law;
    const uint32_t parts = CALX_NORMAL | CALX_COHESION | CALX_TANGENTIAL | CALX_ROLLING;
    return !l->provides || (l->provides & ~parts) ? "provides must name parts of enum calx_part"
           : (l->depends & ~parts)                ? "depends must name parts of enum calx_part"
           : !l->nonsmooth && !l->force           ? "force must not be NULL"
           : !l->nonsmooth && !l->response        ? "response must not be NULL"
           : l->nonsmooth && !l->condition        ? "condition must not be NULL"
           : !(l->demand.gap >= 0)
               ? "demand.gap must not be negative"
               : names_missing(l->history, l->demand.history_vectors + l->demand.history_scalars,
                               "history must name every vector and scalar");
}

static const char *conductance_lacks(const void *law)
{
    const struct calx_conductance_law *l = law;
    return !l->conductance ? "conductance must not be NULL"
           : l->demand.history_vectors || l->demand.history_scalars
               ? "history is not available to conductances"
           : !(l->demand.gap >= 0) ? "demand.gap must not be negative"
                                   : NULL;
}

static const char *motion_lacks(const void *law)
{
    const struct calx_motion_integrator *l = law;
    size_t extra =
        l->extra_translation > l->extra_rotation ? l->extra_translation : l->extra_rotation;
    return l->order == 0                           ? "order must not be 0"
           : !l->stages == !l->advance             ? "either stages or advance must be given"
           : l->stages > 0 && !l->translation      ? "translation must not be NULL"
           : l->stages > 0 && !l->rotation         ? "rotation must not be NULL"
           : !(l->stability > 0)                   ? "stability must be greater than 0"
           : !(l->damping > 0)                     ? "damping must be greater than 0"
           : !isfinite(l->velocity_lag)
               ? "velocity_lag must be finite"
           : l->solves_impulses && !l->advance     ? "solves_impulses needs advance"
           : !(l->reach >= 0)                      ? "reach must not be negative"
           : l->resolves_contacts && (l->stages != 1 || l->start || l->velocity_lag != 0.5)
               ? "resolves_contacts needs one stage, no start and a velocity_lag of 0.5"
               : names_missing(l->extra, extra, "extra must name every row of extra state");
}

static const char *temperature_lacks(const void *law)
{
    const struct calx_temperature_integrator *l = law;
    return l->order == 0                              ? "order must not be 0"
           : !l->advance == !l->solve                 ? "either advance or solve must be given"
           : !l->unconditional && !(l->stability > 0) ? "stability must be greater than 0"
                                                      : NULL;
}

static const char *(*const law_lacks[])(const void *) = {
    [CALX_CONTACT] = contact_lacks,
    [CALX_CONDUCTANCE] = conductance_lacks,
    [CALX_MOTION] = motion_lacks,
    [CALX_TEMPERATURE] = temperature_lacks,
};

static const char *descriptor_lacks(const struct calx_plugin *p)
{
    return p->kind < CALX_CONTACT || p->kind > CALX_TEMPERATURE ? "its kind is unknown"
           : !is_name(p->name) ? "name must be lower-case letters, digits and hyphens, at most 47"
           : !p->summary || !*p->summary     ? "summary must not be empty"
           : !p->reference || !*p->reference ? "reference must not be empty"
           : !p->equation || !*p->equation   ? "equation must not be empty"
           : !p->law                         ? "law must not be NULL"
                                             : law_lacks[p->kind](p->law);
}

int calx_loader_check(const char *path, const struct calx_plugin *p, struct calx_error *error)
{
    if (!p)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s is not a calx plugin: it has no symbol %s", path,
                              CALX_PLUGIN_SYMBOL);
    if (p->magic != CALX_PLUGIN_MAGIC)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s is not a calx plugin: its %s begins with 0x%08x, not 0x%08x",
                              path, CALX_PLUGIN_SYMBOL, p->magic, CALX_PLUGIN_MAGIC);
    if (p->abi != CALX_PLUGIN_ABI)
        return calx_error_set(
            error, CALX_ERROR_INPUT,
            "the plugin %s was built for ABI %u, this calx has ABI %u: build it anew", path, p->abi,
            CALX_PLUGIN_ABI);
    if (p->size != sizeof *p)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "the plugin %s was built for ABI %u with a descriptor of %llu bytes, "
                              "this calx has %zu: build it anew",
                              path, p->abi, (unsigned long long)p->size, sizeof *p);
    const char *lack = descriptor_lacks(p);
    if (lack)
        return calx_error_set(error, CALX_ERROR_INPUT, "the plugin %s is not valid: %s", path,
                              lack);
    return check_rows(path, p, error);
}

/* ---- parameters ---- */

const struct calx_parameter *calx_plugin_parameter(const struct calx_plugin *p, const char *name)
{
    for (size_t i = 0; i < p->parameter_count; i++)
        if (strcmp(p->parameters[i].name, name) == 0)
            return &p->parameters[i];
    return NULL;
}

int calx_parameter_check(const struct calx_parameter *row, double v, struct calx_error *error)
{
    const char *unit = strcmp(row->unit, "1") == 0 ? "" : row->unit, *space = *unit ? " " : "";
    if ((row->flags & (CALX_SWITCH | CALX_CHOICE)) && v != floor(v))
        return calx_error_set(error, CALX_ERROR_INPUT, "%s must be one of %s, not %g", row->name,
                              row->flags & CALX_SWITCH ? "no, yes" : row->choices, v);
    if (isfinite(v) && in_range(row, v))
        return 0;
    return calx_error_set(
        error, CALX_ERROR_INPUT, "%s must be %s %g%s%s and %s %g%s%s, not %g", row->name,
        row->flags & CALX_OPEN_MIN ? "greater than" : "at least", row->min, space, unit,
        row->flags & CALX_OPEN_MAX ? "less than" : "at most", row->max, space, unit, v);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The models of a case: contact laws, conductance, integrators, with their parameters by the
 * plugins' own tables. Output: one complete choice (struct calx_models) for the case, and one more
 * for each stage that changes it.
 */
#include "io/case_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/quantity.h"

/* Taken when heat flows and the case names no integrator of temperature. */
#define DEFAULT_TEMPERATURE_INTEGRATOR "heat-euler"

/* ---- plugins
 * ------------------------------------------------------------------------------------------- */

enum calx_kind calx_case_kind(const xmlNode *node)
{
    const char *name = (const char *)node->name, *of = calx_case_given(node, "of");
    if (strcmp(name, "contact") == 0)
        return CALX_CONTACT;
    if (strcmp(name, "conductance") == 0)
        return CALX_CONDUCTANCE;
    return of && strcmp(of, "temperature") == 0 ? CALX_TEMPERATURE : CALX_MOTION;
}

const struct calx_plugin *calx_case_plugin(struct calx_reader *r, const xmlNode *node,
                                           struct calx_error *e)
{
    const xmlNode *model = strcmp((const char *)node->name, "pair") == 0 ? node->parent : node;
    const char *name = calx_case_given(model, "plugin");
    struct calx_error unused;
    return name ? calx_registry_find(r->registry, calx_case_kind(model), name, e ? e : &unused)
                : NULL;
}

static void note_plugin(struct calx_reader *r, const struct calx_plugin *plugin)
{
    for (size_t k = 0; k < r->plugin_count; k++)
        if (r->plugins[k] == plugin)
            return;
    const struct calx_plugin **entry =
        calx_case_append(r, &r->plugins, &r->plugin_count, sizeof *r->plugins);
    if (entry)
        *entry = plugin;
}

static bool names_plugin(const xmlNode *node)
{
    static const char *const models[] = {"contact", "conductance", "integrator"};
    for (size_t k = 0; k < sizeof models / sizeof *models; k++)
        if (node->type == XML_ELEMENT_NODE && strcmp((const char *)node->name, models[k]) == 0)
            return calx_case_given(node, "plugin") != NULL;
    return false;
}

static void find_plugins_in(struct calx_reader *r, const xmlNode *parent)
{
    for (const xmlNode *node = parent->children; node; node = node->next) {
        if (node->type == XML_ELEMENT_NODE && strcmp((const char *)node->name, "stage") == 0)
            find_plugins_in(r, node);
        if (!names_plugin(node))
            continue;
        struct calx_error e = {0};
        const struct calx_plugin *plugin = calx_case_plugin(r, node, &e);
        if (plugin) {
            note_plugin(r, plugin);
        } else {
            calx_case_fail_with(r, node, "plugin", &e);
            r->plugin_missing = true;
        }
    }
}

void calx_case_find_plugins(struct calx_reader *r)
{
    find_plugins_in(r, r->root);
}

/* ---- parameters
 * ---------------------------------------------------------------------------------------- */

/* The row if the element takes parameters of its scope. */
static const struct calx_parameter *row_in(const struct calx_plugin *plugin,
                                           enum calx_parameters takes, const char *name)
{
    const struct calx_parameter *row = plugin ? calx_plugin_parameter(plugin, name) : NULL;
    static const uint32_t scopes[] = {[CALX_TAKES_NONE] = 0,
                                      [CALX_TAKES_RUN_AND_PAIR] = 1u << CALX_RUN | 1u << CALX_PAIR,
                                      [CALX_TAKES_PAIR] = 1u << CALX_PAIR,
                                      [CALX_TAKES_MATERIAL] = 1u << CALX_MATERIAL};
    return row && scopes[takes] & 1u << row->scope ? row : NULL;
}

const struct calx_parameter *calx_case_parameter(struct calx_reader *r, const xmlNode *node,
                                                 const char *name)
{
    enum calx_parameters takes = calx_case_element(node)->parameters;
    const struct calx_parameter *row = NULL;
    if (takes == CALX_TAKES_MATERIAL)
        for (size_t k = 0; k < r->plugin_count && !row; k++)
            row = row_in(r->plugins[k], takes, name);
    else if (takes != CALX_TAKES_NONE)
        row = row_in(calx_case_plugin(r, node, NULL), takes, name);
    return row;
}

/* Index of text in the words, or NaN with a problem. */
static double choice_index(struct calx_reader *r, const xmlNode *node, const char *attribute,
                           const char *choices, const char *text)
{
    const char *names[32];
    char *copy;
    size_t count = calx_case_split(choices, "|", &copy, names, 32), k = 0;
    while (k < count && strcmp(names[k], text) != 0)
        k++;
    if (k == count)
        calx_case_fail_name(r, node, attribute, "choice", text, names, count);
    free(copy);
    return k < count ? (double)k : NAN;
}

double calx_case_parameter_value(struct calx_reader *r, const xmlNode *node,
                                 const struct calx_parameter *row, const char *text)
{
    struct calx_error e = {0};
    double v;
    if (row->flags & CALX_SWITCH)
        return choice_index(r, node, row->name, "no|yes", text);
    if (row->flags & CALX_CHOICE)
        return choice_index(r, node, row->name, row->choices, text);
    bool read = calx_quantity_parse(text, row->unit, &v, &e) == CALX_OK;
    if (read && !calx_parameter_check(row, v, &e))
        return v;
    calx_case_fail_with(r, node, read ? NULL : row->name, &e); /* the check names the row itself */
    return NAN;
}

static void add_value(struct calx_reader *r, const xmlNode *node, struct calx_model *model,
                      const struct calx_parameter *row, const char *text, const int materials[2])
{
    double v = calx_case_parameter_value(r, node, row, text);
    struct calx_value *value =
        calx_case_append(r, &model->values, &model->value_count, sizeof *model->values);
    if (!value)
        return;
    snprintf(value->name, sizeof value->name, "%.47s", row->name);
    value->value = v;
    value->pair[0] = materials[0];
    value->pair[1] = materials[1];
    value->place = calx_case_place(r, node);
}

static void read_values(struct calx_reader *r, const xmlNode *node, struct calx_model *model,
                        const int materials[2])
{
    for (const xmlAttr *a = node->properties; a; a = a->next) {
        const char *name = (const char *)a->name;
        const struct calx_parameter *row =
            a->ns || calx_element_attribute(calx_case_element(node), name)
                ? NULL
                : calx_case_parameter(r, node, name);
        if (row)
            add_value(r, node, model, row, calx_case_given(node, name), materials);
    }
}

static bool pair_is_known(const struct calx_model *model, const int materials[2])
{
    for (size_t k = 0; k < model->value_count; k++)
        if (model->values[k].pair[0] == materials[0] && model->values[k].pair[1] == materials[1])
            return true;
    return false;
}

static void read_pair(struct calx_reader *r, const xmlNode *node, struct calx_model *model)
{
    const char *text = calx_case_text(node, "of"), *words[3];
    char *copy;
    int materials[2];
    if (!text)
        return;
    size_t count = calx_case_split(text, "", &copy, words, 3);
    if (count < 1 || count > 2) {
        calx_case_fail(r, node, "of", "'%.80s', expected the names of two materials", text);
    } else {
        materials[0] = calx_case_find_material(r, node, "of", words[0]);
        materials[1] = calx_case_find_material(r, node, "of", words[count - 1]);
        if (materials[0] > materials[1])
            memcpy(materials, (int[2]){materials[1], materials[0]}, sizeof materials);
        if (materials[0] >= 0 && pair_is_known(model, materials))
            calx_case_fail(r, node, "of", "there is already a pair of '%.80s' here", text);
        else if (materials[0] >= 0)
            read_values(r, node, model, materials);
    }
    free(copy);
}

/* ---- models
 * -------------------------------------------------------------------------------------------- */

static bool same_model(const struct calx_model *model, const xmlNode *node)
{
    return model->kind == calx_case_kind(node) &&
           strcmp(model->plugin, calx_case_given(node, "plugin")) == 0;
}

static struct calx_model *add_model(struct calx_reader *r, struct calx_models *models,
                                    enum calx_kind kind, const char *plugin,
                                    struct calx_place place)
{
    struct calx_model *model =
        calx_case_append(r, &models->list, &models->count, sizeof *models->list);
    if (!model)
        return NULL;
    model->kind = kind;
    model->place = place;
    snprintf(model->plugin, sizeof model->plugin, "%.47s", plugin);
    return model;
}

static void read_model(struct calx_reader *r, const xmlNode *node, struct calx_models *models)
{
    if (!calx_case_given(node, "plugin"))
        return;
    for (size_t k = 0; k < models->count; k++)
        if (same_model(&models->list[k], node)) {
            calx_case_fail(r, node, "plugin", "this model is there already, on line %d",
                           models->list[k].place.line);
            return;
        }
    struct calx_model *model = add_model(r, models, calx_case_kind(node),
                                         calx_case_given(node, "plugin"), calx_case_place(r, node));
    if (!model)
        return;
    read_values(r, node, model, (int[2]){-1, -1});
    for (const xmlNode *pair = calx_case_first(node, "pair"); pair;
         pair = calx_case_next(pair, "pair"))
        read_pair(r, pair, model);
}

/* Removes the models of a kind, to be replaced. */
static void drop_kind(struct calx_models *models, enum calx_kind kind)
{
    size_t kept = 0;
    for (size_t k = 0; k < models->count; k++) {
        if (models->list[k].kind == kind)
            free(models->list[k].values);
        else
            models->list[kept++] = models->list[k];
    }
    models->count = kept;
}

static const struct calx_model *model_of(const struct calx_models *models, enum calx_kind kind)
{
    for (size_t k = 0; k < models->count; k++)
        if (models->list[k].kind == kind)
            return &models->list[k];
    return NULL;
}

static void read_contacts(struct calx_reader *r, const xmlNode *parent, struct calx_models *models)
{
    const xmlNode *first = calx_case_first(parent, "contact");
    if (!first)
        return;
    drop_kind(models, CALX_CONTACT);
    models->lever_full = false;
    for (const xmlNode *node = first; node; node = calx_case_next(node, "contact")) {
        models->lever_full |= calx_case_word(r, node, "lever") == 1;
        read_model(r, node, models);
    }
}

static double step_of(struct calx_reader *r, const xmlNode *node)
{
    double dt = calx_case_number(r, node, "dt");
    return isnan(dt) ? 0.0 : dt;
}

static void read_integrator(struct calx_reader *r, const xmlNode *node, struct calx_models *models)
{
    enum calx_kind kind = calx_case_kind(node);
    drop_kind(models, kind);
    read_model(r, node, models);
    if (kind == CALX_TEMPERATURE) {
        models->heat_dt = step_of(r, node);
        if (calx_case_given(node, "dt-fraction"))
            calx_case_fail(r, node, "dt-fraction", "is for integrators of motion only");
        if (calx_case_given(node, "force"))
            calx_case_fail(r, node, "force", "is for integrators of motion only");
        if (calx_case_given(node, "safety"))
            calx_case_fail(r, node, "safety", "is for integrators of motion only");
    } else {
        models->safety = calx_case_number(r, node, "safety");
        models->forced = calx_case_yes(r, node, "force");
        models->dt = step_of(r, node);
        models->dt_fraction = calx_case_number(r, node, "dt-fraction");
        models->frozen = false;
    }
}

static void read_integrators(struct calx_reader *r, const xmlNode *parent,
                             struct calx_models *models)
{
    const xmlNode *seen[CALX_TEMPERATURE + 1] = {NULL};
    for (const xmlNode *node = calx_case_first(parent, "integrator"); node;
         node = calx_case_next(node, "integrator")) {
        enum calx_kind kind = calx_case_kind(node);
        if (seen[kind])
            calx_case_fail(r, node, NULL, "there is already an integrator of %s on line %d",
                           kind == CALX_TEMPERATURE ? "temperature" : "motion",
                           calx_case_place(r, seen[kind]).line);
        else
            read_integrator(r, node, models);
        seen[kind] = node;
    }
}

/* What parent says, on top of what `models` holds already. */
static void read_choice(struct calx_reader *r, const xmlNode *parent, struct calx_models *models)
{
    const xmlNode *conductance = calx_case_first(parent, "conductance");
    read_contacts(r, parent, models);
    if (conductance) {
        drop_kind(models, CALX_CONDUCTANCE);
        read_model(r, conductance, models);
    }
    read_integrators(r, parent, models);
    bool heat = model_of(models, CALX_CONDUCTANCE) || calx_case_first(r->root, "heat");
    if (heat && !model_of(models, CALX_TEMPERATURE))
        add_model(r, models, CALX_TEMPERATURE, DEFAULT_TEMPERATURE_INTEGRATOR,
                  calx_case_place(r, parent));
}

static struct calx_models *add_choice(struct calx_reader *r)
{
    return calx_case_append(r, &r->scene->models, &r->scene->models_count,
                            sizeof *r->scene->models);
}

void calx_case_read_models(struct calx_reader *r)
{
    struct calx_models *models = add_choice(r);
    if (!models)
        return;
    models->frozen = true;
    models->dt_fraction = 1.0; /* of no consequence while frozen */
    read_choice(r, r->root, models);
}

static void copy_choice(struct calx_reader *r, const struct calx_models *from,
                        struct calx_models *to)
{
    *to = *from;
    to->list = NULL;
    to->count = 0;
    for (size_t k = 0; k < from->count; k++) {
        const struct calx_model *old = &from->list[k];
        struct calx_model *copy = add_model(r, to, old->kind, old->plugin, old->place);
        for (size_t v = 0; copy && v < old->value_count; v++) {
            struct calx_value *value =
                calx_case_append(r, &copy->values, &copy->value_count, sizeof *copy->values);
            if (value)
                *value = old->values[v];
        }
    }
}

int calx_case_stage_models(struct calx_reader *r, const xmlNode *stage, int before)
{
    bool changes = calx_case_first(stage, "contact") || calx_case_first(stage, "conductance") ||
                   calx_case_first(stage, "integrator");
    struct calx_models *models = changes ? add_choice(r) : NULL;
    if (!models)
        return before;
    copy_choice(r, &r->scene->models[before], models);
    read_choice(r, stage, models);
    return (int)r->scene->models_count - 1;
}

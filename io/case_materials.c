/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The materials of a case, and what particles, walls and models must find in them. Output:
 * scene->materials.
 */
#include "io/case_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading
 * ------------------------------------------------------------------------------------------- */

static void add_value(struct calx_reader *r, const xmlNode *node, struct calx_material *material,
                      const char *name, double v)
{
    struct calx_value *value =
        calx_case_append(r, &material->values, &material->value_count, sizeof *material->values);
    if (!value)
        return;
    snprintf(value->name, sizeof value->name, "%.47s", name);
    value->value = v;
    value->pair[0] = value->pair[1] = -1;
    value->place = calx_case_place(r, node);
}

/* A value that the table of elements knows may also be a parameter of plugins, each with its own
 * range. */
static void check_ranges(struct calx_reader *r, const xmlNode *node, const char *name, double v)
{
    for (size_t k = 0; k < r->plugin_count; k++) {
        const struct calx_parameter *row = calx_plugin_parameter(r->plugins[k], name);
        struct calx_error e = {0};
        if (row && row->scope == CALX_MATERIAL && !isnan(v) && calx_parameter_check(row, v, &e))
            calx_case_fail_with(r, node, NULL, &e);
    }
}

static void read_value(struct calx_reader *r, const xmlNode *node, struct calx_material *material,
                       const char *name)
{
    const struct calx_parameter *row = calx_case_parameter(r, node, name);
    bool known = calx_element_attribute(calx_case_element(node), name) != NULL;
    if (!known && !row)
        return;
    double v = known ? calx_case_number(r, node, name)
                     : calx_case_parameter_value(r, node, row, calx_case_given(node, name));
    check_ranges(r, node, name, v);
    if (strcmp(name, "density") == 0)
        material->density =
            isnan(v) ? INFINITY : v; /* a mistake is told once, not as missing too */
    else if (strcmp(name, "specific-heat") == 0)
        material->specific_heat = isnan(v) ? INFINITY : v;
    else
        add_value(r, node, material, name, v);
}

static void read_material(struct calx_reader *r, const xmlNode *node)
{
    const char *name = calx_case_given(node, "name");
    if (!name)
        return;
    int other = calx_scene_material(r->scene, name);
    if (other >= 0) {
        calx_case_fail(r, node, NULL, "there is already a material of this name on line %d",
                       r->scene->materials[other].place.line);
        return;
    }
    struct calx_material *material = calx_case_append(
        r, &r->scene->materials, &r->scene->material_count, sizeof *r->scene->materials);
    if (!material)
        return;
    snprintf(material->name, sizeof material->name, "%.47s", name);
    material->place = calx_case_place(r, node);
    material->density = material->specific_heat = NAN;
    for (const xmlAttr *a = node->properties; a; a = a->next)
        if (!a->ns && strcmp((const char *)a->name, "name") != 0)
            read_value(r, node, material, (const char *)a->name);
}

void calx_case_read_materials(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "material"); node;
         node = calx_case_next(node, "material"))
        read_material(r, node);
    r->uses = calloc(r->scene->material_count + 1, 1);
    if (!r->uses)
        calx_problems_add(r->problems, (struct calx_place){r->file, 0}, "no memory");
}

/* ---- what the whole scene needs
 * ------------------------------------------------------------------------ */

static bool has_value(const struct calx_value *values, size_t count, const char *name,
                      const int pair[2])
{
    for (size_t k = 0; k < count; k++)
        if (strcmp(values[k].name, name) == 0 && values[k].pair[0] == pair[0] &&
            values[k].pair[1] == pair[1])
            return true;
    return false;
}

static void check_material_row(struct calx_reader *r, const struct calx_model *model,
                               const struct calx_parameter *row)
{
    for (size_t a = 0; a < r->scene->material_count; a++) {
        const struct calx_material *material = &r->scene->materials[a];
        if (r->uses[a] &&
            !has_value(material->values, material->value_count, row->name, (int[2]){-1, -1}))
            calx_problems_add(r->problems, material->place,
                              "material '%s': attribute '%s' is missing (%s, %s), %s '%s' needs it",
                              material->name, row->name, row->doc, row->unit,
                              calx_kind_name(model->kind), model->plugin);
    }
}

/* Each pair that can touch: particles with particles and with walls. */
static void check_pair_row(struct calx_reader *r, const struct calx_model *model,
                           const struct calx_parameter *row)
{
    if (has_value(model->values, model->value_count, row->name, (int[2]){-1, -1}))
        return;
    for (size_t a = 0; a < r->scene->material_count; a++)
        for (size_t b = a; b < r->scene->material_count; b++) {
            bool touch = r->uses[a] && r->uses[b] && (r->uses[a] | r->uses[b]) & CALX_BY_PARTICLES;
            if (touch &&
                !has_value(model->values, model->value_count, row->name, (int[2]){(int)a, (int)b}))
                calx_problems_add(
                    r->problems, model->place,
                    "%s '%s': parameter '%s' is missing (%s, %s) for the pair '%s %s'",
                    calx_kind_name(model->kind), model->plugin, row->name, row->doc, row->unit,
                    r->scene->materials[a].name, r->scene->materials[b].name);
        }
}

static void check_run_row(struct calx_reader *r, const struct calx_model *model,
                          const struct calx_parameter *row)
{
    if (!has_value(model->values, model->value_count, row->name, (int[2]){-1, -1}))
        calx_problems_add(r->problems, model->place, "%s '%s': parameter '%s' is missing (%s, %s)",
                          calx_kind_name(model->kind), model->plugin, row->name, row->doc,
                          row->unit);
}

static void check_model(struct calx_reader *r, const struct calx_model *model)
{
    static void (*const checks[])(struct calx_reader *, const struct calx_model *,
                                  const struct calx_parameter *) = {[CALX_RUN] = check_run_row,
                                                                    [CALX_MATERIAL] =
                                                                        check_material_row,
                                                                    [CALX_PAIR] = check_pair_row};
    struct calx_error e = {0};
    const struct calx_plugin *plugin =
        calx_registry_find(r->registry, model->kind, model->plugin, &e);
    if (!plugin && !r->plugin_missing) /* one that the case does not name itself */
        calx_problems_add(r->problems, model->place, "%s '%s': %s", calx_kind_name(model->kind),
                          model->plugin, e.text);
    if (!plugin)
        return;
    for (size_t k = 0; k < plugin->parameter_count; k++)
        if (plugin->parameters[k].flags & CALX_REQUIRED)
            checks[plugin->parameters[k].scope](r, model, &plugin->parameters[k]);
}

static void check_property(struct calx_reader *r, const struct calx_material *material, double v,
                           const char *name, const char *why)
{
    if (isnan(v))
        calx_problems_add(r->problems, material->place,
                          "material '%s': attribute '%s' is missing, its particles %s",
                          material->name, name, why);
}

static void check_properties(struct calx_reader *r, bool moves, bool warms)
{
    for (size_t a = 0; a < r->scene->material_count; a++) {
        const struct calx_material *material = &r->scene->materials[a];
        if (!(r->uses[a] & CALX_BY_PARTICLES))
            continue;
        if (moves || warms)
            check_property(r, material, material->density, "density",
                           moves ? "move" : "change temperature");
        if (warms)
            check_property(r, material, material->specific_heat, "specific-heat",
                           "change temperature");
    }
}

void calx_case_check_scene(struct calx_reader *r)
{
    bool moves = false, warms = false;
    for (size_t k = 0; k < r->scene->models_count; k++) {
        const struct calx_models *models = &r->scene->models[k];
        moves |= !models->frozen;
        for (size_t m = 0; m < models->count; m++) {
            warms |= models->list[m].kind == CALX_TEMPERATURE;
            check_model(r, &models->list[m]);
        }
    }
    check_properties(r, moves, warms);
}

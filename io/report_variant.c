/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A scene with other numbers: integrator, steps, stiffness, damping, start.
 * Input: a scene and a recipe. Output: a scene that shares with it whatever the recipe leaves alone.
 * Method: stiffness multiplies every parameter called stiffness or young. Damping multiplies the
 * damping ratio: coefficients directly, a restitution through beta(e) = -ln e/sqrt(pi^2 + ln^2 e).
 * Where the stiffness changes, coefficients follow its square root, so that restitution stays.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/random.h"
#include "io/report_parts.h"

/* ---- parameters ---- */

static double scaled_restitution(double e, double damping)
{
    if (damping == 1 || !(e > 0) || e >= 1)
        return e;
    double l = log(e), beta = fmin(0.999, -l / sqrt(M_PI * M_PI + l * l) * damping);
    return exp(-M_PI * beta / sqrt(1 - beta * beta));
}

static double scale_stiffness(double v, const struct calx_report_recipe *r)
{
    return v * r->stiffness;
}

static double scale_damping(double v, const struct calx_report_recipe *r)
{
    return v * r->damping * sqrt(r->stiffness);
}

static double scale_restitution(double v, const struct calx_report_recipe *r)
{
    return scaled_restitution(v, r->damping);
}

static const struct {
    const char *name;
    double (*scale)(double, const struct calx_report_recipe *);
} scaled[] = {{"stiffness", scale_stiffness},   {"young", scale_stiffness}, {"damping", scale_damping},
              {"damping-rate", scale_damping},  {"drag", scale_damping},
              {"restitution", scale_restitution}};

static void scale_values(struct calx_value *values, size_t count, const struct calx_report_recipe *r)
{
    for (size_t v = 0; v < count; v++)
        for (size_t k = 0; k < sizeof scaled / sizeof *scaled; k++)
            if (strcmp(values[v].name, scaled[k].name) == 0)
                values[v].value = scaled[k].scale(values[v].value, r);
}

static void *copy_of(const void *from, size_t count, size_t size)
{
    void *to = malloc(count * size + 1);
    return to && count ? memcpy(to, from, count * size) : to;
}

/* ---- models ---- */

/* There is room for one more value. */
static void set_value(struct calx_model *m, const char *name, double value)
{
    struct calx_value *v = m->values;
    while (v < m->values + m->value_count && strcmp(v->name, name))
        v++;
    if (v == m->values + m->value_count) {
        m->value_count++;
        *v = (struct calx_value){.pair = {-1, -1}, .place = m->place};
        snprintf(v->name, sizeof v->name, "%.47s", name);
    }
    v->value = value;
}

/* Another integrator of the kind takes its own defaults, the case's what the case says; both what was asked for besides. */
static void take_integrator(struct calx_models *models, const struct calx_report_candidate *c)
{
    for (size_t k = 0; k < models->count; k++) {
        struct calx_model *m = &models->list[k];
        if (m->kind != (enum calx_kind)c->plugin->kind)
            continue;
        if (strcmp(m->plugin, c->plugin->name))
            m->value_count = 0;
        snprintf(m->plugin, sizeof m->plugin, "%.47s", c->plugin->name);
        for (size_t v = 0; v < c->value_count; v++)
            set_value(m, c->values[v].name, c->values[v].value);
    }
}

static void take_steps(struct calx_models *models, const struct calx_report_study *s,
                       const struct calx_report_recipe *r)
{
    if (s->axis == CALX_MOTION && !models->frozen && r->dt > 0)
        models->dt = r->dt;
    if (s->axis == CALX_TEMPERATURE && r->dt > 0)
        models->heat_dt = models->dt = r->dt;
    if (r->heat_dt > 0)
        models->heat_dt = r->heat_dt;
    models->forced = r->forced;
}

/* ---- tolerances ---- */

static const char tolerance[] = "tolerance";

static bool has_tolerance(const struct calx_report_study *s, enum calx_kind kind, const char *plugin)
{
    struct calx_error unused;
    const struct calx_plugin *p = calx_registry_find(s->run.registry, kind, plugin, &unused);
    return (kind == CALX_MOTION || kind == CALX_TEMPERATURE) && p && calx_plugin_parameter(p, tolerance);
}

bool calx_report_variant_has_tolerance(const struct calx_report_study *s, int candidate)
{
    const struct calx_models *models = &s->run.scene->models[s->run.scene->stages[0].models];
    bool has = has_tolerance(s, s->axis, s->candidates[candidate].plugin->name);
    for (size_t k = 0; k < models->count; k++)
        has |= models->list[k].kind != s->axis && has_tolerance(s, models->list[k].kind, models->list[k].plugin);
    return has;
}

/* Values, and room for those of a choice and a tolerance. */
static struct calx_value *with_room(const struct calx_value *values, size_t count)
{
    struct calx_value *copy = calloc(count + CALX_REPORT_VALUES + 1, sizeof *copy);
    return copy && count ? memcpy(copy, values, count * sizeof *copy) : copy;
}

static void take_tolerance(const struct calx_report_study *s, struct calx_model *m, double value)
{
    if (value > 0 && has_tolerance(s, m->kind, m->plugin))
        set_value(m, tolerance, value);
}

static bool vary_models(struct calx_models *models, const struct calx_report_study *s,
                        const struct calx_report_recipe *r)
{
    models->list = copy_of(models->list, models->count, sizeof *models->list);
    if (!models->list)
        return false;
    for (size_t k = 0; k < models->count; k++) {
        struct calx_model *m = &models->list[k];
        m->values = with_room(m->values, m->value_count);
        if (!m->values) {
            models->count = k;
            return false;
        }
        if (m->kind == CALX_CONTACT)
            scale_values(m->values, m->value_count, r);
    }
    take_steps(models, s, r);
    take_integrator(models, &s->candidates[r->candidate]);
    for (size_t k = 0; k < models->count; k++)
        take_tolerance(s, &models->list[k], r->tolerance);
    return true;
}

static bool vary_materials(struct calx_scene *scene, const struct calx_report_recipe *r)
{
    scene->materials = copy_of(scene->materials, scene->material_count, sizeof *scene->materials);
    for (size_t k = 0; scene->materials && k < scene->material_count; k++) {
        struct calx_material *m = &scene->materials[k];
        m->values = copy_of(m->values, m->value_count, sizeof *m->values);
        if (!m->values) {
            scene->material_count = k;
            return false;
        }
        scale_values(m->values, m->value_count, r);
    }
    return scene->materials != NULL;
}

/* ---- the start ---- */

/* Each free body is moved by up to this share of its radius along each axis of the case. */
static bool perturb(struct calx_scene *scene, const struct calx_report_recipe *r)
{
    struct calx_particles *p = &scene->particles;
    struct calx_random random;
    p->position = copy_of(p->position, p->count, sizeof *p->position);
    if (!p->position)
        return false;
    calx_random_seed(&random, 1 + (uint64_t)r->draw);
    for (size_t i = 0; r->perturb > 0 && i < p->count; i++)
        for (size_t k = 0; k < scene->dimension && !(p->fixed && p->fixed[i]); k++)
            p->position[i][k] += r->perturb * p->radius[i] * (2 * calx_random_uniform(&random) - 1);
    return true;
}

/* ---- life ---- */

struct calx_scene *calx_report_variant_create(const struct calx_report_study *s,
                                              const struct calx_scene *from,
                                              const struct calx_report_recipe *r)
{
    struct calx_scene *scene = copy_of(from, 1, sizeof *scene);
    if (!scene)
        return NULL;
    scene->materials = NULL;
    scene->models = copy_of(from->models, from->models_count, sizeof *from->models);
    size_t done = 0;
    bool whole = scene->models != NULL;
    for (; whole && done < from->models_count; done++)
        whole = vary_models(&scene->models[done], s, r);
    scene->models_count = done;
    scene->particles.position = NULL;
    if (whole) {
        scene->materials = from->materials;
        scene->particles.position = from->particles.position;
        whole = vary_materials(scene, r);
        whole = perturb(scene, r) && whole;
    }
    if (whole)
        return scene;
    calx_report_variant_free(scene);
    return NULL;
}

void calx_report_variant_free(struct calx_scene *scene)
{
    if (!scene)
        return;
    for (size_t m = 0; scene->models && m < scene->models_count; m++) {
        for (size_t k = 0; scene->models[m].list && k < scene->models[m].count; k++)
            free(scene->models[m].list[k].values);
        free(scene->models[m].list);
    }
    for (size_t k = 0; scene->materials && k < scene->material_count; k++)
        free(scene->materials[k].values);
    free(scene->materials);
    free(scene->models);
    free(scene->particles.position);
    free(scene);
}

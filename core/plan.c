/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The only place that chooses: loads the plugins of each set of models, fills and prepares their parameters for each pair of
 * materials, orders the laws, joins their needs, decides which arrays exist and which time step is taken.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/state.h"

static struct calx_setup setup_of(const struct calx_scene *scene, const struct calx_plan *p)
{
    return (struct calx_setup){.size = sizeof(struct calx_setup), .dimension = scene->dimension,
                               .bodies = scene->bodies, .thickness = scene->thickness,
                               .velocity_lag = p->motion_law ? p->motion_law->velocity_lag : 0.0,
                               .uses_velocity = p->uses_velocity};
}

/* The value of a row for materials a and b: the pair's own, else the model's, else the default. */
static double model_value(const struct calx_model *m, const struct calx_parameter *row, int a, int b)
{
    double v = row->flags & (CALX_REQUIRED | CALX_OPTIONAL) ? NAN : row->initial;
    int lo = a < b ? a : b, hi = a < b ? b : a;
    bool own = false;
    for (size_t k = 0; k < m->value_count; k++) {
        const struct calx_value *value = &m->values[k];
        bool pair = value->pair[0] == lo && value->pair[1] == hi;
        if (strcmp(value->name, row->name) || (value->pair[0] >= 0 && !pair) || (own && !pair))
            continue;
        own |= pair;
        v = value->value;
    }
    return v;
}

static int fill_params(const struct calx_scene *scene, const struct calx_model *m,
                       const struct calx_plugin *plugin, int a, int b, void *params, struct calx_error *e)
{
    for (size_t r = 0; r < plugin->parameter_count; r++) {
        const struct calx_parameter *row = &plugin->parameters[r];
        double *field = (double *)((char *)params + row->offset);
        size_t fields = row->scope == CALX_MATERIAL ? 2 : 1;
        if (row->scope != CALX_MATERIAL)
            field[0] = model_value(m, row, a, b);
        for (size_t k = 0; k < fields; k++) {
            int material = k ? b : a;
            if (row->scope == CALX_MATERIAL)
                field[k] = calx_scene_material_value(scene, (size_t)material, row->name);
            if (isnan(field[k]) && row->scope == CALX_MATERIAL && !(row->flags & (CALX_OPTIONAL | CALX_REQUIRED)))
                field[k] = row->initial;
            if (isnan(field[k]) && row->flags & CALX_REQUIRED)
                return calx_error_at(e, CALX_ERROR_INPUT, row->scope == CALX_MATERIAL ?
                                     scene->materials[material].place : m->place,
                                     "%s '%s' needs %s (%s)%s%s", calx_kind_name(m->kind), m->plugin, row->name,
                                     row->doc, row->scope == CALX_MATERIAL ? " of material " : "",
                                     row->scope == CALX_MATERIAL ? scene->materials[material].name : "");
        }
    }
    return 0;
}

/* Which ordered pairs of materials can meet: those of particles, and particles with walls. */
static bool can_meet(const struct calx_sim *s, size_t a, size_t b)
{
    return s->material_used[a] & 1 && s->material_used[b];
}

/* One filled and prepared struct per ordered pair of materials that can meet. */
static int prepare_pairs(struct calx_sim *s, struct calx_plan *p, const struct calx_model *m,
                         const struct calx_plugin *plugin,
                         int (*prepare)(const struct calx_setup *, void *, struct calx_demand *, char *, size_t),
                         const struct calx_demand *most, struct calx_demand *demand, struct calx_demand *own,
                         char **params, struct calx_error *e)
{
    size_t n = s->scene->material_count;
    struct calx_setup setup = setup_of(s->scene, p);
    char why[512] = "";
    *params = calx_memory_zeroed(n * n, plugin->params_size ? plugin->params_size : 1);
    if (!*params)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for parameters");
    for (size_t type = 0; type < n * n; type++) {
        void *at = *params + plugin->params_size * type;
        struct calx_demand d = *most;
        if (!can_meet(s, type / n, type % n))
            continue;
        CALX_TRY(fill_params(s->scene, m, plugin, (int)(type / n), (int)(type % n), at, e));
        if (prepare && prepare(&setup, at, &d, why, sizeof why))
            return calx_error_at(e, CALX_ERROR_INPUT, m->place, "%s '%s' (materials %s and %s): %s",
                                 calx_kind_name(m->kind), plugin->name, s->scene->materials[type / n].name,
                                 s->scene->materials[type % n].name, why);
        if (own)
            own[type] = d;
        demand->needs |= d.needs;
        demand->history_vectors = d.history_vectors > demand->history_vectors ? d.history_vectors
                                                                              : demand->history_vectors;
        demand->history_scalars = d.history_scalars > demand->history_scalars ? d.history_scalars
                                                                              : demand->history_scalars;
        demand->gap = fmax(demand->gap, d.gap);
    }
    return 0;
}

static int add_law(struct calx_sim *s, struct calx_plan *p, const struct calx_model *m,
                   const struct calx_plugin *plugin, struct calx_error *e)
{
    if (p->law_count == CALX_LAWS_MAX)
        return calx_error_at(e, CALX_ERROR_INPUT, m->place, "more than %d contact laws", CALX_LAWS_MAX);
    struct calx_law *law = &p->laws[p->law_count++];
    law->plugin = plugin;
    law->model = m;
    law->law = plugin->law;
    law->own = calx_memory_zeroed(s->scene->material_count * s->scene->material_count, sizeof *law->own);
    if (!law->own)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for parameters");
    return prepare_pairs(s, p, m, plugin, law->law->prepare, &law->law->demand, &law->demand, law->own,
                         &law->params, e);
}

static int add_conductance(struct calx_sim *s, struct calx_plan *p, const struct calx_model *m,
                           const struct calx_plugin *plugin, struct calx_error *e)
{
    const struct calx_conductance_law *law = plugin->law;
    p->conductance = plugin;
    return prepare_pairs(s, p, m, plugin, law->prepare, &law->demand, &p->conductance_demand,
                         NULL, &p->conductance_params, e);
}

/* One struct of parameters for the run, filled. */
static int fill_run(struct calx_sim *s, const struct calx_model *m, const struct calx_plugin *plugin, void **params,
                    struct calx_error *e)
{
    *params = calx_memory_zeroed(1, plugin->params_size ? plugin->params_size : 1);
    if (!*params)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for parameters");
    return fill_params(s->scene, m, plugin, 0, 0, *params, e);
}

static int refused(const struct calx_model *m, const char *why, struct calx_error *e)
{
    return calx_error_at(e, CALX_ERROR_INPUT, m->place, "integrator '%s': %s", m->plugin, why);
}

static int add_motion(struct calx_sim *s, struct calx_plan *p, const struct calx_model *m,
                      const struct calx_plugin *plugin, struct calx_error *e)
{
    struct calx_setup setup = setup_of(s->scene, p);
    char why[512] = "";
    memcpy(&p->motion_actual, plugin->law, sizeof p->motion_actual);
    p->motion = plugin;
    p->motion_model = m;
    p->motion_law = &p->motion_actual;
    CALX_TRY(fill_run(s, m, plugin, &p->motion_params, e));
    if (p->motion_law->prepare &&
        p->motion_law->prepare(&setup, p->motion_params, &p->motion_actual, why, sizeof why))
        return refused(m, why, e);
    if (p->motion_actual.extra_translation > CALX_EXTRA_MAX || p->motion_actual.extra_rotation > CALX_EXTRA_MAX)
        return refused(m, "it keeps more than 8 rows of extra state per particle", e);
    return 0;
}

/* Once the laws have said whether forces depend on velocities, the integrator of motion is prepared for that. */
static int tell_motion(struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    uint32_t uses = 0;
    for (size_t l = 0; l < p->law_count; l++)
        uses |= p->laws[l].demand.needs & CALX_USES_VELOCITY;
    p->uses_velocity = uses != 0;
    if (!uses || !p->motion_law || !p->motion_law->prepare)
        return 0;
    if (p->motion_law->release)
        p->motion_law->release(p->motion_params);
    free(p->motion_params);
    p->motion_params = NULL;
    return add_motion(s, p, p->motion_model, p->motion, e);
}

static int add_temperature(struct calx_sim *s, struct calx_plan *p, const struct calx_model *m,
                           const struct calx_plugin *plugin, struct calx_error *e)
{
    p->heat = plugin;
    p->heat_law = plugin->law;
    p->global_heat = p->heat_law->solve && !p->heat_law->advance;
    struct calx_setup setup = setup_of(s->scene, p);
    char why[512] = "";
    CALX_TRY(fill_run(s, m, plugin, &p->heat_params, e));
    if (p->heat_law->prepare && p->heat_law->prepare(&setup, p->heat_params, why, sizeof why))
        return refused(m, why, e);
    return 0;
}

/* The integrator of motion first: the other plugins may ask for its velocity lag. */
static const enum calx_kind load_order[] = {CALX_MOTION, CALX_CONTACT, CALX_CONDUCTANCE, CALX_TEMPERATURE};

static int load_models(struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    static int (*const add[])(struct calx_sim *, struct calx_plan *, const struct calx_model *,
                              const struct calx_plugin *, struct calx_error *) = {
        [CALX_CONTACT] = add_law, [CALX_CONDUCTANCE] = add_conductance, [CALX_MOTION] = add_motion,
        [CALX_TEMPERATURE] = add_temperature};
    for (size_t o = 0; o < sizeof load_order / sizeof *load_order; o++)
        for (size_t k = 0; k < p->models->count; k++) {
            const struct calx_model *m = &p->models->list[k];
            if (m->kind != load_order[o])
                continue;
            const struct calx_plugin *plugin = calx_registry_find(s->registry, m->kind, m->plugin, e);
            if (!plugin) {
                if (e && !e->line)
                    e->line = m->place.line;
                return e ? (int)e->code : CALX_ERROR_INPUT;
            }
            CALX_TRY(add[m->kind](s, p, m, plugin, e));
        }
    return tell_motion(s, p, e);
}

static int by_part(const void *a, const void *b)
{
    uint32_t pa = ((const struct calx_law *)a)->law->provides, pb = ((const struct calx_law *)b)->law->provides;
    uint32_t la = pa & -pa, lb = pb & -pb; /* the first part it provides */
    return la < lb ? -1 : la > lb;
}

static const char *part_name(uint32_t part)
{
    return part & CALX_NORMAL ? "normal force" : part & CALX_COHESION ? "cohesion"
         : part & CALX_TANGENTIAL ? "tangential force" : "rolling resistance";
}

/* Laws in the order normal, cohesion, tangential, rolling; each finds what it depends on; smooth and non-smooth do not mix. */
static int order_laws(struct calx_plan *p, struct calx_error *e)
{
    uint32_t provided = 0;
    qsort(p->laws, p->law_count, sizeof *p->laws, by_part);
    for (size_t l = 0; l < p->law_count; l++)
        provided |= p->laws[l].law->provides;
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_contact_law *law = p->laws[l].law;
        uint32_t missing = law->depends & ~provided;
        if (missing)
            return calx_error_at(e, CALX_ERROR_INPUT, p->laws[l].model->place,
                "contact '%s' needs a law that provides a %s, and none of the case's contact laws does: add one, "
                "for example linear or hertz", p->laws[l].plugin->name, part_name(missing));
        if (law->nonsmooth && !(p->motion_law && p->motion_law->solves_impulses))
            return calx_error_at(e, CALX_ERROR_INPUT, p->laws[l].model->place,
                "contact '%s' is non-smooth and needs an integrator that solves for impulses (nscd); '%s' does not",
                p->laws[l].plugin->name, p->motion ? p->motion->name : "none");
        if (!law->nonsmooth && p->motion_law && p->motion_law->solves_impulses)
            return calx_error_at(e, CALX_ERROR_INPUT, p->laws[l].model->place,
                "integrator '%s' solves for impulses and takes non-smooth laws only (signorini-coulomb, cohesive), "
                "not '%s'", p->motion->name, p->laws[l].plugin->name);
        p->cohesion |= (law->provides & CALX_COHESION) != 0;
    }
    p->nonsmooth = p->motion_law && p->motion_law->solves_impulses;
    return 0;
}

/* The host keeps the impulse of each contact for the next step to start from. */
static int keep_impulses(const struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    const struct calx_particles *bodies = &s->scene->particles;
    double smallest = bodies->count ? bodies->radius[0] : 0.0;
    if (p->history + 4 > CALX_HISTORY_MAX)
        return calx_error_at(e, CALX_ERROR_INPUT, p->motion_model->place, "the contact laws keep more than %d numbers per contact",
                             CALX_HISTORY_MAX);
    p->impulse = p->history;
    p->history_is_vector[p->impulse] = 1;
    p->history += 4;
    for (size_t i = 1; i < bodies->count; i++)
        smallest = fmin(smallest, bodies->radius[i]);
    p->gap = fmax(p->gap, p->motion_law->reach * smallest);
    return 0;
}

static int join_needs(const struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    p->needs = p->conductance_demand.needs;
    for (size_t l = 0; l < p->law_count; l++) {
        struct calx_law *law = &p->laws[l];
        size_t columns = 3 * law->demand.history_vectors + law->demand.history_scalars;
        law->first_history = p->history;
        if (p->history + columns > CALX_HISTORY_MAX)
            return calx_error_at(e, CALX_ERROR_INPUT, law->model->place, "the contact laws keep more than %d numbers per contact",
                                 CALX_HISTORY_MAX);
        for (size_t v = 0; v < law->demand.history_vectors; v++)
            p->history_is_vector[p->history + 3 * v] = 1;
        p->history += columns;
        p->needs |= law->demand.needs;
        p->gap = fmax(p->gap, law->demand.gap);
    }
    if (p->needs & CALX_NEEDS_SPIN)
        p->needs |= CALX_NEEDS_ROTATION;
    if (p->needs & CALX_NEEDS_ROTATION)
        p->needs |= CALX_NEEDS_TANGENT;
    if (p->nonsmooth)
        return keep_impulses(s, p, e);
    return calx_motion_resolve(p, e);
}

static int choose_step(struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    const struct calx_models *m = p->models;
    struct calx_place nowhere = {NULL, 0}, place = p->motion_model ? p->motion_model->place : nowhere;
    double fraction = m->dt_fraction > 0.0 ? m->dt_fraction : 0.05;
    CALX_TRY(calx_critical_step(s, p, e));
    p->dt = m->frozen ? m->heat_dt : m->dt > 0.0 ? m->dt : fraction * p->critical_dt;
    if (m->frozen && !(p->dt > 0.0))
        p->dt = m->dt;
    if (p->nonsmooth && !m->frozen && !(m->dt > 0.0))
        return calx_error_at(e, CALX_ERROR_INPUT, place,
            "no time step: rigid contacts vibrate at no frequency that could set one for integrator '%s'; give dt on <integrator>, so that "
            "bodies come a small share of their radius in a step", p->motion->name);
    if (!(p->dt > 0.0) || !isfinite(p->dt))
        return calx_error_at(e, CALX_ERROR_INPUT, place,
            "no time step: nothing in the case sets one (no stiff contact); give dt on <integrator>");
    if (!m->frozen && !m->forced && p->dt > p->critical_dt)
        return calx_error_at(e, CALX_ERROR_INPUT, place,
            "dt = %g s is above the stability limit %g s, set by %s: use dt=\"%.2g s\" (a twentieth of it) or dt=\"auto\"",
            p->dt, p->critical_dt, p->critical_text, 0.05 * p->critical_dt);
    p->adapts = !m->frozen && !(m->dt > 0.0) && !p->motion_law->constant_step;
    double ratio = m->heat_dt > 0.0 && !m->frozen ? m->heat_dt / p->dt : 1.0;
    p->heat_every = ratio > 1.5 ? (int64_t)llround(ratio) : 1;
    p->heat_dt = (double)p->heat_every * p->dt;
    return 0;
}

static void mark_materials(struct calx_sim *s)
{
    const struct calx_scene *scene = s->scene;
    for (size_t i = 0; i < scene->particles.count; i++)
        s->material_used[scene->particles.material[i]] |= 1;
    for (size_t w = 0; w < scene->wall_count; w++)
        if (scene->walls[w].material >= 0)
            s->material_used[scene->walls[w].material] |= 2;
}

static void join_features(struct calx_sim *s)
{
    struct calx_features *f = &s->features;
    const struct calx_scene *scene = s->scene;
    f->dimension = scene->dimension;
    for (size_t k = 0; k < s->plan_count; k++) {
        const struct calx_plan *p = &s->plans[k];
        bool contacts = p->law_count || p->conductance;
        f->motion |= p->motion != NULL;
        f->rotation |= p->motion && p->needs & CALX_NEEDS_ROTATION;
        f->temperature |= p->conductance || p->heat || p->needs & CALX_NEEDS_TEMPERATURE;
        f->history |= p->history > 0;
        f->history_columns = p->history > f->history_columns ? p->history : f->history_columns;
        f->search |= contacts && scene->particles.count > 1;
        f->contacts |= contacts;
        f->wall_contacts |= contacts && scene->wall_count > 0 && scene->particles.count > 0;
        f->heat_network |= p->global_heat;
    }
    for (int k = 0; k < 3; k++)
        f->periodic |= scene->periodic[k];
    f->ledger = true;
}

int calx_plan_create(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_scene *scene = s->scene;
    s->plan_count = scene->models_count;
    s->plans = calx_memory_zeroed(s->plan_count, sizeof *s->plans);
    s->material_used = calx_memory_zeroed(scene->material_count, 1);
    if (!s->plans || !s->material_used)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the plan");
    mark_materials(s);
    for (size_t k = 0; k < s->plan_count; k++) {
        struct calx_plan *p = &s->plans[k];
        p->models = &scene->models[k];
        CALX_TRY(load_models(s, p, e));
        CALX_TRY(order_laws(p, e));
        CALX_TRY(join_needs(s, p, e));
        if (!p->motion)
            p->needs &= ~(uint32_t)CALX_NEEDS_ROTATION;
        CALX_TRY(choose_step(s, p, e));
    }
    join_features(s);
    s->plan = &s->plans[scene->stages[0].models];
    return 0;
}

static void release_pairs(size_t types, const struct calx_plugin *plugin, char *params, void (*release)(void *))
{
    for (size_t t = 0; params && release && t < types; t++)
        release(params + plugin->params_size * t);
    free(params);
}

void calx_plan_free(struct calx_sim *s)
{
    size_t types = s->scene->material_count * s->scene->material_count;
    for (size_t k = 0; s->plans && k < s->plan_count; k++) {
        struct calx_plan *p = &s->plans[k];
        for (size_t l = 0; l < p->law_count; l++) {
            release_pairs(types, p->laws[l].plugin, p->laws[l].params, p->laws[l].law->release);
            free(p->laws[l].own);
        }
        if (p->conductance)
            release_pairs(types, p->conductance, p->conductance_params,
                          ((const struct calx_conductance_law *)p->conductance->law)->release);
        if (p->motion)
            release_pairs(1, p->motion, p->motion_params, p->motion_law->release);
        if (p->heat)
            release_pairs(1, p->heat, p->heat_params, p->heat_law->release);
    }
    free(s->plans);
    free(s->material_used);
}

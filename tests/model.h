/* SPDX-License-Identifier: BSD-3-Clause
 *
 * For tests of single laws: a plugin with prepared numbers, and a batch of one contact.
 */
#ifndef CALX_TESTS_MODEL_H
#define CALX_TESTS_MODEL_H

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/loader.h"

static const struct calx_setup spheres = {
    .size = sizeof spheres, .dimension = 3, .bodies = CALX_SPHERES, .velocity_lag = 0.5};
static const struct calx_setup discs = {.size = sizeof discs,
                                        .dimension = 2,
                                        .bodies = CALX_DISCS,
                                        .thickness = 0.02,
                                        .velocity_lag = 0.5};

static struct calx_registry *registry;

static inline void set_up(void)
{
    registry = calx_registry_create(NULL);
}

static inline void tear_down(void)
{
    calx_registry_free(registry);
}

/* ---- models ---- */

/* A plugin with prepared numbers. */
struct model {
    const struct calx_plugin *plugin;
    struct calx_demand demand;
    _Alignas(16) char params[512];
};

static inline double *field(struct model *m, const char *name)
{
    const struct calx_parameter *row = calx_plugin_parameter(m->plugin, name);
    ck_assert_msg(row != NULL, "no parameter %s", name);
    return (double *)(m->params + row->offset);
}

/* values: "name=1 name=2:3" (body i : body j). Returns what prepare returns. */
static inline int model_prepare(struct model *m, enum calx_kind kind, const char *name,
                                const struct calx_setup *setup, const char *values, char *why,
                                size_t why_size)
{
    struct calx_error error = {0};
    char word[48];
    double a, b;
    memset(m, 0, sizeof *m);
    m->plugin = calx_registry_find(registry, kind, name, &error);
    ck_assert_msg(m->plugin != NULL, "%s", error.text);
    ck_assert_uint_le(m->plugin->params_size, sizeof m->params);
    for (size_t i = 0; i < m->plugin->parameter_count; i++) {
        const struct calx_parameter *row = &m->plugin->parameters[i];
        *field(m, row->name) = row->flags & CALX_OPTIONAL ? NAN : row->initial;
    }
    for (int used = 0; sscanf(values, " %47[^=]=%lf%n", word, &a, &used) >= 2; values += used) {
        double *f = field(m, word);
        f[0] = a;
        if (calx_plugin_parameter(m->plugin, word)->scope != CALX_MATERIAL)
            continue;
        f[1] = a;
        if (values[used] == ':' && sscanf(values + used + 1, "%lf", &b) == 1) {
            f[1] = b;
            used += 1 + (int)strcspn(values + used + 1, " ");
        }
    }
    const struct calx_contact_law *contact = m->plugin->law;
    const struct calx_conductance_law *conductance = m->plugin->law;
    const struct calx_temperature_integrator *temperature = m->plugin->law;
    if (kind == CALX_TEMPERATURE)
        return temperature->prepare ? temperature->prepare(setup, m->params, why, why_size) : 0;
    m->demand = kind == CALX_CONTACT ? contact->demand : conductance->demand;
    int (*prepare)(const struct calx_setup *, void *, struct calx_demand *, char *, size_t) =
        kind == CALX_CONTACT ? contact->prepare : conductance->prepare;
    return prepare ? prepare(setup, m->params, &m->demand, why, why_size) : 0;
}

static inline void model_open(struct model *m, enum calx_kind kind, const char *name,
                              const struct calx_setup *setup, const char *values)
{
    char why[256] = "";
    int failed = model_prepare(m, kind, name, setup, values, why, sizeof why);
    ck_assert_msg(!failed, "%s refuses %s: %s", name, values, why);
}

static inline double sphere_mass(double density, double radius)
{
    return 4.0 / 3.0 * M_PI * density * radius * radius * radius;
}

/* ---- one contact ---- */

/* A batch of one contact with its padding: normal along y, sliding along x. */
struct contact {
    _Alignas(64) double overlap[8], vn[8], vt[3][8], normal[3][8], mass[8], curvature[2][8];
    double fn[8], ft[3][8], work[8], history[12][8];
    double *column[2][12]; /* of the normal and the tangential law */
    struct calx_contacts batch;
};

static inline void contact_begin(struct contact *c, double dt, double inverse_mass,
                                 double curvature_i, double curvature_j)
{
    memset(c, 0, sizeof *c);
    for (int k = 0; k < 12; k++) {
        c->column[0][k] = c->history[k];
        c->column[1][k] = c->history[k + 2 < 12 ? k + 2 : 11];
    }
    c->normal[1][0] = 1;
    c->mass[0] = 1 / inverse_mass;
    c->curvature[0][0] = curvature_i;
    c->curvature[1][0] = curvature_j;
    c->batch = (struct calx_contacts){.size = sizeof c->batch,
                                      .n = 1,
                                      .dt = dt,
                                      .overlap = c->overlap,
                                      .normal = {c->normal[0], c->normal[1], c->normal[2]},
                                      .vn = c->vn,
                                      .vt = {c->vt[0], c->vt[1], c->vt[2]},
                                      .mass = c->mass,
                                      .curvature = {c->curvature[0], c->curvature[1]},
                                      .coulomb = c->fn,
                                      .fn = c->fn,
                                      .ft = {c->ft[0], c->ft[1], c->ft[2]},
                                      .work = c->work};
}

/* One evaluation of a normal and, unless NULL, a tangential law. */
static inline void contact_force(struct contact *c, const struct model *normal,
                                 const struct model *tangential)
{
    const struct model *laws[] = {normal, tangential};
    c->fn[0] = c->ft[0][0] = c->ft[1][0] = c->ft[2][0] = 0;
    for (int k = 0; k < 2 && laws[k]; k++) {
        c->batch.history = c->column[k];
        ((const struct calx_contact_law *)laws[k]->plugin->law)->force(laws[k]->params, &c->batch);
    }
}

#endif

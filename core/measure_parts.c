/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Quantities of one part of a scene: a wall, the slab behind it, a layer of a profile, a signal that is watched. Input: the frame, the simulation, the probe's choices.
 * Output: up to three doubles.
 */
#include <math.h>
#include <string.h>

#include "core/measure_table.h"

/* ---- walls ---- */

static bool copy3(const double (*rows)[3], size_t i, double out[3])
{
    memcpy(out, rows[i], sizeof rows[i]);
    return true;
}

static bool copy1(const double *column, size_t i, double out[3])
{
    if (column)
        out[0] = column[i];
    return column != NULL;
}

bool calx_measure_wall_force(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    int wall = v->probe->wall;
    return f && wall >= 0 && (size_t)wall < f->walls &&
           copy3((const double(*)[3])f->force_on_wall, (size_t)wall, out);
}

static bool wall_vector(const struct calx_measure_view *v, double (*const rows)[3], double out[3])
{
    return rows && v->probe->wall >= 0 && copy3((const double(*)[3])rows, (size_t)v->probe->wall, out);
}

bool calx_measure_wall_displacement(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    return f && wall_vector(v, f->displacement_of_wall, out);
}

bool calx_measure_wall_velocity(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    return f && wall_vector(v, f->velocity_of_wall, out);
}

/* Component k: with the normal along axis k. */
bool calx_measure_wall_friction(const struct calx_measure_view *v, double out[3])
{
    double force[3];
    if (!calx_measure_wall_force(v, force))
        return false;
    for (int k = 0; k < 3; k++) {
        double across = force[(k + 1) % 3] * force[(k + 1) % 3] + force[(k + 2) % 3] * force[(k + 2) % 3];
        out[k] = sqrt(across) / fabs(force[k]);
    }
    return true;
}

bool calx_measure_slab_mean(const struct calx_measure_view *v, double out[3])
{
    out[0] = calx_sim_slab_temperature(v->sim, v->probe->wall, false);
    return true;
}

bool calx_measure_slab_largest(const struct calx_measure_view *v, double out[3])
{
    out[0] = calx_sim_slab_temperature(v->sim, v->probe->wall, true);
    return true;
}

bool calx_measure_wall_temperature(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    int wall = v->probe->wall;
    return f && wall >= 0 && (size_t)wall < f->walls &&
           copy1(f->temperature_of_wall, (size_t)wall, out);
}

/* ---- layers ---- */

/* The layer that the probe chooses, NULL before the first window is complete. */
static const struct calx_layer *layer_of(const struct calx_measure_view *v, const struct calx_profile **profile)
{
    const struct calx_scene *scene = calx_sim_scene(v->sim);
    size_t p = (size_t)v->probe->profile, layer = (size_t)v->probe->layer;
    if (v->probe->profile < 0 || p >= scene->profile_count || layer < 1 || layer > scene->profiles[p].layers)
        return NULL;
    struct calx_profile_view view = calx_sim_profile(v->sim, p);
    *profile = &scene->profiles[p];
    return view.windows > 0 ? &view.layers[layer - 1] : NULL;
}

bool calx_measure_layer_velocity(const struct calx_measure_view *v, double out[3])
{
    const struct calx_profile *p;
    const struct calx_layer *l = layer_of(v, &p);
    if (l)
        memcpy(out, l->velocity, sizeof l->velocity);
    return l != NULL;
}

bool calx_measure_layer_temperature(const struct calx_measure_view *v, double out[3])
{
    const struct calx_profile *p;
    const struct calx_layer *l = layer_of(v, &p);
    out[0] = l ? l->temperature : NAN;
    return l != NULL;
}

bool calx_measure_layer_solid_fraction(const struct calx_measure_view *v, double out[3])
{
    const struct calx_profile *p;
    const struct calx_layer *l = layer_of(v, &p);
    out[0] = l ? l->solid_fraction : NAN;
    return l != NULL;
}

bool calx_measure_layer_traction(const struct calx_measure_view *v, double out[3])
{
    const struct calx_profile *p;
    const struct calx_layer *l = layer_of(v, &p);
    for (int k = 0; l && k < 3; k++)
        out[k] = l->contact_stress[3 * k + p->axis] + l->kinetic_stress[3 * k + p->axis];
    return l != NULL;
}

/* ---- signals that are watched ---- */

static const struct calx_steady_view *watch_of(const struct calx_measure_view *v)
{
    size_t watch = v->probe->steady;
    return watch >= 1 && watch <= calx_sim_scene(v->sim)->steady_count ? calx_sim_steady(v->sim, watch - 1) : NULL;
}

bool calx_measure_steady_drift(const struct calx_measure_view *v, double out[3])
{
    const struct calx_steady_view *w = watch_of(v);
    out[0] = w ? w->drift : NAN;
    return w != NULL;
}

bool calx_measure_steady_since(const struct calx_measure_view *v, double out[3])
{
    const struct calx_steady_view *w = watch_of(v);
    out[0] = w ? w->since : NAN;
    return w != NULL;
}

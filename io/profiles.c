/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Writes profiles. Input: the last complete window of each profile. Output: its rows in a CSV and its layers as cells of a .vtu. One table says
 * which numbers there are; both files follow it.
 */
#include "io/profiles.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "core/measure.h"
#include "io/series.h"
#include "io/table.h"

enum { MOST_COLUMNS = 32 };

/* A number, vector or tensor of a layer. */
static const struct quantity {
    const char *name, *unit;
    size_t components, offset;
    bool thermal;
} quantities[] = {
    {"solid_fraction", "1", 1, offsetof(struct calx_layer, solid_fraction), false},
    {"velocity", "m/s", 3, offsetof(struct calx_layer, velocity), false},
    {"fluctuation", "m/s", 3, offsetof(struct calx_layer, fluctuation), false},
    {"temperature", "K", 1, offsetof(struct calx_layer, temperature), true},
    {"coordination_number", "1", 1, offsetof(struct calx_layer, coordination), false},
    {"stress", "Pa", 9, offsetof(struct calx_layer, contact_stress), false},
    {"kinetic_stress", "Pa", 9, offsetof(struct calx_layer, kinetic_stress), false},
};

enum { QUANTITIES = sizeof quantities / sizeof *quantities };

struct files {
    int64_t windows; /* written, or dropped by who came before */
    struct calx_table *table;
    struct calx_series *series;
};

struct calx_profiles {
    struct calx_sim *sim;
    bool thermal;
    size_t columns;                /* of the CSV */
    char titles[MOST_COLUMNS][40];
    struct files *files;           /* one per profile */
};

static const double *value_of(const struct calx_layer *layer, const struct quantity *q)
{
    return (const double *)((const char *)layer + q->offset);
}

static bool there(const struct calx_profiles *p, const struct quantity *q)
{
    return p->thermal || !q->thermal;
}

/* In 2D the components of z are left out. */
static bool is_column(const struct calx_scene *scene, const struct quantity *q, size_t component)
{
    return q->components == 1 || (component % 3 < scene->dimension && component / 3 < scene->dimension);
}

/* ---- the CSV ---- */

static void title(char to[40], const struct quantity *q, size_t component)
{
    if (q->components == 1)
        snprintf(to, 40, "%s", q->name);
    else if (q->components == 3)
        snprintf(to, 40, "%s_%c", q->name, "xyz"[component]);
    else
        snprintf(to, 40, "%s_%c%c", q->name, "xyz"[component / 3], "xyz"[component % 3]);
}

static void name_columns(struct calx_profiles *p, const struct calx_profile *profile, struct calx_table_column *columns)
{
    const struct calx_scene *scene = calx_sim_scene(p->sim);
    size_t n = 0;
    snprintf(p->titles[n], sizeof p->titles[n], "time");
    columns[n++].unit = "s";
    snprintf(p->titles[n], sizeof p->titles[n], "%c", "xyz"[profile->axis]);
    columns[n++].unit = "m";
    for (const struct quantity *q = quantities; q < quantities + QUANTITIES; q++)
        for (size_t k = 0; k < q->components; k++)
            if (there(p, q) && is_column(scene, q, k)) {
                title(p->titles[n], q, k);
                columns[n++].unit = q->unit;
            }
    for (size_t k = 0; k < n; k++)
        columns[k].name = p->titles[k];
    p->columns = n;
}

static int write_rows(const struct calx_profiles *p, const struct calx_profile *profile, const struct calx_profile_view *v,
                      struct calx_table *table, struct calx_error *e)
{
    for (size_t layer = 0; layer < profile->layers; layer++) {
        double row[MOST_COLUMNS] = {v->end, v->layers[layer].position};
        size_t n = 2;
        for (const struct quantity *q = quantities; q < quantities + QUANTITIES; q++)
            for (size_t k = 0; k < q->components; k++)
                if (there(p, q) && is_column(calx_sim_scene(p->sim), q, k))
                    row[n++] = value_of(&v->layers[layer], q)[k];
        CALX_TRY(calx_table_append(table, row, e));
    }
    return CALX_OK;
}

/* ---- the cells ---- */

/* Layers share the points between them: 2 per border in 2D, 4 in 3D. */
static void place_points(const struct calx_scene *scene, const struct calx_profile *p, struct calx_mesh *m)
{
    static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    size_t per = scene->dimension == 2 ? 2 : 4;
    int u = (p->axis + 1) % 3, v = (p->axis + 2) % 3;
    if (scene->dimension == 2 && u == 2) {
        u = v;
        v = 2;
    }
    for (size_t border = 0; border <= p->layers; border++)
        for (size_t k = 0; k < per; k++) {
            double *at = m->position[per * border + k];
            at[p->axis] = p->low[p->axis] + (p->high[p->axis] - p->low[p->axis]) * (double)border / (double)p->layers;
            at[u] = around[k][0] ? p->high[u] : p->low[u];
            at[v] = per == 2 ? 0.0 : around[k][1] ? p->high[v] : p->low[v];
        }
    for (size_t layer = 0; layer < p->layers; layer++)
        for (size_t k = 0; k < per; k++) {
            m->corner[2 * per * layer + k] = (int64_t)(per * layer + k);
            m->corner[2 * per * layer + per + k] = (int64_t)(per * (layer + 1) + (per == 2 ? 1 - k : k));
        }
}

static int write_cells(const struct calx_profiles *p, const struct calx_profile *profile, const struct calx_profile_view *v,
                       struct calx_series *series, struct calx_error *e)
{
    const struct calx_scene *scene = calx_sim_scene(p->sim);
    size_t per = scene->dimension == 2 ? 2 : 4;
    struct calx_mesh *m = calx_mesh_create(per * (profile->layers + 1), profile->layers, 2 * per);
    bool failed = !m;
    if (m) {
        m->time = v->end;
        place_points(scene, profile, m);
    }
    for (const struct quantity *q = quantities; !failed && q < quantities + QUANTITIES; q++) {
        double *to = there(p, q) ? calx_mesh_add(m, q->name, strcmp(q->unit, "1") ? q->unit : NULL, q->components) : NULL;
        failed = there(p, q) && !to;
        for (size_t layer = 0; to && layer < profile->layers; layer++)
            memcpy(to + q->components * layer, value_of(&v->layers[layer], q), q->components * sizeof *to);
    }
    int code = failed ? calx_error_set(e, CALX_ERROR_MEMORY, "out of memory for profile %s", profile->name)
                      : calx_series_write_mesh(series, m, e);
    calx_mesh_free(m);
    return code;
}

/* ---- all profiles ---- */

static int open_files(struct calx_profiles *p, size_t k, const char *folder, const char *name, bool resumed, struct calx_error *e)
{
    const struct calx_scene *scene = calx_sim_scene(p->sim);
    const struct calx_profile *profile = &scene->profiles[k];
    struct calx_profile_view v = calx_sim_profile(p->sim, k);
    struct calx_table_column columns[MOST_COLUMNS] = {{0}};
    char suffix[64], *path = NULL;
    double kept = resumed ? v.end : -INFINITY;
    p->files[k].windows = v.windows;
    name_columns(p, profile, columns);
    snprintf(suffix, sizeof suffix, "_profile_%s", profile->name);
    if (asprintf(&path, "%s/%s%s.csv", folder, name, suffix) < 0)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory");
    p->files[k].series = calx_series_of_meshes(folder, name, suffix, &scene->output, kept, e);
    if (p->files[k].series)
        p->files[k].table = calx_table_resume(path, columns, p->columns, kept, e);
    free(path);
    return p->files[k].table ? CALX_OK : (int)e->code;
}

struct calx_profiles *calx_profiles_open(const char *folder, const char *name, struct calx_sim *sim, bool resumed,
                                         struct calx_error *e)
{
    struct calx_profiles *p = calloc(1, sizeof *p);
    size_t count = calx_sim_scene(sim)->profile_count;
    struct files *files = calloc(count + 1, sizeof *files);
    if (!p || !files) {
        calx_error_set(e, CALX_ERROR_MEMORY, "out of memory");
        free(p);
        free(files);
        return NULL;
    }
    *p = (struct calx_profiles){.sim = sim, .thermal = calx_sim_features(sim).temperature, .files = files};
    for (size_t k = 0; k < count; k++)
        if (open_files(p, k, folder, name, resumed, e)) {
            calx_profiles_free(p);
            return NULL;
        }
    return p;
}

int calx_profiles_write(struct calx_profiles *p, struct calx_error *e)
{
    const struct calx_scene *scene = calx_sim_scene(p->sim);
    for (size_t k = 0; k < scene->profile_count; k++) {
        struct calx_profile_view v = calx_sim_profile(p->sim, k);
        if (v.windows == p->files[k].windows)
            continue;
        p->files[k].windows = v.windows;
        CALX_TRY(write_rows(p, &scene->profiles[k], &v, p->files[k].table, e));
        CALX_TRY(write_cells(p, &scene->profiles[k], &v, p->files[k].series, e));
    }
    return CALX_OK;
}

void calx_profiles_free(struct calx_profiles *p)
{
    if (!p)
        return;
    for (size_t k = 0; k < calx_sim_scene(p->sim)->profile_count; k++) {
        calx_table_free(p->files[k].table);
        calx_series_free(p->files[k].series);
    }
    free(p->files);
    free(p);
}

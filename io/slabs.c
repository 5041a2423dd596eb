/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Writes slabs: a series of meshes for each wall that has one.
 */
#include "io/slabs.h"

#include <stdlib.h>

#include "core/measure.h"
#include "io/series.h"

struct calx_slab_files {
    struct calx_sim *sim;
    struct calx_series **series; /* per wall; NULL without a slab */
};

struct calx_slab_files *calx_slab_files_open(const char *folder, const char *name, struct calx_sim *sim, double time,
                                             struct calx_error *e)
{
    const struct calx_scene *scene = calx_sim_scene(sim);
    struct calx_slab_files *f = calloc(1, sizeof *f);
    struct calx_series **series = calloc(scene->wall_count + 1, sizeof *series);
    if (!f || !series) {
        calx_error_set(e, CALX_ERROR_MEMORY, "out of memory");
        free(f);
        free(series);
        return NULL;
    }
    *f = (struct calx_slab_files){sim, series};
    for (size_t w = 0; w < scene->wall_count; w++) {
        char suffix[64];
        if (!scene->walls[w].slab.along)
            continue;
        snprintf(suffix, sizeof suffix, "_slab_%s", scene->walls[w].name);
        series[w] = calx_series_of_meshes(folder, name, suffix, &scene->output, time, e);
        if (!series[w]) {
            calx_slab_files_free(f);
            return NULL;
        }
    }
    return f;
}

int calx_slab_files_write(struct calx_slab_files *f, struct calx_error *e)
{
    for (size_t w = 0; w < calx_sim_scene(f->sim)->wall_count; w++) {
        struct calx_mesh *m = f->series[w] ? calx_sim_slab_mesh(f->sim, (int)w) : NULL;
        if (!f->series[w])
            continue;
        int code = m ? calx_series_write_mesh(f->series[w], m, e) : calx_error_set(e, CALX_ERROR_MEMORY, "out of memory for slabs");
        calx_mesh_free(m);
        CALX_TRY(code);
    }
    return CALX_OK;
}

void calx_slab_files_free(struct calx_slab_files *f)
{
    if (!f)
        return;
    for (size_t w = 0; w < calx_sim_scene(f->sim)->wall_count; w++)
        calx_series_free(f->series[w]);
    free(f->series);
    free(f);
}

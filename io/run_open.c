/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Opens a run: finds and reads its case, names its output, makes the simulation and chooses the
 * columns of the CSV. Input: the options. Output: struct calx_run, ready to go.
 */
#include "io/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/measure.h"

static int out_of_memory(struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

/* The last part of a path without slashes at its end and without `.xml`; the caller frees it. */
static char *short_name(const char *path)
{
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/')
        --end;
    size_t begin = end;
    while (begin > 0 && path[begin - 1] != '/')
        --begin;
    if (end - begin > 4 && strncmp(path + end - 4, ".xml", 4) == 0)
        end -= 4;
    return strndup(path + begin, end - begin);
}

/* The folder of the case gives the name, unless the file has a name of its own. */
static char *case_name(const char *file)
{
    const char *base = strrchr(file, '/');
    if (strcmp(base ? base + 1 : file, "case.xml") != 0)
        return short_name(file);
    char *full = realpath(file, NULL);
    if (full)
        *strrchr(full, '/') = '\0';
    char *name = full && *full ? short_name(full) : strdup("case");
    free(full);
    return name;
}

static int find_case(struct calx_run *run, struct calx_error *error)
{
    const char *path = run->options.case_path;
    struct stat info;
    if (stat(path, &info) != 0)
        return calx_error_set(error, CALX_ERROR_INPUT, "no case file or folder '%s'", path);
    if (asprintf(&run->file, S_ISDIR(info.st_mode) ? "%s/case.xml" : "%s", path) < 0) {
        run->file = NULL;
        return out_of_memory(error);
    }
    if (access(run->file, R_OK) != 0)
        return calx_error_set(error, CALX_ERROR_INPUT, "no readable case file '%s'", run->file);
    run->name = case_name(run->file);
    return run->name ? CALX_OK : out_of_memory(error);
}

static int name_output(struct calx_run *run, struct calx_error *error)
{
    int length = run->options.out ? asprintf(&run->folder, "%s", run->options.out)
                                  : asprintf(&run->folder, "results/%s", run->name);
    if (length < 0) {
        run->folder = NULL;
        return out_of_memory(error);
    }
    if (asprintf(&run->restart_path, "%s/%s.restart", run->folder, run->name) < 0) {
        run->restart_path = NULL;
        return out_of_memory(error);
    }
    return CALX_OK;
}

static int choose_columns(struct calx_run *run, struct calx_error *error)
{
    const struct calx_scene *scene = run->scene;
    size_t most = calx_column_count() + scene->probe_count, n = 0;
    bool thermal = calx_sim_features(run->sim).temperature;
    run->columns = calloc(most, sizeof *run->columns);
    run->standard = calloc(calx_column_count(), sizeof *run->standard);
    run->row = calloc(most, sizeof *run->row);
    if (!run->columns || !run->standard || !run->row)
        return out_of_memory(error);
    for (size_t i = 0; i < calx_column_count(); ++i) {
        const struct calx_column *column = calx_column_at(i);
        struct calx_probe *p = &run->standard[i];
        *p = (struct calx_probe){.particle = -1, .material = -1, .wall = -1};
        strncpy(p->name, column->title, sizeof p->name - 1);
        strncpy(p->quantity, column->quantity, sizeof p->quantity - 1);
        strncpy(p->reduce, column->reduce, sizeof p->reduce - 1);
        if (thermal || !column->thermal)
            run->columns[n++] = p;
    }
    for (size_t i = 0; i < scene->probe_count; ++i)
        run->columns[n++] = &scene->probes[i];
    run->column_count = n;
    return CALX_OK;
}

static uint64_t hash_bytes(uint64_t hash, const void *data, size_t bytes)
{
    const unsigned char *c = data;
    for (size_t i = 0; c && i < bytes; ++i)
        hash = (hash ^ c[i]) * 0x100000001b3u; /* FNV-1a */
    return hash;
}

static uint64_t hash_values(uint64_t hash, const struct calx_value *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        hash = hash_bytes(hash, values[i].name, strlen(values[i].name));
        hash = hash_bytes(hash, &values[i].value, sizeof values[i].value);
        hash = hash_bytes(hash, values[i].pair, sizeof values[i].pair);
    }
    return hash;
}

/* What a restart point depends on: bodies, materials and models. Stages and output may be changed
 * to go on longer. */
static uint64_t hash_case(const struct calx_scene *s)
{
    const struct calx_particles *p = &s->particles;
    uint64_t hash = 0xcbf29ce484222325u;
    hash = hash_bytes(hash, &s->dimension, sizeof s->dimension);
    hash = hash_bytes(hash, p->position, p->count * sizeof *p->position);
    hash = hash_bytes(hash, p->radius, p->count * sizeof *p->radius);
    hash = hash_bytes(hash, p->material, p->count * sizeof *p->material);
    for (size_t i = 0; i < s->material_count; ++i) {
        hash = hash_bytes(hash, &s->materials[i].density, sizeof(double));
        hash = hash_bytes(hash, &s->materials[i].specific_heat, sizeof(double));
        hash = hash_values(hash, s->materials[i].values, s->materials[i].value_count);
    }
    for (size_t i = 0; i < s->models_count; ++i)
        for (size_t m = 0; m < s->models[i].count; ++m) {
            const struct calx_model *model = &s->models[i].list[m];
            hash = hash_bytes(hash, model->plugin, strlen(model->plugin));
            hash = hash_values(hash, model->values, model->value_count);
        }
    return hash_bytes(hash, &s->wall_count, sizeof s->wall_count);
}

static int read_case(struct calx_run *run, FILE *messages, struct calx_error *error)
{
    const struct calx_run_options *o = &run->options;
    run->registry = calx_registry_create(NULL);
    if (!run->registry)
        return out_of_memory(error);
    run->scene =
        calx_case_read(run->file, run->registry, o->settings, o->setting_count, &run->problems);
    calx_problems_print(&run->problems, messages);
    if (!run->scene)
        return calx_error_set(error, CALX_ERROR_INPUT, "%zu mistake%s in %s", run->problems.count,
                              run->problems.count == 1 ? "" : "s", run->file);
    for (size_t i = 0; i < run->scene->models_count; ++i)
        run->scene->models[i].forced |= o->force;
    return CALX_OK;
}

int calx_run_open(struct calx_run *run, const struct calx_run_options *options, FILE *messages,
                  struct calx_error *error)
{
    *run = (struct calx_run){
        .options = *options, .scheduled_frame = -INFINITY, .scheduled_row = -INFINITY};
    CALX_TRY(find_case(run, error));
    CALX_TRY(name_output(run, error));
    CALX_TRY(read_case(run, messages, error));
    run->case_hash = hash_case(run->scene);
    run->verify = calx_verify_create(run->scene, error);
    if (!run->verify)
        return error->code;
    run->sim = calx_sim_create(run->scene, run->registry, options->threads, error);
    if (!run->sim)
        return error->code;
    return choose_columns(run, error);
}

void calx_run_close(struct calx_run *run)
{
    calx_slab_files_free(run->slabs);
    calx_profiles_free(run->profiles);
    calx_table_free(run->table);
    calx_series_free(run->series);
    calx_verify_free(run->verify);
    calx_sim_free(run->sim);
    calx_scene_free(run->scene);
    calx_registry_free(run->registry);
    calx_problems_clear(&run->problems);
    free(run->row);
    free(run->standard);
    free(run->columns);
    free(run->restart_path);
    free(run->folder);
    free(run->name);
    free(run->file);
    *run = (struct calx_run){0};
}

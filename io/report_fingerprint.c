/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The fingerprint of a report: equal for the same case, options, plugins and version of calx, so
 * that an interrupted report may go on, and a changed one does not.
 * Input: the case file's bytes, what it made of other files (walls, particles), options, the bytes of
 * the integrators and models. Output: 64 bits, FNV-1a.
 */
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

uint64_t calx_report_hash(uint64_t hash, const void *data, size_t bytes)
{
    const unsigned char *c = data;
    for (size_t i = 0; c && i < bytes; ++i)
        hash = (hash ^ c[i]) * 0x100000001b3u;
    return hash;
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    return calx_report_hash(hash, text ? text : "-", text ? strlen(text) + 1 : 2);
}

static int hash_file(uint64_t *hash, const char *path, struct calx_error *error)
{
    char block[4096];
    size_t n;
    FILE *file = fopen(path, "rb");
    if (!file)
        return calx_error_set(error, CALX_ERROR_IO, "cannot read %s", path);
    while ((n = fread(block, 1, sizeof block, file)) > 0)
        *hash = calx_report_hash(*hash, block, n);
    fclose(file);
    return CALX_OK;
}

/* Whatever the program knows of: a report takes all integrators, and the case names the other models. */
static int hash_plugins(const struct calx_report_study *s, uint64_t *hash, struct calx_error *error)
{
    for (size_t k = 0; k < calx_registry_count(s->run.registry); k++)
        CALX_TRY(hash_file(hash, calx_registry_path(s->run.registry, calx_registry_at(s->run.registry, k)), error));
    return CALX_OK;
}

static uint64_t hash_bodies(uint64_t hash, const struct calx_scene *scene)
{
    const struct calx_particles *p = &scene->particles;
    hash = calx_report_hash(hash, p->position, p->count * sizeof *p->position);
    hash = calx_report_hash(hash, p->radius, p->count * sizeof *p->radius);
    hash = calx_report_hash(hash, p->velocity, p->count * sizeof *p->velocity);
    hash = calx_report_hash(hash, p->temperature, p->count * sizeof *p->temperature);
    if (p->carrier)
        hash = calx_report_hash(hash, p->carrier, p->count * sizeof *p->carrier);
    for (size_t w = 0; w < scene->wall_count; w++)
        for (size_t k = 0; k < scene->walls[w].primitive_count; k++) {
            const struct calx_primitive *q = &scene->walls[w].primitives[k];
            hash = calx_report_hash(hash, q->a, sizeof q->a);
            hash = calx_report_hash(hash, q->b, sizeof q->b);
            hash = calx_report_hash(hash, &q->radius, sizeof q->radius);
        }
    return hash;
}

int calx_report_fingerprint(struct calx_report_study *s, struct calx_error *error)
{
    const struct calx_report_options *o = s->options;
    uint64_t hash = hash_text(0xcbf29ce484222325u, CALX_VERSION);
    const char *texts[] = {o->integrators, o->steps, o->heat_steps, o->soften, o->tolerances, o->quantities};
    const double numbers[] = {o->target, o->budget, o->seeds, o->stability};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        hash = hash_text(hash, texts[k]);
    hash = calx_report_hash(hash, numbers, sizeof numbers);
    for (size_t k = 0; k < o->setting_count; k++)
        hash = hash_text(hash_text(hash, o->settings[k].path), o->settings[k].value);
    CALX_TRY(hash_file(&hash, s->run.file, error));
    CALX_TRY(hash_plugins(s, &hash, error));
    s->fingerprint = hash_bodies(hash, s->run.scene);
    return CALX_OK;
}

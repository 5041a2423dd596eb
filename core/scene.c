/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The life of a scene: created empty, filled by a reader, freed with everything it owns. Finds
 * materials, their values and walls by name.
 */
#include "core/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct calx_scene *calx_scene_create(void)
{
    struct calx_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return NULL;
    scene->dimension = 3;
    scene->bodies = CALX_SPHERES;
    return scene;
}

static void free_particles(struct calx_particles *particles)
{
    free(particles->position);
    free(particles->radius);
    free(particles->material);
    free(particles->velocity);
    free(particles->spin);
    free(particles->temperature);
    free(particles->fixed);
    free(particles->carrier);
}

static void free_models(struct calx_scene *scene)
{
    for (size_t k = 0; k < scene->models_count; k++) {
        for (size_t m = 0; m < scene->models[k].count; m++)
            free(scene->models[k].list[m].values);
        free(scene->models[k].list);
    }
    free(scene->models);
}

static void free_lists(struct calx_scene *scene)
{
    for (size_t k = 0; k < scene->material_count; k++)
        free(scene->materials[k].values);
    for (size_t k = 0; k < scene->wall_count; k++)
        free(scene->walls[k].primitives);
    for (size_t k = 0; k < scene->stage_count; k++) {
        free(scene->stages[k].motion);
        free(scene->stages[k].wall_temperature);
    }
    free(scene->materials);
    free(scene->walls);
    free(scene->stages);
    free(scene->probes);
    free(scene->expects);
    free(scene->exacts);
    free(scene->profiles);
    free(scene->steady);
}

void calx_scene_free(struct calx_scene *scene)
{
    if (!scene)
        return;
    free_models(scene);
    free_lists(scene);
    free_particles(&scene->particles);
    for (size_t k = 0; k < scene->attachment_count; k++)
        scene->attachments[k].release(scene->attachments[k].what);
    free(scene->attachments);
    for (size_t k = 0; k < scene->file_count; k++)
        free(scene->files[k]);
    free(scene->files);
    free(scene->title);
    free(scene->file);
    free(scene->directory);
    free(scene);
}

int calx_scene_attach(struct calx_scene *scene, void *what, void (*release)(void *))
{
    size_t bytes = (scene->attachment_count + 1) * sizeof *scene->attachments;
    struct calx_attachment *grown = realloc(scene->attachments, bytes);
    if (!grown)
        return CALX_ERROR_MEMORY;
    grown[scene->attachment_count] = (struct calx_attachment){what, release};
    scene->attachments = grown;
    scene->attachment_count++;
    return CALX_OK;
}

int calx_scene_material(const struct calx_scene *scene, const char *name)
{
    for (size_t k = 0; k < scene->material_count; k++)
        if (strcmp(scene->materials[k].name, name) == 0)
            return (int)k;
    return -1;
}

int calx_scene_wall(const struct calx_scene *scene, const char *name)
{
    for (size_t k = 0; k < scene->wall_count; k++)
        if (strcmp(scene->walls[k].name, name) == 0)
            return (int)k;
    return -1;
}

double calx_scene_material_value(const struct calx_scene *scene, size_t m, const char *name)
{
    const struct calx_material *material = &scene->materials[m];
    if (!strcmp(name, "density"))
        return material->density;
    if (!strcmp(name, "specific-heat"))
        return material->specific_heat;
    for (size_t k = 0; k < material->value_count; k++)
        if (!strcmp(material->values[k].name, name))
            return material->values[k].value;
    return NAN;
}

double calx_scene_depth(const struct calx_scene *scene)
{
    double largest = 0.0;
    for (size_t i = 0; i < scene->particles.count; i++)
        largest = fmax(largest, scene->particles.radius[i]);
    return scene->bodies == CALX_DISCS ? scene->thickness : 2.0 * largest;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Reads a case. Input: an XML file and settings from the command line. Output: a scene, or all
 * mistakes of the file. Method: load, apply settings, check names and forms against the tables,
 * then one pass per kind of thing in the order in which they refer to each other; each goes on
 * after a mistake.
 */
#include "io/case.h"

#include <stdlib.h>
#include <string.h>

#include "io/case_load.h"
#include "io/case_reader.h"

static char *directory_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

/* Gives the scene the strings that places point to. */
static bool name_scene(struct calx_scene *scene, const char *path)
{
    scene->file = strdup(path);
    scene->directory = directory_of(path);
    scene->title = strdup("");
    scene->files = calloc(1, sizeof *scene->files);
    if (scene->files) {
        scene->files[0] = strdup(path);
        scene->file_count = 1;
    }
    return scene->file && scene->directory && scene->title && scene->files && scene->files[0];
}

static void read_document(struct calx_reader *r, const struct calx_setting *settings,
                          size_t setting_count)
{
    if (strcmp((const char *)r->root->name, calx_elements_root()->name) != 0) {
        calx_problems_add(r->problems, calx_case_place(r, r->root),
                          "the outermost element is <%.40s>, expected <case>",
                          (const char *)r->root->name);
        return;
    }
    calx_case_apply_settings(r, settings, setting_count);
    calx_case_check(r);
    calx_case_read_surroundings(r);
    calx_case_read_materials(r);
    calx_case_read_models(r);
    calx_case_read_walls(r);
    calx_case_read_stages(r);
    calx_case_read_particles(r);
    calx_case_read_slabs(r);
    calx_case_read_profiles(r);
    calx_case_read_output(r);
    calx_case_read_steady(r);
    calx_case_read_expects(r);
    calx_case_read_exacts(r);
    calx_case_check_scene(r);
}

static struct calx_scene *read_file(const char *path, struct calx_registry *registry,
                                    const struct calx_setting *settings, size_t setting_count,
                                    uint64_t draw, struct calx_problems *problems)
{
    struct calx_reader r = {
        .scene = calx_scene_create(), .registry = registry, .problems = problems, .draw = draw};
    if (!r.scene || !name_scene(r.scene, path)) {
        calx_problems_add(problems, (struct calx_place){path, 0}, "no memory");
        return r.scene;
    }
    xmlDoc *document = calx_case_load(path, problems);
    r.file = r.scene->files[0];
    r.root = document ? xmlDocGetRootElement(document) : NULL;
    if (r.root)
        read_document(&r, settings, setting_count);
    xmlFreeDoc(document);
    free(r.plugins);
    free(r.uses);
    return r.scene;
}

struct calx_scene *calx_case_read_draw(const char *path, struct calx_registry *registry,
                                       const struct calx_setting *settings, size_t setting_count,
                                       uint64_t draw, struct calx_problems *problems)
{
    struct calx_scene *scene =
        read_file(path, registry, settings, setting_count, draw, problems);
    calx_problems_sort(problems);
    if (!problems->count)
        return scene;
    calx_scene_free(scene);
    return NULL;
}

struct calx_scene *calx_case_read(const char *path, struct calx_registry *registry,
                                  const struct calx_setting *settings, size_t setting_count,
                                  struct calx_problems *problems)
{
    return calx_case_read_draw(path, registry, settings, setting_count, 0, problems);
}

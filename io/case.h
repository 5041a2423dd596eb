/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Reads a case file (XML) into a scene. cases/FORMAT.md documents the elements; their one table is
 * io/elements.c.
 */
#ifndef CALX_CASE_H
#define CALX_CASE_H

#include <stddef.h>
#include <stdio.h>

#include "core/error.h"
#include "core/loader.h"
#include "core/scene.h"
#include "io/problems.h"

/* An attribute to set before the case is read, from --set path=value. The path is made of element
 * names below <case>, each with an optional [name] or [number from 1], and ends with an attribute:
 * "stage[turn]/for", "particles/pack/count", "title". */
struct calx_setting {
    const char *path, *value;
};

/* The scene of a case file; NULL if there is any mistake, all of which are then in `problems`
 * (warnings may be there either way). Plugins that the case names are loaded into the registry; the
 * scene keeps their names only. The caller frees the scene with calx_scene_free(). */
struct calx_scene *calx_case_read(const char *path, struct calx_registry *,
                                  const struct calx_setting *settings, size_t setting_count,
                                  struct calx_problems *);

/* The same with another draw of all random numbers: draw 0 is that of the file's seeds. */
struct calx_scene *calx_case_read_draw(const char *path, struct calx_registry *,
                                       const struct calx_setting *settings, size_t setting_count,
                                       uint64_t draw, struct calx_problems *);

#endif

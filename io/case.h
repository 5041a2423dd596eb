/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Reads a case file (XML) into a scene. cases/FORMAT.md documents the elements; their one table is io/elements.c.
 */
#ifndef CALX_CASE_H
#define CALX_CASE_H

#include <stddef.h>
#include <stdio.h>

#include "core/error.h"
#include "core/loader.h"
#include "core/scene.h"

/* A growing list of mistakes and warnings, each with its place; text is "element: what, expected, nearest name". */
struct calx_problems {
    size_t count; /* mistakes */
    struct calx_error *list;
    size_t warning_count;
    struct calx_error *warnings;
    bool out_of_memory; /* a mistake or warning could not be kept */
};

/* An attribute to set before the case is read, from --set path=value. The path is made of element names below <case>, each with
 * an optional [name] or [number from 1], and ends with an attribute: "stage[turn]/for", "particles/pack/count", "title". */
struct calx_setting {
    const char *path, *value;
};

/* Adds a mistake (or a warning) unless the same one is there already. file may be NULL, line 0. */
void calx_problems_add(struct calx_problems *, struct calx_place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void calx_problems_warn(struct calx_problems *, struct calx_place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints "file:line: element: text" for each mistake and "file:line: warning: element: text" for each warning. */
void calx_problems_print(const struct calx_problems *, FILE *);

/* Frees the lists; the struct is empty afterwards. An empty struct is all zeros. */
void calx_problems_clear(struct calx_problems *);

/* The scene of a case file; NULL if there is any mistake, all of which are then in `problems` (warnings may be there either way).
 * Plugins that the case names are loaded into the registry, which must outlive nothing here: the scene keeps names only.
 * The caller frees the scene with calx_scene_free(). */
struct calx_scene *calx_case_read(const char *path, struct calx_registry *, const struct calx_setting *settings,
                                  size_t setting_count, struct calx_problems *);

#endif

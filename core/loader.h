/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Finds, loads and checks plugins (dlopen), and answers questions about their tables. A registry is a set of
 * loaded plugins; it belongs to its owner (no global state).
 */
#ifndef CALX_LOADER_H
#define CALX_LOADER_H

#include <stdio.h>

#include "core/error.h"
#include "core/plugin.h"

struct calx_registry;

/* Looks in the folders of `paths` (colon-separated, may be NULL), of the environment variable CALX_PLUGINS, then beside the program and in
 * the installed folder. Loads nothing yet. NULL without memory. */
struct calx_registry *calx_registry_create(const char *paths);
void calx_registry_free(struct calx_registry *);

/* The plugin of that kind and name, loaded at the first call. NULL with an error: not found (paths tried, nearest name, list),
 * dlopen failed, not a calx plugin, ABI differs, wrong kind, table invalid, duplicate name. */
const struct calx_plugin *calx_registry_find(struct calx_registry *, enum calx_kind, const char *name, struct calx_error *);

/* Loads one file. NULL with an error as above. */
const struct calx_plugin *calx_registry_load(struct calx_registry *, const char *path, struct calx_error *);

/* Loads every plugin in the folders; returns how many are loaded. Files that fail are reported to `problems` (may be NULL). */
size_t calx_registry_load_all(struct calx_registry *, FILE *problems);
size_t calx_registry_count(const struct calx_registry *);
const struct calx_plugin *calx_registry_at(const struct calx_registry *, size_t);
const char *calx_registry_path(const struct calx_registry *, const struct calx_plugin *);

/* The word for a kind in a case file: contact, conductance, integrator (motion), integrator (temperature). */
const char *calx_kind_name(enum calx_kind);

/* The row of that name in the plugin's table, or NULL. */
const struct calx_parameter *calx_plugin_parameter(const struct calx_plugin *, const char *name);

/* Whether v is allowed in that row: 0, or CALX_ERROR_INPUT with a text that names the row and its range. */
int calx_parameter_check(const struct calx_parameter *, double v, struct calx_error *);

#endif

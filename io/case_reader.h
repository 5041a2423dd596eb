/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files of the case reader (io/case*.c) share; nobody else includes it. Each element is an
 * xmlNode whose _private points to its row in io/element_tables.c once calx_case_check() has seen
 * it; nodes that it did not know are skipped. Mistakes go to the list of problems and reading goes
 * on; values that could not be read are NaN, -1 or false.
 */
#ifndef CALX_CASE_READER_H
#define CALX_CASE_READER_H

#include <libxml/tree.h>
#include <stdbool.h>

#include "core/calx.h"
#include "io/case.h"
#include "io/elements.h"

/* Who is made of a material; bits. */
enum calx_case_use { CALX_BY_PARTICLES = 1, CALX_BY_WALLS = 2 };

struct calx_reader {
    struct calx_scene *scene;
    struct calx_registry *registry;
    struct calx_problems *problems;
    xmlNode *root;
    const char *file;    /* owned by the scene */
    size_t plugin_count; /* those the case names anywhere */
    const struct calx_plugin **plugins;
    bool plugin_missing; /* some could not be loaded: unknown parameters are then no further mistake
                          */
    unsigned char *uses; /* of each material: enum calx_case_use */
    uint64_t draw;       /* of random numbers: added to every seed, in large steps */
    int32_t surface_count; /* smooth surfaces of walls so far; numbers are unique in the scene */
};

/* ---- places and messages (case_values.c)
 * ---------------------------------------------------------------- */

struct calx_place calx_case_place(const struct calx_reader *, const xmlNode *);

/* Adds "element 'name': attribute: text"; attribute may be NULL. */
void calx_case_fail(struct calx_reader *, const xmlNode *, const char *attribute,
                    const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Adds the text of an error in the same way. */
void calx_case_fail_with(struct calx_reader *, const xmlNode *, const char *attribute,
                         const struct calx_error *);

/* Adds "expected one of ..." with the nearest of names. what is the bad word. */
void calx_case_fail_name(struct calx_reader *, const xmlNode *, const char *attribute,
                         const char *kind, const char *what, const char *const *names,
                         size_t count);

/* Appends a zeroed entry to an array and returns it; on lack of memory adds a problem and returns
 * NULL. */
void *calx_case_append(struct calx_reader *, void *array_pointer, size_t *count, size_t entry_size);

/* ---- walking
 * ------------------------------------------------------------------------------------------- */

const struct calx_element *calx_case_element(const xmlNode *);

/* The first child, and the next sibling, of that element id; NULL at the end. */
xmlNode *calx_case_first(const xmlNode *parent, const char *id);
xmlNode *calx_case_next(const xmlNode *node, const char *id);

/* ---- attributes
 * ---------------------------------------------------------------------------------------- */

/* The text of an attribute as the file gives it, or NULL; valid while the document is. */
const char *calx_case_given(const xmlNode *, const char *name);

/* The same, or the default of the table, or NULL. "" is the text inside the element. */
const char *calx_case_text(const xmlNode *, const char *name);

bool calx_case_yes(struct calx_reader *, const xmlNode *, const char *name);
int calx_case_word(struct calx_reader *, const xmlNode *,
                   const char *name); /* index in the choices, -1 */
uint32_t calx_case_words(struct calx_reader *, const xmlNode *,
                         const char *name); /* bit per choice */
double calx_case_number(struct calx_reader *, const xmlNode *, const char *name);
int64_t calx_case_whole(struct calx_reader *, const xmlNode *,
                        const char *name); /* -1 if not given */
size_t calx_case_list(struct calx_reader *, const xmlNode *, const char *name, double *values,
                      size_t max);
bool calx_case_vector(struct calx_reader *, const xmlNode *, const char *name, double vector[3]);
bool calx_case_function(struct calx_reader *, const xmlNode *, const char *name,
                        struct calx_function *);
bool calx_case_functions(struct calx_reader *, const xmlNode *, const char *name,
                         struct calx_function vector[3]);

/* The same for another unit than the table's, which says none. */
bool calx_case_function_in(struct calx_reader *, const xmlNode *, const char *name,
                           const char *unit, bool difference, struct calx_function *);
double calx_case_number_in(struct calx_reader *, const xmlNode *, const char *name,
                           const char *unit, bool difference);

/* Index of the material or wall that the attribute names; -1 and a problem if there is none, -1 if
 * not given. */
int calx_case_material(struct calx_reader *, const xmlNode *, const char *name);
int calx_case_wall(struct calx_reader *, const xmlNode *, const char *name);
int calx_case_find_material(struct calx_reader *, const xmlNode *, const char *attribute,
                            const char *material);
int calx_case_find_wall(struct calx_reader *, const xmlNode *, const char *attribute,
                        const char *wall);

/* Splits a copy of text at blanks and at the characters of `also`; returns how many words, at most
 * max. The caller frees *copy. */
size_t calx_case_split(const char *text, const char *also, char **copy, const char **words,
                       size_t max);

/* The path of the existing file that an attribute names, relative to the case file; the caller
 * frees it. NULL if it is not given, or with a problem. */
char *calx_case_path(struct calx_reader *, const xmlNode *, const char *name);

/* ---- the passes, each in its file
 * ------------------------------------------------------------------------ */

/* Elements and attributes against the tables: names, number, form; marks the nodes. (case_check.c)
 */
void calx_case_check(struct calx_reader *);

/* Sets attributes before the check. (case_settings.c) */
void calx_case_apply_settings(struct calx_reader *, const struct calx_setting *, size_t count);

/* The plugin that a contact, conductance or integrator names, or NULL with an error.
 * (case_models.c) */
const struct calx_plugin *calx_case_plugin(struct calx_reader *, const xmlNode *,
                                           struct calx_error *);
enum calx_kind calx_case_kind(const xmlNode *);
void calx_case_find_plugins(struct calx_reader *);
/* The row that an attribute means which the element's table lacks, or NULL. */
const struct calx_parameter *calx_case_parameter(struct calx_reader *, const xmlNode *,
                                                 const char *name);
/* Reads a parameter's text: number with unit, yes or no, or a choice; NaN and a problem if it is
 * wrong. */
double calx_case_parameter_value(struct calx_reader *, const xmlNode *,
                                 const struct calx_parameter *, const char *text);

void calx_case_read_materials(struct calx_reader *);
void calx_case_read_models(struct calx_reader *);
int calx_case_stage_models(struct calx_reader *, const xmlNode *stage, int before);
void calx_case_read_surroundings(struct calx_reader *);
void calx_case_read_walls(struct calx_reader *);
void calx_case_read_particles(struct calx_reader *);
void calx_case_read_slabs(struct calx_reader *);
void calx_case_read_stages(struct calx_reader *);
void calx_case_read_gravity(struct calx_reader *, const xmlNode *, struct calx_function gravity[3]);
/* The attribute of <probe> without which the quantity is no single number, or NULL. (case_output.c)
 */
const char *calx_case_needed_choice(const struct calx_measure *);
void calx_case_read_output(struct calx_reader *);
void calx_case_read_profiles(struct calx_reader *);
void calx_case_read_steady(struct calx_reader *);
void calx_case_read_expects(struct calx_reader *);
void calx_case_read_exacts(struct calx_reader *);

/* The index of the stage that the attribute names; -1 if it is not given or there is no such stage
 * (a problem). */
int calx_case_stage(struct calx_reader *, const xmlNode *, const char *attribute);
/* What only the whole scene shows: parameters that materials lack, densities. */
void calx_case_check_scene(struct calx_reader *);

#endif

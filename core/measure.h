/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Quantities: what probes, expectations, stage conditions and the CSV may name. The table itself is
 * behind calx_measure_find() of core/calx.h; this header adds the standard columns, the meaning of
 * an expectation's name, the classes of a mixing index, and what the engine provides for them.
 */
#ifndef CALX_MEASURE_H
#define CALX_MEASURE_H

#include "core/calx.h"

/* ---- the standard columns of the CSV ---- */

struct calx_column {
    const char *title;    /* as in the CSV: kinetic, heat_content */
    const char *quantity; /* as in calx_measure_find() */
    const char *reduce;   /* of a particle quantity, else "" */
    bool thermal;         /* only in a scene with temperature */
};
size_t calx_column_count(void);
const struct calx_column *calx_column_at(size_t);

/* What `of` means in an expectation: a probe of the scene, else a column of the CSV, else a
 * quantity of the whole scene (hyphens and underscores are the same). Fills *probe and returns 0,
 * or CALX_ERROR_INPUT with the nearest name. */
int calx_measure_resolve(const struct calx_scene *, const char *of, struct calx_probe *probe,
                         struct calx_error *);

/* Whether this is a name for `classes` of a mixing index; all names, separated by commas. */
bool calx_measure_is_class(const char *name);
const char *calx_measure_classes(void);

/* ---- for the engine ---- */

/* The frame and ledger of the last measurement, so that one record of the CSV copies the state
 * once. Zero at the start. */
struct calx_measure_cache {
    struct calx_frame *frame;
    struct calx_ledger ledger;
    int64_t frame_step, ledger_step, share_step;
    bool has_ledger, has_share;
    double share;     /* of calx_sim_step_share() */
    int64_t share_id;
    bool written; /* the frame went to a file: changes of the walls count from here */
};

/* Frees the frame and forgets all: when the simulation is freed, and after a restore. */
void calx_measure_clear(struct calx_measure_cache *);

/* Whether the engine must keep classes (one byte per particle, in order of id, saved with restarts)
 * for this probe. */
bool calx_measure_has_classes(const struct calx_probe *);

/* Whether the engine must watch the largest force (calx_sim_watch_peak()) for this probe. */
bool calx_measure_is_peak(const struct calx_probe *);

/* Assigns the classes of the probes that count from this stage. The engine calls it when a stage
 * begins, at t = 0 with 0. */
void calx_measure_begin_stage(struct calx_sim *, int stage);

/* The frame of the present state with its contact network; owned by the cache and valid until the
 * next step. Its walls_changed counts since the frame that calx_measure_mark_written() was called
 * for. NULL without memory. */
const struct calx_frame *calx_measure_frame(struct calx_sim *);
void calx_measure_mark_written(struct calx_sim *);

/* calx_sim_step_share(), worked out once per state. */
double calx_measure_step_share(struct calx_sim *, int64_t *id);

/* ---- provided by the engine ---- */

const struct calx_scene *calx_sim_scene(const struct calx_sim *);
struct calx_measure_cache *calx_sim_measure_cache(struct calx_sim *);
/* The classes of that probe by id, NULL if it has none. Owned by the simulation. */
uint8_t *calx_sim_probe_classes(struct calx_sim *, size_t probe);

#endif

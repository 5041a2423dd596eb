/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to the quantities: the rows of their table and what the rows may look at.
 */
#ifndef CALX_MEASURE_TABLE_H
#define CALX_MEASURE_TABLE_H

#include "core/measure.h"

/* What a row may look at; frame and ledger are made on demand. */
struct calx_measure_view {
    struct calx_sim *sim;
    const struct calx_probe *probe;
};

/* One quantity: exactly one of particle, whole and entry (1 + index of a double in the ledger) is
 * set. The functions return false if the quantity does not exist in the scene. */
struct calx_measure_row {
    struct calx_measure measure;
    bool (*particle)(const struct calx_frame *, size_t i, double out[3]);
    bool (*whole)(const struct calx_measure_view *, double out[3]);
    size_t entry;
};

/* ---- measure_parts.c: of a wall, the slab behind it, a layer of a profile, a signal that is watched; false, or NaN, if there is none ---- */

bool calx_measure_wall_force(const struct calx_measure_view *, double out[3]);
bool calx_measure_wall_displacement(const struct calx_measure_view *, double out[3]);
bool calx_measure_wall_velocity(const struct calx_measure_view *, double out[3]);
bool calx_measure_wall_friction(const struct calx_measure_view *, double out[3]);
bool calx_measure_wall_temperature(const struct calx_measure_view *, double out[3]);
bool calx_measure_slab_mean(const struct calx_measure_view *, double out[3]);
bool calx_measure_slab_largest(const struct calx_measure_view *, double out[3]);
bool calx_measure_layer_velocity(const struct calx_measure_view *, double out[3]);
bool calx_measure_layer_temperature(const struct calx_measure_view *, double out[3]);
bool calx_measure_layer_solid_fraction(const struct calx_measure_view *, double out[3]);
bool calx_measure_layer_traction(const struct calx_measure_view *, double out[3]);
bool calx_measure_steady_drift(const struct calx_measure_view *, double out[3]);
bool calx_measure_steady_since(const struct calx_measure_view *, double out[3]);

/* ---- the table ---- */

/* The row of that name, or NULL. */
const struct calx_measure_row *calx_measure_row(const char *name);

/* The ledger of the present step, kept for the other quantities of this step. */
const struct calx_ledger *calx_measure_ledger(struct calx_sim *);

/* The square of the length of a vector. */
double calx_measure_square(const double v[3]);

/* The unit vector against gravity in the present stage; y without gravity. */
void calx_measure_up(struct calx_sim *, double up[3]);

#endif

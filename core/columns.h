/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the columns of one batch of contacts and what is done with them. Contacts between particles and contacts
 * with walls are filled in by different code (contacts.c, wall_contacts.c) and evaluated by the same (evaluate.c).
 * These files are compiled once per instruction set: CALX_ISA(name) gives each copy its own names.
 */
#ifndef CALX_COLUMNS_H
#define CALX_COLUMNS_H

#include "core/state.h"

#ifndef CALX_ISA_NAME
#define CALX_ISA_NAME base
#endif
#define CALX_PASTE_(a, b) a##_##b
#define CALX_PASTE(a, b) CALX_PASTE_(a, b)
#define CALX_ISA(name) CALX_PASTE(name, CALX_ISA_NAME)

/* Scratch of one thread, small enough for L1. Filled before evaluation: distance to work; then fn to history. */
struct calx_columns {
    /* in */
    double overlap[CALX_BATCH], normal[3][CALX_BATCH], reach[CALX_BATCH]; /* reach: sum of radii */
    double velocity[3][CALX_BATCH];         /* v_i - v_j of the centres; of a wall: at the contact point */
    double lever[2][CALX_BATCH];            /* from each centre to the contact point; 0 for a wall */
    double omega[2][3][CALX_BATCH];
    double tilt[CALX_BATCH];                /* lag/distance: turns the normal back to when the velocity was; 0 for walls */
    double inverse_mass[CALX_BATCH], curvature[2][CALX_BATCH], temperature[2][CALX_BATCH];
    double history[CALX_HISTORY_MAX][CALX_BATCH];
    /* worked out */
    double vn[CALX_BATCH], vt[3][CALX_BATCH], spin[3][CALX_BATCH];
    /* out */
    double fn[CALX_BATCH], coulomb[CALX_BATCH], ft[3][CALX_BATCH], torque[3][CALX_BATCH], work[CALX_BATCH];
    double conductance[CALX_BATCH], heat[2][CALX_BATCH]; /* W/K; W into i and into j */
    double energy[CALX_BATCH];
    double force[3][CALX_BATCH], twist[3][CALX_BATCH]; /* on i; n x ft: what the levers multiply */
    int32_t row[2][CALX_BATCH];
    size_t source[CALX_BATCH]; /* pair, or wall contact, the lane came from */
    double lag;                /* s: velocities are those of so long before the positions */
    size_t n;                  /* last, so that every column is aligned */
} __attribute__((aligned(64)));

/* Fills vn, vt, spin, turns the history, runs the laws and the conductance: fn .. conductance, force, twist. clock may be NULL. */
void CALX_ISA(calx_evaluate_batch)(const struct calx_plan *, size_t type, double dt, bool conduct,
                                   struct calx_columns *, struct calx_clock *);

/* Adds the stored elastic energy of each lane to energy[]; needs what calx_evaluate_batch leaves. */
void CALX_ISA(calx_evaluate_energy)(const struct calx_plan *, size_t type, double dt,
                                    struct calx_columns *);

/* Wall contacts of one block: into its rows, tally and wall forces; or, if energy is not NULL, only the elastic energy is added
 * there; or, if sink is not NULL, each contact is only shown to it. */
void CALX_ISA(calx_wall_contacts)(struct calx_sim *, size_t block, double dt, bool conduct,
                                  struct calx_columns *, double *energy, const struct calx_sink *);

/* integrate.c: see struct calx_engine. */
double CALX_ISA(calx_block_before)(struct calx_sim *, size_t block, size_t stage);
void CALX_ISA(calx_block_finish)(struct calx_sim *, size_t block, int stage, bool ahead);
double CALX_ISA(calx_block_kernels)(struct calx_sim *, size_t block, size_t stage, const void *params,
                                    calx_rows_kernel *translation, calx_rows_kernel *rotation);
double CALX_ISA(calx_block_measure)(struct calx_sim *, size_t block, const void *params, calx_rows_measure *translation,
                                    calx_rows_measure *rotation);

/* The shares of dissipated work that become heat of body i and body j, for a pair type. */
void CALX_ISA(calx_heat_shares)(const struct calx_sim *, size_t material_i, size_t material_j, double share[2]);

#endif

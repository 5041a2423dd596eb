/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the columns of one batch of contacts and what is done with them. Contacts between particles are filled in and
 * delivered by gather.c and scatter.c, contacts with walls by wall_contacts.c; the laws (evaluate.c) see no difference.
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

typedef double calx_column[CALX_BATCH] __attribute__((aligned(64)));

struct calx_changes;

/* Scratch of one thread, small enough for L1. */
struct calx_columns {
    /* what the laws see; `history` points into the store of the pairs, or to `kept` for walls and for whoever only looks */
    calx_column overlap, normal[3], vn, vt[3], spin[3], mass, curvature[2], temperature[2];
    double *history[CALX_HISTORY_MAX];
    /* what they answer */
    calx_column fn, coulomb, ft[3], torque[3], work, conductance, energy;
    /* what takes forces to the bodies: sum and difference (i less j) of the levers, T_i - T_j */
    calx_column levers, excess, warmth;
    /* on the way: 1/distance of the centres; v_i less v_j, or less the wall's velocity at the contact point */
    calx_column inverse, velocity[3];
    /* of wall contacts: spin of the grain; out: force on i, n x ft */
    calx_column omega[3], force[3], twist[3];
    calx_column kept[CALX_HISTORY_MAX];
    /* the batch as each law sees it, and the conductance after them; made once per plan */
    const struct calx_plan *viewed;
    struct calx_contacts views[CALX_LAWS_MAX + 1];
    double *law_history[CALX_LAWS_MAX][CALX_HISTORY_MAX];
    uint8_t was[CALX_BATCH / 8], is[CALX_BATCH / 8]; /* touching, before and now: a bit per lane */
    /* of non-smooth laws: friction, restitution, pull, reach; where their impulses come from, NULL: from history, and which is next */
    calx_column condition[4];
    const struct calx_solution *solution;
    size_t answer;
    calx_column damping; /* of normal laws, N s/m, then their work, J: see onset.c; */
    double centre;       /* s: the step, 0 if there is none */
    const struct calx_changes *begun; /* what has begun in it */
    size_t n;
};

/* ---- evaluate.c ---- */

/* Of wall contacts: normal, velocity (of `lag`, s, before), omega and levers to vn, vt and spin; turns the history with the normal. */
void CALX_ISA(calx_evaluate_motion)(const struct calx_plan *, double lag, struct calx_columns *);

/* Runs the laws and, if `conduct`, the conductance: fn to conductance. clock may be NULL. */
void CALX_ISA(calx_evaluate_stack)(const struct calx_plan *, size_t type, double dt, bool conduct,
                                   struct calx_columns *, struct calx_clock *clock);

/* The same, with onset and end of contacts inside the step if the integrator resolves them: columns are then the first of two. */
void CALX_ISA(calx_evaluate_laws)(const struct calx_plan *, size_t type, double dt, bool conduct,
                                  struct calx_columns *, struct calx_clock *clock);

/* fn, ft and normal to force and twist. */
void CALX_ISA(calx_evaluate_force)(const struct calx_plan *, struct calx_columns *);

/* The stored elastic energy of each lane into energy[]; needs what the laws saw. */
void CALX_ISA(calx_evaluate_energy)(const struct calx_plan *, size_t type, double dt, struct calx_columns *);

/* ---- wall_contacts.c ---- */

/* Wall contacts of one block: into its rows of accelerations a, tally and wall forces; or, if energy is not NULL, only the elastic energy is added
 * there; or, if sink is not NULL, each contact is only shown to it. */
void CALX_ISA(calx_wall_contacts)(struct calx_sim *, size_t block, double dt, bool conduct, double *a,
                                  struct calx_columns *, double *energy, const struct calx_sink *);

/* The shares of dissipated work that become heat of body i and body j, for a pair type. */
void CALX_ISA(calx_heat_shares)(const struct calx_sim *, size_t material_i, size_t material_j, double share[2]);

/* ---- pairs.c: see pairs.h ---- */

calx_pairs_finder CALX_ISA(calx_pairs_find);

/* ---- integrate.c: see struct calx_engine ---- */

double CALX_ISA(calx_block_before)(struct calx_sim *, size_t block, size_t stage);
double CALX_ISA(calx_block_kernels)(struct calx_sim *, size_t block, size_t stage, const void *params,
                                    calx_rows_kernel *translation, calx_rows_kernel *rotation);
double CALX_ISA(calx_block_measure)(struct calx_sim *, size_t block, const void *params, calx_rows_measure *translation,
                                    calx_rows_measure *rotation);
void CALX_ISA(calx_block_finish)(struct calx_sim *, size_t block, const struct calx_pass *, double *a);

#endif

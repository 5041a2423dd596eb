/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to the kernels: pairs of one block, from rows to the columns of one batch (gather.c) and back (scatter.c), and the pairs that do
 * not touch (apart.c).
 */
#ifndef CALX_GATHER_H
#define CALX_GATHER_H

#include "core/columns.h"
#include "core/timing.h"

/* The rows of one block, and where its results go. */
struct calx_block_view {
    struct calx_sim *s;
    const struct calx_row_block *block;
    struct calx_tally *tally;
    const double *x, *v;
    double *a;
    double dt, interval; /* step of motion; time over which heat of this evaluation flows */
    bool conduct;
    bool look;           /* nothing may change */
    const struct calx_sink *sink;
    struct calx_clock *clock;
    /* the batch under way: its pair type, its first pair, the places of its bodies, where column 0 of their history
     * starts and how far apart columns are */
    size_t type, first, history, room;
    const uint32_t *i, *j;
};

/* Fills the columns of c->n pairs from `first` on: what the laws see, levers, and the bits of touch. */
void CALX_ISA(calx_gather_batch)(const struct calx_block_view *, struct calx_columns *);

/* Adds forces, couples and heat to the rows of both bodies in the order of the list; sums for the tally. */
void CALX_ISA(calx_scatter_batch)(const struct calx_block_view *, struct calx_columns *);

/* Moves pairs of a group that have come into reach among those that are evaluated. */
void CALX_ISA(calx_apart_admit)(const struct calx_block_view *, struct calx_group *);

/* Sorts out which pairs may touch while bodies approach by less than `inner`, the others being `soon` out of question; pairs that
 * have parted by more leave the evaluated ones. Returns whether the group then has room for all that may come. */
bool CALX_ISA(calx_apart_sift)(const struct calx_block_view *, struct calx_group *, double inner);

#endif

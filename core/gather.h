/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to the kernels: rows of one block to columns of one batch, and history back.
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
    size_t stride;
    double dt, interval; /* step of motion; time over which heat of this evaluation flows */
    bool conduct;
    const struct calx_sink *sink;
    struct calx_clock *clock;
};

/* Picks touching pairs from first on until the batch is nearly full or `end` is reached; returns where to go on. */
size_t CALX_ISA(calx_gather_select)(const struct calx_block_view *, size_t first, size_t end, double gap,
                                    struct calx_columns *);

/* Fills the columns of the picked pairs: kinematics, geometry, history. */
void CALX_ISA(calx_gather_batch)(const struct calx_block_view *, struct calx_columns *);

/* Stores the history of what touches, forgets that of what has parted. */
void CALX_ISA(calx_gather_keep)(struct calx_sim *, struct calx_columns *);

#endif

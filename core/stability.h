/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: how long a step may be, from the contacts there are now.
 */
#ifndef CALX_STABILITY_H
#define CALX_STABILITY_H

#include "core/state.h"

/* Whom the figures belong to: ids; a wall w is -1 - w. */
enum calx_effort {
    CALX_QUICK, /* plain sums of stiffness over each body's contacts: up to 3.4 times too low, a few tens of ns per contact */
    CALX_BOUND, /* norms of the blocks of each body: up to 1.5 times too low, some us per body */
    CALX_SHARP  /* and the iterations that find the limit itself */
};

struct calx_stability {
    double limit;         /* s: steps up to this one are stable; infinite if nothing vibrates */
    double sharp;         /* s: the limit itself, by iteration, which comes from above, of bodies, and of plates alone; NaN if not asked for */
    double plain;         /* s: the same bound by plain sums of stiffness, for comparison */
    int64_t id;           /* the particle with the least limit; -1: a loaded plate has it, or none */
    int32_t contacts;     /* that it has */
    double shortest;      /* s: half a period of the fastest single contact */
    int64_t pair[2];      /* which */
};

/* The longest stable step of the integrator of motion in the network of the present contacts. Reads the state, refreshes
 * ghosts. CALX_ERROR_MEMORY. */
int calx_stability_look(struct calx_sim *, enum calx_effort, struct calx_stability *, struct calx_error *);

#endif

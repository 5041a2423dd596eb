/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the tangent stiffness and damping of each contact there is now.
 */
#ifndef CALX_TANGENT_H
#define CALX_TANGENT_H

#include "core/columns.h"

/* One contact of two bodies, or of a body and a wall. */
struct calx_tangent {
    int32_t row[2];      /* own rows; a wall w is -1 - w */
    double normal[3];    /* from body 1 to body 0 */
    double lever[2];     /* m; 0 for a wall */
    double stiffness[2]; /* N/m: normal, tangential */
    double damping[2];   /* N s/m */
    double inverse_mass; /* 1/kg, of the pair */
};

struct calx_tangents {
    size_t count, capacity;
    struct calx_tangent *list; /* in the order of the lists: the same for any number of threads */
};

/* Asks the laws of a plan for stiffness, damping and, if not NULL, energy of the first n lanes, of one pair type; adds to what stands in
 * the columns. The columns as calx_evaluate_batch() leaves them. */
void calx_tangent_respond(const struct calx_plan *, size_t type, struct calx_columns *,
                          const struct calx_response *);

/* All contacts that push back or damp. Refreshes ghosts, changes nothing else. Free the list. CALX_ERROR_MEMORY. */
int calx_tangents_collect(struct calx_sim *, struct calx_tangents *, struct calx_error *);

#endif

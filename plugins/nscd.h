/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The two files of the integrator nscd: its parameters, and the solver of a contact problem.
 */
#ifndef CALX_PLUGINS_NSCD_H
#define CALX_PLUGINS_NSCD_H

#include "core/plugin.h"

struct nscd { /* from the table */
    double theta, tolerance, accuracy, sweeps, unsolved, relaxation, order, warm, reach;
};

/* Fills the impulses and velocities of the problem. Returns 0, or 1 with text: no memory, or no solution within the limits. */
int nscd_solve(const struct nscd *, struct calx_problem *, char *why, size_t why_size);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to the kernels: contacts that begin or end inside the step, for integrators that resolve them (onset.c).
 */
#ifndef CALX_ONSET_H
#define CALX_ONSET_H

#include "core/columns.h"
#include "core/vector.h"

enum { CALX_ONSET_NODES = 4 };

/* Weights for eight contacts that began, or will end, s of a step from the evaluation, 0 < s <= 1. The force at the
 * nodes (calx_onset_node, in steps from that moment) times them, summed over nodes, is: `force` the force at the
 * evaluation, `tail` what makes the sum of equal steps from there on the integral, `later` the moment of the impulse
 * before it, of a step. */
struct calx_onset_weights { calx_v8 force[CALX_ONSET_NODES], tail[CALX_ONSET_NODES], later[CALX_ONSET_NODES]; };
void CALX_ISA(calx_onset_weigh)(calx_v8 s, struct calx_onset_weights *);
extern const double CALX_ISA(calx_onset_node)[CALX_ONSET_NODES];

/* The laws with all that begins or ends in the step of dt > 0 before this evaluation; as calx_evaluate_stack. c[1] is
 * scratch. */
void CALX_ISA(calx_onset_laws)(const struct calx_plan *, size_t type, double dt, bool conduct, struct calx_columns *c,
                               struct calx_clock *clock);

/* After the last normal law, l, has answered: damping at the velocity of the moment of the positions, and the impulse
 * owed, unless this is a node. The work so far stays in c->damping. */
void CALX_ISA(calx_onset_normal)(const struct calx_plan *, size_t l, size_t type, struct calx_columns *);

#endif

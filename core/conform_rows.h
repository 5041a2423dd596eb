/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Bodies for the conformance of integrators of motion: oscillators in rows as the engine keeps
 * them, and the host of a global integrator. Private to core/conform_*.c.
 */
#ifndef CALX_CONFORM_ROWS_H
#define CALX_CONFORM_ROWS_H

#include "core/conform_parts.h"

enum { CALX_OSCILLATORS = 7, CALX_OSCILLATOR_EXTRA = 8 };

/* x'' = -omega^2 x - damping x' along the first two axes, body i 0.3 i ahead in phase; spins: w' =
 * cos(t + phase). The third and fourth lane stay. */
struct calx_oscillators {
    struct calx_rows r;
    double x[4 * CALX_OSCILLATORS + 4], v[8 * CALX_OSCILLATORS + 8], a[8 * CALX_OSCILLATORS + 8];
    double extra[CALX_OSCILLATOR_EXTRA][4 * CALX_OSCILLATORS + 4];
    double *extra_of[CALX_OSCILLATOR_EXTRA];
    double omega, damping; /* 1/s */
    double phase;          /* of the first body */
    double shift;          /* m: bodies have been moved by a period of the domain */
    bool spins;
    double time; /* s, of the end of the last step */
    double memory[CALX_MEMORY];
    size_t evaluations;
    size_t disturb; /* the number of the evaluation that is to be wrong; 0: none */
    bool pieces;    /* a global integrator's kernels run over one body at a time */
    double kept;    /* s, time of the last evaluation that was kept */
    struct calx_moments moments; /* of the impulses that are asked for */
    struct calx_problem problem; /* without any contact */
    bool failed;
};

/* Bodies at the time 0; unit frequency. */
void calx_oscillators_begin(struct calx_oscillators *, size_t n, size_t stride, double dt,
                            bool spins);
/* Accelerations at time t. */
void calx_oscillators_accelerate(struct calx_oscillators *, double t);
/* Accelerations at the start, and the integrator's start stages. */
void calx_oscillators_start(struct calx_oscillators *, const struct calx_choice *);
void calx_oscillators_step(struct calx_oscillators *, const struct calx_choice *);
/* The start and so many steps. */
void calx_oscillators_run(struct calx_oscillators *, const struct calx_choice *, size_t steps);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One benchmark of the step loop, and how it is told.
 */
#ifndef CALX_IO_BENCH_H
#define CALX_IO_BENCH_H

#include <stdio.h>

#include "core/calx.h"

struct calx_bench {
    const char *name; /* of the case */
    int threads;
    size_t particles;
    int64_t warm, steps; /* made before the clock started, and on it */
    double seconds;      /* on the clock, without laps */
    int64_t rebuilds;    /* in those steps */
    uint64_t hash;       /* of the state after them */
    struct calx_features features;
    struct calx_timing
        timing;      /* of the steps after those, with laps; names belong to the simulation */
    double resident; /* bytes of the process; 0 if the system does not tell */
    double memory_rate,
        cache_rate; /* bytes/s of triads in memory and in the cache; 0 if not measured */
};

double calx_bench_speed(const struct calx_bench *); /* particle-steps per second */

/* Bytes that a particle-step moves at least in this layout: positions, velocities and accelerations
 * read and written, the two numbers of each pair read, history read and written. */
double calx_bench_traffic(const struct calx_bench *);

void calx_bench_print(const struct calx_bench *, FILE *);
void calx_bench_print_json(const struct calx_bench *, FILE *); /* one object on one line */

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Measures memory bandwidth. Input: length of the arrays, threads. Output: bytes per second.
 * Method: the triad of McCalpin's STREAM (IEEE TCCA Newsletter, December 1995), each thread on the
 * pages it touched first; the best of several sweeps, since whatever else runs can only slow one
 * down.
 */
#include "io/bandwidth.h"

#include <stdbool.h>
#include <stdlib.h>

#include "io/terminal.h"

static const double span = 0.2; /* s */
static const size_t bytes_at_a_time =
    1 << 27; /* between two looks at the clock, so that short arrays are timed well */

static void fill(size_t n, int threads, double *a, double *b, double *c)
{
#pragma omp parallel for simd schedule(static) num_threads(threads)
    for (size_t i = 0; i < n; i++)
        a[i] = 0, b[i] = 1, c[i] = (double)i;
}

static void sweep(size_t n, int threads, double s, double *restrict a, const double *restrict b,
                  const double *restrict c)
{
#pragma omp parallel for simd schedule(static) num_threads(threads)
    for (size_t i = 0; i < n; i++)
        a[i] = b[i] + s * c[i];
}

static double best_rate(size_t n, int threads, double *a, double *b, double *c)
{
    double best = 0, moved = (double)(3 * n * sizeof *a), begin = calx_terminal_clock(),
           now = begin;
    size_t sweeps = 1 + bytes_at_a_time / (3 * n * sizeof *a);
    for (double s = 1; now - begin < span || s < 3; s++) {
        double from = now;
        for (size_t k = 0; k < sweeps; k++)
            sweep(n, threads, s, a, b, c);
        now = calx_terminal_clock();
        double rate = now > from ? moved * (double)sweeps / (now - from) : 0;
        best = rate > best ? rate : best;
    }
    return best;
}

double calx_bandwidth_triad(size_t bytes, int threads)
{
    size_t n = bytes / sizeof(double) / 8 * 8;
    double *arrays[3];
    bool complete = n > 0;
    for (int k = 0; k < 3; k++) {
        arrays[k] = n ? aligned_alloc(64, n * sizeof **arrays) : NULL;
        complete = complete && arrays[k];
    }
    double rate = 0;
    if (complete) {
        fill(n, threads, arrays[0], arrays[1], arrays[2]);
        rate = best_rate(n, threads, arrays[0], arrays[1], arrays[2]);
    }
    for (int k = 0; k < 3; k++)
        free(arrays[k]);
    return rate;
}

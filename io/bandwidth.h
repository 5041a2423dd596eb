/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the memory of this machine delivers.
 */
#ifndef CALX_IO_BANDWIDTH_H
#define CALX_IO_BANDWIDTH_H

#include <stddef.h>

/* Bytes per second of a = b + s*c over three arrays of `bytes` each, on that many threads: the best
 * of repetitions over about a fifth of a second. Two reads and one write are counted per element,
 * not the line that a write may fetch. 0 without memory. */
double calx_bandwidth_triad(size_t bytes, int threads);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the order of particles along a space-filling curve.
 */
#ifndef CALX_SORT_H
#define CALX_SORT_H

#include <stddef.h>
#include <stdint.h>

/* order[k] = index of the particle that comes k-th along the Morton curve over cells of the given size (m); particles
 * of one cell keep their order. x: rows of four, n of them, read through `from` (row of particle k). Returns 0, or 1 without memory. */
int calx_sort_morton(const double *x, const int32_t *from, size_t n, double cell, int32_t *order);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The shape of a bed of grains, from one frame.
 */
#ifndef CALX_HEAP_H
#define CALX_HEAP_H

#include "core/calx.h"

/* Slope of the surface of a 2D heap left (side -1) or right (side 1) of its top, degrees, positive
 * where it falls to the foot. NaN in 3D, without memory, or if that side is narrower than two
 * columns of a mean diameter. */
double calx_heap_slope(const struct calx_frame *, int side);

/* From the lowest to the highest point of the grains along the unit vector up, m; 0 without grains.
 */
double calx_heap_height(const struct calx_frame *, const double up[3]);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The nearest point of a wall primitive to a centre, for those who ask seldom; see surface.h.
 */
#include "core/surface.h"

void calx_surface_nearest(const struct calx_primitive *p, uint32_t dimension, const double x[3],
                          struct calx_touch *t)
{
    calx_surface_touch(p, dimension, x, t);
}

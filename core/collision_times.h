/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: time scales of collisions by which steps are often chosen, for comparison with the limit.
 */
#ifndef CALX_COLLISION_TIMES_H
#define CALX_COLLISION_TIMES_H

#include "core/scene.h"

struct calx_collision_times {
    double rayleigh, hertz;             /* s, the shortest; infinite if no material says young and poisson */
    int rayleigh_material, hertz_material[2]; /* whose */
};

/* Over the smallest particle of each material; Hertz's contact of two of them, or of one with a wall, that meet at `speed` m/s. */
struct calx_collision_times calx_collision_times_find(const struct calx_scene *, double speed);

#endif

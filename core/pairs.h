/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: finds all pairs of particles closer than the sum of radii plus a skin.
 */
#ifndef CALX_PAIRS_H
#define CALX_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How near the bodies of a pair are: they touch or nearly, may touch soon, or later. */
enum calx_nearness { CALX_CLOSE, CALX_SOON, CALX_LATER, CALX_NEARNESSES };

/* A pair of particles in sorted order, i < j. The image of j that is near i is at x_j + shift * box, shift packed as
 * (sx+1) + 3 (sy+1) + 9 (sz+1); 13 is no shift. */
struct calx_found {
    int32_t i, j;
    uint8_t shift, nearness;
};

enum { CALX_NO_SHIFT = 13 };

/* How many periods along an axis a packed shift goes: -1, 0 or 1. */
static inline int calx_shift_turns(int shift, int axis)
{
    static const int weight[3] = {1, 3, 9};
    return shift / weight[axis] % 3 - 1;
}

/* The pairs that belong to one block of consecutive particles: those whose i is in it. */
struct calx_found_list {
    struct calx_found *list;
    size_t count, capacity;
};

struct calx_pairs_input {
    const double *x;      /* rows of four {x, y, z, R}, sorted; positions inside the box on periodic axes */
    size_t n, block;      /* particles, particles per block */
    double skin;          /* m, added to the sum of radii (gap included) */
    double near[2];       /* m, likewise, of pairs that are close, and of those that may touch soon */
    uint32_t dimension;
    bool periodic[3];
    double low[3], length[3]; /* of the box, on periodic axes */
    int threads;
};

/* The engine's find_pairs. lists: one per block, zeroed; the caller frees their arrays. In each list the order of pairs depends on the input alone.
 * Returns 0, or 1 without memory. */
typedef int calx_pairs_finder(const struct calx_pairs_input *, struct calx_found_list *lists);

#endif

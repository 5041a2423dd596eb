/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Sorts particles along the Morton (Z) curve by radix sort of interleaved cell coordinates, so that particles close in
 * space are close in memory. Stable, serial, O(n) per digit.
 * Method: G. M. Morton (1966); least-significant-digit radix sort.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/sort.h"

enum { DIGIT = 11, BUCKETS = 1 << DIGIT };

struct keyed {
    uint64_t key;
    int32_t index;
};

/* Spreads the low 21 bits of v to every third bit. */
static uint64_t spread(uint64_t v)
{
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
}

static void bounds(const double *x, const int32_t *from, size_t n, double lo[3], double hi[3])
{
    for (int k = 0; k < 3; k++) {
        lo[k] = DBL_MAX;
        hi[k] = -DBL_MAX;
    }
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            double v = x[4 * (size_t)from[i] + k];
            lo[k] = v < lo[k] ? v : lo[k];
            hi[k] = v > hi[k] ? v : hi[k];
        }
}

static uint64_t make_keys(const double *x, const int32_t *from, size_t n, double cell,
                          struct keyed *keys)
{
    double lo[3], hi[3], extent = 0.0;
    bounds(x, from, n, lo, hi);
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, hi[k] - lo[k]);
    double inverse = 1.0 / fmax(fmax(cell, extent / 0x1ffff0), DBL_MIN * 0x1000000);
    uint64_t used = 0;
    for (size_t i = 0; i < n; i++) {
        const double *p = x + 4 * (size_t)from[i];
        uint64_t key = 0;
        for (int k = 0; k < 3; k++)
            key |= spread((uint64_t)((p[k] - lo[k]) * inverse)) << k;
        keys[i] = (struct keyed){key, (int32_t)i};
        used |= key;
    }
    return used;
}

static void pass(const struct keyed *in, struct keyed *out, size_t n, int shift)
{
    size_t count[BUCKETS + 1];
    memset(count, 0, sizeof count);
    for (size_t i = 0; i < n; i++)
        count[((in[i].key >> shift) & (BUCKETS - 1)) + 1]++;
    for (size_t b = 0; b < BUCKETS; b++)
        count[b + 1] += count[b];
    for (size_t i = 0; i < n; i++)
        out[count[(in[i].key >> shift) & (BUCKETS - 1)]++] = in[i];
}

int calx_sort_morton(const double *x, const int32_t *from, size_t n, double cell, int32_t *order)
{
    struct keyed *a = malloc((n + 1) * sizeof *a), *b = malloc((n + 1) * sizeof *b);
    int failed = !a || !b;
    if (!failed) {
        uint64_t used = make_keys(x, from, n, cell, a);
        for (int shift = 0; shift < 64 && used >> shift; shift += DIGIT) {
            pass(a, b, n, shift);
            struct keyed *t = a;
            a = b;
            b = t;
        }
        for (size_t i = 0; i < n; i++)
            order[i] = a[i].index;
    }
    free(a);
    free(b);
    return failed;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The only place for compiler vector types: rows of four doubles.
 */
#ifndef CALX_VECTOR_H
#define CALX_VECTOR_H

#include <string.h>

typedef double calx_v4 __attribute__((vector_size(32)));

static inline calx_v4 calx_v4_load(const double *p)
{
    calx_v4 v;
    memcpy(&v, __builtin_assume_aligned(p, 32), sizeof v);
    return v;
}

static inline void calx_v4_store(double *p, calx_v4 v)
{
    memcpy(__builtin_assume_aligned(p, 32), &v, sizeof v);
}

/* p += v */
static inline void calx_v4_add(double *p, calx_v4 v)
{
    calx_v4_store(p, calx_v4_load(p) + v);
}

#endif

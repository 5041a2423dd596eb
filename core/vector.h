/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The only place for compiler vector types and intrinsics: rows of four doubles, columns of eight, turning one
 * into the other, and picking lanes. Compiler vectors everywhere, so that the same code serves any instruction set; intrinsics only
 * where they pick lanes, with a fallback that gives the same bits.
 */
#ifndef CALX_VECTOR_H
#define CALX_VECTOR_H

#include <stdint.h>
#include <string.h>
#if defined(__AVX512F__)
#include <immintrin.h>
#endif

typedef double calx_v4 __attribute__((vector_size(32)));
typedef double calx_v8 __attribute__((vector_size(64)));

static inline calx_v4 calx_v4_load(const double *p)
{
    calx_v4 v;
    memcpy(&v, __builtin_assume_aligned(p, 32), sizeof v);
    return v;
}

static inline calx_v4 calx_v4_load_unaligned(const double *p)
{
    calx_v4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void calx_v4_store_unaligned(double *p, calx_v4 v)
{
    memcpy(p, &v, sizeof v);
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

static inline calx_v8 calx_v8_load(const double *p)
{
    calx_v8 v;
    memcpy(&v, __builtin_assume_aligned(p, 64), sizeof v);
    return v;
}

static inline void calx_v8_store(double *p, calx_v8 v)
{
    memcpy(__builtin_assume_aligned(p, 64), &v, sizeof v);
}

static inline calx_v8 calx_v8_join(calx_v4 first, calx_v4 second)
{
    return __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
}

/* Eight rows of four become four columns of eight. */
static inline void calx_rows_to_columns(const calx_v4 r[8], calx_v8 column[4])
{
    calx_v8 a = __builtin_shufflevector(r[0], r[4], 0, 1, 2, 3, 4, 5, 6, 7);
    calx_v8 b = __builtin_shufflevector(r[1], r[5], 0, 1, 2, 3, 4, 5, 6, 7);
    calx_v8 c = __builtin_shufflevector(r[2], r[6], 0, 1, 2, 3, 4, 5, 6, 7);
    calx_v8 d = __builtin_shufflevector(r[3], r[7], 0, 1, 2, 3, 4, 5, 6, 7);
    calx_v8 ab0 = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    calx_v8 ab1 = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    calx_v8 cd0 = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    calx_v8 cd1 = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    column[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 8, 9, 4, 5, 12, 13);
    column[1] = __builtin_shufflevector(ab1, cd1, 0, 1, 8, 9, 4, 5, 12, 13);
    column[2] = __builtin_shufflevector(ab0, cd0, 2, 3, 10, 11, 6, 7, 14, 15);
    column[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* The inverse: four columns of eight become eight rows of four. */
static inline void calx_columns_to_rows(const calx_v8 column[4], calx_v4 r[8])
{
    calx_v8 xy0 = __builtin_shufflevector(column[0], column[1], 0, 8, 2, 10, 4, 12, 6, 14);
    calx_v8 xy1 = __builtin_shufflevector(column[0], column[1], 1, 9, 3, 11, 5, 13, 7, 15);
    calx_v8 zw0 = __builtin_shufflevector(column[2], column[3], 0, 8, 2, 10, 4, 12, 6, 14);
    calx_v8 zw1 = __builtin_shufflevector(column[2], column[3], 1, 9, 3, 11, 5, 13, 7, 15);
    calx_v8 p = __builtin_shufflevector(xy0, zw0, 0, 1, 8, 9, 4, 5, 12, 13);
    calx_v8 q = __builtin_shufflevector(xy1, zw1, 0, 1, 8, 9, 4, 5, 12, 13);
    calx_v8 s = __builtin_shufflevector(xy0, zw0, 2, 3, 10, 11, 6, 7, 14, 15);
    calx_v8 t = __builtin_shufflevector(xy1, zw1, 2, 3, 10, 11, 6, 7, 14, 15);
    r[0] = __builtin_shufflevector(p, p, 0, 1, 2, 3);
    r[4] = __builtin_shufflevector(p, p, 4, 5, 6, 7);
    r[1] = __builtin_shufflevector(q, q, 0, 1, 2, 3);
    r[5] = __builtin_shufflevector(q, q, 4, 5, 6, 7);
    r[2] = __builtin_shufflevector(s, s, 0, 1, 2, 3);
    r[6] = __builtin_shufflevector(s, s, 4, 5, 6, 7);
    r[3] = __builtin_shufflevector(t, t, 0, 1, 2, 3);
    r[7] = __builtin_shufflevector(t, t, 4, 5, 6, 7);
}

/* Bit l is set where a[l] < b[l]. */
static inline unsigned calx_v8_less(calx_v8 a, calx_v8 b)
{
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#else
    unsigned bits = 0;
    for (unsigned l = 0; l < 8; l++)
        bits |= (unsigned)(a[l] < b[l]) << l;
    return bits;
#endif
}

/* Writes the lanes whose bit is set one after the other, unaligned; may write up to eight values. */
static inline void calx_v8_pick(double *to, calx_v8 v, unsigned bits)
{
#if defined(__AVX512F__)
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd((__mmask8)bits, (__m512d)v));
#else
    for (unsigned l = 0, n = 0; l < 8; l++) {
        to[n] = v[l];
        n += bits >> l & 1;
    }
#endif
}

/* Bit l is set where byte l is not zero. */
static inline unsigned calx_bytes_to_bits(const uint8_t *p)
{
    uint64_t v;
    memcpy(&v, p, sizeof v);
    return (unsigned)((v & 0x0101010101010101ull) * 0x0102040810204080ull >> 56);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The only place for compiler vector types and intrinsics: rows of four doubles, columns of eight, turning one
 * into the other, and picking lanes. Compiler vectors everywhere, so that the same code serves any instruction set; intrinsics only
 * where they pick lanes, with a fallback that gives the same bits.
 */
#ifndef CALX_VECTOR_H
#define CALX_VECTOR_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

typedef double calx_v4 __attribute__((vector_size(32)));
typedef double calx_v8 __attribute__((vector_size(64)));
typedef int64_t calx_bits8 __attribute__((vector_size(64)));

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

static inline calx_v8 calx_v8_load(const double *p)
{
    calx_v8 v;
    memcpy(&v, __builtin_assume_aligned(p, 64), sizeof v);
    return v;
}

static inline calx_v8 calx_v8_load_unaligned(const double *p)
{
    calx_v8 v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void calx_v8_store(double *p, calx_v8 v)
{
    memcpy(__builtin_assume_aligned(p, 64), &v, sizeof v);
}

static inline calx_v8 calx_v8_join(calx_v4 first, calx_v4 second)
{
    calx_v8 v;
    memcpy(&v, &first, sizeof first);
    memcpy((double *)&v + 4, &second, sizeof second);
    return v;
}

#if !defined(__AVX512F__)
/* Without registers of eight doubles the compiler picks and compares lanes of eight one by one: here that is done in pieces that fit. */
#if defined(__AVX__)
enum { CALX_PIECE = 4 };
#else
enum { CALX_PIECE = 2 };
#endif
typedef double calx_piece __attribute__((vector_size(8 * CALX_PIECE)));
typedef int64_t calx_piece_bits __attribute__((vector_size(8 * CALX_PIECE)));

static inline calx_piece calx_v8_piece(const calx_v8 *v, int which)
{
    calx_piece piece;
    memcpy(&piece, (const double *)v + CALX_PIECE * which, sizeof piece);
    return piece;
}

static inline void calx_v8_set_piece(calx_v8 *v, int which, calx_piece piece)
{
    memcpy((double *)v + CALX_PIECE * which, &piece, sizeof piece);
}
#endif

#if defined(__AVX512F__)
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

/* Rows become columns, columns rows. */
static inline void calx_transpose8(calx_v8 r[8])
{
    calx_v8 pair[8], a[8];
    for (int k = 0; k < 8; k += 2) {
        pair[k] = __builtin_shufflevector(r[k], r[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        pair[k + 1] = __builtin_shufflevector(r[k], r[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int q = 0; q < 2; q++) /* even and odd columns */
        for (int half = 0; half < 2; half++) {
            calx_v8 first = pair[4 * half + q], second = pair[4 * half + q + 2];
            a[4 * q + 2 * half] = __builtin_shufflevector(first, second, 0, 1, 4, 5, 8, 9, 12, 13);
            a[4 * q + 2 * half + 1] = __builtin_shufflevector(first, second, 2, 3, 6, 7, 10, 11, 14, 15);
        }
    for (int q = 0; q < 2; q++)
        for (int odd = 0; odd < 2; odd++) {
            calx_v8 first = a[4 * q + odd], second = a[4 * q + 2 + odd];
            r[q + 2 * odd] = __builtin_shufflevector(first, second, 0, 1, 4, 5, 8, 9, 12, 13);
            r[q + 2 * odd + 4] = __builtin_shufflevector(first, second, 2, 3, 6, 7, 10, 11, 14, 15);
        }
}
#else

static inline calx_v4 calx_v8_half(const calx_v8 *v, int which)
{
    calx_v4 half;
    memcpy(&half, (const double *)v + 4 * which, sizeof half);
    return half;
}

static inline void calx_v8_set_half(calx_v8 *v, int which, calx_v4 half)
{
    memcpy((double *)v + 4 * which, &half, sizeof half);
}

/* Rows become columns, columns rows. */
static inline void calx_transpose4(calx_v4 r[4])
{
    calx_v4 ab0 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), ab1 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
    calx_v4 cd0 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), cd1 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
    r[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    r[1] = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    r[2] = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    r[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

/* Eight rows of four become four columns of eight. */
static inline void calx_rows_to_columns(const calx_v4 r[8], calx_v8 column[4])
{
    for (int half = 0; half < 2; half++) {
        calx_v4 part[4] = {r[4 * half], r[4 * half + 1], r[4 * half + 2], r[4 * half + 3]};
        calx_transpose4(part);
        for (int k = 0; k < 4; k++)
            calx_v8_set_half(&column[k], half, part[k]);
    }
}

/* The inverse: four columns of eight become eight rows of four. */
static inline void calx_columns_to_rows(const calx_v8 column[4], calx_v4 r[8])
{
    for (int half = 0; half < 2; half++) {
        for (int k = 0; k < 4; k++)
            r[4 * half + k] = calx_v8_half(&column[k], half);
        calx_transpose4(r + 4 * half);
    }
}

/* Rows become columns, columns rows. */
static inline void calx_transpose8(calx_v8 r[8])
{
    calx_v4 column[4][4]; /* four quarters */
    for (int quarter = 0; quarter < 4; quarter++) {
        for (int k = 0; k < 4; k++)
            column[quarter][k] = calx_v8_half(&r[4 * (quarter / 2) + k], quarter % 2);
        calx_transpose4(column[quarter]);
    }
    for (int quarter = 0; quarter < 4; quarter++)
        for (int k = 0; k < 4; k++)
            calx_v8_set_half(&r[4 * (quarter % 2) + k], quarter / 2, column[quarter][k]);
}
#endif

/* Changes the sign of the lanes in which `minus` is -0.0 (0.0 elsewhere). */
static inline calx_v8 calx_v8_flip(calx_v8 a, calx_v8 minus)
{
    return (calx_v8)((calx_bits8)a ^ (calx_bits8)minus);
}

static inline calx_v8 calx_v8_sqrt(calx_v8 a)
{
#if defined(__AVX512F__)
    return (calx_v8)_mm512_sqrt_pd((__m512d)a);
#else
    for (int k = 0; k < 8 / CALX_PIECE; k++) {
        calx_piece piece = calx_v8_piece(&a, k);
#if defined(__AVX__)
        piece = (calx_piece)_mm256_sqrt_pd((__m256d)piece);
#elif defined(__SSE2__)
        piece = (calx_piece)_mm_sqrt_pd((__m128d)piece);
#else
        for (int l = 0; l < CALX_PIECE; l++)
            piece[l] = sqrt(piece[l]);
#endif
        calx_v8_set_piece(&a, k, piece);
    }
    return a;
#endif
}

/* a > 0 ? yes : no, lane by lane. */
static inline calx_v8 calx_v8_positive(calx_v8 a, calx_v8 yes, calx_v8 no)
{
#if defined(__AVX512F__)
    __mmask8 where = _mm512_cmp_pd_mask((__m512d)a, _mm512_setzero_pd(), _CMP_GT_OQ);
    return (calx_v8)_mm512_mask_blend_pd(where, (__m512d)no, (__m512d)yes);
#else
    for (int k = 0; k < 8 / CALX_PIECE; k++) {
        calx_piece_bits where = calx_v8_piece(&a, k) > 0.0;
        calx_piece_bits piece = (where & (calx_piece_bits)calx_v8_piece(&yes, k)) | (~where & (calx_piece_bits)calx_v8_piece(&no, k));
        calx_v8_set_piece(&no, k, (calx_piece)piece);
    }
    return no;
#endif
}

static inline calx_v8 calx_v8_max(calx_v8 a, calx_v8 b)
{
    return calx_v8_positive(a - b, a, b);
}

/* The first n lanes, zero in the others. */
static inline calx_v8 calx_v8_first(calx_v8 a, size_t n)
{
    static const calx_v8 place = {0, 1, 2, 3, 4, 5, 6, 7};
    return calx_v8_positive((double)n - place, a, (calx_v8){0});
}

/* Bit l is set where a[l] < b[l]. */
static inline unsigned calx_v8_less(calx_v8 a, calx_v8 b)
{
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#else
    unsigned bits = 0;
    for (int k = 0; k < 8 / CALX_PIECE; k++) {
        calx_piece_bits less = calx_v8_piece(&a, k) < calx_v8_piece(&b, k);
#if defined(__AVX__)
        bits |= (unsigned)_mm256_movemask_pd((__m256d)less) << CALX_PIECE * k;
#elif defined(__SSE2__)
        bits |= (unsigned)_mm_movemask_pd((__m128d)less) << CALX_PIECE * k;
#else
        for (int l = 0; l < CALX_PIECE; l++)
            bits |= (unsigned)(less[l] & 1) << (CALX_PIECE * k + l);
#endif
    }
    return bits;
#endif
}

/* Across the lanes, in the same order on every machine. */
static inline double calx_v8_sum(calx_v8 a)
{
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

#endif

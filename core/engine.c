/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Picks the copy of the contact kernels that was compiled for the best instruction set this processor has. All
 * copies give the same bits: no contraction, no reassociation, exact division and square root.
 */
#include "core/state.h"

extern const struct calx_engine calx_engine_base;

#ifdef CALX_MULTI_ISA
extern const struct calx_engine calx_engine_avx2, calx_engine_avx512;

const struct calx_engine *calx_engine_pick(const char **name)
{
    const char *ignored, **out = name ? name : &ignored;
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
        return *out = "AVX-512", &calx_engine_avx512;
    if (__builtin_cpu_supports("avx2"))
        return *out = "AVX2", &calx_engine_avx2;
    return *out = "baseline", &calx_engine_base;
}
#else
const struct calx_engine *calx_engine_pick(const char **name)
{
    if (name)
        *name = "baseline";
    return &calx_engine_base;
}
#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Memory for columns and rows: zeroed, aligned to a cache line, a whole number of cache lines long.
 */
#include <stdlib.h>
#include <string.h>

#include "core/state.h"

void *calx_memory_zeroed(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - 128) / size)
        return NULL;
    size_t bytes = (count * size + 127) / 64 * 64; /* one spare line: kernels may read past the last row */
    void *p = aligned_alloc(64, bytes);
    if (p)
        memset(p, 0, bytes);
    return p;
}

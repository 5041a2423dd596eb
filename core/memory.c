/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Memory for columns and rows: aligned to a cache line, a whole number of cache lines long, zeroed or to be filled. Large arrays ask for huge
 * pages: rows are read in the order of contacts, and with small pages each read is a miss of the page tables as well.
 */
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "core/state.h"

static const size_t HUGE_PAGE = 2u << 20;

static const size_t SPARE = 128; /* bytes, at least a line of which follow the last row: kernels may read past it */

void *calx_memory_to_fill(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - HUGE_PAGE) / size)
        return NULL;
    size_t bytes = (count * size + SPARE - 1) / 64 * 64, all = bytes;
    bool large = bytes >= HUGE_PAGE / 2;
    if (large)
        all = (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    char *p = aligned_alloc(large ? HUGE_PAGE : 64, all);
#ifdef MADV_HUGEPAGE
    if (p && large)
        madvise(p, all, MADV_HUGEPAGE); /* a wish: nothing depends on it */
#endif
    if (p)
        memset(p + count * size, 0, bytes - count * size);
    return p;
}

void *calx_memory_zeroed(size_t count, size_t size)
{
    void *p = calx_memory_to_fill(count, size);
    return p ? memset(p, 0, count * size) : NULL;
}

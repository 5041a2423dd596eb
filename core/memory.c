/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Memory for columns and rows: zeroed, aligned to a cache line, a whole number of cache lines long. Large arrays ask for huge
 * pages: rows are read in the order of contacts, and with small pages each read is a miss of the page tables as well.
 */
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "core/state.h"

static const size_t HUGE_PAGE = 2u << 20;

void *calx_memory_zeroed(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - 128) / size)
        return NULL;
    size_t bytes = (count * size + 127) / 64 * 64; /* one spare line: kernels may read past the last row */
    bool large = bytes >= HUGE_PAGE / 2;
    if (large)
        bytes = (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    void *p = aligned_alloc(large ? HUGE_PAGE : 64, bytes);
#ifdef MADV_HUGEPAGE
    if (p && large)
        madvise(p, bytes, MADV_HUGEPAGE); /* a wish: nothing depends on it */
#endif
    if (p)
        memset(p, 0, bytes);
    return p;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The restart file: named blocks of bytes with format version, hash of the case, byte order and
 * checksums.
 */
#ifndef CALX_IO_RESTART_H
#define CALX_IO_RESTART_H

#include "core/calx.h"

/* What was read; the blocks point into `memory`, aligned to 16 bytes. */
struct calx_restart {
    struct calx_block *blocks;
    size_t count;
    void *memory;
};

/* Writes the blocks to `path`, whole or not at all; the file before is kept as path.bak until the
 * new one is in place. `case_hash` tells one case from another. CALX_ERROR_IO with the reason,
 * CALX_ERROR_MEMORY. */
int calx_restart_write(const char *path, uint64_t case_hash, const struct calx_block *blocks,
                       size_t count, struct calx_error *);

/* Reads and checks a restart file; if it is missing, path.bak in its place. On success the caller
 * clears `restart`. CALX_ERROR_INPUT with file and text: no restart file, not one, cut short, other
 * byte order, other version, other case, checksum (which block); CALX_ERROR_IO, CALX_ERROR_MEMORY.
 */
int calx_restart_read(const char *path, uint64_t case_hash, struct calx_restart *restart,
                      struct calx_error *);

/* Frees what calx_restart_read() allocated. */
void calx_restart_clear(struct calx_restart *);

/* The block of that name, or NULL. */
const struct calx_block *calx_restart_find(const struct calx_restart *, const char *name);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A table of numbers as CSV: a header line `name [unit],...`, then one row per record with 17
 * digits (the same bits when read back). The first column is the time. Each row is flushed when it
 * is written.
 */
#ifndef CALX_IO_TABLE_H
#define CALX_IO_TABLE_H

#include <stddef.h>

#include "core/error.h"

struct calx_table;

/* Unit as UDUNITS-2 text; "", "1" and NULL are pure numbers, whose header is the name alone. */
struct calx_table_column {
    const char *name, *unit;
};

/* Begins the file anew with its header. NULL with an error (CALX_ERROR_IO with the reason,
 * CALX_ERROR_MEMORY). */
struct calx_table *calx_table_create(const char *path, const struct calx_table_column *,
                                     size_t columns, struct calx_error *);

/* Goes on with the file: rows with time > `time` (s) and a last row cut short are removed; a
 * missing file is begun. NULL with an error: CALX_ERROR_IO, also if its header has other columns.
 */
struct calx_table *calx_table_resume(const char *path, const struct calx_table_column *,
                                     size_t columns, double time, struct calx_error *);

/* Writes one row of as many numbers as columns. A row with the time of the last one takes its
 * place. CALX_ERROR_IO with the reason (disk full). */
int calx_table_write(struct calx_table *, const double *row, struct calx_error *);

/* The same for a table with several rows of one time: adds one in any case. */
int calx_table_append(struct calx_table *, const double *row, struct calx_error *);

void calx_table_free(struct calx_table *);

#endif

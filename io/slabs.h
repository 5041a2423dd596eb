/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The files of the slabs of a run: NAME_slab_WALL.pvd, their cells with temperatures, a file per frame.
 */
#ifndef CALX_IO_SLABS_H
#define CALX_IO_SLABS_H

#include "core/calx.h"

struct calx_slab_files;

/* Begins the series of all slabs of the scene; time: as calx_series_resume(), minus infinity: anew. NULL with an error (CALX_ERROR_IO,
 * CALX_ERROR_MEMORY). */
struct calx_slab_files *calx_slab_files_open(const char *folder, const char *name, struct calx_sim *, double time,
                                             struct calx_error *);

/* Adds the present temperatures. */
int calx_slab_files_write(struct calx_slab_files *, struct calx_error *);

void calx_slab_files_free(struct calx_slab_files *);

#endif

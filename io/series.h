/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A time series in a folder: NAME.pvd, NAME_walls.pvd and NAME_contacts.pvd list the .vtu files of
 * the frames with their times. Every file is whole at any instant, so that a killed run leaves a
 * series that opens. Not thread-safe per series.
 */
#ifndef CALX_IO_SERIES_H
#define CALX_IO_SERIES_H

#include "core/calx.h"

struct calx_series;

/* Begins a series in `folder` (made if missing); files of an earlier series of that name are
 * removed. `output` is copied. NULL with an error (CALX_ERROR_IO, CALX_ERROR_MEMORY). */
struct calx_series *calx_series_create(const char *folder, const char *name,
                                       const struct calx_output *output, struct calx_error *);

/* Goes on with the series in `folder`: keeps the frames with time <= `time` (s), removes later
 * ones, and numbers on from there; a missing .pvd is an empty series. NULL with an error
 * (CALX_ERROR_IO: also if a .pvd is not what was written). */
struct calx_series *calx_series_resume(const char *folder, const char *name,
                                       const struct calx_output *output, double time,
                                       struct calx_error *);

/* A series of meshes, NAME and suffix: NAME_profile_shear.pvd for "_profile_shear". `time` as above;
 * minus infinity: begun anew. Fails as the others. */
struct calx_series *calx_series_of_meshes(const char *folder, const char *name, const char *suffix,
                                          const struct calx_output *output, double time,
                                          struct calx_error *);

/* Adds a mesh to such a series; one with the time of the last takes its place. */
int calx_series_write_mesh(struct calx_series *, const struct calx_mesh *, struct calx_error *);

/* Adds a frame: particles, the walls if it has any (a new file only if anything of them changed),
 * contacts if output.network. A frame with the time of the last one takes its place; an earlier
 * time is CALX_ERROR_IO. Else fails as calx_vtk_write(); what the .pvd files list is then still
 * whole. */
int calx_series_write(struct calx_series *, const struct calx_frame *, struct calx_error *);

/* Frames in the series (kept ones included). */
size_t calx_series_count(const struct calx_series *);

/* Time of the last frame, s; minus infinity if there is none. */
double calx_series_last(const struct calx_series *);

/* Path of NAME.pvd, owned by the series. */
const char *calx_series_path(const struct calx_series *);

void calx_series_free(struct calx_series *);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The files of the profiles of a run: NAME_profile_P.csv, a row per layer and window, and NAME_profile_P.pvd, the layers as cells.
 */
#ifndef CALX_IO_PROFILES_H
#define CALX_IO_PROFILES_H

#include "core/calx.h"

struct calx_profiles;

/* Begins the files of all profiles of the scene, or, if `resumed`, goes on after the windows that the simulation has seen. NULL with
 * an error (CALX_ERROR_IO, CALX_ERROR_MEMORY). */
struct calx_profiles *calx_profiles_open(const char *folder, const char *name, struct calx_sim *, bool resumed,
                                         struct calx_error *);

/* Writes the windows that have become complete since the last call: to be called after each step that is looked at. */
int calx_profiles_write(struct calx_profiles *, struct calx_error *);

void calx_profiles_free(struct calx_profiles *);

#endif

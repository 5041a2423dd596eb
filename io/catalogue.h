/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What `calx plugins` prints: the plugins there are, the reference of one, and the conformance of a
 * file.
 */
#ifndef CALX_IO_CATALOGUE_H
#define CALX_IO_CATALOGUE_H

#include <stdio.h>

#include "core/error.h"
#include "core/loader.h"

/* Prints every plugin found, by kind, with its summary; files that cannot be loaded go to stderr
 * with the reason. CALX_ERROR_INPUT if there is none at all. */
int calx_catalogue_list(FILE *, struct calx_registry *, struct calx_error *);

/* Prints the reference of every plugin of that name (a contact law and a conductance may share
 * one): equation, paper, parameters with units, ranges and defaults, needs. CALX_ERROR_INPUT with
 * the nearest name if there is none. */
int calx_catalogue_show(FILE *, struct calx_registry *, const char *name, struct calx_error *);

/* Runs the conformance suite on the file and prints it. 0 if all checks passed, CALX_ERROR_PHYSICS
 * if one failed, CALX_ERROR_INPUT if the file cannot be loaded. */
int calx_catalogue_check(FILE *, struct calx_registry *, const char *path, struct calx_error *);

#endif

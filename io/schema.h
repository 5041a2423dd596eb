/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the tables of the case file and of the plugins say, for editors and for people.
 */
#ifndef CALX_SCHEMA_H
#define CALX_SCHEMA_H

#include <stdio.h>

#include "core/loader.h"

/* Writes the RELAX NG grammar (XML syntax) of the case file with the parameters of every plugin
 * that can be found, which are loaded. Returns 0 or CALX_ERROR_IO. */
int calx_schema_write(FILE *, struct calx_registry *);

/* Writes the reference of the case file, cases/FORMAT.md (Markdown). Returns 0 or CALX_ERROR_IO. */
int calx_schema_write_reference(FILE *);

#endif

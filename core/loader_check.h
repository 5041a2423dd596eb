/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What makes the descriptor of a plugin valid.
 */
#ifndef CALX_LOADER_CHECK_H
#define CALX_LOADER_CHECK_H

#include "core/error.h"
#include "core/plugin.h"

/* Whether the descriptor at the symbol of the file `path` (NULL if there is none) may be used: 0,
 * or CALX_ERROR_INPUT with a text: not a calx plugin, another ABI, or which rule which row or
 * member breaks. */
int calx_loader_check(const char *path, const struct calx_plugin *, struct calx_error *);

#endif

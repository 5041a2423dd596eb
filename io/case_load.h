/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Loads an XML file that may be hostile. Used by the case reader only.
 */
#ifndef CALX_CASE_LOAD_H
#define CALX_CASE_LOAD_H

#include <libxml/tree.h>

#include "io/problems.h"

/* The document, which the caller frees with xmlFreeDoc(), or NULL and a problem: the file cannot be
 * read, is larger than 64 MB, is not text, is not well-formed, declares a document type, or nests
 * deeper than 256 elements. `file` must outlive the problems' making. */
xmlDoc *calx_case_load(const char *file, struct calx_problems *);

#endif

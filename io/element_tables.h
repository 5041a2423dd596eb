/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Short words for the tables of elements (io/element_tables.c, io/element_bodies.c); nobody else
 * includes it.
 */
#ifndef CALX_ELEMENT_TABLES_H
#define CALX_ELEMENT_TABLES_H

#include <math.h>

#include "io/elements.h"

#define REQUIRED CALX_ATTRIBUTE_REQUIRED
#define ANY -INFINITY, INFINITY, 0
#define POSITIVE 0, INFINITY, CALX_ATTRIBUTE_OPEN_MIN
/* Places and radii beyond these are mistakes in a number; cells and products of them stay in range.
 */
#define FARTHEST 1e9
#define A_PLACE -FARTHEST, FARTHEST, 0
#define A_NEEDED_PLACE -FARTHEST, FARTHEST, REQUIRED
#define A_RADIUS 1e-12, 1e6, 0
#define NOT_NEGATIVE 0, INFINITY, 0
#define NO_RANGE 0, 0, 0
#define NEEDED 0, 0, REQUIRED

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define ATTRIBUTES(table) .attribute_count = COUNT(table), .attributes = table
#define CHILDREN(table) .child_count = COUNT(table), .children = table

#define TEXT CALX_FORM_TEXT
#define NAME CALX_FORM_NAME
#define FILE_PATH CALX_FORM_FILE
#define WORD CALX_FORM_WORD
#define WORDS CALX_FORM_WORDS
#define SWITCH CALX_FORM_SWITCH
#define WHOLE CALX_FORM_WHOLE
#define QUANTITY CALX_FORM_QUANTITY
#define VECTOR CALX_FORM_VECTOR
#define VARIES CALX_FORM_VARIES
#define VARYING_VECTOR CALX_FORM_VARYING_VECTOR
#define RESULT CALX_FORM_RESULT

extern const struct calx_element calx_element_particles, calx_element_walls;

#endif

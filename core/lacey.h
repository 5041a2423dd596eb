/* SPDX-License-Identifier: BSD-3-Clause
 *
 * How well two classes of grains are mixed: the index of Lacey, from one frame.
 */
#ifndef CALX_LACEY_H
#define CALX_LACEY_H

#include "core/calx.h"

/* The index of the grains of a frame; classes: 0 or 1 for each grain. cell: edge of the cells, m;
 * 0: of about 8 grains. NaN if there is one class only, or without memory. */
double calx_lacey_index(const struct calx_frame *, const uint8_t *classes, double cell);

/* Class 1 for the grains above the median of what `name` says (material: those of the highest
 * index); up: against gravity. An unknown name leaves one class. */
void calx_lacey_classes(const struct calx_frame *, const char *name, const double up[3],
                        uint8_t *classes);

#endif

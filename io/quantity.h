/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers with units as people write them ("2 mm", "20 rpm", "107 degC"), through UDUNITS-2. A bare
 * number is SI. Angles are kept apart from pure numbers: a frequency is not read as an angular
 * rate.
 */
#ifndef CALX_QUANTITY_H
#define CALX_QUANTITY_H

#include <stdbool.h>
#include <stddef.h>

#include "core/error.h"

/* Reads one quantity. `unit` is the unit of the result, UDUNITS-2 text ("m", "rad/s", "1" for a
 * number). Fails with CALX_ERROR_INPUT if there is no number, it is not finite, the unit is unknown
 * or of another dimension (the text names both). */
int calx_quantity_parse(const char *text, const char *unit, double *value, struct calx_error *);

/* The same for a difference: "5 degC" is 5 K, not 278.15 K. */
int calx_quantity_parse_difference(const char *text, const char *unit, double *value,
                                   struct calx_error *);

/* Reads quantities separated by blanks, with one unit at the end ("0 -9.81 m/s2") or several ("2 mm
 * 0.4 cm"; a unit holds for the numbers before it that have none). At most max are stored; *count
 * is how many there are, or it fails as above. */
int calx_quantity_parse_list(const char *text, const char *unit, double *values, size_t max,
                             size_t *count, struct calx_error *);

/* value in `unit` = scale*(number in `from`) + offset. Fails like calx_quantity_parse. */
int calx_quantity_conversion(const char *from, const char *unit, double *scale, double *offset,
                             struct calx_error *);

/* Whether UDUNITS-2 knows the unit: 0, or CALX_ERROR_INPUT with a text. */
int calx_quantity_check_unit(const char *unit, struct calx_error *);

#endif

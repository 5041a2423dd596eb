/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers that may vary: a quantity ("2 mm") or a muParser expression of t, x, y, z ("300 +
 * 50*sin(2*_pi*t)"), with an optional unit in brackets at its end ("25 + t [degC]"); without it the
 * result is SI. Constants: _pi, _e and those of a list "H = 0.3; C = 2*H".
 */
#ifndef CALX_EXPRESSION_H
#define CALX_EXPRESSION_H

#include "core/error.h"
#include "core/scene.h"

/* How an expression is read. */
struct calx_expression_options {
    const char *unit;      /* of the result, UDUNITS-2 text */
    const char *variables; /* which of "txyz" may be used; "" or NULL: none */
    const char *where;     /* extra constants, or NULL */
    bool difference;       /* a difference of temperatures: no offset */
};

/* Fills f; what it needs is attached to the scene and freed with it. A constant text gives a plain
 * value. Fails with CALX_ERROR_INPUT (position and reason) for what does not compile, uses another
 * variable or has a wrong unit. */
int calx_expression_read(const char *text, const struct calx_expression_options *,
                         struct calx_scene *, struct calx_function *f, struct calx_error *);

/* Reads up to three functions: a list of quantities, or expressions separated by blanks outside of
 * parentheses or by semicolons, with an optional [unit] at the end for all. *count is how many
 * there are. */
int calx_expression_read_list(const char *text, const struct calx_expression_options *,
                              struct calx_scene *, struct calx_function f[3], size_t *count,
                              struct calx_error *);

#endif

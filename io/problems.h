/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The mistakes and warnings of an input file, gathered so that all of them are shown in one go.
 */
#ifndef CALX_PROBLEMS_H
#define CALX_PROBLEMS_H

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include "core/error.h"

/* Past this many mistakes a file is not read by a person any more; further ones are counted only.
 */
#define CALX_PROBLEMS_KEPT 100

/* Growing lists; text is "element: what, what was expected, nearest name". All zeros is empty. */
struct calx_problems {
    size_t count; /* mistakes, also those not kept */
    size_t kept;
    struct calx_error *list; /* the first `kept` */
    size_t warning_count;
    struct calx_error *warnings;
    size_t refusal_count; /* what the file itself says must be refused, each a part of the text;
                             known even if it is */
    char **refusals;
};

/* Adds a mistake (or a warning) unless the same one is there already. place.file may be NULL,
 * place.line 0. Never fails: what finds no memory is counted. */
void calx_problems_add(struct calx_problems *, struct calx_place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void calx_problems_warn(struct calx_problems *, struct calx_place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds an error that already has a text and perhaps a place. */
void calx_problems_add_error(struct calx_problems *, const struct calx_error *);

/* Notes that the file expects to be refused with a text that has `part` in it. */
void calx_problems_expect(struct calx_problems *, const char *part);

/* Orders mistakes by line; those without a place first. */
void calx_problems_sort(struct calx_problems *);

/* Prints "file:line: element: text" for each mistake and "file:line: warning: element: text" for
 * each warning. */
void calx_problems_print(const struct calx_problems *, FILE *);

/* Frees the lists; the struct is empty afterwards. */
void calx_problems_clear(struct calx_problems *);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Errors as values: formats their texts, and finds the nearest valid name for a misspelt one.
 * Method: Levenshtein distance by dynamic programming over two rows.
 */
#include "core/error.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Longer words are not names; they have no neighbour. */
#define LONGEST_WORD 64

static void error_fill(struct calx_error *e, enum calx_code code, struct calx_place place,
                       const char *format, va_list arguments)
{
    if (!e)
        return;
    e->code = code;
    e->line = place.line;
    snprintf(e->file, sizeof e->file, "%s", place.file ? place.file : "");
    vsnprintf(e->text, sizeof e->text, format, arguments);
}

int calx_error_set(struct calx_error *e, enum calx_code code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    error_fill(e, code, (struct calx_place){NULL, 0}, format, arguments);
    va_end(arguments);
    return (int)code;
}

int calx_error_at(struct calx_error *e, enum calx_code code, struct calx_place place,
                  const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    error_fill(e, code, place, format, arguments);
    va_end(arguments);
    return (int)code;
}

int calx_error_exit(enum calx_code code)
{
    static const int status[] = {[CALX_OK] = 0,
                                 [CALX_ERROR_PHYSICS] = 1,
                                 [CALX_ERROR_INPUT] = 2,
                                 [CALX_ERROR_MEMORY] = 1,
                                 [CALX_ERROR_IO] = 1};
    return (size_t)code < sizeof status / sizeof *status ? status[code] : 1;
}

static size_t smallest(size_t a, size_t b, size_t c)
{
    size_t least = a < b ? a : b;
    return least < c ? least : c;
}

/* Insertions, deletions and replacements that turn one word into the other. */
static size_t edit_distance(const char *from, size_t from_length, const char *to, size_t to_length)
{
    size_t rows[2][LONGEST_WORD + 1];
    for (size_t k = 0; k <= to_length; k++)
        rows[0][k] = k;
    for (size_t i = 1; i <= from_length; i++) {
        const size_t *above = rows[(i - 1) % 2];
        size_t *row = rows[i % 2];
        row[0] = i;
        for (size_t k = 1; k <= to_length; k++)
            row[k] =
                smallest(row[k - 1] + 1, above[k] + 1, above[k - 1] + (from[i - 1] != to[k - 1]));
    }
    return rows[from_length % 2][to_length];
}

const char *calx_error_nearest(const char *word, const char *const *names, size_t count)
{
    size_t length = strlen(word), best = SIZE_MAX;
    const char *nearest = NULL;
    if (length > LONGEST_WORD)
        return NULL;
    for (size_t k = 0; k < count; k++) {
        size_t name_length = strlen(names[k]);
        if (name_length > LONGEST_WORD)
            continue;
        size_t distance = edit_distance(word, length, names[k], name_length);
        if (distance <= length / 2 + 1 && distance < best) {
            best = distance;
            nearest = names[k];
        }
    }
    return nearest;
}

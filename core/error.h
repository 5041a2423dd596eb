/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Errors as values: a code, a text, and the place in a file where it comes from. A function that can fail returns the code
 * (0 is success) and fills the struct; callers pass it up with CALX_TRY.
 */
#ifndef CALX_ERROR_H
#define CALX_ERROR_H

#include <stddef.h>

enum calx_code {
    CALX_OK = 0,
    CALX_ERROR_PHYSICS, /* the simulation went wrong, or an expectation failed: exit 1 */
    CALX_ERROR_INPUT,   /* case file, command line, plugin: exit 2 */
    CALX_ERROR_MEMORY,
    CALX_ERROR_IO
};

struct calx_error {
    enum calx_code code;
    int line;         /* 0 if not from a file */
    char file[512];   /* "" if not from a file */
    char text[2048];
};

/* Where a thing stands in a case file; `file` is owned by the scene. */
struct calx_place {
    const char *file;
    int line;
};

/* Fills e (which may be NULL) and returns code. */
int calx_error_set(struct calx_error *e, enum calx_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with a place. */
int calx_error_at(struct calx_error *e, enum calx_code code, struct calx_place place, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The exit status of the program for a code: 0, 1 (physics, I/O, memory) or 2 (input). */
int calx_error_exit(enum calx_code code);

/* The entry of names[count] nearest to `word` (Levenshtein distance at most half its length plus one), or NULL. */
const char *calx_error_nearest(const char *word, const char *const *names, size_t count);

#define CALX_TRY(call)               \
    do {                             \
        int calx_code_ = (call);     \
        if (calx_code_)              \
            return calx_code_;       \
    } while (0)

#endif

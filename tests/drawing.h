/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Drawings for the tests of the SVG reader: text is written to a file and read.
 */
#ifndef CALX_TESTS_DRAWING_H
#define CALX_TESTS_DRAWING_H

#include <math.h>
#include <string.h>

#include "core/region.h"
#include "io/svg.h"
#include "tests/folder.h"

/* Coordinates of the tables are user units, and one unit is 1 m with y flipped: the page is -50
 * ... 50. */
#define PAGE                                                                                       \
    "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "      \
    "viewBox=\"-50 -50 100 100\">"

/* Rounding of a few operations on numbers up to 100: 100 * 2^-53 * 8 = 9e-14. */
static const double ROUNDING = 1e-13;

static struct calx_svg svg;
static struct calx_svg_options options;

static inline void begin(void)
{
    make_folder();
    svg = (struct calx_svg){0};
    options = (struct calx_svg_options){.tolerance = 0.01, .scale = 1};
}

static inline void end(void)
{
    calx_svg_free(&svg);
    remove_folder();
}

static inline int read_bytes(const char *text, size_t size)
{
    calx_svg_free(&svg);
    FILE *f = fopen(in_folder("a.svg"), "wb");
    ck_assert_ptr_nonnull(f);
    ck_assert_uint_eq(fwrite(text, 1, size, f), size);
    fclose(f);
    error = (struct calx_error){0};
    return calx_svg_read(full_path, &options, &svg, &error);
}

static inline int read_body(const char *body)
{
    char text[8192];
    int n = snprintf(text, sizeof text, "%s\n%s\n</svg>\n", PAGE, body);
    ck_assert_int_lt(n, sizeof text);
    return read_bytes(text, (size_t)n);
}

static inline int read_path(const char *data)
{
    char body[4096];
    snprintf(body, sizeof body, "<path d=\"%s\"/>", data);
    return read_body(body);
}

#define READ(call) ck_assert_msg((call) == CALX_OK, "%s: %s", #call, error.text)

#endif

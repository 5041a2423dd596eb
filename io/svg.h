/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Reads the shapes of an SVG file as chains of straight segments, in metres. The origin is the
 * centre of the viewBox (of width x height if there is no viewBox; else the file's own origin), x
 * points right and y UP: a drum drawn in the middle of its page is centred at (0, 0), and what runs
 * counter-clockwise on the screen runs counter-clockwise here. Lines count, not their paint: a
 * stroke's width and a fill mean nothing. What is hidden (display, visibility) is not read, unless
 * options->id asks for it.
 */
#ifndef CALX_SVG_H
#define CALX_SVG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"

struct calx_svg_options {
    double tolerance; /* m, > 0: largest distance between a curve and its chords */
    double scale;     /* m per unit of the viewBox; 0: from width and height, else 1/96 inch */
    const char *id;   /* only the element or layer of this id or inkscape:label; NULL: all */
};

/* Segments of a chain follow each other and share their end points bit by bit. */
struct calx_svg_segment {
    double a[2], b[2]; /* m */
    int32_t surface;   /* shared, from 0, by segments whose joints turn by at most 15 degrees */
    int32_t chain;     /* index into chains */
};

/* One subpath: segments first ... first + count - 1; closed: the end of the last is the start of
 * the first. */
struct calx_svg_chain {
    size_t first, count;
    bool closed;
    int line; /* of the element in the file */
};

struct calx_svg {
    size_t segment_count, chain_count, warning_count;
    struct calx_svg_segment *segments;
    struct calx_svg_chain *chains;
    char **warnings; /* "file:line: what was not used, and why", one per kind and line */
    int32_t surface_count;
    bool closed; /* at least one chain, and all are closed: they bound an inside (even-odd) */
};

/* Reads the file into *out, which the caller clears with calx_svg_free(). Fails, with file and
 * line, if the file cannot be read, is not well-formed, is no SVG, declares entities, has broken
 * path data or a broken transform, is too large, lacks options->id, or draws nothing. A DOCTYPE
 * that only refers to a DTD is ignored; nothing is loaded. */
int calx_svg_read(const char *path, const struct calx_svg_options *options, struct calx_svg *out,
                  struct calx_error *error);

/* Frees what calx_svg_read() filled; harmless on a zeroed struct. */
void calx_svg_free(struct calx_svg *svg);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Progress of a run: a bar that is redrawn on a terminal, a line now and then on a pipe or into a
 * file.
 */
#ifndef CALX_IO_TERMINAL_H
#define CALX_IO_TERMINAL_H

#include <stdio.h>

#include "core/calx.h"

struct calx_terminal {
    FILE *file;                               /* NULL: silent */
    bool live;                                /* a terminal: the bar is redrawn */
    bool drawn;                               /* a bar stands on the last line */
    bool hot;                                 /* there are temperatures to show */
    double begin, last, interval;             /* s of the clock */
    double begin_time, last_time;             /* s of the simulation */
    double steps_per_second, time_per_second; /* smoothed */
    int64_t begin_step, last_step;
};

/* Begins the progress of `sim` on `file` (NULL: silent). */
void calx_terminal_begin(struct calx_terminal *, FILE *file, const struct calx_sim *);

/* To be called after each step; draws at most five times a second, on a pipe every ten seconds. */
void calx_terminal_update(struct calx_terminal *, struct calx_sim *);

/* Prints a line of its own, above the bar. */
void calx_terminal_say(struct calx_terminal *, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Draws a last time and leaves the line. */
void calx_terminal_end(struct calx_terminal *, struct calx_sim *);

/* Seconds of a clock that only goes forward. */
double calx_terminal_clock(void);

/* Writes a number in four characters or so: 950, 12.3k, 2.61M. Returns text. */
const char *calx_terminal_number(double, char *text, size_t size);

/* Writes a duration: 0.42 s, 12 s, 3:07, 1:02:33. Returns text. */
const char *calx_terminal_duration(double seconds, char *text, size_t size);

#endif

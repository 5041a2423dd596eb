/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Progress of a report: a bar of the work done, redrawn on a terminal; on a pipe a line now and then.
 */
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "io/report_parts.h"

static const double live_interval = 0.2, pipe_interval = 10; /* s */
enum { BAR = 24 };

void calx_report_progress_begin(struct calx_report_progress *p, FILE *file)
{
    double now = calx_terminal_clock();
    *p = (struct calx_report_progress){.file = file, .live = file && isatty(fileno(file)), .begin = now, .last = now};
}

static void draw_bar(const struct calx_report_progress *p, double share)
{
    char bar[BAR + 1];
    for (int i = 0; i < BAR; i++)
        bar[i] = i < (int)(share * BAR + 0.5) ? '#' : '-';
    bar[BAR] = '\0';
    fprintf(p->file, "\r[%s]", bar);
}

void calx_report_progress_update(struct calx_report_progress *p, const char *what, double dt)
{
    char left[32];
    double now = calx_terminal_clock(), share = p->all > 0 ? fmin(1, p->spent / p->all) : 0;
    if (!p->file || now - p->last < (p->live ? live_interval : pipe_interval))
        return;
    p->last = now;
    if (p->live)
        draw_bar(p, share);
    fprintf(p->file, " %3.0f%%  run %zu  %s, step %.3g s", 100 * share, p->runs, what, dt);
    if (p->all > p->spent)
        fprintf(p->file, "  %s left", calx_terminal_duration(p->all - p->spent, left, sizeof left));
    fputs(p->live ? "\033[K" : "\n", p->file);
    p->drawn = p->live;
    fflush(p->file);
}

void calx_report_progress_end(struct calx_report_progress *p)
{
    if (p->file && p->drawn)
        fputs("\r\033[K", p->file);
    p->drawn = false;
}

void calx_report_progress_say(struct calx_report_progress *p, const char *format, ...)
{
    va_list list;
    if (!p->file)
        return;
    calx_report_progress_end(p);
    va_start(list, format);
    vfprintf(p->file, format, list);
    va_end(list);
    fputc('\n', p->file);
    fflush(p->file);
}

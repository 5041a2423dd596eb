/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Shows the progress of a run on stderr.
 * Input: the simulation after each step. Output: a bar with simulated time, speed, time left,
 * contacts and temperatures. Method: the clock is read every step (tens of nanoseconds); what costs
 * more is done only when it draws. The line is cut to the width of the terminal, the least
 * important part first.
 */
#include "io/terminal.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

static const double live_interval = 0.2, pipe_interval = 10; /* s */
enum { LEAST_BAR = 8, MOST_BAR = 30, MOST_LINE = 400, DEFAULT_WIDTH = 80 };

double calx_terminal_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

const char *calx_terminal_number(double x, char *text, size_t size)
{
    static const char suffix[] = " kMGT";
    size_t i = 0;
    for (; fabs(x) >= 999.5 && i + 2 < sizeof suffix; ++i)
        x /= 1000;
    if (i == 0)
        snprintf(text, size, "%.3g", x);
    else
        snprintf(text, size, "%.3g%c", x, suffix[i]);
    return text;
}

const char *calx_terminal_duration(double seconds, char *text, size_t size)
{
    double whole = floor(seconds + 0.5);
    int s = (int)fmod(whole, 60), m = (int)fmod(whole / 60, 60);
    if (!(seconds < 3.6e8))
        snprintf(text, size, "long");
    else if (seconds < 10)
        snprintf(text, size, "%.2g s", seconds);
    else if (whole < 60)
        snprintf(text, size, "%d s", s);
    else if (whole < 3600)
        snprintf(text, size, "%d:%02d", m, s);
    else
        snprintf(text, size, "%.0f:%02d:%02d", floor(whole / 3600), m, s);
    return text;
}

static int terminal_width(FILE *file)
{
    struct winsize size;
    if (ioctl(fileno(file), TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        return size.ws_col;
    return DEFAULT_WIDTH;
}

void calx_terminal_begin(struct calx_terminal *t, FILE *file, const struct calx_sim *sim)
{
    *t = (struct calx_terminal){.file = file, .begin = calx_terminal_clock()};
    t->live = file && isatty(fileno(file));
    t->interval = t->live ? live_interval : pipe_interval;
    t->hot = calx_sim_features(sim).temperature;
    t->last = t->begin;
    t->begin_time = t->last_time = calx_sim_time(sim);
    t->begin_step = t->last_step = calx_sim_step_count(sim);
}

/* ---- the line ---- */

static double share_done(const struct calx_sim *sim)
{
    double end = calx_sim_end(sim);
    if (calx_sim_done(sim))
        return 1;
    return isfinite(end) && end > 0 ? fmin(1, calx_sim_time(sim) / end) : 0;
}

/* Appends to the line if it fits into `width`; what comes later is less important. */
__attribute__((format(printf, 3, 4))) static void append(char *line, int width, const char *format,
                                                         ...)
{
    char part[MOST_LINE];
    va_list list;
    va_start(list, format);
    vsnprintf(part, sizeof part, format, list);
    va_end(list);
    if (strlen(line) + strlen(part) + 1 < (size_t)(width < MOST_LINE ? width : MOST_LINE))
        strcat(line, part);
}

static void append_temperatures(char *line, int width, struct calx_sim *sim)
{
    struct calx_probe low = {
        .quantity = "temperature", .particle = -1, .material = -1, .wall = -1, .reduce = "min"};
    struct calx_probe high = low;
    strcpy(high.reduce, "max");
    append(line, width, "  %.4g..%.4g K", calx_sim_measure(sim, &low),
           calx_sim_measure(sim, &high));
}

static void compose(const struct calx_terminal *t, struct calx_sim *sim, char *line, int width)
{
    char number[32];
    double end = calx_sim_end(sim), steps = t->steps_per_second;
    *line = '\0';
    append(line, width, isfinite(end) ? " %3.0f%%  t %.4g/%.4g s" : " %3.0f%%  t %.4g s",
           100 * share_done(sim), calx_sim_time(sim), end);
    if (isfinite(end) && t->time_per_second > 0 && !calx_sim_done(sim))
        append(line, width, "  %s left",
               calx_terminal_duration((end - calx_sim_time(sim)) / t->time_per_second, number,
                                      sizeof number));
    append(line, width, "  %s steps/s", calx_terminal_number(steps, number, sizeof number));
    append(
        line, width, "  %s particle-steps/s",
        calx_terminal_number(steps * (double)calx_sim_particle_count(sim), number, sizeof number));
    append(line, width, "  %zu contacts", calx_sim_contact_count(sim));
    if (t->hot)
        append_temperatures(line, width, sim);
}

static void draw(struct calx_terminal *t, struct calx_sim *sim)
{
    char line[MOST_LINE], bar[MOST_BAR + 1];
    int width = t->live ? terminal_width(t->file) - 1 : MOST_LINE - MOST_BAR - 8;
    compose(t, sim, line, width - LEAST_BAR - 2);
    int room = width - 2 - (int)strlen(line);
    int cells = room > MOST_BAR ? MOST_BAR : room;
    for (int i = 0; i < cells; ++i)
        bar[i] = i < (int)(share_done(sim) * cells + 0.5) ? '#' : '-';
    bar[cells > 0 ? cells : 0] = '\0';
    if (t->live)
        fprintf(t->file, "\r[%s]%s\033[K", bar, line);
    else
        fprintf(t->file, "%s\n", line + 1);
    fflush(t->file);
    t->drawn = t->live;
}

/* ---- progress ---- */

/* Speeds since the last drawing, smoothed so that the time left does not jump. */
static void measure_speed(struct calx_terminal *t, const struct calx_sim *sim, double now)
{
    double passed = now - t->last, weight = t->steps_per_second > 0 ? 0.3 : 1;
    double steps = (double)(calx_sim_step_count(sim) - t->last_step) / passed;
    double time = (calx_sim_time(sim) - t->last_time) / passed;
    t->steps_per_second += weight * (steps - t->steps_per_second);
    t->time_per_second += weight * (time - t->time_per_second);
    t->last = now;
    t->last_step = calx_sim_step_count(sim);
    t->last_time = calx_sim_time(sim);
}

void calx_terminal_update(struct calx_terminal *t, struct calx_sim *sim)
{
    if (!t->file)
        return;
    double now = calx_terminal_clock();
    if (now - t->last < t->interval)
        return;
    measure_speed(t, sim, now);
    draw(t, sim);
}

void calx_terminal_say(struct calx_terminal *t, const char *format, ...)
{
    va_list list;
    if (!t->file)
        return;
    if (t->drawn)
        fputs("\r\033[K", t->file);
    t->drawn = false;
    va_start(list, format);
    vfprintf(t->file, format, list);
    va_end(list);
    fputc('\n', t->file);
    fflush(t->file);
}

void calx_terminal_end(struct calx_terminal *t, struct calx_sim *sim)
{
    if (!t->file)
        return;
    double passed = calx_terminal_clock() - t->begin;
    if (passed > 0)
        t->steps_per_second = (double)(calx_sim_step_count(sim) - t->begin_step) / passed;
    t->time_per_second = 0;
    if (t->live) {
        draw(t, sim);
        fputc('\n', t->file);
    }
    t->drawn = false;
    fflush(t->file);
}

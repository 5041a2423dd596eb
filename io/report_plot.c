/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The work-precision diagram: report.gp for gnuplot, from it report.svg and report.png.
 * Input: results. Output: error against seconds, both logarithmic, one curve per integrator with its
 * measured order; the Pareto front; the verdict's point; runs that failed at the upper edge.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "io/report_parts.h"

/* Colours that people with any eyes tell apart (Okabe and Ito), then darker ones. */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b8860b", "#7f3fbf",
                                      "#444444", "#8c564b", "#17becf"};
static const int shapes[] = {7, 4, 8, 10, 12, 5, 6, 9, 11, 13};
/* Other codes: dashed, in shades that no integrator has. */
static const char *const peer_colours[] = {"#000000", "#777777", "#aa7744"};
static const int peer_shapes[] = {3, 1, 2};
enum { PEERS = sizeof peer_shapes / sizeof *peer_shapes };
enum { STYLES = sizeof colours / sizeof *colours, PANELS = 4 };

/* ---- limits of the picture ---- */

struct frame {
    double left, right, low, high;
};

static double seconds_of(const struct calx_report_job *job, const struct calx_report_result *r)
{
    const struct calx_report_candidate *c = &job->study.candidates[r->point->candidate];
    return r->status == CALX_REPORT_GOOD && r->runs ? r->seconds
                                                    : job->plan.window / r->point->dt * c->evaluations * c->cost;
}

/* Errors above the size of the quantity itself are all the same: at the edge. */
static bool seen(const struct calx_report_result *r, size_t q)
{
    return r->status == CALX_REPORT_GOOD && r->errors[q].error < 3;
}

/* What is drawn: the error; with statistics what it is at most. A zero is drawn as rounding. */
static double height_of(const struct calx_report_job *job, const struct calx_report_result *r, size_t q)
{
    return fmax(calx_report_upper(&job->plan, &r->errors[q]), 1e-16);
}

static struct frame frame_of(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q)
{
    struct frame f = {INFINITY, 0, job->study.options->target, job->study.options->target};
    for (size_t k = 0; k < a->count; k++) {
        double x = seconds_of(job, &a->results[k]), y = height_of(job, &a->results[k], q);
        if (!(x > 0))
            continue;
        f.left = fmin(f.left, x);
        f.right = fmax(f.right, x);
        if (seen(&a->results[k], q) && y > 0) {
            f.low = fmin(f.low, y);
            f.high = fmax(f.high, y);
        }
    }
    for (size_t k = 0; k < job->peer_count; k++) {
        const struct calx_report_peer *p = &job->peers[k];
        if (p->quantity != q || !(p->seconds > 0))
            continue;
        f.left = fmin(f.left, p->seconds);
        f.right = fmax(f.right, p->seconds);
        f.low = fmin(f.low, p->error);
        f.high = fmax(f.high, fmin(p->error, 3));
    }
    f.low = fmax(f.low, 1e-16) / 2;
    f.high = pow(10, ceil(log10(f.high * 2)));
    f.left /= 1.6;
    f.right *= 5;
    return f;
}

/* ---- data ---- */

static void print_curve(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, size_t c,
                        FILE *f)
{
    fprintf(f, "$c%zuq%zu << EOD\n", c, q);
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        if (r->point->candidate != (int)c || !seen(r, q) || !calx_report_is_plain(r->point))
            continue;
        fprintf(f, "%.6g %.6g\n", seconds_of(job, r), height_of(job, r, q));
    }
    fputs("EOD\n", f);
}

/* One after the other, as the file has them; without seconds there is no place for them. */
static void print_peers(const struct calx_report_job *job, size_t q, FILE *f)
{
    for (size_t first = calx_report_points_curve(job, q, 0); first < job->peer_count;
         first = calx_report_points_curve(job, q, first + 1)) {
        fprintf(f, "$peer%zuq%zu << EOD\n", first, q);
        for (size_t k = first; k < job->peer_count; k++)
            if (job->peers[k].quantity == q && strcmp(job->peers[k].name, job->peers[first].name) == 0 &&
                job->peers[k].seconds > 0)
                fprintf(f, "%.6g %.6g\n", job->peers[k].seconds, fmax(job->peers[k].error, 1e-16));
        fputs("EOD\n", f);
    }
}

struct marks {
    size_t front, failed; /* how many */
};

/* The colour of a point's integrator as a number, for lc rgb variable. */
static long colour_of(const struct calx_report_result *r)
{
    return strtol(colours[r->point->candidate % STYLES] + 1, NULL, 16);
}

/* Points beside the ladders, the front, and what failed. */
static struct marks print_marks(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q,
                        const struct frame *frame, FILE *f)
{
    struct marks marks = {0, 0};
    fprintf(f, "$other%zu << EOD\n", q);
    for (size_t k = 0; k < a->count; k++)
        if (seen(&a->results[k], q) && !calx_report_is_plain(a->results[k].point))
            fprintf(f, "%.6g %.6g %ld\n", a->results[k].seconds, height_of(job, &a->results[k], q), colour_of(&a->results[k]));
    fprintf(f, "EOD\n$front%zu << EOD\n", q);
    for (size_t k = 0; k < a->count; k++)
        if (a->results[k].front[q] && seen(&a->results[k], q))
            marks.front += fprintf(f, "%.6g %.6g\n", a->results[k].seconds, height_of(job, &a->results[k], q)) > 0;
    fprintf(f, "EOD\n$edge%zu << EOD\n", q);
    for (size_t k = 0; k < a->count; k++)
        if (a->results[k].status != CALX_REPORT_GOOD || (a->results[k].runs && a->results[k].errors[q].error >= 3))
            marks.failed += fprintf(f, "%.6g %.6g %ld\n", seconds_of(job, &a->results[k]), frame->high / 1.3,
                    colour_of(&a->results[k])) > 0;
    fputs("EOD\n", f);
    return marks;
}

/* ---- the script ---- */

static void print_text(const char *text, FILE *f)
{
    for (; *text; text++)
        if (*text != '"' && *text != '\\' && (unsigned char)*text >= ' ')
            fputc(*text, f);
}

static void print_axes(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q,
                       const struct frame *frame, FILE *f)
{
    const struct calx_report_quantity *quantity = &job->study.quantities[q];
    const struct calx_report_scale *scale = &a->scales[q];
    fprintf(f, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", frame->left, frame->right, frame->low, frame->high);
    bool seeds = job->plan.reference == CALX_REPORT_STATISTICS;
    fputs("set key outside right top Left reverse invert samplen 2 spacing 1.1\n", f); /* curves may lie in any corner */
    fprintf(f, "set ylabel \"error%s of ", seeds ? ", at most (95 %),": "");
    print_text(quantity->name, f);
    if (scale->absolute)
        fprintf(f, " (%s)\"\n", quantity->unit);
    else
        fprintf(f, " (relative to %.3g%s%s)\"\n", scale->scale, strcmp(quantity->unit, "1") ? " " : "",
                strcmp(quantity->unit, "1") ? quantity->unit : "");
    fprintf(f, "set arrow 1 from graph 0, first %.6g to graph 1, first %.6g nohead dt 3 lc rgb '#888888' back\n",
            job->study.options->target, job->study.options->target);
    fprintf(f, "set label 1 \"target\" at graph 0.015, first %.6g offset 0,0.5 tc rgb '#666666' font ',11'\n",
            job->study.options->target);
}

/* A mark with its words above it to the right, where no falling curve goes; near the right edge the words end there. */
static void print_mark(int label, const char *words, double x, double y, const struct frame *frame, const char *mark,
                       FILE *f)
{
    const double letter = 0.0145; /* of the width of a panel */
    bool edge = log(x / frame->left) / log(frame->right / frame->left) > 1 - letter * (double)strlen(words);
    fprintf(f, "set label %d \"\" at %.6g,%.6g point %s lc rgb '#000000' front\n", label, x, y, mark);
    if (edge)
        fprintf(f, "set label %d \"%s\" at graph 0.985, first %.6g right offset 0,2.4 front\n", label + 1, words, y);
    else
        fprintf(f, "set label %d \"%s\" at %.6g,%.6g left offset 1.4,0.9 front\n", label + 1, words, x, y);
}

static void print_best(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q,
                       const struct frame *frame, FILE *f)
{
    const struct calx_report_result *best = a->verdicts[q].best;
    const struct calx_report_result *mine = calx_report_nearest(a, job->study.own, job->study.own_dt);
    char step[32], more[96], words[320];
    if (mine && mine != best && seen(mine, q))
        print_mark(4, "the step you have", mine->seconds, height_of(job, mine, q), frame, "pt 12 ps 2.4 lw 1.5", f);
    if (!best)
        return;
    snprintf(words, sizeof words, "use %s, dt = %s%s", job->study.candidates[best->point->candidate].name,
             calx_report_step(best->point->dt, step, sizeof step), calx_report_beside(best->point, ", ", more, sizeof more));
    print_mark(2, words, best->seconds, height_of(job, best, q), frame, "pt 6 ps 2.6 lw 2", f);
}

static size_t curve_length(const struct calx_report_analysis *a, size_t q, size_t c)
{
    size_t n = 0;
    for (size_t k = 0; k < a->count; k++)
        n += a->results[k].point->candidate == (int)c && seen(&a->results[k], q) &&
             calx_report_is_plain(a->results[k].point);
    return n;
}

/* The order beside the finest point of its curve. */
static void print_orders(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    for (size_t c = 0; c < s->candidate_count; c++) {
        const struct calx_report_curve *curve = &a->curves[c * s->quantity_count + q];
        const struct calx_report_result *last = NULL;
        for (size_t k = 0; k < a->count; k++)
            if (a->results[k].point->candidate == (int)c && seen(&a->results[k], q) && calx_report_is_plain(a->results[k].point))
                last = &a->results[k];
        if (last && !isnan(curve->order))
            fprintf(f, "set label %zu \"%.1f\" at %.6g,%.6g offset 0.9,0 tc rgb '%s' font ',12' front\n", 10 + c,
                    curve->order, last->seconds, height_of(job, last, q), colours[c % STYLES]);
    }
}

/* The front first, as a broad band under the curves; the case's own integrator last, on top. Markers under others are
 * larger, so that curves which fall together are seen. */
static void print_plot(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, bool failed,
                       FILE *f)
{
    const struct calx_report_study *s = &job->study;
    fprintf(f, "plot $front%zu using 1:2 smooth unique with lines lw 11 lc rgb '#d8d8d8' title \"Pareto front\"", q);
    if (failed)
        fprintf(f, ", \\\n  $edge%zu using 1:2:3 with points pt 2 ps 1.3 lw 2 lc rgb variable "
                   "title \"unstable, or no digit right\"", q);
    if (s->soften_count || !isnan(s->heat_low) || !isnan(s->tight))
        fprintf(f, ", \\\n  $other%zu using 1:2:3 with points pt 2 ps 1 lw 1.6 lc rgb variable title \"%s\"", q,
                s->soften_count ? "softer contacts" : !isnan(s->tight) ? "other tolerances" : "other heat steps");
    for (size_t k = calx_report_points_curve(job, q, 0), n = 0; k < job->peer_count; k = calx_report_points_curve(job, q, k + 1), n++)
        fprintf(f, ", \\\n  $peer%zuq%zu using 1:2 with linespoints pt %d ps 1.3 dt 2 lw 1.6 lc rgb '%s' title \"%s\"", k, q,
                peer_shapes[n % PEERS], peer_colours[n % PEERS], job->peers[k].name);
    for (size_t c = s->candidate_count; c-- > 0;) {
        const struct calx_report_curve *curve = &a->curves[c * s->quantity_count + q];
        const char *colour = colours[c % STYLES];
        char order[32] = "";
        if (!curve_length(a, q, c))
            continue;
        if (!isnan(curve->order))
            snprintf(order, sizeof order, ", order %.1f", curve->order);
        fprintf(f, ", \\\n  $c%zuq%zu using 1:2 with linespoints pt %d ps %.2f lw 1.6 lc rgb '%s' title \"%s%s\"", c, q,
                shapes[c % STYLES], 0.8 + 0.15 * fmin((double)c, 5), colour, s->candidates[c].name, order);
    }
    fputc('\n', f);
}

static void print_panel(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    struct frame frame = frame_of(job, a, q);
    for (size_t c = 0; c < job->study.candidate_count; c++)
        print_curve(job, a, q, c, f);
    print_peers(job, q, f);
    const struct marks marks = print_marks(job, a, q, &frame, f);
    fputs("unset label\nunset arrow\n", f);
    print_axes(job, a, q, &frame, f);
    print_orders(job, a, q, f);
    print_best(job, a, q, &frame, f);
    if (marks.front)
        print_plot(job, a, q, marks.failed > 0, f);
}

static void print_script(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    size_t panels = job->study.quantity_count < PANELS ? job->study.quantity_count : PANELS;
    int columns = panels > 1 ? 2 : 1, rows = ((int)panels + columns - 1) / columns;
    const char *title = job->study.run.scene->title;
    fprintf(f, "# Redraws report.svg or report.png: gnuplot -e \"kind='svg'\" report.gp\n"
               "if (!exists(\"kind\")) kind = 'svg'\n"
               "if (kind eq 'svg') { set terminal svg size %d,%d font 'Helvetica,14' background '#ffffff' } "
               "else { set terminal pngcairo size %d,%d font 'Sans,11' background '#ffffff' }\n"
               "set output 'report.'.kind\n", columns * 1120, rows * 560, columns * 1120, rows * 560);
    fputs("set encoding utf8\nset logscale xy\nset format x \"10^{%L}\"\nset format y \"10^{%L}\"\nset grid lt 1 lw 0.5 lc rgb '#e4e4e4'\n"
          "set datafile missing '?'\nset border lc rgb '#666666'\n"
          "set xlabel \"run time of what was compared (s), counted work x measured cost\"\n", f);
    if (panels > 1)
        fprintf(f, "set multiplot layout %d,%d\n", rows, columns);
    fputs("set title \"", f);
    print_text(title && *title ? title : job->study.run.name, f);
    fputs("\"\n", f);
    for (size_t q = 0; q < panels; q++)
        print_panel(job, a, q, f);
    if (panels > 1)
        fputs("unset multiplot\n", f);
}

/* ---- gnuplot ---- */

/* 0: drawn; 127: no gnuplot. */
static int draw(const char *folder, const char *script, const char *kind)
{
    char choice[32];
    int status = 0;
    snprintf(choice, sizeof choice, "kind='%s'", kind);
    pid_t child = fork();
    if (child == 0) {
        if (chdir(folder) == 0)
            execlp("gnuplot", "gnuplot", "-e", choice, script, (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status))
        return 1;
    return WEXITSTATUS(status);
}

int calx_report_draw(const char *folder, const char *script, bool *drawn, struct calx_error *error)
{
    fflush(NULL);
    int svg = draw(folder, script, "svg"), png = svg ? svg : draw(folder, script, "png");
    *drawn = svg == 0 && png == 0;
    if (svg == 127 || (svg == 0 && png == 0))
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_IO, "gnuplot failed on %s/%s", folder, script);
}

int calx_report_write_plot(const struct calx_report_job *job, const struct calx_report_analysis *a, bool *drawn,
                           struct calx_error *error)
{
    struct calx_file file;
    CALX_TRY(calx_report_create(job, "report.gp", &file, error));
    print_script(job, a, file.stream);
    CALX_TRY(calx_file_commit(&file, error));
    return calx_report_draw(job->study.folder, "report.gp", drawn, error);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Words and numbers that page, picture, JSON and terminal share: steps, errors, the verdict, the
 * machine.
 */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#include "io/file.h"
#include "io/report_parts.h"

const char *calx_report_step(double seconds, char *text, size_t size)
{
    static const char *const units[] = {"s", "ms", "us", "ns"};
    size_t k = 0;
    double v = seconds;
    for (; v < 0.9995 && k + 1 < sizeof units / sizeof *units; k++)
        v *= 1e3;
    snprintf(text, size, "%.3g %s", v, units[k]);
    return text;
}

const char *calx_report_time(double seconds, char *text, size_t size)
{
    return seconds < 0.1 ? calx_report_step(seconds, text, size) : calx_terminal_duration(seconds, text, size);
}

void calx_report_shorten(char *text, size_t size, const char *from)
{
    static const char more[] = " ...";
    if (snprintf(text, size, "%s", from) < (int)size)
        return;
    size_t end = size - sizeof more;
    while (end && text[end] != ' ')
        end--;
    memcpy(text + end, more, sizeof more);
}

const char *calx_report_beside(const struct calx_report_point *p, const char *before, char *text, size_t size)
{
    char step[32];
    *text = '\0';
    if (p->stiffness != 1)
        snprintf(text, size, "%scontacts %.3g times softer", before, 1 / p->stiffness);
    else if (p->tolerance > 0)
        snprintf(text, size, "%sa tolerance of %.0e", before, p->tolerance);
    else if (p->heat_dt > 0)
        snprintf(text, size, "%sa heat step of %s", before, calx_report_step(p->heat_dt, step, sizeof step));
    return text;
}

const char *calx_report_percent(double error, bool absolute, const char *unit, char *text, size_t size)
{
    if (isnan(error))
        snprintf(text, size, "-");
    else if (absolute)
        snprintf(text, size, "%.2g %s", error, strcmp(unit, "1") == 0 ? "" : unit);
    else if (error >= 1e-4 && error < 1)
        snprintf(text, size, "%.2g %%", 100 * error);
    else if (error >= 1 && error < 100)
        snprintf(text, size, "%.0f %%", 100 * error);
    else
        snprintf(text, size, "%.1e", error);
    return text;
}

/* "Intel ...; 2 processors; Linux 6.1" as far as the system tells. */
const char *calx_report_machine(char *text, size_t size)
{
    char line[256] = "", model[128] = "unknown processor";
    struct utsname system;
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':')) {
            snprintf(model, sizeof model, "%.*s", (int)strcspn(strchr(line, ':') + 2, "\n"),
                     strchr(line, ':') + 2);
            break;
        }
    if (file)
        fclose(file);
    bool known = uname(&system) == 0;
    snprintf(text, size, "%s, %d processors, %s %s", model, omp_get_num_procs(), known ? system.sysname : "",
             known ? system.release : "");
    return text;
}

int calx_report_create(const struct calx_report_job *job, const char *name, struct calx_file *file,
                       struct calx_error *error)
{
    char *path = NULL;
    if (asprintf(&path, "%s/%s", job->study.folder, name) < 0)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    int code = calx_file_create(file, path, error);
    free(path);
    return code;
}

/* ---- the verdict ---- */

/* Why the verdict is on another target than was asked. */
static void print_out_of_reach(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, const char *wanted,
                               FILE *file)
{
    const struct calx_report_verdict *v = &a->verdicts[q];
    char chance[32];
    if (v->target <= job->study.options->target)
        return;
    calx_report_percent(v->best->errors[q].confidence, a->scales[q].absolute, job->study.quantities[q].unit, chance, sizeof chance);
    if (job->plan.reference == CALX_REPORT_STATISTICS)
        fprintf(file, " The %s asked for cannot be promised: chance alone makes ± %s with %zu seeds; more of them (--seeds) or a larger "
                      "--budget narrow that.", wanted, chance, v->best->runs);
    else
        fprintf(file, " No step that was tried keeps within %s: ask for smaller ones with --steps, or for a larger "
                      "--budget.", wanted);
}

/* How the case's step compares with the largest one that would do with its own integrator. */
static void print_own(const struct calx_report_job *job, const struct calx_report_verdict *v, FILE *file)
{
    const struct calx_report_study *s = &job->study;
    char step[32];
    if (s->own < 0)
        return;
    calx_report_step(s->own_dt, step, sizeof step);
    const char *name = s->candidates[s->own].name;
    const char *begin = v->target > s->options->target ? " For that the" : " The"; /* it is said of the target that is reached */
    if (!v->own)
        fprintf(file, " With %s, which the case has, no step that was tried is enough.", name);
    else if (v->own_factor > 1.2)
        fprintf(file, "%s step you have (%s, %s) is %.2g times finer than needed.", begin, name, step, v->own_factor);
    else if (v->own_factor < 0.8)
        fprintf(file, "%s step you have (%s, %s) is %.2g times too coarse.", begin, name, step, 1 / v->own_factor);
    else if (!isnan(v->own_factor))
        fprintf(file, "%s step you have (%s, %s) is right.", begin, name, step);
}

/* Why there is no verdict at all: no time, or no step that works. */
static void print_nothing(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *file)
{
    char budget[32];
    size_t good = 0;
    for (size_t k = 0; k < a->count; k++)
        good += a->results[k].runs > 0 && a->results[k].status == CALX_REPORT_GOOD;
    calx_terminal_duration(job->study.options->budget, budget, sizeof budget);
    if (good && job->plan.reference == CALX_REPORT_STATISTICS)
        fprintf(file, "No verdict on %s: within the budget of %s no step that calx would take came to two seeds; give more with --budget.\n",
                job->study.quantities[q].name, budget);
    else
        fprintf(file, "No verdict on %s: no run with a step that calx would take came to its end and gave an error; see the notes.\n",
                job->study.quantities[q].name);
}

size_t calx_report_ranked(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t rank)
{
    size_t moving = 0, still = 0, n = job->study.quantity_count;
    for (size_t q = 0; q < n; q++)
        if (!a->scales[q].still && moving++ == rank)
            return q;
    for (size_t q = 0; q < n; q++)
        if (a->scales[q].still && moving + still++ == rank)
            return q;
    return 0;
}

void calx_report_print_verdict(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q,
                               FILE *file)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_quantity *quantity = &s->quantities[q];
    const struct calx_report_verdict *v = &a->verdicts[q];
    bool absolute = a->scales[q].absolute;
    char target[32], wanted[32], step[32], error[32], time[32], more[96];
    calx_report_percent(s->options->target, absolute, quantity->unit, wanted, sizeof wanted);
    calx_report_percent(v->target, absolute, quantity->unit, target, sizeof target);
    if (a->scales[q].still) {
        fprintf(file, "%s does not change in the %.3g s that were compared.\n", quantity->name, job->plan.window);
        return;
    }
    if (!v->best) {
        print_nothing(job, a, q, file);
        return;
    }
    const struct calx_report_point *p = v->best->point;
    calx_report_step(p->dt, step, sizeof step);
    calx_report_percent(calx_report_upper(&job->plan, &v->best->errors[q]), absolute, quantity->unit, error, sizeof error);
    fprintf(file, "For %s in %s use %s with dt = %s", target, quantity->name,
            s->candidates[p->candidate].name, step);
    fputs(calx_report_beside(p, " and ", more, sizeof more), file);
    bool whole = !isnan(v->whole);
    fprintf(file, ": %s%s, error %s%s.",
            calx_report_time(whole ? v->whole : v->best->seconds, time, sizeof time),
            whole ? "" : " for what was compared", error,
            job->plan.reference == CALX_REPORT_STATISTICS ? " at most (95 %)" : "");
    print_own(job, v, file);
    print_out_of_reach(job, a, q, wanted, file);
    fputc('\n', file);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Points that other codes have measured, for the same picture.
 * Input: a CSV file; its first line names the columns, in any order: name, dt (s), error (as this report's: relative to the quantity's
 * scale), and, if known, seconds, evaluations and quantity (else the first one). Output: a list of peers. Errors name the line.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

enum { NAME, DT, ERROR, SECONDS, EVALUATIONS, QUANTITY, COLUMNS, NEEDED = ERROR + 1 };
static const char *const titles[COLUMNS] = {"name", "dt", "error", "seconds", "evaluations", "quantity"};
enum { WIDEST = 16 }; /* columns of a file */

struct reader {
    const char *path;
    size_t line;
    int column[WIDEST]; /* what it is */
    size_t columns;
    struct calx_report_job *job;
    struct calx_error *error;
};

static int complain(const struct reader *r, const char *what, const char *text)
{
    return calx_error_set(r->error, CALX_ERROR_INPUT, "%s, line %zu: %s%s%s", r->path, r->line, what, *text ? ": " : "", text);
}

/* The next field of a line, without spaces around it; NULL at the end. */
static char *field(char **rest)
{
    char *text = strsep(rest, ",");
    if (!text)
        return NULL;
    text += strspn(text, " \t");
    for (size_t n = strlen(text); n && strchr(" \t\r\n", text[n - 1]); n--)
        text[n - 1] = '\0';
    return text;
}

static int read_header(struct reader *r, char *line)
{
    bool there[COLUMNS] = {false};
    for (char *text; (text = field(&line)); r->columns++) {
        int k = 0;
        while (k < COLUMNS && strcmp(text, titles[k]))
            k++;
        if (k == COLUMNS || r->columns == WIDEST || there[k])
            return complain(r, "expected the columns name, dt, error and, if known, seconds, evaluations, quantity, each once, not", text);
        there[k] = true;
        r->column[r->columns] = k;
    }
    for (int k = 0; k < NEEDED; k++)
        if (!there[k])
            return complain(r, "a column is missing", titles[k]);
    return CALX_OK;
}

static int take_quantity(struct reader *r, const char *text, struct calx_report_peer *p)
{
    const struct calx_report_study *s = &r->job->study;
    const char *names[CALX_REPORT_QUANTITIES];
    for (size_t q = 0; q < s->quantity_count; q++) {
        names[q] = s->quantities[q].name;
        if (strcmp(text, names[q]) == 0) {
            p->quantity = q;
            return CALX_OK;
        }
    }
    const char *nearest = calx_error_nearest(text, names, s->quantity_count);
    return calx_error_set(r->error, CALX_ERROR_INPUT, "%s, line %zu: this report has no quantity '%s'%s%s%s", r->path, r->line, text,
                          nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

static int take_number(struct reader *r, int column, const char *text, struct calx_report_peer *p)
{
    double *const to[COLUMNS] = {[DT] = &p->dt, [ERROR] = &p->error, [SECONDS] = &p->seconds, [EVALUATIONS] = &p->evaluations};
    char *end;
    if (!*text && column >= NEEDED)
        return CALX_OK;
    *to[column] = strtod(text, &end);
    bool good = end != text && !*end && isfinite(*to[column]) && *to[column] >= 0 && (column != DT || *to[column] > 0);
    return good ? CALX_OK : complain(r, column == DT ? "dt must be a number above 0, in s, not" : "expected a number of 0 or more, not", text);
}

static int take_field(struct reader *r, int column, const char *text, struct calx_report_peer *p)
{
    if (column == QUANTITY)
        return *text ? take_quantity(r, text, p) : CALX_OK;
    if (column != NAME)
        return take_number(r, column, text, p);
    if (!*text || strlen(text) >= sizeof p->name || strpbrk(text, "\"\\|"))
        return complain(r, "a name has 1 to 63 characters, none of \" \\ |", text);
    snprintf(p->name, sizeof p->name, "%s", text);
    return CALX_OK;
}

static int read_point(struct reader *r, char *line)
{
    struct calx_report_peer p = {.seconds = NAN, .evaluations = NAN};
    size_t k = 0;
    for (char *text; (text = field(&line)); k++) {
        if (k == r->columns)
            return complain(r, "more fields than columns", "");
        CALX_TRY(take_field(r, r->column[k], text, &p));
    }
    if (k < r->columns)
        return complain(r, "fewer fields than columns", "");
    struct calx_report_peer *grown = realloc(r->job->peers, (r->job->peer_count + 1) * sizeof *grown);
    if (!grown)
        return calx_error_set(r->error, CALX_ERROR_MEMORY, "out of memory");
    r->job->peers = grown;
    grown[r->job->peer_count++] = p;
    return CALX_OK;
}

static int read_lines(struct reader *r, FILE *file)
{
    char *line = NULL;
    size_t size = 0;
    int code = CALX_OK;
    while (!code && getline(&line, &size, file) >= 0) {
        r->line++;
        if (line[strspn(line, " \t\r\n")] != '\0')
            code = r->columns ? read_point(r, line) : read_header(r, line);
    }
    free(line);
    return code || r->columns ? code : complain(r, "the file is empty", "");
}

int calx_report_points_read(struct calx_report_job *job, struct calx_error *error)
{
    struct reader r = {.path = job->study.options->points, .job = job, .error = error};
    if (!r.path)
        return CALX_OK;
    FILE *file = fopen(r.path, "r");
    if (!file)
        return calx_error_set(error, CALX_ERROR_INPUT, "--points %s: cannot be read", r.path);
    int code = read_lines(&r, file);
    fclose(file);
    return code;
}

size_t calx_report_points_curve(const struct calx_report_job *job, size_t quantity, size_t from)
{
    for (size_t k = from; k < job->peer_count; k++) {
        bool first = job->peers[k].quantity == quantity;
        for (size_t before = 0; before < k && first; before++)
            first = job->peers[before].quantity != quantity || strcmp(job->peers[before].name, job->peers[k].name);
        if (first)
            return k;
    }
    return job->peer_count;
}

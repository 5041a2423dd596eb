/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The CSV table of a run. Input: rows of numbers; output: a file that any spreadsheet, gnuplot or
 * ParaView reads (RFC 4180, decimal point). Method: %.17g gives back the same bits (C11 5.2.4.2.2,
 * DBL_DECIMAL_DIG); the place where the last row begins is kept, so that it can be replaced; going
 * on means cutting the file after the last row wanted.
 */
#include "io/table.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct calx_table {
    FILE *stream;
    char *path;
    size_t columns;
    double time; /* of the last row; minus infinity without one */
    off_t row;   /* where the last row begins */
};

static int fail(const struct calx_table *t, const char *what, struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_IO, "cannot %s %s: %s", what, t->path, strerror(errno));
}

void calx_table_free(struct calx_table *t)
{
    if (!t)
        return;
    if (t->stream)
        fclose(t->stream); /* every row was flushed */
    free(t->path);
    free(t);
}

/* ---- the header ---- */

static void print_column(FILE *stream, const struct calx_table_column *c)
{
    bool quoted = strpbrk(c->name, ",\"\r\n");
    if (quoted)
        fputc('"', stream);
    for (const char *p = c->name; *p; p++)
        fprintf(stream, *p == '"' ? "\"\"" : "%c", *p);
    if (c->unit && *c->unit && strcmp(c->unit, "1"))
        fprintf(stream, " [%s]", c->unit);
    if (quoted)
        fputc('"', stream);
}

/* The line without its end. The caller frees it; NULL without memory. */
static char *compose_header(const struct calx_table_column *columns, size_t n)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return NULL;
    for (size_t i = 0; i < n; i++) {
        if (i)
            fputc(',', stream);
        print_column(stream, &columns[i]);
    }
    if (!fclose(stream))
        return text;
    free(text);
    return NULL;
}

/* ---- opening ---- */

static int begin(struct calx_table *t, const char *header, struct calx_error *e)
{
    if (ftruncate(fileno(t->stream), 0) || fseeko(t->stream, 0, SEEK_SET))
        return fail(t, "empty", e);
    if (fprintf(t->stream, "%s\n", header) < 0 || fflush(t->stream))
        return fail(t, "write", e);
    return CALX_OK;
}

/* Finds the end of the last row up to `time` and cuts the file there. */
static int go_on(struct calx_table *t, const char *header, double time, struct calx_error *e)
{
    char *line = NULL;
    size_t size = 0;
    ssize_t n = getline(&line, &size, t->stream);
    size_t length = strlen(header);
    bool same = n == (ssize_t)length + 1 && !memcmp(line, header, length) && line[length] == '\n';
    off_t end = n;
    while (same && (n = getline(&line, &size, t->stream)) > 0) {
        char *stop;
        double at = strtod(line, &stop);
        if (line[n - 1] != '\n' || stop == line || !(at <= time))
            break;
        t->time = at;
        t->row = end;
        end += n;
    }
    free(line);
    if (!same)
        return calx_error_set(
            e, CALX_ERROR_IO,
            "%s has other columns than this case: move it away to resume without it", t->path);
    if (ferror(t->stream))
        return fail(t, "read", e);
    return ftruncate(fileno(t->stream), end) || fseeko(t->stream, end, SEEK_SET) ? fail(t, "cut", e)
                                                                                 : CALX_OK;
}

static int open_file(struct calx_table *t, const char *mode, struct calx_error *e)
{
    t->stream = fopen(t->path, mode);
    return t->stream ? CALX_OK : fail(t, "write", e);
}

struct calx_table *calx_table_resume(const char *path, const struct calx_table_column *columns,
                                     size_t n, double time, struct calx_error *e)
{
    struct calx_table *t = calloc(1, sizeof *t);
    char *header = compose_header(columns, n);
    if (t)
        *t = (struct calx_table){.path = strdup(path), .columns = n, .time = -INFINITY};
    int code = CALX_OK;
    if (!t || !t->path || !header)
        code = calx_error_set(e, CALX_ERROR_MEMORY, "out of memory for the table %s", path);
    bool fresh = time == -INFINITY || access(path, F_OK);
    code = code ? code : open_file(t, fresh ? "w+e" : "r+e", e);
    code = code ? code : fresh ? begin(t, header, e) : go_on(t, header, time, e);
    free(header);
    if (!code)
        return t;
    calx_table_free(t);
    return NULL;
}

struct calx_table *calx_table_create(const char *path, const struct calx_table_column *columns,
                                     size_t n, struct calx_error *e)
{
    return calx_table_resume(path, columns, n, -INFINITY, e);
}

/* ---- rows ---- */

int calx_table_append(struct calx_table *t, const double *row, struct calx_error *e)
{
    off_t start = ftello(t->stream);
    for (size_t i = 0; i < t->columns; i++)
        fprintf(t->stream, i ? ",%.17g" : "%.17g", isnan(row[i]) ? NAN : row[i]); /* never "-nan" */
    fputc('\n', t->stream);
    if (start < 0 || fflush(t->stream) || ferror(t->stream))
        return fail(t, "write", e);
    t->time = row[0];
    t->row = start;
    return CALX_OK;
}

int calx_table_write(struct calx_table *t, const double *row, struct calx_error *e)
{
    bool replaces = row[0] == t->time;
    if (replaces && (fseeko(t->stream, t->row, SEEK_SET) || ftruncate(fileno(t->stream), t->row)))
        return fail(t, "write", e);
    return calx_table_append(t, row, e);
}

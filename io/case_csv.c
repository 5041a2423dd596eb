/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <csv>: bodies from a table. Input: a text file in SI units, one body per line, numbers separated
 * by commas, semicolons or blanks; the first line (or the attribute `columns`) names the columns;
 * lines that start with # are skipped. Output: bodies.
 */
#include "io/case_bodies.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_COLUMNS 16
#define LONGEST_LINE 4096

enum column { X, Y, Z, RADIUS, VX, VY, VZ, WX, WY, WZ, TEMPERATURE, FIXED, COLUMN_COUNT };
static const char *const column_names[COLUMN_COUNT] = {
    "x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz", "temperature", "fixed"};

struct table {
    struct calx_bed *bed;
    struct calx_group *group;
    FILE *file;
    char *path;
    int line;
    size_t column_count;
    enum column columns[MOST_COLUMNS];
    bool has[COLUMN_COUNT];
    double scale, radius;
};

static void fail(struct table *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void fail(struct table *t, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    calx_problems_add(t->bed->reader->problems, (struct calx_place){t->path, t->line}, "csv: %s",
                      text);
}

/* ---- columns
 * ------------------------------------------------------------------------------------------- */

static bool add_column(struct table *t, const char *name)
{
    size_t k = 0;
    while (k < COLUMN_COUNT && strcmp(name, column_names[k]) != 0)
        k++;
    if (k == COLUMN_COUNT) {
        const char *nearest = calx_error_nearest(name, column_names, COLUMN_COUNT);
        fail(t,
             "no column '%.40s'%s%s, expected some of x y z radius vx vy vz wx wy wz temperature "
             "fixed",
             name, nearest ? ", nearest is " : "", nearest ? nearest : "");
        return false;
    }
    if (t->has[k] || t->column_count == MOST_COLUMNS) {
        fail(t, "column '%s' is there twice", name);
        return false;
    }
    t->has[k] = true;
    t->columns[t->column_count++] = (enum column)k;
    return true;
}

static bool read_columns(struct table *t, const char *text)
{
    const char *words[MOST_COLUMNS + 1];
    char *copy;
    size_t count = calx_case_split(text, ",;\"", &copy, words, MOST_COLUMNS + 1);
    bool good = true;
    for (size_t k = 0; k < count && good; k++)
        good = add_column(t, words[k]);
    free(copy);
    if (good &&
        (!t->has[X] || !t->has[Y] || (t->bed->reader->scene->dimension == 3 && !t->has[Z]))) {
        fail(t, "no column for each axis, expected x, y%s",
             t->bed->reader->scene->dimension == 3 ? ", z" : "");
        return false;
    }
    return good;
}

/* ---- rows
 * ---------------------------------------------------------------------------------------------- */

static void give(struct calx_start *start, const bool *has, const double *v, enum column first)
{
    for (size_t k = 0; k < 3; k++)
        if (has[first + k]) {
            start->given = true;
            start->random = 0;
            start->value[k] = v[first + k];
        }
}

static bool place_row(struct table *t, const double v[COLUMN_COUNT])
{
    struct calx_group *group = t->group;
    double at[3] = {v[X] * t->scale, v[Y] * t->scale, v[Z] * t->scale};
    double radius = t->has[RADIUS] ? v[RADIUS] * t->scale : t->radius;
    if (!(radius >= CALX_LEAST_RADIUS && radius <= CALX_LARGEST_RADIUS)) {
        fail(t, "radius %g m, expected at least %g and at most %g", radius, CALX_LEAST_RADIUS,
             CALX_LARGEST_RADIUS);
        return false;
    }
    if (fmax(fmax(fabs(at[0]), fabs(at[1])), fabs(at[2])) > CALX_FARTHEST_PLACE) {
        fail(t, "(%g, %g, %g) m is too far away, expected at most %g", at[0], at[1], at[2],
             CALX_FARTHEST_PLACE);
        return false;
    }
    if (group->carrier < 0) {
        give(&group->velocity, t->has, v, VX);
        give(&group->spin, t->has, v, WX);
    }
    if (t->has[TEMPERATURE]) {
        group->has_temperature = true;
        group->temperature = (struct calx_function){.value = v[TEMPERATURE]};
    }
    if (t->has[FIXED])
        group->fixed = v[FIXED] != 0;
    return calx_case_place_body(t->bed, group, at, radius) >= 0;
}

static bool read_row(struct table *t, const char *text, locale_t locale)
{
    const char *words[MOST_COLUMNS + 1];
    double v[COLUMN_COUNT] = {0};
    char *copy;
    size_t count = calx_case_split(text, ",;", &copy, words, MOST_COLUMNS + 1);
    bool good = count == t->column_count;
    if (!good)
        fail(t, "%zu numbers, expected %zu", count, t->column_count);
    for (size_t k = 0; k < count && good; k++) {
        char *end;
        v[t->columns[k]] = strtod_l(words[k], &end, locale);
        good = *end == '\0' && isfinite(v[t->columns[k]]);
        if (!good)
            fail(t, "'%.40s' in column %s, expected a finite number", words[k],
                 column_names[t->columns[k]]);
    }
    free(copy);
    return good && place_row(t, v);
}

static bool is_empty(const char *line)
{
    size_t blanks = strspn(line, " \t\r\n");
    return line[blanks] == '\0' || line[blanks] == '#';
}

static void read_lines(struct table *t, const char *columns, locale_t locale)
{
    char line[LONGEST_LINE];
    bool good = !columns || read_columns(t, columns), named = columns != NULL;
    while (good && fgets(line, sizeof line, t->file)) {
        t->line++;
        if (strlen(line) == sizeof line - 1) {
            fail(t, "a line has at most %d characters", LONGEST_LINE - 2);
            return;
        }
        if (is_empty(line))
            continue;
        good = named ? read_row(t, line, locale) : read_columns(t, line);
        named = true;
    }
    if (ferror(t->file))
        fail(t, "%s", strerror(errno));
    else if (good && !named)
        fail(t, "the file is empty");
}

void calx_case_read_csv(struct calx_bed *bed, struct calx_group *group)
{
    struct calx_reader *r = bed->reader;
    struct table t = {.bed = bed, .group = group, .path = calx_case_path(r, group->node, "file")};
    locale_t locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    t.scale = calx_case_number(r, group->node, "scale");
    t.radius = calx_case_bearer(group->node, "radius") ? calx_case_radius(r, group->node) : 0.0;
    t.file = t.path && locale ? fopen(t.path, "r") : NULL;
    if (t.file) {
        read_lines(&t, calx_case_given(group->node, "columns"), locale);
        fclose(t.file);
    }
    if (locale)
        freelocale(locale);
    free(t.path);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers, lengths, transform lists and view boxes of SVG attributes. Input: attribute text;
 * output: values in user units (1 px = 1/96 inch). Grammar: SVG 1.1 (W3C, 2011),
 * sections 4.2, 7.6, 7.8. The caller sets the C locale (io/svg.c).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_parts.h"

static const double pi = 3.14159265358979323846;
static const double px_per_inch = 96.0;

struct calx_svg_matrix calx_svg_text_compose(struct calx_svg_matrix outer,
                                             struct calx_svg_matrix inner)
{
    return (struct calx_svg_matrix){
        .a = outer.a * inner.a + outer.c * inner.b,
        .b = outer.b * inner.a + outer.d * inner.b,
        .c = outer.a * inner.c + outer.c * inner.d,
        .d = outer.b * inner.c + outer.d * inner.d,
        .e = outer.a * inner.e + outer.c * inner.f + outer.e,
        .f = outer.b * inner.e + outer.d * inner.f + outer.f,
    };
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

void calx_svg_text_skip(const char **text, bool comma)
{
    const char *s = *text;
    while (is_space(*s) || (comma && *s == ',')) {
        comma = comma && *s != ',';
        s++;
    }
    *text = s;
}

static const char *skip_digits(const char *s)
{
    while (is_digit(*s))
        s++;
    return s;
}

/* The end of the number that starts at s, or s. strtod alone would also take hexadecimal, inf and
 * nan. */
static const char *number_end(const char *s)
{
    const char *mantissa = s + (*s == '+' || *s == '-');
    const char *end = skip_digits(mantissa);
    size_t digits = (size_t)(end - mantissa);
    if (*end == '.') {
        const char *after = skip_digits(end + 1);
        digits += (size_t)(after - end) - 1;
        end = after;
    }
    if (digits == 0)
        return s;
    if (*end == 'e' || *end == 'E') {
        const char *power = end + 1 + (end[1] == '+' || end[1] == '-');
        if (is_digit(*power))
            end = skip_digits(power);
    }
    return end;
}

bool calx_svg_text_number(const char **text, double *value)
{
    const char *end = number_end(*text);
    if (end == *text)
        return false;
    char *stop;
    double number = strtod(*text, &stop);
    if (stop != end) /* only "0x..." is read further than the grammar allows: the number is the 0 */
        number = 0;
    if (!isfinite(number))
        return false;
    *value = number;
    *text = end;
    return true;
}

bool calx_svg_text_length(const char *text, double whole, double *value)
{
    const struct {
        const char *name;
        double px;
    } units[] = {
        {"", 1.0},
        {"px", 1.0},
        {"in", px_per_inch},
        {"cm", px_per_inch / 2.54},
        {"mm", px_per_inch / 25.4},
        {"Q", px_per_inch / 101.6},
        {"pt", px_per_inch / 72.0},
        {"pc", px_per_inch / 6.0},
        {"%", whole / 100.0},
    };
    double number;
    calx_svg_text_skip(&text, false);
    if (!calx_svg_text_number(&text, &number))
        return false;
    size_t length = strlen(text);
    while (length > 0 && is_space(text[length - 1]))
        length--;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strlen(units[i].name) == length && strncmp(text, units[i].name, length) == 0) {
            *value = number * units[i].px;
            return isfinite(*value);
        }
    }
    return false;
}

/* ---- transforms ---- */

static struct calx_svg_matrix make_matrix(const double *v, int count)
{
    (void)count;
    return (struct calx_svg_matrix){v[0], v[1], v[2], v[3], v[4], v[5]};
}

static struct calx_svg_matrix make_translate(const double *v, int count)
{
    return (struct calx_svg_matrix){1, 0, 0, 1, v[0], count > 1 ? v[1] : 0};
}

static struct calx_svg_matrix make_scale(const double *v, int count)
{
    return (struct calx_svg_matrix){v[0], 0, 0, count > 1 ? v[1] : v[0], 0, 0};
}

static struct calx_svg_matrix make_rotate(const double *v, int count)
{
    double c = cos(v[0] * pi / 180), s = sin(v[0] * pi / 180);
    double x = count > 1 ? v[1] : 0, y = count > 1 ? v[2] : 0;
    return (struct calx_svg_matrix){c, s, -s, c, x - c * x + s * y, y - s * x - c * y};
}

static struct calx_svg_matrix make_skew_x(const double *v, int count)
{
    (void)count;
    return (struct calx_svg_matrix){1, 0, tan(v[0] * pi / 180), 1, 0, 0};
}

static struct calx_svg_matrix make_skew_y(const double *v, int count)
{
    (void)count;
    return (struct calx_svg_matrix){1, tan(v[0] * pi / 180), 0, 1, 0, 0};
}

static const struct transform {
    const char *name;
    int few, many; /* the two counts of arguments that are allowed */
    struct calx_svg_matrix (*make)(const double *v, int count);
} transforms[] = {
    {"matrix", 6, 6, make_matrix}, {"translate", 1, 2, make_translate},
    {"scale", 1, 2, make_scale},   {"rotate", 1, 3, make_rotate},
    {"skewX", 1, 1, make_skew_x},  {"skewY", 1, 1, make_skew_y},
};

static const struct transform *find_transform(const char **text)
{
    for (size_t i = 0; i < sizeof transforms / sizeof *transforms; i++) {
        size_t length = strlen(transforms[i].name);
        if (strncmp(*text, transforms[i].name, length) == 0) {
            *text += length;
            return &transforms[i];
        }
    }
    return NULL;
}

/* Reads "( numbers )" into v; returns how many, or -1. */
static int read_arguments(const char **text, double v[6])
{
    int count = 0;
    calx_svg_text_skip(text, false);
    if (*(*text)++ != '(')
        return -1;
    calx_svg_text_skip(text, false);
    while (count < 6 && calx_svg_text_number(text, &v[count])) {
        count++;
        calx_svg_text_skip(text, true);
    }
    return *(*text)++ == ')' ? count : -1;
}

const char *calx_svg_text_transform(const char *text, struct calx_svg_matrix *matrix)
{
    struct calx_svg_matrix all = {1, 0, 0, 1, 0, 0};
    for (calx_svg_text_skip(&text, true); *text; calx_svg_text_skip(&text, true)) {
        const struct transform *kind = find_transform(&text);
        if (!kind)
            return "expected matrix, translate, scale, rotate, skewX or skewY";
        double v[6];
        int count = read_arguments(&text, v);
        if (count != kind->few && count != kind->many)
            return "wrong arguments of a transform";
        all = calx_svg_text_compose(all, kind->make(v, count));
    }
    *matrix = all;
    return NULL;
}

/* ---- viewports ---- */

bool calx_svg_text_view_box(const char *text, double box[4])
{
    for (int k = 0; k < 4; k++) {
        calx_svg_text_skip(&text, k > 0);
        if (!calx_svg_text_number(&text, &box[k]))
            return false;
    }
    calx_svg_text_skip(&text, false);
    return *text == 0 && box[2] > 0 && box[3] > 0;
}

/* Share of the free space that goes before the content: xMin 0, xMid 1/2 (the default), xMax 1. */
static double alignment(const char *aspect, const char *min, const char *max)
{
    if (aspect && strstr(aspect, min))
        return 0;
    return aspect && strstr(aspect, max) ? 1 : 0.5;
}

struct calx_svg_matrix calx_svg_text_viewport(const double viewport[4], const double box[4],
                                              const char *aspect)
{
    double sx = viewport[2] / box[2], sy = viewport[3] / box[3];
    if (!aspect || !strstr(aspect, "none"))
        sx = sy = aspect && strstr(aspect, "slice") ? fmax(sx, sy) : fmin(sx, sy);
    double free_x = viewport[2] - sx * box[2], free_y = viewport[3] - sy * box[3];
    return (struct calx_svg_matrix){
        sx,
        0,
        0,
        sy,
        viewport[0] + alignment(aspect, "xMin", "xMax") * free_x - sx * box[0],
        viewport[1] + alignment(aspect, "YMin", "YMax") * free_y - sy * box[1],
    };
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Path data of SVG: text to lines, cubic Beziers and elliptical arcs in a sink. Grammar and rules:
 * SVG 1.1 (W3C, 2011), section 8.3; arcs from end points to a centre: its appendix F.6.
 */
#include <math.h>
#include <string.h>

#include "io/svg_parts.h"

static const double pi = 3.14159265358979323846;

/* The control point of the command before, which S and T mirror: of a cubic, of a quadratic, or
 * none. */
enum handle { HANDLE_NONE, HANDLE_CUBIC, HANDLE_QUADRATIC };

struct pen {
    struct calx_svg_sink *sink;
    double at[2], start[2], control[2]; /* user units */
    enum handle handle;
    bool closed; /* the command before was Z: what draws next begins a subpath at `start` */
};

typedef int draw_function(struct pen *pen, const double *v, const double base[2]);

static int draw_move(struct pen *pen, const double *v, const double base[2])
{
    for (int k = 0; k < 2; k++)
        pen->start[k] = pen->at[k] = base[k] + v[k];
    pen->closed = false;
    return calx_svg_flatten_move(pen->sink, pen->at);
}

static int line_to(struct pen *pen, double x, double y)
{
    pen->at[0] = x;
    pen->at[1] = y;
    return calx_svg_flatten_line(pen->sink, pen->at);
}

static int draw_line(struct pen *pen, const double *v, const double base[2])
{
    return line_to(pen, base[0] + v[0], base[1] + v[1]);
}

static int draw_horizontal(struct pen *pen, const double *v, const double base[2])
{
    return line_to(pen, base[0] + v[0], pen->at[1]);
}

static int draw_vertical(struct pen *pen, const double *v, const double base[2])
{
    return line_to(pen, pen->at[0], base[1] + v[0]);
}

/* A cubic by its two handles and its end; the second handle is remembered. */
static int cubic_to(struct pen *pen, const double one[2], const double two[2], const double end[2])
{
    double p[4][2];
    for (int k = 0; k < 2; k++) {
        p[0][k] = pen->at[k];
        p[1][k] = one[k];
        p[2][k] = two[k];
        p[3][k] = end[k];
    }
    memcpy(pen->control, p[2], sizeof pen->control);
    memcpy(pen->at, p[3], sizeof pen->at);
    pen->handle = HANDLE_CUBIC;
    return calx_svg_flatten_cubic(pen->sink, p);
}

/* A quadratic is the cubic whose handles lie two thirds of the way to its one handle. */
static int quadratic_to(struct pen *pen, const double handle[2], const double end[2])
{
    double one[2], two[2];
    for (int k = 0; k < 2; k++) {
        one[k] = pen->at[k] + 2.0 / 3.0 * (handle[k] - pen->at[k]);
        two[k] = end[k] + 2.0 / 3.0 * (handle[k] - end[k]);
    }
    CALX_TRY(cubic_to(pen, one, two, end));
    memcpy(pen->control, handle, sizeof pen->control);
    pen->handle = HANDLE_QUADRATIC;
    return CALX_OK;
}

/* The handle of the curve before, mirrored at the present point; that point itself after anything
 * else. */
static void mirror(const struct pen *pen, enum handle kind, double out[2])
{
    for (int k = 0; k < 2; k++)
        out[k] = pen->handle == kind ? 2 * pen->at[k] - pen->control[k] : pen->at[k];
}

static void offset(const double *v, const double base[2], double out[2])
{
    out[0] = base[0] + v[0];
    out[1] = base[1] + v[1];
}

static int draw_cubic(struct pen *pen, const double *v, const double base[2])
{
    double one[2], two[2], end[2];
    offset(v, base, one);
    offset(v + 2, base, two);
    offset(v + 4, base, end);
    return cubic_to(pen, one, two, end);
}

static int draw_smooth_cubic(struct pen *pen, const double *v, const double base[2])
{
    double one[2], two[2], end[2];
    mirror(pen, HANDLE_CUBIC, one);
    offset(v, base, two);
    offset(v + 2, base, end);
    return cubic_to(pen, one, two, end);
}

static int draw_quadratic(struct pen *pen, const double *v, const double base[2])
{
    double handle[2], end[2];
    offset(v, base, handle);
    offset(v + 2, base, end);
    return quadratic_to(pen, handle, end);
}

static int draw_smooth_quadratic(struct pen *pen, const double *v, const double base[2])
{
    double handle[2], end[2];
    mirror(pen, HANDLE_QUADRATIC, handle);
    offset(v, base, end);
    return quadratic_to(pen, handle, end);
}

/* Appendix F.6.5 and F.6.6: half axes rx, ry (enlarged if they cannot reach), tilt phi, flags. */
static int arc_to(struct pen *pen, double rx, double ry, double phi, bool large, bool sweep,
                  const double end[2])
{
    double c = cos(phi), s = sin(phi);
    double hx = (pen->at[0] - end[0]) / 2, hy = (pen->at[1] - end[1]) / 2;
    double x = (c * hx + s * hy) / rx,
           y = (c * hy - s * hx) / ry; /* half the chord on the unit circle */
    double reach = hypot(x, y);
    if (reach > 1) {
        rx *= reach;
        ry *= reach;
        x /= reach;
        y /= reach;
        reach = 1;
    }
    double up = sqrt(fmax(0, 1 - reach * reach)) / reach * (large == sweep ? -1 : 1);
    double cx = up * y, cy = -up * x; /* the centre, seen from the middle of the chord */
    double from = atan2(y - cy, x - cx), turn = atan2(-y - cy, -x - cx) - from;
    if (sweep && turn < 0)
        turn += 2 * pi;
    if (!sweep && turn > 0)
        turn -= 2 * pi;
    double u[2] = {rx * c, rx * s}, v[2] = {-ry * s, ry * c};
    double centre[2];
    for (int k = 0; k < 2; k++)
        centre[k] = (pen->at[k] + end[k]) / 2 + u[k] * cx + v[k] * cy;
    memcpy(pen->at, end, sizeof pen->at);
    return calx_svg_flatten_arc(pen->sink, centre, u, v, from, turn, end);
}

static int draw_arc(struct pen *pen, const double *v, const double base[2])
{
    double end[2];
    offset(v + 5, base, end);
    double rx = fabs(v[0]), ry = fabs(v[1]);
    if (end[0] == pen->at[0] && end[1] == pen->at[1])
        return CALX_OK;
    if (rx == 0 || ry == 0)
        return line_to(pen, end[0], end[1]);
    return arc_to(pen, rx, ry, v[2] * pi / 180, v[3] != 0, v[4] != 0, end);
}

static int draw_close(struct pen *pen, const double *v, const double base[2])
{
    (void)v;
    (void)base;
    memcpy(pen->at, pen->start, sizeof pen->at);
    pen->closed = true;
    return calx_svg_flatten_end(pen->sink, true);
}

static const struct command {
    char name;         /* in lower case: relative */
    int count;         /* of numbers */
    unsigned flags;    /* bit k: number k is a flag, one digit 0 or 1 */
    enum handle keeps; /* the handle that this command leaves behind */
    draw_function *draw;
} commands[] = {
    {'m', 2, 0, HANDLE_NONE, draw_move},
    {'l', 2, 0, HANDLE_NONE, draw_line},
    {'h', 1, 0, HANDLE_NONE, draw_horizontal},
    {'v', 1, 0, HANDLE_NONE, draw_vertical},
    {'c', 6, 0, HANDLE_CUBIC, draw_cubic},
    {'s', 4, 0, HANDLE_CUBIC, draw_smooth_cubic},
    {'q', 4, 0, HANDLE_QUADRATIC, draw_quadratic},
    {'t', 2, 0, HANDLE_QUADRATIC, draw_smooth_quadratic},
    {'a', 7, 1 << 3 | 1 << 4, HANDLE_NONE, draw_arc},
    {'z', 0, 0, HANDLE_NONE, draw_close},
};

static const struct command *find_command(char letter)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if ((letter | 0x20) == commands[i].name)
            return &commands[i];
    return NULL;
}

static bool read_flag(const char **text, double *value)
{
    if (**text != '0' && **text != '1')
        return false;
    *value = *(*text)++ - '0';
    return true;
}

static bool read_numbers(const struct command *command, const char **text, double v[7])
{
    for (int k = 0; k < command->count; k++) {
        calx_svg_text_skip(text, k > 0);
        if (!(command->flags >> k & 1 ? read_flag(text, &v[k]) : calx_svg_text_number(text, &v[k])))
            return false;
    }
    return true;
}

static int draw_command(struct pen *pen, const struct command *command, const double *v,
                        bool relative)
{
    if (pen->closed && command->draw != draw_move) {
        pen->closed = false;
        CALX_TRY(calx_svg_flatten_move(pen->sink, pen->start));
    }
    const double origin[2] = {0, 0}, base[2] = {pen->at[0], pen->at[1]};
    CALX_TRY(command->draw(pen, v, relative ? base : origin));
    if (command->keeps == HANDLE_NONE)
        pen->handle = HANDLE_NONE;
    return CALX_OK;
}

static int fail(const struct pen *pen, const char *data, const char *text, const char *expected)
{
    return calx_error_at(pen->sink->error, CALX_ERROR_INPUT, pen->sink->place,
                         "path data: expected %s at character %zu, found \"%.16s\"", expected,
                         (size_t)(text - data) + 1, text);
}

/* True if more numbers follow: the command repeats. */
static bool repeats(const char **text)
{
    const char *peek = *text;
    double ignored;
    calx_svg_text_skip(&peek, true);
    if (!calx_svg_text_number(&peek, &ignored))
        return false;
    calx_svg_text_skip(text, true);
    return true;
}

int calx_svg_path_draw(struct calx_svg_sink *sink, const char *data)
{
    struct pen pen = {.sink = sink};
    const char *text = data;
    bool first = true;
    for (calx_svg_text_skip(&text, false); *text; calx_svg_text_skip(&text, false)) {
        const struct command *command = find_command(*text);
        if (!command)
            return fail(&pen, data, text, "a command, one of MmLlHhVvCcSsQqTtAaZz");
        if (first && command->draw != draw_move)
            return fail(&pen, data, text, "M or m first");
        bool relative = *text++ >= 'a';
        first = false;
        do {
            double v[7];
            if (!read_numbers(command, &text, v))
                return fail(&pen, data, text, "a number");
            CALX_TRY(draw_command(&pen, command, v, relative));
            if (command->draw == draw_move)
                command = find_command('l'); /* further pairs of a move are lines */
        } while (command->count > 0 && repeats(&text));
    }
    return calx_svg_flatten_end(sink, false);
}

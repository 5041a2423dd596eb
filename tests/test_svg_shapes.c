/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What an SVG file draws: commands and shapes against exact points, two spellings of one path,
 * curves against dense samples of their definition, insides and surfaces.
 */
#include "tests/drawing.h"

/* ---- straight commands and shapes: exact points ---- */

static const struct {
    const char *body;
    bool closed;
    size_t count; /* of points; a closed chain does not repeat the first */
    double points[8][2];
} lines[] = {
    {"<path d='M 1 2 L 3 4'/>", false, 2, {{1, 2}, {3, 4}}},
    {"<path d='m 1 2 l 3 4'/>", false, 2, {{1, 2}, {4, 6}}},
    {"<path d='M1,2 3,4 5,6'/>", false, 3, {{1, 2}, {3, 4}, {5, 6}}},
    {"<path d='m1,2 3,4 5,6'/>", false, 3, {{1, 2}, {4, 6}, {9, 12}}},
    {"<path d='M 1 2 H 5 V 7 h -2 v -1'/>", false, 5, {{1, 2}, {5, 2}, {5, 7}, {3, 7}, {3, 6}}},
    {"<path d='M 1 2 H 5 6 8 V 7 9'/>", false, 6, {{1, 2}, {5, 2}, {6, 2}, {8, 2}, {8, 7}, {8, 9}}},
    {"<path d='M1-2.5.5e-3'/>",
     false,
     0,
     {{0, 0}}}, /* a move and half a line: an error, tested below */
    {"<path d='M1-2.5L.5.25-1e1+2E+0'/>", false, 3, {{1, -2.5}, {.5, .25}, {-10, 2}}},
    {"<path d='M 0 0 L 4 0 4 4 Z'/>", true, 3, {{0, 0}, {4, 0}, {4, 4}}},
    {"<path d='M 0 0 L 4 0 4 4 0 0 z'/>", true, 3, {{0, 0}, {4, 0}, {4, 4}}},
    {"<path d='M 0 0 L 4 0 4 4 0 0'/>", true, 3, {{0, 0}, {4, 0}, {4, 4}}},
    {"<path d='M 0 0 L 4 0 4 0 4 4 4 4 Z'/>", true, 3, {{0, 0}, {4, 0}, {4, 4}}},
    {"<path d='M 0 0 L 4 0 4 4 0.000001 0 Z'/>", true, 3, {{0, 0}, {4, 0}, {4, 4}}},
    {"<path d='M 1 1 L 4 0 Z'/>", false, 2, {{1, 1}, {4, 0}}},
    {"<path d='M 9 9 M 1 1 L 4 0'/>", false, 2, {{1, 1}, {4, 0}}},
    {"<line x1='1' y1='2' x2='3' y2='4'/>", false, 2, {{1, 2}, {3, 4}}},
    {"<line x2='3'/>", false, 2, {{0, 0}, {3, 0}}},
    {"<polyline points='1,2 3 4, 5-6'/>", false, 3, {{1, 2}, {3, 4}, {5, -6}}},
    {"<polygon points='1,2 3 4, 5-6'/>", true, 3, {{1, 2}, {3, 4}, {5, -6}}},
    {"<rect x='1' y='2' width='3' height='4'/>", true, 4, {{1, 2}, {4, 2}, {4, 6}, {1, 6}}},
    {"<rect width='50%' height='10%'/>", true, 4, {{0, 0}, {50, 0}, {50, 10}, {0, 10}}},
    {"<path d='M 0 0 A 0 5 0 0 1 3 4'/>", false, 2, {{0, 0}, {3, 4}}},
    {"<path d='M 1 1 A 5 5 0 0 1 1 1 L 2 2'/>", false, 2, {{1, 1}, {2, 2}}},
    {"<path d='M 0 0 C 1 1 2 2 3 3'/>", false, 2, {{0, 0}, {3, 3}}},
    {"<path d='M 0 0 Q 1 1 2 2 T 4 4'/>", false, 3, {{0, 0}, {2, 2}, {4, 4}}},
};

START_TEST(test_lines)
{
    if (lines[_i].count == 0) {
        ck_assert_int_eq(read_body(lines[_i].body), CALX_ERROR_INPUT);
        return;
    }
    READ(read_body(lines[_i].body));
    ck_assert_uint_eq(svg.chain_count, 1);
    ck_assert_int_eq(svg.chains[0].closed, lines[_i].closed);
    ck_assert_int_eq(svg.closed, lines[_i].closed);
    size_t n = lines[_i].count;
    ck_assert_uint_eq(svg.segment_count, lines[_i].closed ? n : n - 1);
    for (size_t s = 0; s < svg.segment_count; s++) {
        for (int k = 0; k < 2; k++) {
            double sign = k == 0 ? 1 : -1;
            ck_assert_double_eq(svg.segments[s].a[k], sign * lines[_i].points[s][k]);
            ck_assert_double_eq(svg.segments[s].b[k], sign * lines[_i].points[(s + 1) % n][k]);
        }
    }
}
END_TEST

START_TEST(test_subpaths)
{
    READ(read_path("M 0 0 h 4 v 4 z m 10 0 h 1 v 1 z l -1 0 M 20 20 l 1 1"));
    static const struct {
        size_t count;
        bool closed;
        double start[2];
    } expected[] = {
        {3, true, {0, 0}}, {3, true, {10, 0}}, {1, false, {10, 0}}, {1, false, {20, -20}}};
    ck_assert_uint_eq(svg.chain_count, 4);
    for (int c = 0; c < 4; c++) {
        ck_assert_uint_eq(svg.chains[c].count, expected[c].count);
        ck_assert_int_eq(svg.chains[c].closed, expected[c].closed);
        ck_assert_double_eq(svg.segments[svg.chains[c].first].a[0], expected[c].start[0]);
        ck_assert_double_eq(svg.segments[svg.chains[c].first].a[1], expected[c].start[1]);
        for (size_t i = 0; i < svg.chains[c].count; i++)
            ck_assert_int_eq(svg.segments[svg.chains[c].first + i].chain, c);
    }
    ck_assert(!svg.closed);
}
END_TEST

/* ---- two spellings of one path ---- */

static const struct {
    const char *one, *two;
} same[] = {
    {"M 1 2 c 3 4 5 6 7 -8", "M 1 2 C 4 6 6 8 8 -6"},
    {"M 1 2 q 3 4 5 -6", "M 1 2 Q 4 6 6 -4"},
    {"M 0 0 Q 3 6 9 0", "M 0 0 C 2 4 5 4 9 0"},
    {"M 0 0 C 1 2 3 4 5 0 S 8 -4 9 0", "M 0 0 C 1 2 3 4 5 0 C 7 -4 8 -4 9 0"},
    {"M 0 0 c 1 2 3 4 5 0 s 3 -4 4 0", "M 0 0 C 1 2 3 4 5 0 C 7 -4 8 -4 9 0"},
    {"M 0 0 L 5 0 S 8 -4 9 0", "M 0 0 L 5 0 C 5 0 8 -4 9 0"},
    {"M 0 0 Q 2 4 5 0 T 10 0", "M 0 0 Q 2 4 5 0 Q 8 -4 10 0"},
    {"M 0 0 q 2 4 5 0 t 5 0 t 5 0", "M 0 0 Q 2 4 5 0 Q 8 -4 10 0 Q 12 4 15 0"},
    {"M 0 0 C 1 2 3 4 5 0 T 10 3",
     "M 0 0 C 1 2 3 4 5 0 L 10 3"}, /* no quadratic before: the handle is the point */
    {"M 0 0 Q 1 2 5 0 S 8 -4 9 0", "M 0 0 Q 1 2 5 0 C 5 0 8 -4 9 0"},
    {"M 1 1 a 5 4 30 1 0 3 2", "M 1 1 A 5 4 30 1 0 4 3"},
    {"M 1 1 a5 4 30 10 3 2", "M 1 1 A 5 4 30 1 0 4 3"},
    {"M1 1a5,4,30,0,1,3,2,5,4,30,0,1,3,2", "M1 1a5 4 30 013 2a5 4 30 013 2"},
    {"M 1 1 A -5 4 30 0 1 4 3", "M 1 1 A 5 4 30 0 1 4 3"},
    {"M 0 0 A 1 1 0 0 1 8 0", "M 0 0 A 4 4 0 0 1 8 0"}, /* too small a radius grows */
    {"M 0 0 C 1 2 3 4 5 0 1 2 3 4 5 9", "M 0 0 C 1 2 3 4 5 0 C 1 2 3 4 5 9"},
};

START_TEST(test_same)
{
    READ(read_path(same[_i].one));
    struct calx_svg one = svg;
    svg = (struct calx_svg){0};
    READ(read_path(same[_i].two));
    ck_assert_uint_eq(one.segment_count, svg.segment_count);
    ck_assert_uint_gt(one.segment_count, 3);
    for (size_t s = 0; s < svg.segment_count; s++) {
        ck_assert_double_eq_tol(one.segments[s].b[0], svg.segments[s].b[0], ROUNDING);
        ck_assert_double_eq_tol(one.segments[s].b[1], svg.segments[s].b[1], ROUNDING);
    }
    calx_svg_free(&one);
}
END_TEST

/* ---- curves: the tolerance ---- */

/* The true curves, by their definition. v: control points, or centre, half axes, tilt and angles in
 * degrees. */
static void bezier(const double *v, double t, double out[2])
{
    double p[8];
    memcpy(p, v, sizeof p);
    for (int n = 3; n > 0; n--)
        for (int k = 0; k < 2 * n; k++)
            p[k] += t * (p[k + 2] - p[k]);
    out[0] = p[0];
    out[1] = p[1];
}

static void ellipse(const double *v, double t, double out[2])
{
    double tilt = v[4] * M_PI / 180, angle = (v[5] + t * (v[6] - v[5])) * M_PI / 180;
    double x = v[2] * cos(angle), y = v[3] * sin(angle);
    out[0] = v[0] + cos(tilt) * x - sin(tilt) * y;
    out[1] = v[1] + sin(tilt) * x + cos(tilt) * y;
}

static const struct {
    const char *body;
    void (*curve)(const double *v, double t, double out[2]);
    double v[8];
} curves[] = {
    {"<path d='M 0 0 C 10 20 30 20 40 0'/>", bezier, {0, 0, 10, 20, 30, 20, 40, 0}},
    {"<path d='M 0 0 C 30 30 -20 30 10 0'/>", bezier, {0, 0, 30, 30, -20, 30, 10, 0}},
    {"<path d='M 0 0 C 0 0 0 20 30 5'/>", bezier, {0, 0, 0, 0, 0, 20, 30, 5}},
    {"<path d='M 0 0 C 40 0 0 0 40 1'/>", bezier, {0, 0, 40, 0, 0, 0, 40, 1}},
    {"<circle r='30'/>", ellipse, {0, 0, 30, 30, 0, 0, 360}},
    {"<circle cx='3' cy='-4' r='.5'/>", ellipse, {3, -4, .5, .5, 0, 0, 360}},
    {"<ellipse cx='1' cy='2' rx='40' ry='5'/>", ellipse, {1, 2, 40, 5, 0, 0, 360}},
    {"<ellipse cx='1' cy='2' rx='40' ry='5' transform='rotate(30)'/>",
     ellipse,
     {0.8660254037844386 - 1, 0.5 + 2 * 0.8660254037844386, 40, 5, 30, 0, 360}},
    {"<path d='M 10 0 A 10 10 0 0 1 0 10'/>", ellipse, {0, 0, 10, 10, 0, 0, 90}},
    {"<path d='M 10 0 A 10 10 0 1 0 0 10'/>", ellipse, {0, 0, 10, 10, 0, 0, -270}},
    {"<path d='M 10 0 A 10 10 0 0 0 0 10'/>", ellipse, {10, 10, 10, 10, 0, -90, -180}},
    {"<path d='M 10 0 A 10 10 0 1 1 0 10'/>", ellipse, {10, 10, 10, 10, 0, -90, 180}},
    {"<path d='M 20 0 A 20 10 0 0 1 -20 0'/>", ellipse, {0, 0, 20, 10, 0, 0, 180}},
    {"<path d='M 0 20 A 20 10 90 0 1 0 -20'/>", ellipse, {0, 0, 20, 10, 90, 0, 180}},
    {"<circle r='3' transform='scale(10 2)'/>", ellipse, {0, 0, 30, 6, 0, 0, 360}},
};

static double distance_to_segments(const double p[2])
{
    double least = INFINITY, away[2], x[3] = {p[0], p[1], 0};
    for (size_t s = 0; s < svg.segment_count; s++) {
        const double *a = svg.segments[s].a, *b = svg.segments[s].b;
        least = fmin(least, calx_region_edge((double[]){a[0], a[1], b[0], b[1]}, x, away));
    }
    return least;
}

START_TEST(test_tolerance)
{
    enum { SAMPLES = 4000 };
    const double tolerances[] = {1, 0.1, 0.01, 0.001};
    for (int k = 0; k < 4; k++) {
        options.tolerance = tolerances[k];
        READ(read_body(curves[_i].body));
        double farthest = 0, point[2];
        for (int i = 0; i <= SAMPLES; i++) {
            curves[_i].curve(curves[_i].v, (double)i / SAMPLES, point);
            point[1] = -point[1];
            farthest = fmax(farthest, distance_to_segments(point));
        }
        ck_assert_msg(farthest <= tolerances[k] + ROUNDING, "%s: %g beyond %g", curves[_i].body,
                      farthest, tolerances[k]);
        /* no waste: the bound of a Bezier is loose where its bend varies (by 15 in the S above),
         * and a circle has at least 4 chords */
        if (svg.segment_count > 4)
            ck_assert_msg(farthest >= tolerances[k] / 20, "%s: %g is far below %g", curves[_i].body,
                          farthest, tolerances[k]);
    }
}
END_TEST

/* Ends of segments lie on the curve, and the first and last are its ends. */
START_TEST(test_points_on_curve)
{
    READ(read_body(curves[_i].body));
    double from[2], to[2];
    curves[_i].curve(curves[_i].v, 0, from);
    curves[_i].curve(curves[_i].v, 1, to);
    const double *first = svg.segments[0].a, *last = svg.segments[svg.segment_count - 1].b;
    ck_assert_double_eq_tol(hypot(first[0] - from[0], first[1] + from[1]), 0, ROUNDING);
    ck_assert_double_eq_tol(hypot(last[0] - to[0], last[1] + to[1]), 0, ROUNDING);
    size_t n = svg.segment_count;
    for (size_t s = 0; s < n; s++) { /* equal steps of the parameter, in both kinds */
        double point[2];
        curves[_i].curve(curves[_i].v, (double)s / (double)n, point);
        ck_assert_double_eq_tol(
            hypot(svg.segments[s].a[0] - point[0], svg.segments[s].a[1] + point[1]), 0, ROUNDING);
    }
}
END_TEST

START_TEST(test_round_rect)
{
    static const char *const alike[] = {"rx='2'", "ry='2'", "rx='2' ry='2'", "rx='2' ry='auto'"};
    for (int k = 0; k < 4; k++) {
        char body[200];
        snprintf(body, sizeof body, "<rect x='1' y='2' width='10' height='6' %s/>", alike[k]);
        READ(read_body(body));
        ck_assert(svg.closed);
        ck_assert_int_eq(svg.surface_count, 1);
        const double corner[2] = {1 + 2 - sqrt(2),
                                  -(2 + 2 - sqrt(2))}; /* the middle of the first arc */
        ck_assert_double_le(distance_to_segments(corner), options.tolerance);
        ck_assert_double_ge(distance_to_segments((double[]){1, -2}), 2 * (sqrt(2) - 1) - ROUNDING);
    }
    READ(read_body("<rect width='10' height='6' rx='90' ry='90'/>")); /* clamped to an ellipse */
    ck_assert_double_le(distance_to_segments((double[]){5 - 5 * sqrt(.5), -3 - 3 * sqrt(.5)}),
                        options.tolerance);
}
END_TEST

/* ---- inside ---- */

static const struct {
    const char *body;
    double x, y;
    bool inside;
} insides[] = {
    {"<circle r='10'/>", 0, 0, true},
    {"<circle r='10'/>", 7, 7.2, false},
    {"<circle r='10'/>", 7, -7, true},
    {"<circle r='10'/><circle r='5'/>", 0, 0, false},
    {"<circle r='10'/><circle r='5'/>", 0, 7, true},
    {"<path d='M 0 0 H 20 V 20 H 0 Z M 5 5 H 10 V 10 H 5 Z'/>", 7, -7, false},
    {"<path d='M 0 0 H 20 V 20 H 0 Z M 5 5 H 10 V 10 H 5 Z'/>", 7, -12, true},
    {"<path d='M 0 0 H 20 V 20 H 10 V 5 H 0 Z'/>", 5, -10, false},
    {"<path d='M 0 0 H 20 V 20 H 10 V 5 H 0 Z'/>", 15, -10, true},
    {"<path d='M -10 0 A 10 10 0 0 0 10 0 Z'/>", 0, -5,
     true}, /* from left to right and anticlockwise on the screen: below */
    {"<path d='M -10 0 A 10 10 0 0 0 10 0 Z'/>", 0, 5, false},
};

START_TEST(test_inside)
{
    READ(read_body(insides[_i].body));
    ck_assert(svg.closed);
    struct calx_region region;
    calx_region_init(&region, 2);
    region.kind = CALX_REGION_OUTLINE;
    region.edge_count = svg.segment_count;
    region.edges = calloc(svg.segment_count, sizeof *region.edges);
    for (size_t s = 0; s < svg.segment_count; s++)
        memcpy(region.edges[s], svg.segments[s].a, sizeof *region.edges);
    ck_assert_int_eq(calx_region_holds(&region, (double[]){insides[_i].x, insides[_i].y, 0}, 0),
                     insides[_i].inside);
    calx_region_clear(&region);
}
END_TEST

/* ---- surfaces ---- */

static const struct {
    const char *body;
    int32_t surfaces;
} surfaces[] = {
    {"<circle r='10'/>", 1},
    {"<rect width='10' height='10'/>", 4},
    {"<rect width='10' height='10' rx='2'/>", 1},
    {"<path d='M -10 0 A 10 10 0 0 0 10 0 Z'/>", 2},
    {"<path d='M 0 0 H 10'/><path d='M 10 0 H 20'/>", 2},
    {"<path d='M 0 0 L 10 0 L 19.703 -2.419'/>", 1}, /* 14 degrees */
    {"<path d='M 0 0 L 10 0 L 19.613 -2.756'/>", 2}, /* 16 degrees */
    {"<path d='M 0 0 L 10 0 L 0 0.1'/>", 2},
    {"<path d='M 0 0 C 0 5 5 10 10 10 S 20 5 20 0'/>", 1},
    {"<path d='M 0 0 C 0 5 5 10 10 10 C 10 15 20 15 20 0'/>", 2},
    {"<path d='M 0 0 C 0 0 5 0 10 0 L 20 0'/>",
     1}, /* a handle of length 0 has a tangent all the same */
    {"<path d='M 10 0 A 10 10 0 0 1 -10 0 A 10 10 0 0 1 10 0'/>", 1},
    {"<path d='M 5 0 H 10 V 10 H 0 V 0 Z'/>", 4}, /* begins in the middle of a side */
};

START_TEST(test_surfaces)
{
    const double tolerances[] = {3, 0.3, 0.003}; /* a coarse circle is one surface too */
    for (int k = 0; k < 3; k++) {
        options.tolerance = tolerances[k];
        READ(read_body(surfaces[_i].body));
        ck_assert_int_eq(svg.surface_count, surfaces[_i].surfaces);
        for (size_t s = 0; s < svg.segment_count; s++) {
            ck_assert_int_ge(svg.segments[s].surface, 0);
            ck_assert_int_lt(svg.segments[s].surface, svg.surface_count);
        }
    }
}
END_TEST

START_TEST(test_surface_runs_through_the_start)
{
    READ(read_path("M 5 0 H 10 V 10 H 0 V 0 Z"));
    const int32_t expected[] = {0, 1, 2, 3, 0};
    ck_assert_uint_eq(svg.segment_count, 5);
    for (int s = 0; s < 5; s++)
        ck_assert_int_eq(svg.segments[s].surface, expected[s]);
}
END_TEST

/* Every chain of every table: joints are equal bit by bit, nothing has length zero. */
START_TEST(test_joints)
{
    READ(read_body(curves[_i].body));
    for (size_t c = 0; c < svg.chain_count; c++) {
        const struct calx_svg_segment *s = svg.segments + svg.chains[c].first;
        size_t n = svg.chains[c].count;
        for (size_t i = 0; i < n; i++) {
            ck_assert_double_gt(hypot(s[i].b[0] - s[i].a[0], s[i].b[1] - s[i].a[1]), 0);
            if (i + 1 < n || svg.chains[c].closed)
                ck_assert_mem_eq(s[i].b, s[(i + 1) % n].a, sizeof s->a);
        }
    }
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("svg_shapes");
    TCase *tcase = tcase_create("svg_shapes");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_lines, lines);
    tcase_add_test(tcase, test_subpaths);
    LOOP(test_same, same);
    LOOP(test_tolerance, curves);
    LOOP(test_points_on_curve, curves);
    tcase_add_test(tcase, test_round_rect);
    LOOP(test_inside, insides);
    LOOP(test_surfaces, surfaces);
    tcase_add_test(tcase, test_surface_runs_through_the_start);
    LOOP(test_joints, curves);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Where an SVG file draws: transforms, units, the page and its scale, nested viewports, use.
 */
#include "tests/drawing.h"

/* ---- transforms, units, pages ---- */

static const struct {
    const char *transform;
    double x, y; /* where (2, 1) goes */
} transforms[] = {
    {"", 2, 1},
    {"translate(3)", 5, 1},
    {"translate(3,-4)", 5, -3},
    {"translate(3-4)", 5, -3},
    {"scale(2)", 4, 2},
    {"scale(2 3)", 4, 3},
    {"scale(-1, 1)", -2, 1},
    {"rotate(90)", -1, 2},
    {"rotate(90, 1 1)", 1, 2},
    {"skewX(45)", 3, 1},
    {"skewY(45)", 2, 3},
    {"matrix(1 2 3 4 5 6)", 10, 14},
    {"translate(10 0) rotate(90)", 9, 2},
    {"rotate(90) translate(10 0)", -1, 12},
    {" translate( 1 , 2 ),scale(2)\trotate( 180 ) ", -3, 0},
};

START_TEST(test_transform)
{
    char body[400];
    snprintf(body, sizeof body, "<path d='M 2 1 l 1 0' transform='%s'/>", transforms[_i].transform);
    READ(read_body(body));
    ck_assert_double_eq_tol(svg.segments[0].a[0], transforms[_i].x, ROUNDING);
    ck_assert_double_eq_tol(svg.segments[0].a[1], -transforms[_i].y, ROUNDING);
    /* the same after another one, in nested groups */
    snprintf(body, sizeof body,
             "<g transform='translate(1 1)'><a><g transform='scale(3)'><g transform='%s'>"
             "<path d='M 2 1 l 1 0'/></g></g></a></g>",
             transforms[_i].transform);
    READ(read_body(body));
    ck_assert_double_eq_tol(svg.segments[0].a[0], 1 + 3 * transforms[_i].x, ROUNDING);
    ck_assert_double_eq_tol(svg.segments[0].a[1], -1 - 3 * transforms[_i].y, ROUNDING);
}
END_TEST

static const struct {
    const char *root;
    double scale;
    const char *point; /* attributes x2, y2 of a line from 0, 0 */
    double x, y;       /* where it goes, m */
    size_t warnings;
} pages[] = {
    {"width='100mm' height='60mm' viewBox='0 0 100 60'", 0, "x2='60' y2='20'", 0.01, 0.01, 0},
    {"width='100mm' height='60mm' viewBox='0 0 100 60'", 2, "x2='60' y2='20'", 20, 20, 0},
    {"width='100mm' height='60mm'", 0, "x2='60mm' y2='20mm'", 0.01, 0.01, 0},
    {"width='10cm' height='60mm' viewBox='0 0 1000 600'", 0, "x2='600' y2='200'", 0.01, 0.01, 0},
    {"width='4in' height='2in' viewBox='-2 -1 4 2'", 0, "x2='1' y2='-1'", 0.0254, 0.0254, 0},
    {"width='96' height='96'", 0, "x2='96' y2='0'", 0.0127, 0.0127, 0},
    {"width='96px' height='96px'", 0, "x2='1in' y2='0'", 0.0127, 0.0127, 0},
    {"width='72pt' height='6pc'", 0, "x2='25.4mm' y2='0'", 0.0127, 0.0127, 0},
    {"width='101.6Q' height='2.54cm'", 0, "x2='72pt' y2='0Q'", 0.0127, 0.0127, 0},
    {"width='96' height='96'", 0, "x2='100%' y2='0%'", 0.0127, 0.0127, 0},
    /* the smaller scale counts, and the middle stays the middle */
    {"width='200mm' height='60mm' viewBox='0 0 100 60'", 0, "x2='60' y2='20'", 0.01, 0.01, 0},
    {"width='200mm' height='60mm' viewBox='0 0 100 60' preserveAspectRatio='xMidYMid slice'", 0,
     "x2='60' y2='20'", 0.02, 0.02, 0},
    {"width='200mm' height='60mm' viewBox='0 0 100 60' preserveAspectRatio='none'", 0,
     "x2='60' y2='20'", 0.02, 0.01, 0},
    {"width='100mm' viewBox='0 0 100 60'", 0, "x2='60' y2='20'", 0.01, 0.01, 0},
    {"viewBox='0 0 96 96'", 0, "x2='96' y2='0'", 0.0127, 0.0127, 1},
    {"width='100%' height='100%' viewBox='0 0 96 96'", 0, "x2='96' y2='0'", 0.0127, 0.0127, 1},
    {"", 0, "x2='96' y2='-96'", 0.0254, 0.0254, 1},
    {"", 0.001, "x2='60' y2='-20'", 0.06, 0.02, 0},
};

START_TEST(test_page)
{
    char text[600];
    int n =
        snprintf(text, sizeof text, "<svg %s><line %s/></svg>", pages[_i].root, pages[_i].point);
    options.scale = pages[_i].scale;
    options.tolerance = 1e-5;
    READ(read_bytes(text, (size_t)n));
    ck_assert_double_eq_tol(svg.segments[0].b[0], pages[_i].x, ROUNDING);
    ck_assert_double_eq_tol(svg.segments[0].b[1], pages[_i].y, ROUNDING);
    ck_assert_uint_eq(svg.warning_count, pages[_i].warnings);
}
END_TEST

static const struct {
    const char *body;
    double x, y; /* where (2, 1) of the inner drawing goes */
} nested[] = {
    {"<svg x='10' y='5'>%s</svg>", 12, 6},
    {"<svg x='10' y='5' width='40' height='40' viewBox='0 0 4 4'>%s</svg>", 30, 15},
    {"<svg width='40' height='80' viewBox='0 0 4 4'>%s</svg>", 20, 30},
    {"<svg width='40' height='80' viewBox='0 0 4 4' preserveAspectRatio='xMinYMin'>%s</svg>", 20,
     10},
    {"<svg width='40' height='80' viewBox='0 0 4 4' preserveAspectRatio='xMidYMax meet'>%s</svg>",
     20, 50},
    {"<svg width='40' height='80' viewBox='0 0 4 4' preserveAspectRatio='xMinYMid slice'>%s</svg>",
     40, 20},
    {"<svg width='40' height='80' viewBox='0 0 4 4' preserveAspectRatio='none'>%s</svg>", 20, 20},
    {"<defs><g id='a'>%s</g></defs><use href='#a' x='3' y='4'/>", 5, 5},
    {"<defs><g id='a' transform='scale(2)'>%s</g></defs><use xlink:href='#a' x='3' y='4' "
     "transform='rotate(90)'/>",
     -6, 7},
    {"<symbol id='a' viewBox='0 0 4 4'>%s</symbol><use href='#a' x='3' y='4' width='8' "
     "height='8'/>",
     7, 6},
    {"<g visibility='hidden'><g visibility='visible'>%s</g></g>", 2, 1},
    {"<g style='display : inline ; visibility:visible'>%s</g>", 2, 1},
};

START_TEST(test_nested)
{
    char body[400];
    snprintf(body, sizeof body, nested[_i].body, "<path d='M 2 1 l 1 0'/>");
    READ(read_body(body));
    ck_assert_uint_eq(svg.segment_count, 1);
    ck_assert_double_eq_tol(svg.segments[0].a[0], nested[_i].x, ROUNDING);
    ck_assert_double_eq_tol(svg.segments[0].a[1], -nested[_i].y, ROUNDING);
    ck_assert_uint_eq(svg.warning_count, 0);
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("svg_page");
    TCase *tcase = tcase_create("svg_page");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_transform, transforms);
    LOOP(test_page, pages);
    LOOP(test_nested, nested);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

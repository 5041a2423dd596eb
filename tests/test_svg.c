/* SPDX-License-Identifier: BSD-3-Clause
 *
 * SVG files: wrong and hostile ones first, then warnings, a file as Inkscape writes it, and the
 * drums of the cases.
 */
#include "tests/drawing.h"

/* ---- wrong files ---- */

static const struct {
    const char *text;
    int line;
    const char *words;
} bad_files[] = {
    {"", 1, "not well-formed"},
    {"hello", 1, "not well-formed"},
    {"<svg", 1, "not well-formed"},
    {"<svg>\n<g>\n</svg>", 3, "not well-formed"},
    {"<html/>", 1, "expected an <svg> element, found <html>"},
    {"<svg/>", 1, "nothing is drawn"},
    {PAGE "\n<path d='M 0 0 L 1'/></svg>", 2, "expected a number at character 10"},
    {PAGE "<path d='L 1 1'/></svg>", 1, "expected M or m first"},
    {PAGE "<path d='M 0 0 X 1'/></svg>", 1,
     "expected a command, one of MmLlHhVvCcSsQqTtAaZz at character 7, found \"X 1\""},
    {PAGE "<path d='M 0 0 A 1 1 0 2 0 5 5'/></svg>", 1, "expected a number at character 15"},
    {PAGE "<path d='M 0 0 L inf 1'/></svg>", 1, "expected a number"},
    {PAGE "<path d='M 0 0 L nan 1'/></svg>", 1, "expected a number"},
    {PAGE "<path d='M 0 0 L 1e999 1'/></svg>", 1, "expected a number"},
    {PAGE "<path d='M 0 0 L 0x10 1'/></svg>", 1, "expected a number"},
    {PAGE "<path d='M 0 0 z 5'/></svg>", 1, "expected a command"},
    {PAGE "<path d='M 1e308 0 L 0 1' transform='scale(1e9)'/></svg>", 1,
     "a coordinate is too large"},
    {PAGE "<path d='M 0 0 C 1e30 0 0 1e30 1 1'/></svg>", 1, "raise the tolerance"},
    {PAGE "<polygon points='0,0 1'/></svg>", 1, "expected a pair of numbers, found \"1\""},
    {PAGE "<polyline points='0,0 1,1 a'/></svg>", 1, "expected a pair of numbers, found \"a\""},
    {PAGE "\n\n<circle r='-1'/></svg>", 3, "circle: r is negative"},
    {PAGE "<rect width='1em' height='2'/></svg>", 1, "width=\"1em\": expected a length"},
    {PAGE "<g transform='turn(3)'><circle r='1'/></g></svg>", 1,
     "expected matrix, translate, scale"},
    {PAGE "<g transform='rotate(3 4)'><circle r='1'/></g></svg>", 1, "wrong arguments"},
    {PAGE "<g transform='scale(2'><circle r='1'/></g></svg>", 1, "wrong arguments"},
    {"<svg viewBox='0 0 0 10'><circle r='1'/></svg>", 1, "viewBox"},
    {"<svg viewBox='0 0 10'><circle r='1'/></svg>", 1, "viewBox"},
    {"<svg width='-1mm' viewBox='0 0 10 10'><circle r='1'/></svg>", 1, "width is negative"},
    {PAGE "<g id='wall'><circle r='1'/></g></svg>", -1, "did you mean \"wall\""},
    /* entities: a bomb, a file, a parameter entity */
    {"<!DOCTYPE svg [<!ENTITY a 'aaaa'>\n<!ENTITY b '&a;&a;'>]><svg><path d='&b;'/></svg>", 1,
     "declares an entity"},
    {"<!DOCTYPE svg [<!ENTITY a SYSTEM 'file:///etc/passwd'>]><svg><text>&a;</text></svg>", 1,
     "declares an entity"},
    {"<!DOCTYPE svg [<!ENTITY % a SYSTEM 'http://127.0.0.1:1/a'>%a;]><svg/>", 1,
     "declares an entity"},
    /* a use that draws itself */
    {PAGE "<g id='a'><use href='#a'/></g></svg>", 1, "a use draws itself"},
};

START_TEST(test_bad_file)
{
    if (strstr(bad_files[_i].words, "did you mean"))
        options.id = "walls";
    int code = read_bytes(bad_files[_i].text, strlen(bad_files[_i].text));
    ck_assert_msg(code == CALX_ERROR_INPUT, "%s: read", bad_files[_i].text);
    ck_assert_int_eq(error.code, CALX_ERROR_INPUT);
    ck_assert_msg(strstr(error.text, bad_files[_i].words) != NULL, "%s: %s", bad_files[_i].text,
                  error.text);
    if (bad_files[_i].line >= 0)
        ck_assert_int_eq(error.line, bad_files[_i].line);
    ck_assert_ptr_null(svg.segments);
    ck_assert_uint_eq(svg.segment_count + svg.chain_count + svg.warning_count, 0);
}
END_TEST

START_TEST(test_bad_path_or_options)
{
    ck_assert_int_eq(calx_svg_read(in_folder("none.svg"), &options, &svg, &error),
                     CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "No such file"));
    ck_assert_int_eq(calx_svg_read(folder, &options, &svg, &error), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "Is a directory"));
    const double tolerances[] = {0, -1, NAN, INFINITY};
    for (int k = 0; k < 4; k++) {
        options.tolerance = tolerances[k];
        ck_assert_int_eq(read_path("M 0 0 1 1"), CALX_ERROR_INPUT);
    }
}
END_TEST

START_TEST(test_nul_bytes_and_cut_files)
{
    const char nul[] = PAGE "<path d='M 0 0 L 1 \0 1'/></svg>";
    ck_assert_int_eq(read_bytes(nul, sizeof nul - 1), CALX_ERROR_INPUT);
    const char whole[] = PAGE "<path d='M 0 0 C 1 1 2 2 3 0 Z'/></svg>";
    for (size_t n = 0; n < sizeof whole - 1; n++)
        ck_assert_int_eq(read_bytes(whole, n), CALX_ERROR_INPUT);
    READ(read_bytes(whole, sizeof whole - 1));
}
END_TEST

START_TEST(test_deep_nesting)
{
    static char text[20000];
    const int depths[] = {150, 230, 1000};
    for (int k = 0; k < 3; k++) {
        strcpy(text, PAGE);
        for (int i = 0; i < depths[k]; i++)
            strcat(text, "<g>");
        strcat(text, "<circle r='1'/>");
        for (int i = 0; i < depths[k]; i++)
            strcat(text, "</g>");
        strcat(text, "</svg>");
        ck_assert_int_eq(read_bytes(text, strlen(text)), k == 0 ? CALX_OK : CALX_ERROR_INPUT);
    }
}
END_TEST

/* Each level uses the one before ten times: 10^8 lines from a small file. */
START_TEST(test_use_bomb)
{
    static char text[20000];
    int n = snprintf(text, sizeof text, PAGE "<defs><path id='b0' d='M 0 0 0 0'/>");
    for (int level = 1; level <= 8; level++) {
        n += snprintf(text + n, sizeof text - (size_t)n, "<g id='b%d'>", level);
        for (int k = 0; k < 10; k++)
            n += snprintf(text + n, sizeof text - (size_t)n, "<use href='#b%d'/>", level - 1);
        n += snprintf(text + n, sizeof text - (size_t)n, "</g>");
    }
    n += snprintf(text + n, sizeof text - (size_t)n, "</defs><use href='#b8'/></svg>");
    ck_assert_int_lt(n, sizeof text);
    ck_assert_int_eq(read_bytes(text, (size_t)n), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "elements are drawn"));
}
END_TEST

/* ---- warnings ---- */

static const struct {
    const char *body, *words; /* NULL: no warning */
} warned[] = {
    {"<text x='1'>a</text>", "<text> is not read"},
    {"<image href='a.png'/>", "<image> is not read"},
    {"<foreignObject/>", "<foreignObject> is not read"},
    {"<switch><circle r='1'/></switch>", "<switch> is not read"},
    {"<use href='other.svg#a'/>", "use of \"other.svg#a\" is not drawn"},
    {"<use href='#nobody'/>", "use of \"#nobody\" is not drawn"},
    {"<style>.a { display: none }</style>", "the style sheet sets \"display\""},
    {"<defs><style>.a { visibility: hidden }</style></defs>",
     "the style sheet sets \"visibility\""},
    {"<defs><style>.a { transform: none }</style></defs>", "the style sheet sets \"transform\""},
    {"<circle r='2' clip-path='url(#a)'/>", "clip-path on <circle> is not applied"},
    {"<g style='mask:url(#a)'/>", "mask on <g> is not applied"},
    {"<circle r='2' style='fill:none;marker-end:url(#a)'/>", "marker-end on <circle> is not drawn"},
    {"<circle r='2' style='transform:scale(2)'/>", "transform in style on <circle> is not applied"},
    {"<pattern id='p'/><circle r='2' fill='url(#p)'/>",
     "the pattern that fills <circle> is not drawn"},
    {"<circle r='2'><animateTransform/></circle>", "<animateTransform> is not read"},
    {"<circle/>", "radius 0 draws nothing"},
    {"<rect width='3'/>", "draws nothing"},
    {"<g style='display:none'><text/></g>", NULL},
    {"<g display='none'><circle r='3'/></g>", NULL},
    {"<g visibility='hidden'><text/></g>", NULL},
    {"<style>.a { fill: none }</style>", NULL},
    {"<linearGradient id='p'/><circle r='2' fill='url(#p)'/>", NULL},
    {"<circle r='2' clip-path='none'/>", NULL},
    {"<title>a</title><desc>b</desc><metadata><x/></metadata>", NULL},
    {"<x:namedview "
     "xmlns:x='http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd'><x:guide/></x:namedview>",
     NULL},
};

START_TEST(test_warning)
{
    char body[600], expected[600];
    snprintf(body, sizeof body, "<path d='M 0 0 1 1'/>\n%s", warned[_i].body);
    READ(read_body(body));
    if (!warned[_i].words) {
        ck_assert_uint_eq(svg.warning_count, 0);
        return;
    }
    ck_assert_uint_eq(svg.warning_count, 1);
    snprintf(expected, sizeof expected, "%s:3: ", full_path);
    ck_assert_msg(strncmp(svg.warnings[0], expected, strlen(expected)) == 0, "%s", svg.warnings[0]);
    ck_assert_msg(strstr(svg.warnings[0], warned[_i].words) != NULL, "%s", svg.warnings[0]);
}
END_TEST

START_TEST(test_many_warnings)
{
    char *text = malloc(100000);
    strcpy(text, PAGE "<path d='M 0 0 1 1'/>");
    for (int i = 0; i < 3000; i++)
        strcat(text, "<text/>\n");
    strcat(text, "</svg>");
    READ(read_bytes(text, strlen(text)));
    free(text);
    ck_assert_uint_gt(svg.warning_count, 100);
    ck_assert_uint_lt(svg.warning_count, 1000);
    ck_assert_ptr_nonnull(
        strstr(svg.warnings[svg.warning_count - 1], "further warnings are left out"));
}
END_TEST

/* ---- whole files ---- */

static const char *source(const char *name)
{
    static char path[512];
    const char *root = getenv("CALX_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/%s", root ? root : ".", name);
    return path;
}

static const struct {
    const char *id;
    size_t chains, warnings;
    double first[2]; /* m: where the first chain starts */
} layers[] = {
    {NULL, 3, 1, {-0.05, 0.04}},     {"hopper", 1, 0, {-0.05, 0.04}},
    {"layer1", 1, 0, {-0.05, 0.04}}, {"old idea", 1, 0, {-0.1, 0.05}},
    {"pegs", 2, 1, {0.002, 0.02}},   {"use2", 1, 0, {-0.018, 0}},
};

START_TEST(test_inkscape)
{
    options = (struct calx_svg_options){.tolerance = 1e-5, .id = layers[_i].id};
    READ(calx_svg_read(source("tests/data/svg/inkscape.svg"), &options, &svg, &error));
    ck_assert_uint_eq(svg.chain_count, layers[_i].chains);
    ck_assert_uint_eq(svg.warning_count, layers[_i].warnings);
    ck_assert_double_eq_tol(svg.segments[0].a[0], layers[_i].first[0], ROUNDING);
    ck_assert_double_eq_tol(svg.segments[0].a[1], layers[_i].first[1], ROUNDING);
}
END_TEST

/* Cases 6 and 7: a drum of inner diameter 152.4 mm about the origin; flights 15 mm high with a lip
 * of 8 mm, towards where they turn. */
START_TEST(test_drums)
{
    const double DRAWN = 1e-8; /* m: the files have 5 digits of a millimetre */
    options = (struct calx_svg_options){.tolerance = 1e-5, .id = "shell"};
    const char *const files[] = {"cases/06-smooth-drum/drum.svg",
                                 "cases/07-drum-with-flights/flights.svg"};
    for (int k = 0; k < 2; k++) {
        READ(calx_svg_read(source(files[k]), &options, &svg, &error));
        ck_assert(svg.closed);
        ck_assert_int_eq(svg.surface_count, 1);
        for (size_t s = 0; s < svg.segment_count; s++)
            ck_assert_double_eq_tol(hypot(svg.segments[s].a[0], svg.segments[s].a[1]), 0.0762,
                                    DRAWN);
        calx_svg_free(&svg);
    }
    options.id = "flights";
    READ(calx_svg_read(source(files[1]), &options, &svg, &error));
    ck_assert_uint_eq(svg.chain_count, 8);
    ck_assert_uint_eq(svg.segment_count, 16);
    ck_assert_int_eq(svg.surface_count, 16);
    for (int f = 0; f < 8; f++) {
        const struct calx_svg_segment *s = svg.segments + 2 * f;
        ck_assert_double_eq_tol(hypot(s->a[0], s->a[1]), 0.0762, DRAWN);
        ck_assert_double_eq_tol(hypot(s->b[0], s->b[1]), 0.0762 - 0.015, DRAWN);
        double lip[2] = {s[1].b[0] - s[1].a[0], s[1].b[1] - s[1].a[1]};
        ck_assert_double_eq_tol(hypot(lip[0], lip[1]), 0.008, DRAWN);
        double turn =
            s->b[0] * lip[1] - s->b[1] * lip[0]; /* counter-clockwise, across the radius */
        ck_assert_double_eq_tol(turn, 0.008 * (0.0762 - 0.015), DRAWN);
    }
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("svg");
    TCase *tcase = tcase_create("svg");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_bad_file, bad_files);
    tcase_add_test(tcase, test_bad_path_or_options);
    tcase_add_test(tcase, test_nul_bytes_and_cut_files);
    tcase_add_test(tcase, test_deep_nesting);
    tcase_add_test(tcase, test_use_bomb);
    LOOP(test_warning, warned);
    tcase_add_test(tcase, test_many_warnings);
    LOOP(test_inkscape, layers);
    tcase_add_test(tcase, test_drums);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

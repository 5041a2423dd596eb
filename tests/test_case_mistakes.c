/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The case reader on bad input: one mistake at a time with the line and the words of its message,
 * all mistakes of a file in one go, and hostile files.
 */
#include <limits.h>

#include "tests/case_files.h"

/* ---- one mistake at a time
 * ------------------------------------------------------------------------------ */

/* A case without mistakes; each line may be replaced. */
static const struct {
    const char *name, *text;
} good_lines[] = {
    {"", ""}, /* lines count from 1 */
    {"CASE", "<case title='t' dimension='2'>"},
    {"MATERIAL", "<material name='copper' density='8900' specific-heat='172'/>"},
    {"WALL_MATERIAL", "<material name='steel'/>"},
    {"CONTACT", "<contact plugin='linear' stiffness='6000 N/m'><pair of='copper steel' "
                "restitution='0.5'/></contact>"},
    {"INTEGRATOR", "<integrator plugin='velocity-verlet'/>"},
    {"GRAVITY", "<gravity>0 -9.81</gravity>"},
    {"DOMAIN", "<domain low='-1 -1' high='1 1'/>"},
    {"WALLS", "<walls name='floor' material='steel'><segment from='0 0' to='1 0'/></walls>"},
    {"PARTICLES", "<particles material='copper'><particle at='0 0.1' radius='1 mm'/></particles>"},
    {"STAGE", "<stage name='fall' for='1 s'/>"},
    {"LATER", "<stage name='rest' until='kinetic-energy &lt; 1 nJ'/>"},
    {"OUTPUT", "<output every='1 ms'/>"},
    {"PROBE", "<probe name='height' of='position' particle='0' component='y'/>"},
    {"EXPECT", "<expect of='height' below='1 m'/>"},
    {"END", "</case>"},
};
enum { DOMAIN = 7, CONTACT = 4, PARTICLES = 9, OUTPUT = 12 };

/* The lines of tests/data/cases/mistakes.txt. */
#define MOST_MISTAKES 400
static struct mistake {
    char text[512];
    int line;
    const char *instead, *words[3];
} mistakes[MOST_MISTAKES];
static int mistake_count;

static int line_called(const char *name)
{
    for (int k = 1; k < COUNT(good_lines); k++)
        if (strcmp(good_lines[k].name, name) == 0)
            return k;
    return 0;
}

static void split_mistake(struct mistake *m)
{
    char *rest = m->text;
    m->text[strcspn(m->text, "\n")] = '\0';
    m->line = line_called(strsep(&rest, "|"));
    m->instead = strsep(&rest, "|");
    for (int w = 0; w < 3; w++)
        m->words[w] = strsep(&rest, "|");
}

static void load_mistakes(void)
{
    FILE *file = fopen(source_path("tests/data/cases/mistakes.txt"), "r");
    while (file && mistake_count < MOST_MISTAKES &&
           fgets(mistakes[mistake_count].text, sizeof mistakes->text, file))
        if (*mistakes[mistake_count].text != '#')
            split_mistake(&mistakes[mistake_count++]);
    if (file)
        fclose(file);
}

static void read_text(const char *text)
{
    put_file("case.xml", text);
    scene = calx_case_read(in_folder("case.xml"), registry, NULL, 0, &problems);
}

/* The good case with one line replaced. */
static void read_with(int line, const char *text)
{
    char whole[8192] = "";
    for (int k = 1; k < COUNT(good_lines); k++) {
        strcat(whole, k == line ? text : good_lines[k].text);
        strcat(whole, "\n");
    }
    ck_assert_uint_lt(strlen(whole), sizeof whole - 1);
    read_text(whole);
}

START_TEST(test_no_mistake)
{
    read_with(0, "");
    calx_problems_print(&problems, stderr);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(problems.count, 0);
}
END_TEST

START_TEST(test_mistake)
{
    const struct mistake *m = &mistakes[_i];
    bool found = false;
    ck_assert_msg(m->line && m->words[2], "mistakes.txt: %s", m->text);
    read_with(m->line, m->instead);
    ck_assert_msg(!scene, "not found: %s", m->instead);
    for (size_t k = 0; k < problems.kept && !found; k++) {
        found = problems.list[k].line == m->line && strstr(problems.list[k].file, "case.xml");
        for (int w = 0; w < 3; w++)
            found = found && strstr(problems.list[k].text, m->words[w]);
    }
    if (!found)
        calx_problems_print(&problems, stderr);
    ck_assert_msg(found, "line %d: %s", m->line, m->instead);
}
END_TEST

/* One mistake is one message: nothing follows from it, except that a name that is not there is
 * missed elsewhere. */
START_TEST(test_mistake_is_told_once)
{
    read_with(DOMAIN, "<domain low='0 0' high='1 1' periodic='q'/>");
    ck_assert_uint_eq(problems.count, 1);
    calx_problems_clear(&problems);
    read_with(CONTACT, "<contact plugin='liner' stiffness='1' restitution='0.5'/>");
    ck_assert_uint_eq(problems.count, 1);
    calx_problems_clear(&problems);
    read_with(PARTICLES, "<particles material='copper'><csv file='missing.csv'/></particles>");
    ck_assert_uint_eq(problems.count, 1);
}
END_TEST

START_TEST(test_all_mistakes_in_one_go)
{
    const int lines[] = {1, 2, 4, 6, 8, 9, 10, 12, 13, 14};
    read_text("<case dimension='2' foo='1'>\n<material name='copper' density='1 m' "
              "specific-heat='172'/>\n"
              "<material name='steel'/>\n<contact plugin='linear' stiffness='-1'/>\n"
              "<integrator plugin='velocity-verlet'/>\n<gravity>0 q</gravity>\n<domain/>\n"
              "<walls name='floor' material='stel'><plane normal='0 1'/></walls>\n"
              "<particles material='copper'><particle at='0' radius='1'/></particles>\n<stage "
              "for='1 m'/>\n\n"
              "<output every='1 m'/>\n<probe name='p' of='nothing'/>\n<expect of='nothing' "
              "value='1'/>\n</case>\n");
    ck_assert_ptr_null(scene);
    if (problems.count != COUNT(lines))
        calx_problems_print(&problems, stderr);
    ck_assert_uint_eq(problems.count, COUNT(lines));
    for (int k = 0; k < COUNT(lines); k++)
        ck_assert_int_eq(problems.list[k].line, lines[k]); /* in the order of the file */
}
END_TEST

/* A tag over several lines has the line where it begins; behind 70000 lines too. */
START_TEST(test_lines)
{
    static char text[80000] = "<case";
    read_text("<case\n dimension='2'\n foo='1'\n>\n<matter\n name='a'\n b='2'/></case>");
    ck_assert_int_eq(problems.list[0].line, 1);
    ck_assert_int_eq(problems.list[problems.count - 1].line, 5);
    calx_problems_clear(&problems);
    memset(text + 5, '\n', 70000);
    strcat(text, ">\n<matter/></case>");
    read_text(text);
    ck_assert_int_ge(problems.list[problems.count - 1].line, USHRT_MAX);
}
END_TEST

START_TEST(test_printed_form)
{
    char *text = NULL, expected[600];
    size_t size = 0;
    read_with(OUTPUT, "<output every='1 m'/>");
    FILE *out = open_memstream(&text, &size);
    ck_assert_ptr_nonnull(out);
    calx_problems_print(&problems, out);
    fclose(out);
    snprintf(expected, sizeof expected,
             "%s:%d: output: every: unit 'm' where one like 's' is expected\n",
             in_folder("case.xml"), OUTPUT);
    ck_assert_str_eq(text, expected);
    free(text);
}
END_TEST

/* ---- tables of bodies
 * ----------------------------------------------------------------------------------- */

static const struct {
    const char *text;
    int line;
    const char *words[2];
} tables[] = {
    {"", 0, {"empty", ""}},
    {"# only a remark\n", 1, {"empty", ""}},
    {"x,y,raduis\n", 1, {"'raduis'", "radius"}},
    {"x,radius\n", 1, {"each axis", "x, y"}},
    {"x,y,x\n", 1, {"'x'", "twice"}},
    {"x,y,radius\n1,2\n", 2, {"2 numbers", "expected 3"}},
    {"x,y,radius\n1,2,3,4\n", 2, {"4 numbers", "expected 3"}},
    {"x,y,radius\n1,2,a\n", 2, {"'a'", "radius"}},
    {"x,y,radius\n1,nan,1\n", 2, {"'nan'", "finite"}},
    {"x,y,radius\n\n1,2,-1\n", 3, {"radius -1", "at least 1e-12"}},
    {"x,y,radius\n1e10,2,1\n", 2, {"1e+10", "too far"}},
    {"x,y\n1,2\n", 2, {"radius 0", "at least 1e-12"}},
};

START_TEST(test_tables)
{
    bool found = false;
    put_file("bodies.csv", tables[_i].text);
    read_with(PARTICLES, "<particles material='copper'><csv file='bodies.csv'/></particles>");
    ck_assert_ptr_null(scene);
    for (size_t k = 0; k < problems.kept; k++)
        found |= problems.list[k].line == tables[_i].line &&
                 strstr(problems.list[k].file, "bodies.csv") &&
                 strstr(problems.list[k].text, tables[_i].words[0]) &&
                 strstr(problems.list[k].text, tables[_i].words[1]);
    if (!found)
        calx_problems_print(&problems, stderr);
    ck_assert(found);
}
END_TEST

/* ---- hostile files
 * ------------------------------------------------------------------------------------- */

#define LAUGHS(n, m)                                                                               \
    "<!ENTITY l" #n " \"&l" #m ";&l" #m ";&l" #m ";&l" #m ";&l" #m ";&l" #m ";&l" #m ";&l" #m ";"  \
    "\""                                                                                           \
    ">"

static const struct {
    const char *text;
    size_t size; /* 0: up to the end of the string */
    int line;
    const char *word;
} hostile[] = {
    {"", 0, 0, "empty"},
    {"not XML", 0, 1, "XML"},
    {"<case>", 0, 1, "XML"},
    {"<case>\n<material", 0, 2, "XML"},
    {"<case>\n</cas>", 0, 2, "XML"},
    {"<case>\n\0</case>", 16, 2, "zero byte"},
    {"<case a='1'\n a='2'/>", 0, 2, "XML"},
    {"<case>&undeclared;</case>", 0, 1, "XML"},
    {"<case title='\xff\xfe'/>", 0, 1, "XML"},
    {"<!DOCTYPE case SYSTEM 'http://192.0.2.1/x.dtd'>\n<case/>", 0, 1, "document type"},
    {"<?xml version='1.0'?>\n<!DOCTYPE case [<!ENTITY f SYSTEM 'file:///etc/passwd'>]>\n<case "
     "title='&f;'/>",
     0, 2, "document type"},
    {"<!DOCTYPE case [<!ENTITY l0 \"ha\">" LAUGHS(1, 0) LAUGHS(2, 1) LAUGHS(3, 2) LAUGHS(4, 3)
         LAUGHS(5, 4) LAUGHS(6, 5) LAUGHS(7, 6) LAUGHS(8, 7)
             LAUGHS(9, 8) "]>\n<case title='&l9;'>&l9;</case>",
     0, 1, "document type"},
    {"<drawing/>", 0, 1, "expected <case>"},
    {"<case xmlns:xi='http://www.w3.org/2001/XInclude'>\n<xi:include href='/etc/passwd' "
     "parse='text'/></case>",
     0, 2, "include"},
};

static void read_bytes(const char *text, size_t size)
{
    FILE *file = fopen(in_folder("hostile.xml"), "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(text, 1, size, file), size);
    fclose(file);
    scene = calx_case_read(in_folder("hostile.xml"), registry, NULL, 0, &problems);
    ck_assert_ptr_null(scene);
    ck_assert_uint_gt(problems.count, 0);
}

static bool has_problem(int line, const char *word)
{
    for (size_t k = 0; k < problems.kept; k++)
        if (problems.list[k].line == line && strstr(problems.list[k].text, word))
            return true;
    calx_problems_print(&problems, stderr);
    return false;
}

START_TEST(test_hostile)
{
    read_bytes(hostile[_i].text, hostile[_i].size ? hostile[_i].size : strlen(hostile[_i].text));
    ck_assert(has_problem(hostile[_i].line, hostile[_i].word));
}
END_TEST

START_TEST(test_deep_nesting)
{
    char *text = malloc(1000001);
    ck_assert_ptr_nonnull(text);
    for (size_t k = 0; k < 1000000; k += 4)
        memcpy(text + k, "<a> ", 4);
    read_bytes(text, 1000000);
    free(text);
    ck_assert(has_problem(1, "depth"));
}
END_TEST

START_TEST(test_missing_file_and_folder)
{
    ck_assert_ptr_null(calx_case_read(in_folder("missing.xml"), registry, NULL, 0, &problems));
    ck_assert(has_problem(0, "No such file"));
    calx_problems_clear(&problems);
    ck_assert_ptr_null(calx_case_read(folder, registry, NULL, 0, &problems));
    ck_assert(has_problem(0, "not a file"));
}
END_TEST

/* Every prefix of a good file, and every good file with one byte changed, is read or refused. */
START_TEST(test_truncated_and_changed)
{
    static char text[8192];
    FILE *file = fopen(source_path("tests/data/cases/everything.xml"), "rb");
    ck_assert_ptr_nonnull(file);
    size_t size = fread(text, 1, sizeof text, file);
    fclose(file);
    ck_assert_uint_lt(size, sizeof text);
    for (size_t cut = 1; cut + 2 < size; cut += 61) {
        read_bytes(text, cut);
        calx_problems_clear(&problems);
    }
    for (size_t at = 0; at < size; at += 37) {
        char before = text[at];
        text[at] = (char)('!' + at % 90);
        FILE *changed = fopen(in_folder("changed.xml"), "wb");
        ck_assert_ptr_nonnull(changed);
        fwrite(text, 1, size, changed);
        fclose(changed);
        scene = calx_case_read(in_folder("changed.xml"), registry, NULL, 0, &problems);
        ck_assert((scene == NULL) == (problems.count > 0));
        calx_scene_free(scene);
        scene = NULL;
        calx_problems_clear(&problems);
        text[at] = before;
    }
}
END_TEST

static void add_tests(TCase *cases)
{
    tcase_add_loop_test(cases, test_hostile, 0, COUNT(hostile));
    tcase_add_test(cases, test_deep_nesting);
    tcase_add_test(cases, test_missing_file_and_folder);
    tcase_add_test(cases, test_truncated_and_changed);
    tcase_add_loop_test(cases, test_mistake, 0, mistake_count);
    tcase_add_loop_test(cases, test_tables, 0, COUNT(tables));
    tcase_add_test(cases, test_mistake_is_told_once);
    tcase_add_test(cases, test_all_mistakes_in_one_go);
    tcase_add_test(cases, test_printed_form);
    tcase_add_test(cases, test_lines);
    tcase_add_test(cases, test_no_mistake);
}

int main(void)
{
    load_mistakes();
    if (!mistake_count)
        return EXIT_FAILURE;
    return run_suite("case_mistakes", add_tests);
}

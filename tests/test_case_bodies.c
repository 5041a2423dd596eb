/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Bodies that a case places: every region and distribution of <pack>, levels, grids and tables in
 * 3D, seeds; and what a case leaves out: a frozen bed, the default integrator of temperature,
 * stages that end at a time.
 */
#include <math.h>

#include "tests/case_files.h"

#define CASE_3D                                                                                    \
    "<case dimension='3'><material name='m' density='1' specific-heat='1' conductivity='1'/>"      \
    "<stage until='1 s'/>"
#define DOMAIN_3D "<domain low='-1 -1 0' high='1 1 0.5' periodic='z'/>"
#define DRUM "<walls name='drum' material='m'><cylinder radius='0.1' axis='0 0 2'/></walls>"

static void read_text(const char *text)
{
    put_file("case.xml", text);
    scene = calx_case_read(in_folder("case.xml"), registry, NULL, 0, &problems);
    if (!scene)
        calx_problems_print(&problems, stderr);
    ck_assert_ptr_nonnull(scene);
}

static void read_pack(const char *pack)
{
    char text[2048];
    snprintf(text, sizeof text,
             CASE_3D DOMAIN_3D DRUM "<particles material='m' seed='3'>%s</particles></case>", pack);
    read_text(text);
}

/* ---- regions
 * ------------------------------------------------------------------------------------------- */

static double along(const double x[3], double radius)
{
    return hypot(x[0], x[1]) + radius;
}

static bool in_drum(const double x[3], double radius)
{
    return along(x, radius) <= 0.1 && x[2] >= 0 && x[2] <= 0.5; /* z is periodic: centres only */
}

static bool in_half_drum(const double x[3], double radius)
{
    return in_drum(x, radius) && x[1] + radius <= 0;
}

static bool in_box(const double x[3], double radius)
{
    return fmax(fmax(fabs(x[0]), fabs(x[1])), fabs(x[2] - 0.2)) + radius <= 0.1 * (1 + 1e-12);
}

static bool in_sphere(const double x[3], double radius)
{
    return sqrt(x[0] * x[0] + x[1] * x[1] + (x[2] - 0.2) * (x[2] - 0.2)) + radius <= 0.1;
}

static bool in_lying_cylinder(const double x[3], double radius)
{
    return hypot(x[1], x[2] - 0.2) + radius <= 0.1 && fabs(x[0]) + radius <= 0.15 * (1 + 1e-12);
}

static const struct {
    const char *text;
    bool (*holds)(const double x[3], double radius);
} regions[] = {
    {"<pack inside='drum' count='40' radius='5 mm'/>", in_drum},
    {"<pack inside='drum' count='40' radius='5 mm' level='0'/><!-- up is against gravity -->",
     in_half_drum},
    {"<pack box='-0.1 -0.1 0.1 0.1 0.1 0.3' count='40' radius='5 mm'/>", in_box},
    {"<pack sphere='0 0 0.2 0.1' count='40' radius='5 mm'/>", in_sphere},
    {"<pack cylinder='0 0 0.2 0.1 0.3' axis='2 0 0' count='40' radius='5 mm'/>", in_lying_cylinder},
    {"<pack cylinder='0 0 0.25 0.1 0' count='40' radius='5 mm'/>", in_drum},
};

START_TEST(test_regions)
{
    char text[2048];
    snprintf(text, sizeof text,
             CASE_3D DOMAIN_3D DRUM
             "<gravity>0 -9.81 0</gravity><particles material='m' seed='3'>%s</particles></case>",
             regions[_i].text);
    read_text(text);
    const struct calx_particles *p = &scene->particles;
    ck_assert_uint_eq(p->count, 40);
    for (size_t i = 0; i < p->count; i++)
        ck_assert_msg(regions[_i].holds(p->position[i], p->radius[i]), "%g %g %g",
                      p->position[i][0], p->position[i][1], p->position[i][2]);
}
END_TEST

/* The larger extent of the region is used: a wrong radius of it would leave the outer part empty.
 */
START_TEST(test_region_is_used)
{
    double farthest = 0;
    read_pack("<pack inside='drum' count='400' radius='2 mm'/>");
    for (size_t i = 0; i < scene->particles.count; i++)
        farthest = fmax(farthest, along(scene->particles.position[i], 0.002));
    ck_assert_double_gt(
        farthest, 0.095); /* of 400 places in a disc, none beyond 0.93 of it: 0.86^400 = 1e-26 */
}
END_TEST

/* ---- radii
 * --------------------------------------------------------------------------------------------- */

/* Means over 400 radii; the tolerance is five standard errors, deviation/sqrt(400). */
static const struct {
    const char *radius;
    double mean, deviation, least, largest;
} distributions[] = {
    {"2 mm", 2e-3, 0, 2e-3, 2e-3},
    {"uniform 1 mm 3 mm", 2e-3, 0.58e-3, 1e-3, 3e-3},
    {"uniform 1 3 mm", 2e-3, 0.58e-3, 1e-3, 3e-3},
    {"normal 2 0.2 mm", 2e-3, 0.2e-3, 1e-3, 3e-3},
    {"normal 2 0.2 1.9 2.1 mm", 2e-3, 0.06e-3, 1.9e-3, 2.1e-3},
    {"lognormal 2 0.3 mm", 2e-3, 0.3e-3, 0.5e-3, 5e-3},
    {"lognormal 2 0.3 1 4 mm", 2e-3, 0.3e-3, 1e-3, 4e-3},
    /* shares of mass w: numbers go as w/d^3, here 8 of 1 mm to 1 of 2 mm */
    {"masses 2 mm 0.5 4 mm 0.5", (8e-3 + 2e-3) / 9, 0.32e-3, 1e-3, 2e-3},
    {"masses 0.002 1 4mm 1", (8e-3 + 2e-3) / 9, 0.32e-3, 1e-3, 2e-3},
};

START_TEST(test_distributions)
{
    char pack[256];
    double sum = 0;
    snprintf(pack, sizeof pack, "<pack inside='drum' count='400' radius='%s'/>",
             distributions[_i].radius);
    read_pack(pack);
    ck_assert_uint_eq(scene->particles.count, 400);
    for (size_t i = 0; i < 400; i++) {
        double radius = scene->particles.radius[i];
        ck_assert(radius >= distributions[_i].least && radius <= distributions[_i].largest);
        sum += radius;
    }
    ck_assert_double_eq_tol(sum / 400, distributions[_i].mean,
                            5 * distributions[_i].deviation / 20 + 1e-15);
}
END_TEST

START_TEST(test_fill)
{
    double volume = 0;
    read_pack("<pack box='-0.1 -0.1 0.1 0.1 0.1 0.3' fill='0.1' radius='5 mm'/>");
    for (size_t i = 0; i < scene->particles.count; i++)
        volume += 4.0 / 3.0 * acos(-1) * pow(scene->particles.radius[i], 3);
    ck_assert_double_eq_tol(volume / 0.008, 0.1,
                            4.0 / 3.0 * acos(-1) * pow(0.005, 3) / 0.008); /* one body */
}
END_TEST

/* ---- seeds, velocities
 * --------------------------------------------------------------------------------- */

static double first_place(const char *pack)
{
    read_pack(pack);
    double x = scene->particles.position[0][0];
    calx_scene_free(scene);
    scene = NULL;
    return x;
}

START_TEST(test_seeds)
{
    double x = first_place("<pack inside='drum' count='5' radius='5 mm'/>");
    ck_assert_double_eq(first_place("<pack inside='drum' count='5' radius='5 mm'/>"), x);
    ck_assert_double_ne(first_place("<pack inside='drum' count='5' radius='5 mm' seed='4'/>"), x);
    read_pack("<pack inside='drum' count='5' radius='5 mm'/><pack inside='drum' count='5' "
              "radius='5 mm'/>");
    ck_assert_double_ne(scene->particles.position[0][0], scene->particles.position[5][0]);
}
END_TEST

START_TEST(test_random_velocities)
{
    int negative = 0;
    read_pack(
        "<pack inside='drum' count='100' radius='2 mm' velocity='random 1 m/s' spin='random 2'/>");
    for (size_t i = 0; i < 100; i++)
        for (int k = 0; k < 3; k++) {
            ck_assert_double_le(fabs(scene->particles.velocity[i][k]), 1);
            ck_assert_double_le(fabs(scene->particles.spin[i][k]), 2);
            negative += scene->particles.velocity[i][k] < 0;
        }
    ck_assert_int_gt(negative, 100); /* of 300, half: 150 - 6 deviations of sqrt(300)/2 */
    ck_assert_int_lt(negative, 200);
}
END_TEST

/* ---- grids, tables
 * ------------------------------------------------------------------------------------- */

START_TEST(test_grid_to_a_corner)
{
    read_pack("<grid from='0 0 0.1' to='0.3 0.1 0.1' radius='0.05'/>"); /* 0.3/0.1 is below 3 in
                                                                           doubles */
    ck_assert_uint_eq(scene->particles.count, 4 * 2 * 1);
    ck_assert_double_eq_tol(scene->particles.position[7][0], 0.3, 1e-15);
    ck_assert_double_eq_tol(scene->particles.position[7][1], 0.1, 1e-15);
    ck_assert_ptr_null(scene->particles.velocity);
    ck_assert_ptr_null(scene->particles.temperature);
    ck_assert_ptr_null(scene->particles.fixed);
}
END_TEST

START_TEST(test_table_with_columns)
{
    put_file("bodies.csv", "0.1;0.2;0.3;0.01\n0.4 0.5 0.2 0.02\n");
    read_pack("<csv file='bodies.csv' columns='x y z radius'/>");
    ck_assert_uint_eq(scene->particles.count, 2);
    ck_assert_double_eq(scene->particles.position[1][1], 0.5);
    ck_assert_double_eq(scene->particles.radius[1], 0.02);
}
END_TEST

/* ---- what a case leaves out
 * ---------------------------------------------------------------------------- */

#define SPHERE "<particles material='m'><particle at='0 0 0' radius='1 mm'/></particles>"

START_TEST(test_defaults)
{
    read_text(CASE_3D "<conductance plugin='overlap'/>" SPHERE
                      "<stage name='b' until='3 s'/></case>");
    ck_assert(scene->models[0].frozen);
    ck_assert_uint_eq(scene->models[0].count, 2);
    ck_assert_str_eq(scene->models[0].list[1].plugin, "heat-euler");
    ck_assert_int_eq(scene->models[0].list[1].kind, CALX_TEMPERATURE);
    ck_assert_double_eq(scene->stages[0].duration, 1);
    ck_assert_double_eq(scene->stages[1].duration, 2);
    ck_assert_double_eq(scene->from_dissipation, 0);
    ck_assert_uint_eq(scene->seed, 1);
    ck_assert_int_eq(scene->output.compression, 6);
    ck_assert_uint_eq(scene->output.fields, CALX_FIELD_VELOCITY | CALX_FIELD_SPIN |
                                                CALX_FIELD_TEMPERATURE | CALX_FIELD_MATERIAL |
                                                CALX_FIELD_CONTACTS | CALX_FIELD_GROUP);
    for (int k = 0; k < 3; k++)
        ck_assert(!scene->periodic[k] && !scene->bounded[k] &&
                  scene->stages[0].gravity[k].value == 0);
}
END_TEST

static void add_tests(TCase *cases)
{
    tcase_add_loop_test(cases, test_regions, 0, COUNT(regions));
    tcase_add_test(cases, test_region_is_used);
    tcase_add_loop_test(cases, test_distributions, 0, COUNT(distributions));
    tcase_add_test(cases, test_fill);
    tcase_add_test(cases, test_seeds);
    tcase_add_test(cases, test_random_velocities);
    tcase_add_test(cases, test_grid_to_a_corner);
    tcase_add_test(cases, test_table_with_columns);
    tcase_add_test(cases, test_defaults);
}

int main(void)
{
    return run_suite("case_bodies", add_tests);
}

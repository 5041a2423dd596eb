/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Rigid groups in a case: where rings and rows put their bodies, which wall carries them, what they
 * inherit, and how stages move and heat them; grids of several sizes.
 */
#include <math.h>

#include "tests/case_files.h"

static void read_case(int dimension, const char *particles, const char *stages)
{
    char text[4096];
    snprintf(text, sizeof text,
             "<case dimension='%d'><material name='a' density='1' specific-heat='1' "
             "conductivity='1'/><material name='b' density='2' specific-heat='1' "
             "conductivity='1'/><walls name='floor' material='a'><plane normal='0 1%s'/></walls>"
             "%s%s</case>",
             dimension, dimension == 3 ? " 0" : "", particles, stages);
    put_file("case.xml", text);
    scene = calx_case_read(in_folder("case.xml"), registry, NULL, 0, &problems);
    if (!scene)
        calx_problems_print(&problems, stderr);
    ck_assert_ptr_nonnull(scene);
}

#define STAGE "<stage until='1 s'/>"

static void near_place(size_t i, double x, double y, double z)
{
    const double *at = scene->particles.position[i];
    ck_assert_msg(fabs(at[0] - x) + fabs(at[1] - y) + fabs(at[2] - z) < 1e-14,
                  "body %zu is at (%.16g, %.16g, %.16g)", i, at[0], at[1], at[2]);
}

START_TEST(rings_and_arcs)
{
    read_case(2,
              "<particles material='a' radius='1 cm'><ring center='1 2' distance='0.5' count='4'/>"
              "<ring distance='2' from='90 deg' to='180 deg' count='3'/></particles>",
              STAGE);
    ck_assert_uint_eq(scene->particles.count, 7);
    near_place(0, 1.5, 2.0, 0.0);
    near_place(1, 1.0, 2.5, 0.0);
    near_place(2, 0.5, 2.0, 0.0);
    near_place(3, 1.0, 1.5, 0.0);
    near_place(4, 0.0, 2.0, 0.0);
    near_place(5, -sqrt(2.0), sqrt(2.0), 0.0);
    near_place(6, -2.0, 0.0, 0.0);
}
END_TEST

/* Six coins fit around one; a wider spacing takes fewer bodies, a little closer than it says. An
 * arc has one more than it has spaces. */
START_TEST(rings_by_spacing)
{
    read_case(2,
              "<particles material='a' radius='1'><ring distance='2'/>"
              "<ring distance='2' spacing='2.1'/>"
              "<ring distance='2' from='0' to='60 deg'/></particles>",
              STAGE);
    ck_assert_uint_eq(scene->particles.count, 6 + 6 + 2);
    near_place(7, 1.0, sqrt(3.0), 0.0);
    near_place(13, 1.0, sqrt(3.0), 0.0);
}
END_TEST

/* Across the axis, the start is next to x, or y where the axis is x; right-handed about the axis.
 */
START_TEST(rings_in_space)
{
    read_case(3,
              "<particles material='a' radius='1 cm'>"
              "<ring distance='1' axis='2 0 0' count='4'/>"
              "<ring distance='1' axis='0 -1 0' count='4'/>"
              "<ring distance='1' axis='1 0 1' count='2'/></particles>",
              STAGE);
    near_place(0, 0.0, 1.0, 0.0);
    near_place(1, 0.0, 0.0, 1.0);
    near_place(4, 1.0, 0.0, 0.0);
    near_place(5, 0.0, 0.0, 1.0);
    near_place(8, sqrt(0.5), 0.0, -sqrt(0.5));
}
END_TEST

START_TEST(rows)
{
    read_case(3,
              "<particles material='a' radius='0.1'><row from='0 0 1' to='1 1 1' count='3'/>"
              "<row from='0 0 2' to='1 0 2'/><row from='0 0 3' to='1 0 3' spacing='0.3'/>"
              "<row from='0 0 4' to='1 0 4' count='1'/></particles>",
              STAGE);
    ck_assert_uint_eq(scene->particles.count, 3 + 6 + 5 + 1);
    near_place(1, 0.5, 0.5, 1.0);
    near_place(4, 0.2, 0.0, 2.0);
    near_place(10, 0.25, 0.0, 3.0);
    near_place(14, 0.0, 0.0, 4.0);
}
END_TEST

START_TEST(groups_are_walls)
{
    read_case(2,
              "<particles material='a' radius='1 cm' velocity='1 2' temperature='300 K'>"
              "<particle at='5 5'/>"
              "<group name='ring' material='b' temperature='400 K' isothermal='yes'>"
              "<ring distance='0.5' count='4'/><particle at='0 0' radius='2 cm'/></group>"
              "<group name='bar'><row from='1 3' to='2 3' count='2'/></group></particles>",
              "<stage for='1 s'><move walls='ring' rotate='3 rad/s'/></stage>"
              "<stage for='1 s'><move walls='ring bar' velocity='1 0'/>"
              "<walls name='ring' temperature='500 K'/></stage>");
    const struct calx_particles *p = &scene->particles;
    int ring = calx_scene_wall(scene, "ring"), bar = calx_scene_wall(scene, "bar");
    const int32_t carrier[8] = {-1, ring, ring, ring, ring, ring, bar, bar};
    ck_assert_uint_eq(scene->wall_count, 3);
    ck_assert_uint_eq(p->count, 8);
    for (size_t i = 0; i < 8; i++) {
        bool in_ring = carrier[i] == ring;
        ck_assert_int_eq(p->carrier[i], carrier[i]);
        ck_assert_int_eq(p->fixed[i], carrier[i] >= 0);
        ck_assert_int_eq(p->material[i], in_ring);
        ck_assert_double_eq(p->velocity[i][1], carrier[i] >= 0 ? 0.0 : 2.0);
        ck_assert_double_eq(p->temperature[i], in_ring ? 400.0 : 300.0);
    }
    ck_assert_double_eq(p->radius[5], 0.02);
    ck_assert(scene->walls[ring].carries && scene->walls[ring].isothermal);
    ck_assert(scene->walls[bar].carries && !scene->walls[bar].isothermal);
    ck_assert_double_eq(scene->stages[0].motion[ring].rate.value, 3.0);
    ck_assert(!scene->stages[0].motion[bar].moves && scene->stages[1].motion[bar].moves);
    ck_assert_double_eq(scene->stages[0].wall_temperature[ring].value, 400.0);
    ck_assert_double_eq(scene->stages[1].wall_temperature[ring].value, 500.0);
}
END_TEST

/* ---- grids of several sizes ---- */

static size_t count_size(size_t first, double radius)
{
    size_t count = 0;
    for (size_t i = first; i < scene->particles.count; i++)
        count += scene->particles.radius[i] == radius;
    return count;
}

/* n_i = 4 f w_i A/(pi d_i^2) with f = 0.3 and A = 40*25*(4 mm)^2: 458.4 and 267.4; the spacing is
 * the largest diameter. */
START_TEST(a_grid_by_mass)
{
    double area = 40 * 25 * 16e-6, small = 0.3 * 0.3 * area / (M_PI * 1e-6),
           large = 0.3 * 0.7 * area / (M_PI * 4e-6);
    read_case(2,
              "<particles material='a'><grid from='1 2 mm' count='40 25' fill='0.3' seed='3' "
              "radius='masses 2 mm 0.3 4 mm 0.7' velocity='random 0.2 m/s'/></particles>",
              STAGE);
    ck_assert_double_eq_tol((double)count_size(0, 1e-3), small, 1.0); /* rounded */
    ck_assert_double_eq_tol((double)count_size(0, 2e-3), large, 1.0);
    near_place(39, 1e-3 + 39 * 4e-3, 2e-3, 0.0);
    near_place(40, 1e-3, 6e-3, 0.0);
    double runs = 0, most = 0;
    for (size_t i = 1; i < scene->particles.count; i++) {
        runs += scene->particles.radius[i] != scene->particles.radius[i - 1];
        most = fmax(most, fabs(scene->particles.velocity[i][0]));
    }
    /* in random order sizes change 2 n1 n2/n = 338 times, give or take sqrt(n)/2 = 14 */
    double n = small + large;
    ck_assert_double_eq_tol(runs, 2.0 * small * large / n, 5.0 * 0.5 * sqrt(n));
    ck_assert(most > 0.19 && most <= 0.2);
}
END_TEST

START_TEST(a_grid_by_number)
{
    read_case(3,
              "<particles material='a'><grid from='0 0 1' count='5 4 3' "
              "radius='numbers 2 mm 1 4 mm 1'/></particles>",
              STAGE);
    ck_assert_uint_eq(scene->particles.count, 60);
    ck_assert_uint_eq(count_size(0, 1e-3), 30);
    ck_assert_uint_eq(count_size(0, 2e-3), 30);
    near_place(59, 16e-3, 12e-3, 1.008);
}
END_TEST

static void add_tests(TCase *cases)
{
    tcase_add_test(cases, a_grid_by_mass);
    tcase_add_test(cases, a_grid_by_number);
    tcase_add_test(cases, rings_and_arcs);
    tcase_add_test(cases, rings_by_spacing);
    tcase_add_test(cases, rings_in_space);
    tcase_add_test(cases, rows);
    tcase_add_test(cases, groups_are_walls);
}

int main(void)
{
    return run_suite("case_groups", add_tests);
}

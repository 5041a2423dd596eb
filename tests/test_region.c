/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Regions: wrong ones first, then volumes against formulas, and the inside of walls.
 */
#include "tests/regions.h"

/* ---- wrong regions ---- */

static void spoil_dimension(struct calx_region *region)
{
    region->dimension = 4;
}

static void spoil_flat_cylinder(struct calx_region *region)
{
    region->kind = CALX_REGION_CYLINDER;
    region->dimension = 2;
}

static void spoil_radius(struct calx_region *region)
{
    region->kind = CALX_REGION_BALL;
}

static void spoil_axis(struct calx_region *region)
{
    region->kind = CALX_REGION_CYLINDER;
    region->radius = 1;
    region->axis[2] = 0;
}

static void spoil_bound(struct calx_region *region)
{
    region->high[1] = INFINITY;
}

static void spoil_order(struct calx_region *region)
{
    region->high[1] = region->low[1];
}

static void spoil_period(struct calx_region *region)
{
    region->kind = CALX_REGION_BALL;
    region->radius = 0.01;
    region->periodic[0] = true;
    region->low[0] = -INFINITY;
}

static void spoil_image(struct calx_region *region)
{
    region->periodic[0] = true;
    region->high[0] = region->low[0] + 0.003;
}

static void spoil_clearance(struct calx_region *region)
{
    region->clearance = -1;
}

static void spoil_outline(struct calx_region *region)
{
    region->kind = CALX_REGION_OUTLINE;
}

static const struct {
    void (*spoil)(struct calx_region *);
    const char *words;
} bad_regions[] = {
    {spoil_dimension, "dimension"},    {spoil_flat_cylinder, "3D only"},
    {spoil_radius, "positive radius"}, {spoil_axis, "needs an axis"},
    {spoil_bound, "endless in y"},     {spoil_order, "empty: y"},
    {spoil_period, "periodic in x"},   {spoil_image, "its own periodic image"},
    {spoil_clearance, "clearance"},    {spoil_outline, "no closed outline"},
};

START_TEST(test_bad_region)
{
    struct calx_region region = make_box();
    bad_regions[_i].spoil(&region);
    const struct calx_sizes sizes = {.kind = CALX_SIZES_FIXED, .a = 0.002};
    ck_assert_int_eq(calx_pack_region(&region, &sizes, 1, 0, 1, NULL, &packing, &error),
                     CALX_ERROR_INPUT);
    ck_assert_msg(strstr(error.text, bad_regions[_i].words) != NULL, "%s", error.text);
}
END_TEST

/* ---- volumes, walls ---- */

static struct calx_region make_cap(void) /* the lower half of a ball */
{
    struct calx_region region = make_ball();
    region.high[2] = region.centre[2];
    return region;
}

static struct calx_region make_half_circle(void)
{
    struct calx_region region = make_circle();
    region.low[0] = 0.3;
    return region;
}

static const struct {
    struct calx_region (*make)(void);
    double volume, tolerance;
} volumes[] = {
    {make_rectangle, 0.01, 1e-15},
    {make_box, 1.25e-4, 1e-15},
    {make_circle, M_PI * 0.0025, 1e-4},
    {make_half_circle, M_PI * 0.00125, 1e-4},
    {make_ball, 4 * M_PI / 3 * 2.7e-5, 1e-4},
    {make_cap, 2 * M_PI / 3 * 2.7e-5, 1e-4},
    {make_drum, M_PI * 0.0762 * 0.0762 * 0.05, 1e-4},
    {make_half_drum, M_PI * 0.0762 * 0.0762 * 0.025, 1e-4},
    {make_tilted, M_PI * 0.0004 * 0.05, 3e-4}, /* the ends are staircases of 1024 lines */
    /* polygons of n corners: n/2 R^2 sin(2 pi/n) */
    {make_outline, 45 * 0.0036 * 0.06975647374412530 - 15 * 0.000225 * 0.20791169081775934, 1e-4},
    {make_prism, 0.02 * (45 * 0.0036 * 0.06975647374412530 - 15 * 0.000225 * 0.20791169081775934),
     1e-4},
};

START_TEST(test_volume)
{
    struct calx_region region = volumes[_i].make();
    ck_assert_double_eq_tol(calx_region_volume(&region) / volumes[_i].volume, 1,
                            volumes[_i].tolerance);
    calx_region_clear(&region);
}
END_TEST

static void segment(struct calx_wall *wall, double ax, double ay, double bx, double by)
{
    wall->primitives[wall->primitive_count++] =
        (struct calx_primitive){.shape = CALX_SEGMENT, .a = {ax, ay}, .b = {bx, by}};
}

START_TEST(test_region_of_wall)
{
    struct calx_primitive primitives[16];
    struct calx_wall wall = {.name = "hull", .primitives = primitives};
    struct calx_region region;
    calx_region_init(&region, 2);
    segment(&wall, 0, 0, 1, 0);
    segment(&wall, 1, 0, 1, 1);
    ck_assert_int_eq(calx_region_of_wall(&region, &wall, &error), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(error.text, "wall hull does not bound one inside"));
    segment(&wall, 1, 1, 0, 0);
    segment(&wall, 0, 0, -1, 0); /* an open chain that begins where the closed one ended */
    segment(&wall, 3, 3, 4, 4);
    ck_assert_int_eq(calx_region_of_wall(&region, &wall, &error), CALX_OK);
    ck_assert_int_eq(region.kind, CALX_REGION_OUTLINE);
    ck_assert_uint_eq(region.edge_count, 3);
    ck_assert_uint_eq(region.obstacle_count, 2);
    ck_assert(calx_region_holds(&region, (double[]){0.7, 0.2, 0}, 0.1));
    ck_assert(!calx_region_holds(&region, (double[]){0.2, 0.7, 0}, 0.1));
    primitives[wall.primitive_count++] =
        (struct calx_primitive){.shape = CALX_CYLINDER, .inside = true, .radius = 1};
    ck_assert_int_eq(calx_region_of_wall(&region, &wall, &error), CALX_ERROR_INPUT);
    calx_region_clear(&region);
}
END_TEST

static const struct {
    uint32_t dimension;
    struct calx_primitive primitive;
    enum calx_region_kind kind;
    int code;
} rounds[] = {
    {2,
     {.shape = CALX_CYLINDER, .inside = true, .radius = 2, .a = {1, 2, 3}, .n = {0, 0, 1}},
     CALX_REGION_BALL,
     CALX_OK},
    {3,
     {.shape = CALX_CYLINDER,
      .inside = true,
      .radius = 2,
      .a = {1, 2, 3},
      .n = {0, 0, 1},
      .length = 9},
     CALX_REGION_CYLINDER,
     CALX_OK},
    {3,
     {.shape = CALX_SPHERE, .inside = true, .radius = 2, .a = {1, 2, 3}},
     CALX_REGION_BALL,
     CALX_OK},
    {3, {.shape = CALX_SPHERE, .inside = false, .radius = 2}, CALX_REGION_BALL, CALX_ERROR_INPUT},
    {3, {.shape = CALX_PLANE, .n = {0, 1, 0}}, CALX_REGION_BOX, CALX_ERROR_INPUT},
};

START_TEST(test_region_of_round_wall)
{
    struct calx_primitive primitive = rounds[_i].primitive;
    const struct calx_wall wall = {.name = "shell", .primitives = &primitive, .primitive_count = 1};
    struct calx_region region;
    calx_region_init(&region, rounds[_i].dimension);
    ck_assert_int_eq(calx_region_of_wall(&region, &wall, &error), rounds[_i].code);
    if (rounds[_i].code == CALX_OK) {
        ck_assert_int_eq(region.kind, rounds[_i].kind);
        ck_assert_double_eq(region.radius, 2);
        ck_assert_double_eq(region.length, primitive.length);
        ck_assert_mem_eq(region.centre, primitive.a, sizeof region.centre);
    }
    calx_region_clear(&region);
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("region");
    TCase *tcase = tcase_create("region");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_bad_region, bad_regions);
    LOOP(test_volume, volumes);
    tcase_add_test(tcase, test_region_of_wall);
    LOOP(test_region_of_round_wall, rounds);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

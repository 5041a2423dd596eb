/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <pack>: bodies at random places without overlap. Input: a region (given, or the inside of walls),
 * radii, a count or a solid fraction. Method: core/pack.h; what was placed before is kept clear of.
 */
#include "io/case_bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/pack.h"
#include "io/quantity.h"

/* ---- region
 * -------------------------------------------------------------------------------------------- */

static bool set_box(struct calx_region *region, const double *v)
{
    uint32_t d = region->dimension;
    region->kind = CALX_REGION_BOX;
    for (uint32_t k = 0; k < d; k++) {
        region->periodic[k] &= v[k] <= region->low[k] && v[d + k] >= region->high[k];
        region->low[k] = fmax(region->low[k], v[k]);
        region->high[k] = fmin(region->high[k], v[d + k]);
        if (!(region->low[k] < region->high[k]))
            return false;
    }
    return true;
}

static bool set_ball(struct calx_region *region, const double *v)
{
    region->kind = CALX_REGION_BALL;
    memcpy(region->centre, v, region->dimension * sizeof *v);
    region->radius = v[region->dimension];
    return region->radius > 0;
}

static bool set_cylinder(struct calx_region *region, const double *v)
{
    region->kind = CALX_REGION_CYLINDER;
    memcpy(region->centre, v, sizeof region->centre);
    region->radius = v[3];
    region->length = v[4];
    return region->radius > 0 && region->length >= 0;
}

static const struct shape {
    const char *name;
    uint32_t dimensions; /* bits 2 and 3 */
    bool (*set)(struct calx_region *, const double *);
    size_t numbers[4]; /* by dimension */
} shapes[] = {{"box", 1u << 2 | 1u << 3, set_box, {0, 0, 4, 6}},
              {"rectangle", 1u << 2, set_box, {0, 0, 4, 0}},
              {"circle", 1u << 2, set_ball, {0, 0, 3, 0}},
              {"sphere", 1u << 3, set_ball, {0, 0, 0, 4}},
              {"cylinder", 1u << 3, set_cylinder, {0, 0, 0, 5}}};
#define SHAPE_COUNT (sizeof shapes / sizeof *shapes)

static bool read_shape(struct calx_reader *r, const xmlNode *node, const struct shape *shape,
                       struct calx_region *region)
{
    uint32_t d = r->scene->dimension;
    double v[6];
    size_t count = calx_case_list(r, node, shape->name, v, 6);
    if (!count)
        return false;
    if (!(shape->dimensions >> d & 1u))
        calx_case_fail(r, node, shape->name, "is not for dimension %u", d);
    else if (count != shape->numbers[d])
        calx_case_fail(r, node, shape->name, "%zu numbers, expected %zu", count, shape->numbers[d]);
    else if (!shape->set(region, v))
        calx_case_fail(r, node, shape->name,
                       "'%.80s' is empty, expected lower before upper ends and a radius above 0",
                       calx_case_given(node, shape->name));
    else
        return shape->set != set_cylinder || calx_case_vector(r, node, "axis", region->axis);
    return false;
}

static bool read_inside(struct calx_reader *r, const xmlNode *node, struct calx_region *region)
{
    int wall = calx_case_wall(r, node, "inside");
    struct calx_error e = {0};
    if (wall >= 0 && r->scene->walls[wall].carries)
        calx_case_fail(
            r, node, "inside",
            "'%s' is a group of particles, which encloses no region: give a box, circle, "
            "sphere or cylinder",
            r->scene->walls[wall].name);
    if (wall < 0 || !r->scene->walls[wall]
                         .primitive_count) /* a wall without primitives is a mistake already told */
        return false;
    if (calx_region_of_wall(region, &r->scene->walls[wall], &e)) {
        calx_case_fail_with(r, node, "inside", &e);
        return false;
    }
    return true;
}

/* Where the upper end is: against gravity at t = 0 along its largest component. */
static void cut_at_level(struct calx_reader *r, const xmlNode *node, struct calx_region *region)
{
    struct calx_function gravity[3] = {{0}, {0}, {0}};
    const xmlNode *given = calx_case_first(r->root, "gravity");
    double level = calx_case_number(r, node, "level"), g[3];
    size_t axis = r->scene->dimension - 1;
    if (isnan(level))
        return;
    if (given)
        calx_case_read_gravity(r, given, gravity);
    for (size_t k = 0; k < 3; k++)
        g[k] = calx_evaluate(&gravity[k], 0.0, (double[3]){0, 0, 0});
    for (size_t k = 0; k < r->scene->dimension; k++)
        axis = fabs(g[k]) > fabs(g[axis]) ? k : axis;
    if (g[axis] <= 0)
        region->high[axis] = fmin(region->high[axis], level);
    else
        region->low[axis] = fmax(region->low[axis], level);
}

static bool read_region(struct calx_reader *r, const xmlNode *node, struct calx_region *region)
{
    const struct shape *chosen = NULL;
    bool inside = calx_case_given(node, "inside") != NULL, good = false;
    size_t given = inside;
    for (size_t k = 0; k < SHAPE_COUNT; k++)
        if (calx_case_given(node, shapes[k].name)) {
            chosen = &shapes[k];
            given++;
        }
    for (size_t k = 0; k < r->scene->dimension; k++)
        if (r->scene->bounded[k]) {
            region->low[k] = r->scene->low[k];
            region->high[k] = r->scene->high[k];
            region->periodic[k] = r->scene->periodic[k];
        }
    if (given != 1)
        calx_case_fail(
            r, node, NULL,
            "has %s region, expected one of box, rectangle, circle, sphere, cylinder, inside",
            given ? "more than one" : "no");
    else
        good = inside ? read_inside(r, node, region) : read_shape(r, node, chosen, region);
    region->clearance = calx_case_number(r, node, "gap");
    cut_at_level(r, node, region);
    return good && !isnan(region->clearance);
}

/* ---- packing
 * ------------------------------------------------------------------------------------------- */

static void place(struct calx_bed *bed, struct calx_group *group, const struct calx_region *region,
                  const struct calx_radii *radii, size_t count, double fill)
{
    const struct calx_particles *p = bed->particles;
    struct calx_bodies_at avoid = {p->count, (const double(*)[3])p->position, p->radius};
    struct calx_packing packing = {0};
    struct calx_error e = {0};
    if (calx_pack_region(region, &radii->sizes, count, fill, group->seed, &avoid, &packing, &e)) {
        calx_case_fail_with(bed->reader, group->node, NULL, &e);
        return;
    }
    for (size_t i = 0; i < packing.count; i++)
        if (calx_case_place_body(bed, group, packing.position[i], packing.radius[i]) < 0)
            break;
    calx_packing_free(&packing);
}

void calx_case_read_pack(struct calx_bed *bed, struct calx_group *group)
{
    struct calx_reader *r = bed->reader;
    struct calx_region region;
    struct calx_radii radii = {0};
    int64_t count = calx_case_whole(r, group->node, "count");
    double fill = calx_case_number(r, group->node, "fill");
    calx_region_init(&region, r->scene->dimension);
    if (calx_case_given(group->node, "count") && calx_case_given(group->node, "fill"))
        calx_case_fail(r, group->node, NULL, "has both 'count' and 'fill', expected one");
    if (count > CALX_MOST_BODIES)
        calx_case_fail(r, group->node, "count", "more than %d bodies", CALX_MOST_BODIES);
    bool has_region = read_region(r, group->node, &region),
         has_radii = calx_case_read_radii(r, group->node, &radii);
    if (has_region && has_radii && !r->problems->count)
        place(bed, group, &region, &radii, count > 0 ? (size_t)count : 0, isnan(fill) ? 0.0 : fill);
    calx_region_clear(&region);
}

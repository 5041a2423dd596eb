/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <pack>: bodies at random places without overlap. Input: a region (given, or the inside of walls),
 * radii, a count or a solid fraction. Method: core/pack.h; what was placed before is kept clear of.
 */
#include "io/case_bodies.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/pack.h"
#include "io/quantity.h"

#define MOST_CLASSES 32

/* ---- radii
 * --------------------------------------------------------------------------------------------- */

struct radii {
    struct calx_sizes sizes;
    double list[MOST_CLASSES], weight[MOST_CLASSES];
};

static bool are_radii(struct calx_reader *r, const xmlNode *node, const double *v, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (!(v[k] >= CALX_LEAST_RADIUS && v[k] <= CALX_LARGEST_RADIUS)) {
            calx_case_fail(r, node, "radius",
                           "%g m is out of range, expected at least %g and at most %g", v[k],
                           CALX_LEAST_RADIUS, CALX_LARGEST_RADIUS);
            return false;
        }
    return true;
}

/* A diameter with its unit, which may be further words, and the share that follows. Returns the
 * word after them. */
static const char **read_class(struct calx_reader *r, const xmlNode *node, const char **word,
                               struct radii *radii)
{
    char length[96];
    size_t used = (size_t)snprintf(length, sizeof length, "%.60s", *word++);
    struct calx_error e;
    double v[2];
    while (*word && !isdigit((unsigned char)**word) && **word != '.' && used < sizeof length)
        used += (size_t)snprintf(length + used, sizeof length - used, " %.20s", *word++);
    if (!*word || radii->sizes.count == MOST_CLASSES) {
        calx_case_fail(r, node, "radius",
                       "masses: expected pairs of a diameter and its share, at most %d",
                       MOST_CLASSES);
        return NULL;
    }
    if (calx_quantity_parse(length, "m", &v[0], &e) || calx_quantity_parse(*word, "1", &v[1], &e)) {
        calx_case_fail_with(r, node, "radius", &e);
        return NULL;
    }
    if (!(v[1] > 0))
        calx_case_fail(r, node, "radius", "share %g of the mass, expected greater than 0", v[1]);
    if (!(v[1] > 0) || !are_radii(r, node, v, 1))
        return NULL;
    radii->list[radii->sizes.count] = v[0] / 2;
    radii->weight[radii->sizes.count++] = v[1];
    return word + 1;
}

static bool read_masses(struct calx_reader *r, const xmlNode *node, const char *text,
                        struct radii *radii)
{
    const char *words[4 * MOST_CLASSES + 1] = {NULL}, **word = words;
    char *copy;
    size_t count = calx_case_split(text, "", &copy, words, 4 * MOST_CLASSES);
    while (word && *word)
        word = read_class(r, node, word, radii);
    if (!count)
        calx_case_fail(r, node, "radius", "masses: expected pairs of a diameter and its share");
    free(copy);
    return word && count;
}

/* The numbers after the word of a distribution: least to most of them. */
static bool read_numbers(struct calx_reader *r, const xmlNode *node, const char *text, size_t least,
                         size_t most, double *v)
{
    struct calx_error e;
    size_t count;
    if (calx_quantity_parse_list(text, "m", v, 4, &count, &e)) {
        calx_case_fail_with(r, node, "radius", &e);
        return false;
    }
    if (count != least && count != most) {
        calx_case_fail(r, node, "radius", "'%.80s' has %zu numbers, expected %zu%s", text, count,
                       least, most > least ? " or 4" : "");
        return false;
    }
    if (!are_radii(r, node, v, count))
        return false;
    bool ends_in_range = count == 4 || least == most;
    if (ends_in_range && v[count - 2] > v[count - 1]) {
        calx_case_fail(r, node, "radius", "'%.80s': the least is above the largest", text);
        return false;
    }
    return true;
}

static bool read_distribution(struct calx_reader *r, const xmlNode *node, const char *text,
                              struct radii *radii)
{
    static const struct {
        const char *word;
        enum calx_sizes_kind kind;
        size_t least, most;
    } known[] = {{"uniform", CALX_SIZES_UNIFORM, 2, 2},
                 {"normal", CALX_SIZES_NORMAL, 2, 4},
                 {"lognormal", CALX_SIZES_LOGNORMAL, 2, 4}};
    const char *names[] = {"uniform", "normal", "lognormal", "masses"};
    double v[4] = {0};
    size_t length = strcspn(text, " \t");
    char word[24];
    snprintf(word, sizeof word, "%.*s", (int)(length < 20 ? length : 20), text);
    if (strcmp(word, "masses") == 0) {
        radii->sizes.kind = CALX_SIZES_MASSES;
        return read_masses(r, node, text + length, radii);
    }
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(word, known[k].word) == 0) {
            bool good = read_numbers(r, node, text + length, known[k].least, known[k].most, v);
            radii->sizes = (struct calx_sizes){
                .kind = known[k].kind, .a = v[0], .b = v[1], .min = v[2], .max = v[3]};
            return good;
        }
    calx_case_fail_name(r, node, "radius", "distribution", word, names, 4);
    return false;
}

static bool read_radii(struct calx_reader *r, const xmlNode *node, struct radii *radii)
{
    const xmlNode *bearer = calx_case_bearer(node, "radius");
    const char *text = bearer ? calx_case_given(bearer, "radius") : "";
    bool good;
    text += strspn(text, " \t\r\n");
    if (!bearer || !isalpha((unsigned char)*text)) {
        radii->sizes =
            (struct calx_sizes){.kind = CALX_SIZES_FIXED, .a = calx_case_radius(r, node)};
        good = !isnan(radii->sizes.a);
    } else {
        good = read_distribution(r, bearer, text, radii);
    }
    radii->sizes.list = radii->list;
    radii->sizes.weight = radii->weight;
    return good;
}

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
        calx_case_fail(r, node, "inside",
                       "'%s' is a group of particles, which encloses no region: give a box, circle, "
                       "sphere or cylinder", r->scene->walls[wall].name);
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
                  const struct radii *radii, size_t count, double fill)
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
    struct radii radii = {0};
    int64_t count = calx_case_whole(r, group->node, "count");
    double fill = calx_case_number(r, group->node, "fill");
    calx_region_init(&region, r->scene->dimension);
    if (calx_case_given(group->node, "count") && calx_case_given(group->node, "fill"))
        calx_case_fail(r, group->node, NULL, "has both 'count' and 'fill', expected one");
    if (count > CALX_MOST_BODIES)
        calx_case_fail(r, group->node, "count", "more than %d bodies", CALX_MOST_BODIES);
    bool has_region = read_region(r, group->node, &region),
         has_radii = read_radii(r, group->node, &radii);
    if (has_region && has_radii && !r->problems->count)
        place(bed, group, &region, &radii, count > 0 ? (size_t)count : 0, isnan(fill) ? 0.0 : fill);
    calx_region_clear(&region);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The particles of a case: single ones here, the others in case_grid.c, case_lines.c, case_pack.c
 * and case_csv.c. Output: scene->particles, in the order of the file. No packing is made once there
 * is a mistake: it takes time.
 */
#include "io/case_bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/quantity.h"

#define ROOM_TEMPERATURE 293.15 /* K, of bodies that say none */

/* Streams of different elements are apart by odd multiples of 2^64 over the golden ratio. */
#define SEED_STEP 0x9e3779b97f4a7c15u
#define DRAW_STEP                                                                                  \
    0xd1342543de82ef95u /* large and odd: draws do not meet seeds that a person would write */

const xmlNode *calx_case_bearer(const xmlNode *node, const char *name)
{
    while (!calx_case_given(node, name) && strcmp(calx_case_element(node)->id, "particles") != 0)
        node = node->parent;
    return calx_case_given(node, name) ? node : NULL;
}

double calx_case_radius(struct calx_reader *r, const xmlNode *node)
{
    const xmlNode *bearer = calx_case_bearer(node, "radius");
    if (!bearer)
        calx_case_fail(r, node, NULL, "attribute 'radius' is missing here and on <particles>");
    return bearer ? calx_case_number(r, bearer, "radius") : NAN;
}

/* ---- groups
 * -------------------------------------------------------------------------------------------- */

static void read_random(struct calx_reader *r, const xmlNode *node, const char *name,
                        const char *text, struct calx_start *start)
{
    const struct calx_attribute *row = calx_element_attribute(calx_case_element(node), name);
    struct calx_error e;
    if (calx_quantity_parse(text, row->unit, &start->random, &e))
        calx_case_fail_with(r, node, name, &e);
    else if (start->random < 0)
        calx_case_fail(r, node, name, "random %g, expected at least 0", start->random);
}

/* In 2D a spin is one number, about z. */
static void read_given(struct calx_reader *r, const xmlNode *node, const char *name,
                       double value[3])
{
    double numbers[3] = {0, 0, 0};
    bool about_z = strcmp(name, "spin") == 0 && r->scene->dimension == 2;
    if (!about_z) {
        calx_case_vector(r, node, name, value);
        return;
    }
    size_t count = calx_case_list(r, node, name, numbers, 3);
    if (count == 1)
        value[2] = numbers[0];
    else if (count == 3 && numbers[0] == 0 && numbers[1] == 0)
        value[2] = numbers[2];
    else if (count)
        calx_case_fail(r, node, name, "%zu numbers, expected one in 2D, about z", count);
}

static struct calx_start read_start(struct calx_reader *r, const xmlNode *node, const char *name)
{
    struct calx_start start = {0};
    const xmlNode *bearer = calx_case_bearer(node, name);
    const char *text = bearer ? calx_case_given(bearer, name) : "";
    start.given = bearer != NULL;
    if (strncmp(text, "random ", 7) == 0)
        read_random(r, bearer, name, text + 7, &start);
    else if (bearer)
        read_given(r, bearer, name, start.value);
    return start;
}

static int group_material(struct calx_reader *r, const xmlNode *node)
{
    const xmlNode *bearer = calx_case_bearer(node, "material");
    if (!bearer)
        calx_case_fail(r, node, NULL, "attribute 'material' is missing here and on <particles>");
    int material = bearer ? calx_case_material(r, bearer, "material") : -1;
    if (material >= 0 && r->uses)
        r->uses[material] |= CALX_BY_PARTICLES;
    return material;
}

static uint64_t group_seed(struct calx_reader *r, const xmlNode *node, uint64_t ordinal)
{
    bool own = calx_case_given(node, "seed") != NULL;
    const xmlNode *bearer = calx_case_bearer(node, "seed");
    uint64_t seed = bearer ? (uint64_t)calx_case_whole(r, bearer, "seed") : r->scene->seed;
    seed += DRAW_STEP * r->draw;
    return own ? seed : seed + SEED_STEP * ordinal;
}

/* A body of a group moves with it. */
static int read_carrier(struct calx_reader *r, const xmlNode *node)
{
    static const char *const own[] = {"velocity", "spin", "fixed"};
    if (strcmp(calx_case_element(node->parent)->id, "group") != 0)
        return -1;
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
        if (calx_case_given(node, own[k]))
            calx_case_fail(r, node, own[k],
                           "is not for bodies of a <group>: a <move> in a stage moves all of it");
    const char *name = calx_case_given(node->parent, "name");
    return name ? calx_scene_wall(r->scene, name) : -1;
}

static struct calx_group read_group(struct calx_reader *r, const xmlNode *node, uint64_t ordinal)
{
    struct calx_group group = {.node = node, .carrier = read_carrier(r, node)};
    const xmlNode *temperature = calx_case_bearer(node, "temperature"),
                  *fixed = calx_case_bearer(node, "fixed");
    group.material = group_material(r, node);
    group.fixed = fixed && calx_case_yes(r, fixed, "fixed");
    group.has_temperature =
        temperature && calx_case_function(r, temperature, "temperature", &group.temperature);
    if (group.carrier < 0) {
        group.velocity = read_start(r, node, "velocity");
        group.spin = read_start(r, node, "spin");
    }
    group.seed = group_seed(r, node, ordinal);
    calx_random_seed(&group.random, group.seed ^ SEED_STEP); /* apart from the stream of places */
    return group;
}

/* ---- bodies
 * -------------------------------------------------------------------------------------------- */

static bool grow_array(void *array_pointer, size_t capacity, size_t entry_size)
{
    void **array = array_pointer, *grown = realloc(*array, capacity * entry_size);
    if (grown)
        *array = grown;
    return grown != NULL;
}

static bool grow(struct calx_bed *bed)
{
    struct calx_particles *p = bed->particles;
    size_t capacity = bed->capacity ? 2 * bed->capacity : 64;
    bool done = grow_array(&p->position, capacity, sizeof *p->position) &&
                grow_array(&p->radius, capacity, sizeof *p->radius) &&
                grow_array(&p->material, capacity, sizeof *p->material) &&
                grow_array(&p->velocity, capacity, sizeof *p->velocity) &&
                grow_array(&p->spin, capacity, sizeof *p->spin) &&
                grow_array(&p->temperature, capacity, sizeof *p->temperature) &&
                grow_array(&p->fixed, capacity, sizeof *p->fixed) &&
                grow_array(&p->carrier, capacity, sizeof *p->carrier);
    if (done)
        bed->capacity = capacity;
    else
        calx_problems_add(bed->reader->problems, (struct calx_place){bed->reader->file, 0},
                          "no memory for particles");
    return done;
}

static void draw_start(struct calx_group *group, const struct calx_start *start, const bool axes[3],
                       double out[3])
{
    for (size_t k = 0; k < 3; k++)
        out[k] =
            start->value[k] + (start->random > 0 && axes[k]
                                   ? start->random * (2 * calx_random_uniform(&group->random) - 1)
                                   : 0.0);
}

int64_t calx_case_place_body(struct calx_bed *bed, struct calx_group *group,
                             const double position[3], double radius)
{
    struct calx_particles *p = bed->particles;
    bool plane = bed->reader->scene->dimension == 2;
    size_t i = p->count;
    if (i == bed->capacity && !grow(bed))
        return -1;
    memcpy(p->position[i], position, sizeof p->position[i]);
    p->radius[i] = radius;
    p->material[i] = group->material;
    p->fixed[i] = group->fixed || group->carrier >= 0;
    p->carrier[i] = group->carrier;
    p->temperature[i] = group->has_temperature ? calx_evaluate(&group->temperature, 0.0, position)
                                               : ROOM_TEMPERATURE;
    draw_start(group, &group->velocity, (bool[]){true, true, !plane}, p->velocity[i]);
    draw_start(group, &group->spin, (bool[]){!plane, !plane, true}, p->spin[i]);
    if (!isfinite(p->temperature[i]) || p->temperature[i] < 0)
        calx_case_fail(bed->reader, group->node, "temperature",
                       "%g K at (%g, %g, %g) m, expected at least 0 K", p->temperature[i],
                       position[0], position[1], position[2]);
    bed->any_velocity |= group->velocity.given;
    bed->any_spin |= group->spin.given;
    bed->any_temperature |= group->has_temperature;
    bed->any_fixed |= p->fixed[i];
    bed->any_carrier |= group->carrier >= 0;
    return (int64_t)p->count++;
}

static void drop_unsaid(struct calx_bed *bed)
{
    struct calx_particles *p = bed->particles;
    struct {
        bool keep;
        void **array;
    } arrays[] = {{bed->any_velocity, (void **)&p->velocity},
                  {bed->any_spin, (void **)&p->spin},
                  {bed->any_temperature, (void **)&p->temperature},
                  {bed->any_fixed, (void **)&p->fixed},
                  {bed->any_carrier, (void **)&p->carrier}};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        if (!arrays[k].keep) {
            free(*arrays[k].array);
            *arrays[k].array = NULL;
        }
}

/* ---- elements
 * ------------------------------------------------------------------------------------------ */

static void read_particle(struct calx_bed *bed, struct calx_group *group)
{
    double at[3], radius = calx_case_radius(bed->reader, group->node);
    if (calx_case_vector(bed->reader, group->node, "at", at) && !isnan(radius))
        calx_case_place_body(bed, group, at, radius);
}

static void read_body_element(struct calx_bed *bed, const xmlNode *node, uint64_t ordinal)
{
    static const struct {
        const char *id;
        void (*read)(struct calx_bed *, struct calx_group *);
    } readers[] = {{"particle", read_particle},   {"grid", calx_case_read_grid},
                   {"pack", calx_case_read_pack}, {"csv", calx_case_read_csv},
                   {"row", calx_case_read_row},   {"ring", calx_case_read_ring}};
    struct calx_group group = read_group(bed->reader, node, ordinal);
    for (size_t k = 0; k < sizeof readers / sizeof *readers; k++)
        if (strcmp(readers[k].id, calx_case_element(node)->id) == 0)
            readers[k].read(bed, &group);
}

static void read_children(struct calx_bed *bed, const xmlNode *parent, uint64_t *ordinal)
{
    for (const xmlNode *child = parent->children; child; child = child->next) {
        if (child->type != XML_ELEMENT_NODE || !child->_private)
            continue;
        if (strcmp(calx_case_element(child)->id, "group") == 0)
            read_children(bed, child, ordinal);
        else
            read_body_element(bed, child, (*ordinal)++);
    }
}

void calx_case_read_particles(struct calx_reader *r)
{
    struct calx_bed bed = {.reader = r, .particles = &r->scene->particles};
    uint64_t ordinal = 0;
    for (const xmlNode *node = calx_case_first(r->root, "particles"); node;
         node = calx_case_next(node, "particles"))
        read_children(&bed, node, &ordinal);
    drop_unsaid(&bed);
    if (!bed.particles->count && !r->problems->count)
        calx_case_fail(r, calx_case_first(r->root, "particles"), NULL, "has no particle");
}

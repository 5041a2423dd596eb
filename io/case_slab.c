/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <slab>: the solid behind a wall of one plane or one segment. Input: the element, the wall's primitive, its material, the domain. Output: the
 * slab of the wall. Read after the bodies, whose size is the depth of a 2D scene of spheres.
 */
#include "io/case_reader.h"

#include <math.h>
#include <string.h>

/* The extent of the domain along an axis that the slab needs; in 2D along z the depth of the bodies. */
static bool read_extent(struct calx_reader *r, const xmlNode *node, int axis, double *low, double *length)
{
    const struct calx_scene *scene = r->scene;
    *low = scene->low[axis];
    *length = scene->high[axis] - scene->low[axis];
    if (axis == 2 && scene->dimension == 2) {
        *length = calx_scene_depth(scene);
        *low = -0.5 * *length;
    } else if (!scene->bounded[axis]) {
        calx_case_fail(r, node, NULL, "the domain has no extent along %c, expected one: it is that of the slab", "xyz"[axis]);
        return false;
    }
    return true;
}

/* From end to end; the grains are on its left, and the slab is on the other side. */
static bool behind_segment(struct calx_reader *r, const xmlNode *node, const struct calx_primitive *p, struct calx_slab *b)
{
    double low;
    b->length = hypot(p->b[0] - p->a[0], p->b[1] - p->a[1]);
    for (int k = 0; k < 2; k++) {
        b->axis[0][k] = (p->b[k] - p->a[k]) / b->length;
        b->corner[k] = p->a[k];
    }
    b->axis[1][0] = b->axis[0][1];
    b->axis[1][1] = -b->axis[0][0];
    b->axis[2][2] = 1.0;
    if (!read_extent(r, node, 2, &low, &b->width))
        return false;
    b->corner[2] = low;
    for (int k = 0; k < 2; k++) {
        double period = r->scene->high[k] - r->scene->low[k], off = fabs(fabs(b->axis[0][k]) * b->length - period);
        b->periodic |= r->scene->periodic[k] && off <= 1e-9 * period && fabs(b->axis[0][1 - k]) <= 1e-9;
    }
    return true;
}

/* Along the axis that `along` names, or the first that lies in the plane. */
static bool behind_plane(struct calx_reader *r, const xmlNode *node, const struct calx_primitive *p, struct calx_slab *b)
{
    int normal = -1, along = calx_case_word(r, node, "along");
    double low[2];
    for (int k = 0; k < 3; k++)
        normal = fabs(p->n[k]) > 1.0 - 1e-12 ? k : normal;
    if (normal < 0) {
        calx_case_fail(r, node, NULL, "the plane behind which it lies is not normal to x, y or z; expected that, or a <segment>");
        return false;
    }
    if (along < 0)
        along = normal == 0 ? 1 : 0;
    if (along == normal || along >= (int)r->scene->dimension) {
        calx_case_fail(r, node, "along", "the plane has no direction %c", "xyz"[along]);
        return false;
    }
    int across = 3 - normal - along;
    b->axis[0][along] = 1.0;
    b->axis[1][normal] = p->n[normal] > 0.0 ? -1.0 : 1.0;
    b->axis[2][across] = 1.0;
    b->periodic = r->scene->periodic[along];
    if (!read_extent(r, node, along, &low[0], &b->length) || !read_extent(r, node, across, &low[1], &b->width))
        return false;
    b->corner[normal] = p->a[normal];
    b->corner[along] = low[0];
    b->corner[across] = low[1];
    return true;
}

static void read_material(struct calx_reader *r, const xmlNode *node, const struct calx_wall *wall, struct calx_slab *b)
{
    if (wall->material < 0)
        return;
    const struct calx_material *m = &r->scene->materials[wall->material];
    const char *const names[] = {"density", "specific-heat", "conductivity"};
    b->conductivity = calx_scene_material_value(r->scene, (size_t)wall->material, "conductivity");
    b->capacity = m->density * m->specific_heat;
    const double values[] = {m->density, m->specific_heat, b->conductivity};
    for (int k = 0; k < 3; k++)
        if (!(values[k] > 0.0))
            calx_case_fail(r, node, NULL, "material '%s' needs a %s above 0", m->name, names[k]);
}

static void read_cells(struct calx_reader *r, const xmlNode *node, struct calx_slab *b)
{
    double cells[3];
    size_t count = calx_case_list(r, node, "cells", cells, 3);
    bool whole = count == 2 && cells[0] == floor(cells[0]) && cells[1] == floor(cells[1]);
    if (count && !whole)
        calx_case_fail(r, node, "cells", "expected two whole numbers, along the face and into the depth");
    if (!whole)
        return;
    b->along = (size_t)cells[0];
    b->deep = (size_t)cells[1];
    if (b->periodic && b->along == 2)
        calx_case_fail(r, node, "cells", "2 along a periodic face, expected 1 or at least 3");
}

static bool has_temperature(const struct calx_scene *scene)
{
    for (size_t k = 0; k < scene->models_count; k++)
        for (size_t m = 0; m < scene->models[k].count; m++)
            if (scene->models[k].list[m].kind == CALX_TEMPERATURE)
                return true;
    return false;
}

static void read_slab(struct calx_reader *r, const xmlNode *node, struct calx_wall *wall)
{
    struct calx_slab b = {.theta = calx_case_number(r, node, "theta"), .depth = calx_case_number(r, node, "depth")};
    double far = calx_case_number(r, node, "far-temperature");
    const struct calx_primitive *p = wall->primitives;
    bool one = wall->primitive_count == 1 && (p->shape == CALX_PLANE || p->shape == CALX_SEGMENT);
    if (!one)
        calx_case_fail(r, node, NULL, "is behind one <plane> or one <segment>, these walls are others");
    if (wall->isothermal)
        calx_case_fail(r, node->parent, "temperature", "the walls have a slab, whose face is as warm as it becomes; expected its start in <slab>");
    if (!has_temperature(r->scene))
        calx_case_fail(r, node, NULL, "there is no temperature in this scene, expected <conductance> or <integrator of=\"temperature\">");
    b.start = calx_case_number(r, node, "temperature");
    b.far_isothermal = calx_case_word(r, node, "far") == 1;
    b.far = isnan(far) ? b.start : far;
    if (!b.far_isothermal && !isnan(far))
        calx_case_fail(r, node, "far-temperature", "is for far=\"isothermal\"");
    read_material(r, node, wall, &b);
    if (one && (p->shape == CALX_PLANE ? behind_plane(r, node, p, &b) : behind_segment(r, node, p, &b)))
        read_cells(r, node, &b);
    wall->slab = b;
}

void calx_case_read_slabs(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "walls"); node; node = calx_case_next(node, "walls")) {
        const xmlNode *slab = calx_case_first(node, "slab");
        const char *name = calx_case_given(node, "name");
        int wall = slab && name ? calx_scene_wall(r->scene, name) : -1;
        if (wall >= 0)
            read_slab(r, slab, &r->scene->walls[wall]);
    }
}

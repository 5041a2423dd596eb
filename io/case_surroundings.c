/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What a case says about space and rules that hold for all bodies: attributes of <case>, gravity,
 * domain, heat, numerics. Output: the scalars of the scene.
 */
#include "io/case_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_THICKNESS 1.0 /* m, of discs */

static const char *const axis_names[3] = {"x", "y", "z"};

static void read_case(struct calx_reader *r)
{
    struct calx_scene *scene = r->scene;
    double thickness = calx_case_number(r, r->root, "thickness");
    free(scene->title);
    scene->title = strdup(calx_case_text(r->root, "title"));
    scene->bodies = calx_case_word(r, r->root, "bodies") == 1 ? CALX_DISCS : CALX_SPHERES;
    if (scene->bodies == CALX_DISCS && scene->dimension == 3)
        calx_case_fail(r, r->root, "bodies", "discs are for dimension 2");
    if (scene->bodies == CALX_SPHERES && calx_case_given(r->root, "thickness"))
        calx_case_fail(r, r->root, "thickness", "is for bodies=\"discs\" only");
    if (scene->bodies == CALX_DISCS)
        scene->thickness = isnan(thickness) ? DEFAULT_THICKNESS : thickness;
}

void calx_case_read_gravity(struct calx_reader *r, const xmlNode *node,
                            struct calx_function gravity[3])
{
    bool text = calx_case_given(node, "") != NULL, components = false;
    for (size_t k = 0; k < 3; k++)
        components |= calx_case_given(node, axis_names[k]) != NULL;
    if (text == components) {
        calx_case_fail(r, node, NULL,
                       "%s, expected either text as in '0 -9.81 m/s2' or attributes x, y, z",
                       text ? "has text and components" : "is empty");
        return;
    }
    if (text)
        calx_case_functions(r, node, "", gravity);
    for (size_t k = 0; components && k < 3; k++)
        calx_case_function(r, node, axis_names[k], &gravity[k]);
    if (r->scene->dimension == 2 && calx_case_given(node, "z"))
        calx_case_fail(r, node, "z", "there is no z in 2D");
}

/* ---- domain
 * -------------------------------------------------------------------------------------------- */

static void set_extent(struct calx_reader *r, const xmlNode *node, size_t axis, double low,
                       double high)
{
    struct calx_scene *scene = r->scene;
    if (!(low < high))
        calx_case_fail(r, node, axis_names[axis], "from %g m to %g m, expected the lower end first",
                       low, high);
    if (scene->bounded[axis])
        calx_case_fail(r, node, axis_names[axis],
                       "the extent is given twice, by low and high and by this");
    scene->low[axis] = low;
    scene->high[axis] = high;
    scene->bounded[axis] = true;
}

static void read_corners(struct calx_reader *r, const xmlNode *node)
{
    double low[3], high[3];
    bool has_low = calx_case_given(node, "low") != NULL,
         has_high = calx_case_given(node, "high") != NULL;
    if (has_low != has_high)
        calx_case_fail(r, node, has_low ? "low" : "high", "low and high are given together");
    if (!has_low || !has_high || !calx_case_vector(r, node, "low", low) ||
        !calx_case_vector(r, node, "high", high))
        return;
    for (size_t k = 0; k < r->scene->dimension; k++)
        set_extent(r, node, k, low[k], high[k]);
}

static void read_extent(struct calx_reader *r, const xmlNode *node, size_t axis)
{
    double ends[2];
    const char *name = axis_names[axis];
    if (!calx_case_given(node, name))
        return;
    size_t count = calx_case_list(r, node, name, ends, 2);
    if (axis >= r->scene->dimension)
        calx_case_fail(r, node, name, "there is no z in 2D");
    else if (count == 1)
        calx_case_fail(r, node, name, "one number, expected two");
    else if (count == 2)
        set_extent(r, node, axis, ends[0], ends[1]);
}

static void read_domain(struct calx_reader *r, const xmlNode *node)
{
    uint32_t periodic = calx_case_words(r, node, "periodic");
    read_corners(r, node);
    for (size_t k = 0; k < 3; k++)
        read_extent(r, node, k);
    for (size_t k = 0; k < 3; k++) {
        r->scene->periodic[k] = periodic >> k & 1u;
        if (r->scene->periodic[k] && !r->scene->bounded[k])
            calx_case_fail(r, node, "periodic",
                           "axis %s needs an extent: %s=\"low high\", or low and high",
                           axis_names[k], axis_names[k]);
    }
}

/* ---- the rest
 * ------------------------------------------------------------------------------------------ */

static void read_heat(struct calx_reader *r, const xmlNode *node)
{
    r->scene->from_dissipation = calx_case_number(r, node, "from-dissipation");
    r->scene->split_effusivity = calx_case_word(r, node, "split") == 1;
}

static void read_numerics(struct calx_reader *r, const xmlNode *node)
{
    double skin = calx_case_number(r, node, "skin");
    r->scene->skin = isnan(skin) ? 0.0 : skin;
    r->scene->seed = (uint64_t)calx_case_whole(r, node, "seed");
}

void calx_case_read_surroundings(struct calx_reader *r)
{
    static const struct {
        const char *id;
        void (*read)(struct calx_reader *, const xmlNode *);
    } readers[] = {{"domain", read_domain}, {"heat", read_heat}, {"numerics", read_numerics}};
    read_case(r);
    r->scene->seed = 1;
    for (size_t k = 0; k < sizeof readers / sizeof *readers; k++) {
        const xmlNode *node = calx_case_first(r->root, readers[k].id);
        if (node)
            readers[k].read(r, node);
    }
}

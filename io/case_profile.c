/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <profile>: layers across an axis. Input: the element, the domain, the bodies. Output: scene->profiles.
 */
#include "io/case_reader.h"

#include <math.h>
#include <string.h>

static const char axis_names[] = "xyz";

/* Along the axis of the layers. */
static void read_range(struct calx_reader *r, const xmlNode *node, struct calx_profile *p)
{
    const struct calx_scene *scene = r->scene;
    double from = calx_case_number(r, node, "from"), to = calx_case_number(r, node, "to");
    bool bounded = scene->bounded[p->axis];
    for (int k = 0; k < 2 && !bounded; k++)
        if (!calx_case_given(node, k ? "to" : "from"))
            calx_case_fail(r, node, NULL, "attribute '%s' is missing: the domain has no extent along %c", k ? "to" : "from",
                           axis_names[p->axis]);
    p->low[p->axis] = isnan(from) ? scene->low[p->axis] : from;
    p->high[p->axis] = isnan(to) ? scene->high[p->axis] : to;
    if (!(p->low[p->axis] < p->high[p->axis]) && (bounded || (!isnan(from) && !isnan(to))))
        calx_case_fail(r, node, "from", "layers from %g m to %g m, expected the lower end first", p->low[p->axis],
                       p->high[p->axis]);
    if (scene->periodic[p->axis] && p->high[p->axis] - p->low[p->axis] > (1.0 + 1e-9) * (scene->high[p->axis] - scene->low[p->axis]))
        calx_case_fail(r, node, "to", "layers from %g m to %g m are more than a period of the domain", p->low[p->axis],
                       p->high[p->axis]);
}

static void set_across(struct calx_profile *p, int axis, double middle, double length)
{
    p->low[axis] = middle - 0.5 * length;
    p->high[axis] = middle + 0.5 * length;
}

static void read_across(struct calx_reader *r, const xmlNode *node, struct calx_profile *p)
{
    const struct calx_scene *scene = r->scene;
    double lengths[3];
    size_t wanted = scene->dimension - 1, count = calx_case_list(r, node, "across", lengths, 3);
    if (count && count != wanted)
        calx_case_fail(r, node, "across", "%zu number%s, expected %zu in %uD", count, count == 1 ? "" : "s", wanted,
                       scene->dimension);
    size_t next = 0;
    for (int k = 0; k < (int)scene->dimension; k++) {
        if (k == p->axis)
            continue;
        double middle = scene->bounded[k] ? 0.5 * (scene->low[k] + scene->high[k]) : 0.0;
        if (count == wanted)
            set_across(p, k, middle, lengths[next++]);
        else if (scene->bounded[k])
            set_across(p, k, middle, scene->high[k] - scene->low[k]);
        else if (!calx_case_given(node, "across"))
            calx_case_fail(r, node, NULL, "attribute 'across' is missing: the domain has no extent along %c", axis_names[k]);
    }
    if (scene->dimension == 2)
        set_across(p, 2, 0.0, calx_scene_depth(scene));
}

static void read_times(struct calx_reader *r, const xmlNode *node, struct calx_profile *p)
{
    double every = calx_case_number(r, node, "every");
    p->over = calx_case_number(r, node, "over");
    p->every = isnan(every) ? p->over / 100.0 : every;
    p->after = calx_case_number(r, node, "after");
    double samples = p->over / p->every;
    if (!isnan(samples) && (samples < 0.5 || samples > 1e9 || fabs(samples - round(samples)) > 1e-6 * samples))
        calx_case_fail(r, node, "over", "%g s is %g times 'every', expected a whole number of times", p->over, samples);
}

static void read_profile(struct calx_reader *r, const xmlNode *node)
{
    const char *name = calx_case_given(node, "name");
    int axis = calx_case_word(r, node, "axis");
    int64_t layers = calx_case_whole(r, node, "layers");
    for (size_t k = 0; name && k < r->scene->profile_count; k++)
        if (strcmp(r->scene->profiles[k].name, name) == 0)
            calx_case_fail(r, node, NULL, "there is already a profile of this name on line %d", r->scene->profiles[k].place.line);
    if (axis >= (int)r->scene->dimension) {
        calx_case_fail(r, node, "axis", "there is no z in 2D");
        return;
    }
    if (axis < 0 || layers < 0)
        return;
    struct calx_profile *p = calx_case_append(r, &r->scene->profiles, &r->scene->profile_count, sizeof *r->scene->profiles);
    if (!p)
        return;
    snprintf(p->name, sizeof p->name, "%.47s", name ? name : "");
    p->place = calx_case_place(r, node);
    p->axis = axis;
    p->layers = (size_t)layers;
    p->groups = calx_case_yes(r, node, "groups");
    read_range(r, node, p);
    read_across(r, node, p);
    read_times(r, node, p);
}

void calx_case_read_profiles(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "profile"); node; node = calx_case_next(node, "profile"))
        read_profile(r, node);
}

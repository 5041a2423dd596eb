/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What a case writes: output and probes. Output: scene->output, scene->probes.
 */
#include "io/case_reader.h"

#include <math.h>
#include <string.h>

#include "core/calx.h"
#include "core/measure.h"

/* The defaults hold too when there is no <output>: its attributes are then those of an empty
 * element. */
static void read_output(struct calx_reader *r, const xmlNode *node)
{
    struct calx_output *output = &r->scene->output;
    double every = calx_case_number(r, node, "csv-every");
    uint32_t fields = calx_case_words(r, node, "fields"),
             all = 1u << 9; /* the last of the choices */
    output->fields = fields & all ? CALX_FIELD_ALL : fields;
    output->network = calx_case_yes(r, node, "network");
    output->single = calx_case_word(r, node, "precision") == 1;
    output->compression = (int)calx_case_whole(r, node, "compression");
    output->csv_every = isnan(every) ? 0.0 : every;
}

static void read_no_output(struct calx_reader *r)
{
    const struct calx_child *child = calx_element_child(calx_elements_root(), "output");
    xmlNode *empty = xmlNewNode(NULL, BAD_CAST "output");
    if (!empty) {
        calx_problems_add(r->problems, (struct calx_place){r->file, 0}, "no memory");
        return;
    }
    empty->_private = (void *)(uintptr_t)child->element;
    read_output(r, empty);
    xmlFreeNode(empty);
}

/* ---- probes
 * -------------------------------------------------------------------------------------------- */

static const struct calx_measure *read_measure(struct calx_reader *r, const xmlNode *node)
{
    const char *of = calx_case_given(node, "of"), *names[96];
    const struct calx_measure *measure = of ? calx_measure_find(of) : NULL;
    size_t count = 0;
    if (measure || !of)
        return measure;
    for (; count < calx_measure_count() && count < 96; count++)
        names[count] = calx_measure_at(count)->name;
    calx_case_fail_name(r, node, "of", "quantity", of, names, count);
    return NULL;
}

static void read_layer(struct calx_reader *r, const xmlNode *node, struct calx_probe *probe)
{
    const char *name = calx_case_given(node, "profile"), *names[32];
    size_t count = 0;
    int64_t layer = calx_case_whole(r, node, "layer");
    probe->layer = layer < 0 ? 0 : layer;
    probe->profile = -1;
    for (size_t k = 0; name && k < r->scene->profile_count; k++) {
        if (count < 32)
            names[count++] = r->scene->profiles[k].name;
        if (strcmp(r->scene->profiles[k].name, name) == 0)
            probe->profile = (int)k;
    }
    if (name && probe->profile < 0)
        calx_case_fail_name(r, node, "profile", "profile", name, names, count);
    else if (name && layer < 1)
        calx_case_fail(r, node, NULL, "attribute 'layer' is missing: which of the profile's, from 1");
    else if (name && (size_t)layer > r->scene->profiles[probe->profile].layers)
        calx_case_fail(r, node, "layer", "%lld, but the profile has %zu", (long long)layer,
                       r->scene->profiles[probe->profile].layers);
}

static void read_choices(struct calx_reader *r, const xmlNode *node, struct calx_probe *probe)
{
    static const char components[] = {'x', 'y', 'z', 'm'};
    int component = calx_case_word(r, node, "component"),
        reduce = calx_case_word(r, node, "reduce");
    double cell = calx_case_number(r, node, "cell");
    int stage = calx_case_stage(r, node, "since");
    probe->particle = calx_case_whole(r, node, "particle");
    probe->material = calx_case_material(r, node, "material");
    probe->wall = calx_case_wall(r, node, "wall");
    read_layer(r, node, probe);
    probe->stage = stage < 0 ? 0 : stage;
    probe->component = component < 0 ? 0 : components[component];
    probe->cell = isnan(cell) ? 0.0 : cell;
    if (reduce >= 0)
        snprintf(probe->reduce, sizeof probe->reduce, "%.11s", calx_case_given(node, "reduce"));
    if (calx_case_given(node, "classes"))
        snprintf(probe->classes, sizeof probe->classes, "%.31s", calx_case_given(node, "classes"));
}

const char *calx_case_needed_choice(const struct calx_measure *measure)
{
    static const struct {
        const char *quantity, *choice;
    } needs[] = {{"wall-force", "wall"},        {"wall-temperature", "wall"}, {"wall-displacement", "wall"},
                 {"wall-velocity", "wall"},     {"wall-friction", "wall"},    {"lacey-index", "classes"},
                 {"layer-velocity", "profile"}, {"layer-temperature", "profile"},
                 {"layer-solid-fraction", "profile"}, {"layer-traction", "profile"},
                 {"steady-drift", "steady"}, {"steady-since", "steady"},
                 {"slab-mean-temperature", "wall"}, {"slab-max-temperature", "wall"}};
    for (size_t k = 0; k < sizeof needs / sizeof *needs; k++)
        if (strcmp(needs[k].quantity, measure->name) == 0)
            return needs[k].choice;
    return measure->components > 1 ? "component" : NULL;
}

/* Choices that contradict each other or the quantity. */
static void check_probe(struct calx_reader *r, const xmlNode *node,
                        const struct calx_measure *measure, const struct calx_probe *probe)
{
    bool one = calx_case_given(node, "particle") != NULL, many = *probe->reduce != '\0';
    const char *needed = calx_case_needed_choice(measure);
    if (needed && !calx_case_given(node, needed))
        calx_case_fail(r, node, NULL, "attribute '%s' is missing: '%s' needs it", needed,
                       measure->name);
    if (measure->per_particle && one == many)
        calx_case_fail(r, node, NULL,
                       "'%s' is of particles, expected either 'particle' or 'reduce'",
                       measure->name);
    if (!measure->per_particle && (one || many))
        calx_case_fail(r, node, one ? "particle" : "reduce", "'%s' is of the whole scene",
                       measure->name);
    if (strcmp(measure->name, "wall-friction") == 0 && (!probe->component || probe->component == 'm'))
        calx_case_fail(r, node, "component", "expected the axis normal to the wall: x, y or z");
    if (measure->components == 1 && probe->component)
        calx_case_fail(r, node, "component", "'%s' is a single number", measure->name);
    if (probe->particle >= 0 && r->scene->particles.count &&
        (size_t)probe->particle >= r->scene->particles.count && !r->problems->count)
        calx_case_fail(r, node, "particle", "no particle %lld, ids go from 0 to %zu",
                       (long long)probe->particle, r->scene->particles.count - 1);
    if (calx_measure_has_classes(probe) && !*probe->classes)
        calx_case_fail(r, node, NULL, "attribute 'classes' is missing: expected one of %s",
                       calx_measure_classes());
    if (*probe->classes && !calx_measure_is_class(probe->classes))
        calx_case_fail(r, node, "classes", "'%s', expected one of %s", probe->classes,
                       calx_measure_classes());
}

static void read_probe(struct calx_reader *r, const xmlNode *node)
{
    const char *name = calx_case_given(node, "name");
    const struct calx_measure *measure = read_measure(r, node);
    for (size_t k = 0; name && k < r->scene->probe_count; k++)
        if (strcmp(r->scene->probes[k].name, name) == 0)
            calx_case_fail(r, node, NULL, "there is already a probe of this name on line %d",
                           r->scene->probes[k].place.line);
    struct calx_probe *probe =
        calx_case_append(r, &r->scene->probes, &r->scene->probe_count, sizeof *r->scene->probes);
    if (!probe)
        return;
    snprintf(probe->name, sizeof probe->name, "%.47s", name ? name : "");
    probe->place = calx_case_place(r, node);
    read_choices(r, node, probe);
    if (!measure)
        return;
    snprintf(probe->quantity, sizeof probe->quantity, "%.63s", measure->name);
    check_probe(r, node, measure, probe);
}

void calx_case_read_output(struct calx_reader *r)
{
    const xmlNode *output = calx_case_first(r->root, "output");
    if (output)
        read_output(r, output);
    else
        read_no_output(r);
    for (const xmlNode *node = calx_case_first(r->root, "probe"); node;
         node = calx_case_next(node, "probe"))
        read_probe(r, node);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * <steady>: a quantity that is watched until it is stationary. Input: the element, profiles and probes. Output: scene->steady, and two probes for
 * each: the columns NAME_drift and NAME_since.
 */
#include "io/case_reader.h"

#include <math.h>
#include <string.h>

#include "core/measure.h"

/* A quantity of all layers of a profile. */
static bool read_layers(struct calx_reader *r, const xmlNode *node, const char *of, struct calx_probe *signal)
{
    const char *name = calx_case_given(node, "profile"), *names[32];
    const struct calx_measure *measure = calx_measure_find(of);
    const char *needed = measure ? calx_case_needed_choice(measure) : NULL;
    int component = calx_case_word(r, node, "component");
    size_t count = 0;
    for (size_t k = 0; k < r->scene->profile_count; k++) {
        if (count < 32)
            names[count++] = r->scene->profiles[k].name;
        if (strcmp(r->scene->profiles[k].name, name) == 0)
            signal->profile = (int)k;
    }
    if (signal->profile < 0)
        calx_case_fail_name(r, node, "profile", "profile", name, names, count);
    if (!needed || strcmp(needed, "profile") != 0) {
        calx_case_fail(r, node, "of", "'%.60s' is no quantity of layers, which `profile` asks for", of);
        return false;
    }
    if ((measure->components > 1) != (component >= 0))
        calx_case_fail(r, node, component < 0 ? NULL : "component", component < 0 ? "attribute 'component' is missing: '%s' is a vector"
                       : "'%s' is a single number", measure->name);
    snprintf(signal->quantity, sizeof signal->quantity, "%.63s", measure->name);
    signal->component = component < 0 ? 0 : "xyz"[component];
    return signal->profile >= 0;
}

static bool read_signal(struct calx_reader *r, const xmlNode *node, struct calx_probe *signal)
{
    const char *of = calx_case_given(node, "of");
    struct calx_error e = {0};
    *signal = (struct calx_probe){.particle = -1, .material = -1, .wall = -1, .profile = -1};
    if (!of)
        return false;
    if (calx_case_given(node, "profile"))
        return read_layers(r, node, of, signal);
    if (calx_case_given(node, "component"))
        calx_case_fail(r, node, "component", "goes with `profile`; otherwise a <probe> says it");
    if (calx_measure_resolve(r->scene, of, signal, &e)) {
        calx_case_fail_with(r, node, "of", &e);
        return false;
    }
    const char *needed = calx_case_needed_choice(calx_measure_find(signal->quantity));
    bool by_probe = false;
    for (size_t k = 0; k < r->scene->probe_count; k++)
        by_probe |= strcmp(r->scene->probes[k].name, of) == 0;
    if (needed && !by_probe)
        calx_case_fail(r, node, "of", "'%.60s' needs a <probe> that says its '%s'", of, needed);
    if (calx_measure_has_classes(signal))
        calx_case_fail(r, node, "of", "a mixing index is not watched");
    signal->profile = -1; /* a layer, if it is one, is that of the probe */
    return true;
}

static void read_times(struct calx_reader *r, const xmlNode *node, struct calx_steady *w)
{
    double every = calx_case_number(r, node, "every");
    int64_t blocks = calx_case_whole(r, node, "blocks");
    w->over = calx_case_number(r, node, "over");
    w->every = isnan(every) ? w->over / 20.0 : every;
    w->after = calx_case_number(r, node, "after");
    w->blocks = blocks > 0 ? (size_t)blocks : 0;
    double samples = w->over / w->every;
    if (!isnan(samples) && (samples < 0.5 || samples > 1e9 || fabs(samples - round(samples)) > 1e-6 * samples))
        calx_case_fail(r, node, "over", "%g s is %g times 'every', expected a whole number of times", w->over, samples);
    if (blocks % 2)
        calx_case_fail(r, node, "blocks", "%lld, expected an even number: two halves are compared", (long long)blocks);
    if (w->signal.profile >= 0 && w->over < (1.0 - 1e-6) * r->scene->profiles[w->signal.profile].over)
        calx_case_fail(r, node, "over", "%g s is less than the profile's window of %g s", w->over,
                       r->scene->profiles[w->signal.profile].over);
}

static void add_column(struct calx_reader *r, const struct calx_steady *w, const char *suffix, const char *quantity)
{
    char name[64];
    snprintf(name, sizeof name, "%s%s", w->name, suffix);
    for (size_t k = 0; k < r->scene->probe_count; k++)
        if (strcmp(r->scene->probes[k].name, name) == 0)
            calx_problems_add(r->problems, w->place, "steady: there is already a column '%s', on line %d", name,
                              r->scene->probes[k].place.line);
    struct calx_probe *probe = calx_case_append(r, &r->scene->probes, &r->scene->probe_count, sizeof *r->scene->probes);
    if (!probe)
        return;
    *probe = (struct calx_probe){.particle = -1, .material = -1, .wall = -1, .profile = -1, .steady = r->scene->steady_count,
                                 .place = w->place};
    snprintf(probe->name, sizeof probe->name, "%.47s", name);
    snprintf(probe->quantity, sizeof probe->quantity, "%.63s", quantity);
}

static void read_steady(struct calx_reader *r, const xmlNode *node)
{
    const char *name = calx_case_given(node, "name");
    struct calx_steady w = {.place = calx_case_place(r, node)};
    if (!name || !read_signal(r, node, &w.signal))
        return;
    if (strlen(name) > 40)
        calx_case_fail(r, node, "name", "longer than 40 letters");
    snprintf(w.name, sizeof w.name, "%.40s", name);
    read_times(r, node, &w);
    w.within = calx_case_number_in(r, node, "within", calx_measure_find(w.signal.quantity)->unit, true);
    struct calx_steady *kept = calx_case_append(r, &r->scene->steady, &r->scene->steady_count, sizeof *r->scene->steady);
    if (!kept)
        return;
    *kept = w;
    add_column(r, &w, "_drift", "steady-drift");
    add_column(r, &w, "_since", "steady-since");
}

void calx_case_read_steady(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "steady"); node; node = calx_case_next(node, "steady"))
        read_steady(r, node);
}

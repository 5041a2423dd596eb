/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What a report compares: quantities with exact solutions, probes, the paths of bodies, their
 * temperatures.
 * Input: the case and --quantity. Output: a list of quantities, each with its place among the numbers
 * of a sample. Without --quantity: what has an exact solution; else the probes, and, as long as paths
 * do not decorrelate, paths and temperatures.
 */
#include <math.h>
#include <string.h>

#include "io/report_parts.h"

static const char paths[] = "paths", temperatures[] = "temperatures";

static const struct calx_exact *find_exact(const struct calx_scene *scene, const char *of)
{
    for (size_t k = 0; k < scene->exact_count; k++)
        if (strcmp(scene->exacts[k].of, of) == 0)
            return &scene->exacts[k];
    return NULL;
}

static bool add(struct calx_report_study *s, struct calx_report_quantity q)
{
    for (size_t k = 0; k < s->quantity_count; k++)
        if (strcmp(s->quantities[k].name, q.name) == 0)
            return true;
    if (s->quantity_count == CALX_REPORT_QUANTITIES)
        return false;
    q.first = s->width;
    s->width += q.width;
    s->quantities[s->quantity_count++] = q;
    return true;
}

static bool add_paths(struct calx_report_study *s)
{
    return add(s, (struct calx_report_quantity){.name = "paths", .unit = "m", .form = CALX_REPORT_PATHS,
                                                .width = 3 * s->body_count});
}

static bool add_temperatures(struct calx_report_study *s)
{
    return add(s, (struct calx_report_quantity){.name = "temperatures", .unit = "K",
                                                .form = CALX_REPORT_TEMPERATURES, .width = s->body_count});
}

/* A probe, column or quantity of the scene. */
static int add_named(struct calx_report_study *s, const char *name, struct calx_error *error)
{
    struct calx_report_quantity q = {.form = CALX_REPORT_NUMBER, .width = 1,
                                     .exact = find_exact(s->run.scene, name)};
    CALX_TRY(calx_measure_resolve(s->run.scene, name, &q.probe, error));
    snprintf(q.name, sizeof q.name, "%.63s", name);
    snprintf(q.unit, sizeof q.unit, "%.31s", calx_measure_find(q.probe.quantity)->unit);
    if (calx_measure_is_peak(&q.probe))
        calx_sim_watch_peak(s->run.sim);
    bool later = calx_measure_has_classes(&q.probe) && q.probe.stage > 0; /* a number from that stage on */
    if (!later && isnan(calx_sim_measure(s->run.sim, &q.probe)))
        return calx_error_set(error, CALX_ERROR_INPUT, "--quantity %s: does not exist in this case", name);
    return add(s, q) ? CALX_OK : calx_error_set(error, CALX_ERROR_INPUT, "more than %d quantities",
                                                CALX_REPORT_QUANTITIES);
}

static int add_wanted(struct calx_report_study *s, bool statistics, struct calx_error *error)
{
    const char *list = s->options->quantities;
    char word[64];
    while (calx_report_options_word(&list, word, sizeof word)) {
        bool path = strcmp(word, paths) == 0, field = strcmp(word, temperatures) == 0;
        if (path && s->axis != CALX_MOTION)
            return calx_error_set(error, CALX_ERROR_INPUT, "--quantity paths: nothing moves in this case");
        if (field && !s->temperature)
            return calx_error_set(error, CALX_ERROR_INPUT, "--quantity temperatures: there are none in this case");
        if ((path || field) && statistics)
            continue; /* the page says that they were left out, and why */
        if (path)
            add_paths(s);
        else if (field)
            add_temperatures(s);
        else
            CALX_TRY(add_named(s, word, error));
    }
    return CALX_OK;
}

static void add_probes(struct calx_report_study *s)
{
    struct calx_error unused;
    for (size_t k = 0; k < s->run.scene->probe_count; k++)
        add_named(s, s->run.scene->probes[k].name, &unused);
}

/* What every chaotic case has: probes alone may all stand still in the time that is compared. */
static void add_means(struct calx_report_study *s)
{
    static const char *const means[] = {"kinetic", "contacts"};
    struct calx_error unused;
    for (size_t k = 0; k < sizeof means / sizeof *means; k++)
        add_named(s, means[k], &unused);
}

int calx_report_quantities_choose(struct calx_report_study *s, bool statistics, struct calx_error *error)
{
    s->quantity_count = s->width = 0;
    if (s->options->quantities)
        CALX_TRY(add_wanted(s, statistics, error));
    else if (s->run.scene->exact_count)
        for (size_t k = 0; k < s->run.scene->exact_count; k++)
            CALX_TRY(add_named(s, s->run.scene->exacts[k].of, error));
    else
        add_probes(s);
    if (statistics && !s->options->quantities)
        add_means(s);
    if (!s->options->quantities && !s->run.scene->exact_count && !statistics) {
        if (s->axis == CALX_MOTION)
            add_paths(s);
        if (s->temperature)
            add_temperatures(s);
    }
    if (s->quantity_count)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_INPUT, "nothing to compare: name a quantity with --quantity");
}

void calx_report_quantities_paths(struct calx_report_study *s)
{
    s->quantity_count = s->width = 0;
    add_paths(s);
}

static void sample_frame(const struct calx_report_study *s, const struct calx_report_quantity *q,
                         const struct calx_frame *f, double *out)
{
    for (size_t b = 0; b < s->body_count; b++) {
        size_t i = s->bodies[b];
        if (q->form == CALX_REPORT_TEMPERATURES)
            out[b] = f && f->temperature ? f->temperature[i] : NAN;
        else
            for (size_t k = 0; k < 3; k++)
                out[3 * b + k] = f ? f->position[i][k] : NAN;
    }
}

void calx_report_quantities_sample(const struct calx_report_study *s, struct calx_sim *sim, double *values)
{
    for (size_t k = 0; k < s->quantity_count; k++) {
        const struct calx_report_quantity *q = &s->quantities[k];
        if (q->form == CALX_REPORT_NUMBER)
            values[q->first] = calx_sim_measure(sim, &q->probe);
        else
            sample_frame(s, q, calx_measure_frame(sim), values + q->first);
    }
}

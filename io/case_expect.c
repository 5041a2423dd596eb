/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What a case says must come out. Output: scene->expects, with values in the unit of their
 * quantity.
 */
#include "io/case_reader.h"

#include <math.h>
#include <string.h>

#include "core/calx.h"
#include "core/measure.h"
#include "io/quantity.h"

/* The attributes that say both when and what; all others take value, above, below. */
static const struct {
    const char *name;
    enum calx_when when;
} results[] = {
    {"always", CALX_ALWAYS}, {"min", CALX_MINIMUM}, {"max", CALX_MAXIMUM}, {"change", CALX_CHANGE}};

/* The one result attribute that is given, or NULL. Two of them, or one with `at`, are a problem. */
static const char *read_when(struct calx_reader *r, const xmlNode *node, struct calx_expect *expect)
{
    const char *chosen = NULL, *at = calx_case_given(node, "at");
    struct calx_error e = {0};
    for (size_t k = 0; k < sizeof results / sizeof *results; k++) {
        if (!calx_case_given(node, results[k].name))
            continue;
        if (chosen || at)
            calx_case_fail(r, node, results[k].name,
                           "'%s' says already when, expected one of at, always, min, max, change",
                           chosen ? chosen : "at");
        chosen = results[k].name;
        expect->when = results[k].when;
    }
    if (!chosen && at && strcmp(at, "end") != 0) {
        expect->when = CALX_AT_TIME;
        if (calx_quantity_parse(at, "s", &expect->time, &e))
            calx_case_fail(r, node, "at", "%s, or 'end'", e.text);
        else if (expect->time < 0)
            calx_case_fail(r, node, "at", "%g s, expected at least 0", expect->time);
    }
    return chosen;
}

static void read_bounds(struct calx_reader *r, const xmlNode *node, const char *unit,
                        bool difference, struct calx_expect *expect)
{
    expect->above = calx_case_number_in(r, node, "above", unit, difference);
    expect->below = calx_case_number_in(r, node, "below", unit, difference);
    if (expect->above > expect->below)
        calx_case_fail(r, node, NULL, "above %g and below %g leave nothing between", expect->above,
                       expect->below);
}

/* The value stands in the attribute that says when, or in `value`. */
static void read_value(struct calx_reader *r, const xmlNode *node, const char *chosen,
                       const char *unit, struct calx_expect *expect)
{
    bool difference = expect->when == CALX_CHANGE;
    bool in_chosen = chosen && strcmp(calx_case_given(node, chosen), "yes") != 0,
         in_value = calx_case_given(node, "value") != NULL;
    int ways =
        in_chosen + in_value + (calx_case_given(node, "above") || calx_case_given(node, "below"));
    if (ways != 1)
        calx_case_fail(r, node, NULL, "has %s, expected either a value or above and below",
                       ways ? "more than one of them" : "no value");
    read_bounds(r, node, unit, difference, expect);
    const char *attribute = in_chosen ? chosen : "value";
    expect->has_value = (in_chosen || in_value) &&
                        calx_case_function_in(r, node, attribute, unit, difference, &expect->value);
    expect->rtol = calx_case_number(r, node, "rtol");
    expect->atol = calx_case_number_in(r, node, "atol", unit, true);
}

int calx_case_stage(struct calx_reader *r, const xmlNode *node, const char *attribute)
{
    const char *stage = calx_case_given(node, attribute), *names[64];
    size_t count = 0;
    for (size_t k = 0; stage && k < r->scene->stage_count; k++)
        if (strcmp(r->scene->stages[k].name, stage) == 0)
            return (int)k;
    for (; count < r->scene->stage_count && count < 64; count++)
        names[count] = r->scene->stages[count].name;
    if (stage)
        calx_case_fail_name(r, node, attribute, "stage", stage, names, count);
    return -1;
}

static bool is_probe(const struct calx_scene *scene, const char *name)
{
    for (size_t k = 0; k < scene->probe_count; k++)
        if (strcmp(scene->probes[k].name, name) == 0)
            return true;
    return false;
}

/* The unit of what is expected; NULL and a problem if there is no such column. */
static const char *read_of(struct calx_reader *r, const xmlNode *node, struct calx_expect *expect)
{
    const char *of = calx_case_given(node, "of");
    struct calx_probe probe = {0};
    struct calx_error e = {0};
    if (!of)
        return NULL;
    snprintf(expect->of, sizeof expect->of, "%.63s", of);
    if (calx_measure_resolve(r->scene, of, &probe, &e)) {
        calx_case_fail_with(r, node, "of", &e);
        return NULL;
    }
    const struct calx_measure *measure = calx_measure_find(probe.quantity);
    const char *needed = measure ? calx_case_needed_choice(measure) : NULL;
    if (needed && !is_probe(r->scene, of))
        calx_case_fail(r, node, "of", "'%.60s' needs a <probe> that says its '%s'", of, needed);
    return measure ? measure->unit : NULL;
}

/* Whether the element expects a refusal, which takes nothing else but where that is known from. */
static bool read_refusal(struct calx_reader *r, const xmlNode *node)
{
    const char *text = calx_case_given(node, "refusal"), *of = calx_case_given(node, "of");
    if (!text && !of)
        calx_case_fail(
            r, node, NULL,
            "needs 'of' (what must come out) or 'refusal' (the message it must be refused with)");
    if (!text)
        return false;
    for (const xmlAttr *a = node->properties; a; a = a->next)
        if (strcmp((const char *)a->name, "refusal") != 0 &&
            strcmp((const char *)a->name, "source") != 0)
            calx_case_fail(r, node, (const char *)a->name, "does not go together with 'refusal'");
    if (!*text)
        calx_case_fail(r, node, "refusal", "is empty, expected a part of the message");
    if (r->scene->expect_count)
        calx_case_fail(
            r, node, "refusal",
            "the case expects results too; it can be refused or come to its end, not both");
    calx_problems_expect(r->problems, text);
    return true;
}

static void read_expect(struct calx_reader *r, const xmlNode *node)
{
    if (read_refusal(r, node))
        return;
    if (r->problems->refusal_count)
        calx_case_fail(
            r, node, NULL,
            "the case expects to be refused; it can be refused or come to its end, not both");
    struct calx_expect *expect =
        calx_case_append(r, &r->scene->expects, &r->scene->expect_count, sizeof *r->scene->expects);
    if (!expect)
        return;
    expect->place = calx_case_place(r, node);
    if (calx_case_given(node, "source"))
        snprintf(expect->source, sizeof expect->source, "%.255s", calx_case_given(node, "source"));
    const char *unit = read_of(r, node, expect), *chosen = read_when(r, node, expect);
    int stage = calx_case_stage(r, node, "stage");
    if (stage >= 0)
        snprintf(expect->stage, sizeof expect->stage, "%s", r->scene->stages[stage].name);
    if (unit)
        read_value(r, node, chosen, unit, expect);
}

void calx_case_read_expects(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "expect"); node;
         node = calx_case_next(node, "expect"))
        read_expect(r, node);
}

/* ---- exact solutions ---- */

/* One with a tolerance is an expectation as well. */
static void expect_exact(struct calx_reader *r, const xmlNode *node, const struct calx_exact *exact,
                         const char *unit)
{
    double rtol = calx_case_number(r, node, "rtol"),
           atol = calx_case_number_in(r, node, "atol", unit, true);
    if (isnan(rtol) && isnan(atol))
        return;
    struct calx_expect *expect =
        calx_case_append(r, &r->scene->expects, &r->scene->expect_count, sizeof *r->scene->expects);
    if (!expect)
        return;
    expect->when = exact->from > 0 ? CALX_AT_END : CALX_ALWAYS;
    expect->has_value = true;
    expect->value = exact->value;
    expect->rtol = isnan(rtol) ? 0 : rtol;
    expect->atol = isnan(atol) ? 0 : atol;
    expect->above = expect->below = NAN;
    expect->place = exact->place;
    memcpy(expect->of, exact->of, sizeof expect->of);
    memcpy(expect->source, exact->source, sizeof expect->source);
}

static void read_exact(struct calx_reader *r, const xmlNode *node)
{
    struct calx_exact exact = {.place = calx_case_place(r, node), .source = "exact"};
    struct calx_expect named = {0};
    const char *source = calx_case_given(node, "source"), *unit = read_of(r, node, &named);
    memcpy(exact.of, named.of, sizeof exact.of);
    for (size_t k = 0; unit && k < r->scene->exact_count; k++)
        if (strcmp(r->scene->exacts[k].of, exact.of) == 0)
            calx_case_fail(r, node, "of", "'%s' has an exact solution already, on line %d",
                           exact.of, r->scene->exacts[k].place.line);
    exact.from = calx_case_number(r, node, "from");
    if (source)
        snprintf(exact.source, sizeof exact.source, "%.255s", source);
    if (!unit || !calx_case_given(node, "value") ||
        !calx_case_function_in(r, node, "value", unit, false, &exact.value))
        return;
    struct calx_exact *kept =
        calx_case_append(r, &r->scene->exacts, &r->scene->exact_count, sizeof *r->scene->exacts);
    if (!kept)
        return;
    *kept = exact;
    expect_exact(r, node, kept, unit);
}

void calx_case_read_exacts(struct calx_reader *r)
{
    for (const xmlNode *node = calx_case_first(r->root, "exact"); node;
         node = calx_case_next(node, "exact"))
        read_exact(r, node);
}

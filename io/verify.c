/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Follows the expectations of a case during its run and judges them.
 * Input: the state at each record. Output: a verdict per expectation.
 * Method: each kind of expectation (at the end, always, minimum, ...) is a rule that says which
 * states it keeps; what is kept is judged by its excess: how far the value lies outside its
 * tolerance or bound, passed if not above 0. A value that is no number has no excess and fails.
 */
#include "io/verify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is kept of the states seen; saved as bytes. */
struct kept {
    double value, time, first;
    int64_t seen;
};

struct calx_verify {
    const struct calx_scene *scene;
    size_t count;
    struct kept *kept;
    struct calx_probe *probes;
};

/* ---- judgement ---- */

static struct calx_verdict judge(const struct calx_expect *e, const struct kept *kept)
{
    const double origin[3] = {0, 0, 0};
    bool change = e->when == CALX_CHANGE;
    struct calx_verdict v = {
        .expect = e, .expected = NAN, .error = NAN, .tolerance = NAN, .time = NAN};
    v.got = !kept->seen ? NAN : change ? kept->value - kept->first : kept->value;
    if (!kept->seen)
        return v;
    v.time = kept->time;
    if (!e->has_value) {
        double under = isnan(e->above) ? 0 : e->above - v.got,
               over = isnan(e->below) ? 0 : v.got - e->below;
        v.error = isnan(v.got) ? NAN : fmax(0, fmax(under, over));
        v.passed = under <= 0 && over <= 0;
        return v;
    }
    v.expected = calx_evaluate(&e->value, v.time, origin);
    /* a change is small against what changes: its relative tolerance is that of the quantity itself
     */
    double scale = change ? fmax(fabs(kept->first), fabs(kept->value)) : fabs(v.expected);
    v.tolerance = (isnan(e->atol) ? 0 : e->atol) + (isnan(e->rtol) ? 0 : e->rtol * scale);
    v.error = fabs(v.got - v.expected);
    v.passed = v.error <= v.tolerance;
    return v;
}

/* How far outside: error over tolerance, or the error itself if there is none. Not a number counts
 * as worst. */
static double severity(const struct calx_expect *e, double value, double time)
{
    struct kept state = {value, time, 0, 1};
    struct calx_verdict v = judge(e, &state);
    if (isnan(v.error) || isnan(v.got))
        return INFINITY;
    return v.tolerance > 0 ? v.error / v.tolerance : v.error;
}

/* ---- which states are kept ---- */

static bool keep_last(const struct calx_expect *e, const struct kept *k, double value, double time,
                      double before)
{
    (void)e, (void)k, (void)value, (void)time, (void)before;
    return true;
}

/* Half a millionth of a step: times are sums of steps and may miss a round number by their
 * rounding. */
static double slack(double before, double now)
{
    return 0.5e-6 * (now - before);
}

static bool reaches(double when, double before, double now)
{
    double s = slack(before, now);
    return when <= now + s && (when > before + s || before == now);
}

static bool keep_at(const struct calx_expect *e, const struct kept *k, double value, double time,
                    double before)
{
    (void)k, (void)value;
    return reaches(e->time, before, time) && (before < time || e->time == time);
}

static bool keep_worst(const struct calx_expect *e, const struct kept *k, double value, double time,
                       double before)
{
    (void)before;
    return severity(e, value, time) >= severity(e, k->value, k->time);
}

static bool keep_lower(const struct calx_expect *e, const struct kept *k, double value, double time,
                       double before)
{
    (void)e, (void)time, (void)before;
    return !(value >= k->value);
}

static bool keep_higher(const struct calx_expect *e, const struct kept *k, double value,
                        double time, double before)
{
    (void)e, (void)time, (void)before;
    return !(value <= k->value);
}

static const struct {
    const char *word;
    bool (*keep)(const struct calx_expect *, const struct kept *, double value, double time,
                 double before);
    bool needs_time; /* the first state seen is not kept unless the rule says so */
} rules[] = {
    [CALX_AT_END] = {"at the end", keep_last, false},
    [CALX_AT_TIME] = {"at", keep_at, true},
    [CALX_ALWAYS] = {"always", keep_worst, false},
    [CALX_MINIMUM] = {"minimum", keep_lower, false},
    [CALX_MAXIMUM] = {"maximum", keep_higher, false},
    [CALX_CHANGE] = {"change", keep_last, false},
};

bool calx_verify_is_due(const struct calx_verify *verify, double before, double now)
{
    for (size_t i = 0; i < verify->count; ++i) {
        const struct calx_expect *e = &verify->scene->expects[i];
        if (e->when == CALX_AT_TIME && keep_at(e, NULL, 0, now, before))
            return true;
    }
    return false;
}

/* A step that ends a stage shows the end of that stage and the start of the next. */
static bool in_stage(const struct calx_scene *scene, const struct calx_expect *e, int from, int to)
{
    bool inside = !e->stage[0];
    for (int s = from; s <= to && s < (int)scene->stage_count; ++s)
        inside = inside || strcmp(scene->stages[s].name, e->stage) == 0;
    return inside;
}

void calx_verify_record(struct calx_verify *verify, struct calx_sim *sim, double before, int stage)
{
    double now = calx_sim_time(sim);
    for (size_t i = 0; i < verify->count; ++i) {
        const struct calx_expect *e = &verify->scene->expects[i];
        struct kept *k = &verify->kept[i];
        if (!in_stage(verify->scene, e, stage, calx_sim_stage(sim)))
            continue;
        if (rules[e->when].needs_time && !rules[e->when].keep(e, k, 0, now, before))
            continue;
        double value = calx_sim_measure(sim, &verify->probes[i]);
        if (!k->seen)
            k->first = value;
        if (!k->seen || rules[e->when].keep(e, k, value, now, before)) {
            k->value = value;
            k->time = now;
        }
        k->seen += 1;
    }
}

/* ---- results ---- */

size_t calx_verify_count(const struct calx_verify *verify)
{
    return verify->count;
}

struct calx_verdict calx_verify_verdict(const struct calx_verify *verify, size_t i)
{
    return judge(&verify->scene->expects[i], &verify->kept[i]);
}

size_t calx_verify_failures(const struct calx_verify *verify)
{
    size_t failures = 0;
    for (size_t i = 0; i < verify->count; ++i)
        failures += !calx_verify_verdict(verify, i).passed;
    return failures;
}

void calx_verify_print_header(FILE *file)
{
    fprintf(file, "%-22s %-34s %14s %14s %10s %10s  %-7s %s\n", "case", "quantity", "expected",
            "got", "error", "tolerance", "verdict", "source");
}

static void print_expected(const struct calx_verdict *v, char *text, size_t size)
{
    const struct calx_expect *e = v->expect;
    if (e->has_value)
        snprintf(text, size, "%.8g", v->expected);
    else if (isnan(e->above))
        snprintf(text, size, "< %.6g", e->below);
    else if (isnan(e->below))
        snprintf(text, size, "> %.6g", e->above);
    else
        snprintf(text, size, "%.4g..%.4g", e->above, e->below);
}

static void print_quantity(const struct calx_verdict *v, char *text, size_t size)
{
    const struct calx_expect *e = v->expect;
    char time[32] = "";
    if (e->when == CALX_AT_TIME)
        snprintf(time, sizeof time, " %g s", e->time);
    snprintf(text, size, "%s %s%s%s%s", e->of, rules[e->when].word, time, e->stage[0] ? " of " : "",
             e->stage);
}

void calx_verify_print(const struct calx_verify *verify, const char *name, FILE *file)
{
    for (size_t i = 0; i < verify->count; ++i) {
        struct calx_verdict v = calx_verify_verdict(verify, i);
        char expected[48], quantity[160], tolerance[24] = "bound";
        print_expected(&v, expected, sizeof expected);
        print_quantity(&v, quantity, sizeof quantity);
        if (v.expect->has_value)
            snprintf(tolerance, sizeof tolerance, "%.2e", v.tolerance);
        const char *verdict = v.passed ? "passed" : isnan(v.time) ? "unseen" : "FAILED";
        fprintf(file, "%-22s %-34s %14s %14.8g %10.2e %10s  %-7s %s\n", name, quantity, expected,
                v.got, v.error, tolerance, verdict, v.expect->source);
    }
}

/* ---- life ---- */

struct calx_verify *calx_verify_create(const struct calx_scene *scene, struct calx_error *error)
{
    size_t n = scene->expect_count;
    struct calx_verify *verify = calloc(1, sizeof *verify);
    if (verify)
        *verify = (struct calx_verify){scene, n, calloc(n + 1, sizeof *verify->kept),
                                       calloc(n + 1, sizeof *verify->probes)};
    if (!verify || !verify->kept || !verify->probes) {
        calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
        calx_verify_free(verify);
        return NULL;
    }
    for (size_t i = 0; i < n; ++i) {
        const struct calx_expect *e = &scene->expects[i];
        struct calx_error why;
        if (calx_measure_resolve(scene, e->of, &verify->probes[i], &why) != CALX_OK) {
            calx_error_at(error, why.code, e->place, "expect: %s", why.text);
            calx_verify_free(verify);
            return NULL;
        }
    }
    return verify;
}

void calx_verify_free(struct calx_verify *verify)
{
    if (!verify)
        return;
    free(verify->kept);
    free(verify->probes);
    free(verify);
}

struct calx_block calx_verify_save(const struct calx_verify *verify)
{
    return (struct calx_block){"expectations", verify->kept, verify->count * sizeof *verify->kept};
}

int calx_verify_restore(struct calx_verify *verify, const struct calx_block *block,
                        struct calx_error *error)
{
    size_t bytes = verify->count * sizeof *verify->kept;
    if (block->bytes != bytes)
        return calx_error_set(
            error, CALX_ERROR_INPUT,
            "the restart file is of a case with %zu expectations, this one has %zu",
            block->bytes / sizeof *verify->kept, verify->count);
    memcpy(verify->kept, block->data, bytes);
    return CALX_OK;
}

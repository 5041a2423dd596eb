/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance suite: the report, and the choices of parameters that a plugin is tried with,
 * taken from its own table. Input: a plugin that the loader accepted. Output: the worst figure of
 * each check over all choices. The checks themselves are in conform_contact.c, conform_cycle.c,
 * conform_condition.c, conform_heat.c, conform_motion.c and conform_stability.c.
 */
#include "core/conform.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/conform_parts.h"

const struct calx_setup calx_conform_setups[2] = {
    {.size = sizeof(struct calx_setup),
     .dimension = 3,
     .bodies = CALX_SPHERES,
     .velocity_lag = 0.5},
    {.size = sizeof(struct calx_setup),
     .dimension = 2,
     .bodies = CALX_DISCS,
     .thickness = 1e-2,
     .velocity_lag = 0.5},
};

double calx_conform_random(uint64_t *state, double low, double high)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u; /* splitmix64, Steele, Lea and Flood 2014 */
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* ---- the report ---- */

/* How far beyond its bound: comparable between figures of one check. */
static double excess(double figure, double bound)
{
    return isnan(figure) ? INFINITY : figure - bound;
}

void calx_conform_note(struct calx_conformance *r, const char *name, double figure, double bound,
                       const char *where)
{
    size_t k = 0;
    while (k < r->count && strcmp(r->checks[k].name, name) != 0)
        k++;
    if (k == CALX_CHECKS_MAX)
        return;
    struct calx_check *c = &r->checks[k];
    if (k < r->count && !(excess(figure, bound) > excess(c->figure, c->bound)))
        return;
    bool failed = !(figure <= bound);
    r->failed += (size_t)failed - (k < r->count && !c->passed);
    r->count += k == r->count;
    *c = (struct calx_check){.name = name, .figure = figure, .bound = bound, .passed = !failed};
    snprintf(c->where, sizeof c->where, "%s", where);
}

/* ---- values ---- */

/* A value inside the range: its geometric middle, or a small number if the range reaches zero. */
static double inside(const struct calx_parameter *row)
{
    if (row->min > 0)
        return isfinite(row->max) ? sqrt(row->min) * sqrt(row->max) : row->min * 1e3;
    return fmin(fmax(0.3, row->min), row->max);
}

double calx_choice_typical(const struct calx_parameter *row)
{
    return row->flags & CALX_OPTIONAL   ? NAN
           : row->flags & CALX_REQUIRED ? inside(row)
                                        : row->initial;
}

/* Another value than the typical one, or NaN if there is none. */
static double other(const struct calx_parameter *row)
{
    if (row->flags & (CALX_SWITCH | CALX_CHOICE))
        return row->initial < row->max ? row->initial + 1 : row->min;
    return row->flags & CALX_REQUIRED ? NAN : inside(row);
}

/* The end of the range, or a number next to it if the end itself is excluded. */
static double end(const struct calx_parameter *row, int upper)
{
    double v = upper ? row->max : row->min;
    v = isfinite(v) ? v : copysign(1e300, v);
    if (row->flags & (upper ? CALX_OPEN_MAX : CALX_OPEN_MIN))
        v += (upper ? -1e-6 : 1e-6) *
             (isfinite(row->max - row->min) ? fmin(row->max - row->min, 1) : 1);
    return v;
}

/* ---- one choice ---- */

/* The first phase of each kind. */
static int prepare_contact(struct calx_choice *c, char *why, size_t why_size)
{
    const struct calx_contact_law *law = c->plugin->law;
    c->demand = law->demand;
    return law->prepare ? law->prepare(&c->setup, c->params, &c->demand, why, why_size) : 0;
}

static int prepare_conductance(struct calx_choice *c, char *why, size_t why_size)
{
    const struct calx_conductance_law *law = c->plugin->law;
    c->demand = law->demand;
    return law->prepare ? law->prepare(&c->setup, c->params, &c->demand, why, why_size) : 0;
}

static int prepare_motion(struct calx_choice *c, char *why, size_t why_size)
{
    memcpy(&c->motion, c->plugin->law, sizeof c->motion);
    return c->motion.prepare
               ? c->motion.prepare(&c->setup, c->params, &c->motion, why, why_size)
               : 0;
}

static int prepare_temperature(struct calx_choice *c, char *why, size_t why_size)
{
    const struct calx_temperature_integrator *law = c->plugin->law;
    return law->prepare ? law->prepare(&c->setup, c->params, why, why_size) : 0;
}

static const struct {
    int (*prepare)(struct calx_choice *, char *why, size_t why_size);
    size_t release; /* offset of the function in the law */
    calx_choice_visit *suite;
} kinds[] = {
    [CALX_CONTACT] = {prepare_contact, offsetof(struct calx_contact_law, release),
                      calx_conform_contact},
    [CALX_CONDUCTANCE] = {prepare_conductance, offsetof(struct calx_conductance_law, release),
                          calx_conform_conductance},
    [CALX_MOTION] = {prepare_motion, offsetof(struct calx_motion_integrator, release),
                     calx_conform_motion},
    [CALX_TEMPERATURE] = {prepare_temperature,
                          offsetof(struct calx_temperature_integrator, release),
                          calx_conform_temperature},
};

static void choice_release(struct calx_choice *c)
{
    void (*release)(void *);
    memcpy(&release, (const char *)c->plugin->law + kinds[c->plugin->kind].release, sizeof release);
    if (release)
        release(c->params);
}

int calx_choice_exchange(struct calx_choice *c)
{
    char why[240];
    choice_release(c);
    for (size_t i = 0; i < c->plugin->parameter_count; i++) {
        const struct calx_parameter *row = &c->plugin->parameters[i];
        double *field = (double *)((char *)c->params + row->offset), keep = field[0];
        if (row->scope != CALX_MATERIAL)
            continue;
        field[0] = field[1];
        field[1] = keep;
    }
    return kinds[c->plugin->kind].prepare(c, why, sizeof why);
}

static void choice_put(struct calx_choice *c, const struct calx_parameter *row, double value)
{
    double *field = (double *)((char *)c->params + row->offset);
    field[0] = value;
    if (row->scope ==
        CALX_MATERIAL) /* two materials that differ, so that exchanging them matters */
        field[1] = fmin(fmax(0.8 * value, row->min), row->max);
}

/* One row to change, or none. */
struct change {
    const struct calx_parameter *row;
    double value;
};

/* Prepares typical values with the changes, visits, releases. Returns whether prepare accepted. */
static bool choice_try(const struct calx_plugin *p, const struct calx_setup *setup,
                       const struct change changes[2], struct calx_conformance *report,
                       calx_choice_visit *visit, char *why)
{
    struct calx_choice c = {
        .plugin = p, .setup = *setup, .params = calloc(1, p->params_size ? p->params_size : 1)};
    int used = snprintf(c.where, sizeof c.where, "%s", setup->bodies == CALX_DISCS ? "discs" : "");
    if (setup->uses_velocity)
        used = snprintf(c.where, sizeof c.where, "forces use velocities");
    if (!c.params)
        return false;
    for (size_t i = 0; i < p->parameter_count; i++)
        choice_put(&c, &p->parameters[i], calx_choice_typical(&p->parameters[i]));
    for (int k = 0; k < 2; k++) {
        if (!changes[k].row)
            continue;
        choice_put(&c, changes[k].row, changes[k].value);
        used += snprintf(c.where + used, sizeof c.where - (size_t)used, "%s%s=%g", used ? ", " : "",
                         changes[k].row->name, changes[k].value);
    }
    char text[240] = "";
    bool accepted = kinds[p->kind].prepare(&c, text, sizeof text) == 0;
    if (accepted) {
        visit(&c, report);
        choice_release(&c);
    } else if (why)
        snprintf(why, 256, "refused: %s", text);
    free(c.params);
    return accepted;
}

size_t calx_choice_each(const struct calx_plugin *p, const struct calx_setup *setup,
                        struct calx_conformance *report, calx_choice_visit *visit, char *why)
{
    struct change changes[2] = {0};
    size_t count = choice_try(p, setup, changes, report, visit, why);
    for (size_t i = 0; i < p->parameter_count; i++) {
        changes[0] = (struct change){&p->parameters[i], other(&p->parameters[i])};
        changes[1].row = NULL;
        if (isnan(changes[0].value))
            continue;
        count += choice_try(p, setup, changes, report, visit, NULL);
        for (size_t k = i + 1; k < p->parameter_count; k++) {
            changes[1] = (struct change){&p->parameters[k], other(&p->parameters[k])};
            if (!isnan(changes[1].value))
                count += choice_try(p, setup, changes, report, visit, NULL);
        }
    }
    return count;
}

size_t calx_choice_each_bound(const struct calx_plugin *p, const struct calx_setup *setup,
                              struct calx_conformance *report, calx_choice_visit *visit)
{
    size_t count = 0;
    for (size_t i = 0; i < p->parameter_count; i++) {
        const struct calx_parameter *row = &p->parameters[i];
        double step = row->flags & (CALX_SWITCH | CALX_CHOICE) ? 1 : end(row, 1) - end(row, 0);
        for (double v = end(row, 0); v <= end(row, 1); v += step) {
            struct change changes[2] = {{row, v}, {NULL, 0}};
            count += choice_try(p, setup, changes, report, visit, NULL);
            if (step <= 0)
                break;
        }
    }
    return count;
}

/* ---- the suite ---- */

int calx_conform_run(const struct calx_plugin *p, struct calx_conformance *report,
                     struct calx_error *error)
{
    memset(report, 0, sizeof *report);
    if (p->kind < CALX_CONTACT || p->kind > CALX_TEMPERATURE)
        return calx_error_set(error, CALX_ERROR_INPUT, "the plugin %s is of no known kind",
                              p->name);
    char why[256] = "";
    size_t accepted = 0;
    for (size_t k = 0; k < 2; k++) {
        accepted += calx_choice_each(p, &calx_conform_setups[k], report, kinds[p->kind].suite, why);
        if (p->kind == CALX_CONTACT || p->kind == CALX_CONDUCTANCE)
            calx_choice_each_bound(p, &calx_conform_setups[k], report, calx_trial_check_finite);
    }
    if (p->kind == CALX_MOTION) {
        struct calx_setup uses = calx_conform_setups[0];
        uses.uses_velocity = 1;
        calx_choice_each(p, &uses, report, calx_conform_motion, why);
        calx_choice_each_bound(p, &calx_conform_setups[0], report, calx_conform_motion);
    }
    calx_conform_note(report, "typical values are accepted", accepted == 0, 0, accepted ? "" : why);
    return 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * plugin_kernels FILE.so...: calls the kernels of plugins over full batches, for a counter of instructions to look at
 * (test_instructions.py, under callgrind). Each choice of parameters, the typical one and those that differ in one row, is one call of
 * drive(), which is dumped at its end; one line says plugin, choice, how many contacts, particles or bodies went through, and a hash of
 * the results, which must be the same on any machine (tests/aarch64).
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/conform_rows.h"
#include "core/loader.h"

enum { TURNS = 8, BODIES = 512, SEED = 271828 };

/* Rows of BODIES particles, as the engine keeps them: translation and rotation side by side. */
static struct {
    _Alignas(64) double x[4 * BODIES], v[8 * BODIES], a[8 * BODIES], extra[CALX_OSCILLATOR_EXTRA][4 * BODIES];
} rows;

static struct {
    double temperature[4 * BODIES], inflow[4 * BODIES], capacity[BODIES], source[BODIES], inverse[BODIES];
    double conductance[BODIES];
    int32_t edge[2][BODIES];
} heat;

static struct calx_trial trial;
static struct calx_oscillators oscillators;

static void drive_batches(const struct calx_choice *c)
{
    calx_trial_evaluate(&trial, c);
}

static void run_stages(const struct calx_choice *c, const struct calx_stage *stages, struct calx_rows *r)
{
    for (r->stage = c->motion.start; r->stage < c->motion.start + c->motion.stages; r->stage++) {
        if (stages[r->stage].before)
            stages[r->stage].before(c->params, r);
        if (stages[r->stage].after)
            stages[r->stage].after(c->params, r);
    }
}

static void drive_motion(const struct calx_choice *c)
{
    double *extra[CALX_OSCILLATOR_EXTRA], dt = 1e-6;
    for (size_t k = 0; k < CALX_OSCILLATOR_EXTRA; k++)
        extra[k] = rows.extra[k];
    struct calx_rows r = {.size = sizeof r, .n = BODIES, .stride = 8, .dt = {dt, dt, dt, 0, dt, dt, dt, 0},
                          .x = rows.x, .v = rows.v, .a = rows.a, .extra = extra};
    if (c->motion.advance) {
        calx_oscillators_step(&oscillators, c);
    } else if (c->motion.whole) {
        run_stages(c, c->motion.whole, &r);
    } else {
        run_stages(c, c->motion.translation, &r);
        r.x = NULL, r.v += 4, r.a += 4;
        run_stages(c, c->motion.rotation, &r);
    }
}

/* A chain of bodies with a source in each. */
static void drive_temperature(const struct calx_choice *c)
{
    const struct calx_temperature_integrator *law = c->plugin->law;
    char why[256] = "";
    struct calx_network net = {.size = sizeof net, .n = BODIES, .dt = 1, .temperature = heat.temperature,
                               .capacity = heat.capacity, .source = heat.source, .edges = BODIES - 1,
                               .edge = {heat.edge[0], heat.edge[1]}, .edge_conductance = heat.conductance};
    if (law->advance)
        law->advance(c->params, BODIES, 1e-3, heat.temperature, 4, heat.inflow, 4, heat.inverse);
    else if (law->solve(c->params, &net, why, sizeof why))
        fprintf(stderr, "%s: %s\n", c->plugin->name, why), exit(1);
}

static void fill(const struct calx_choice *c)
{
    uint64_t seed = SEED;
    memset(&rows, 0, sizeof rows);
    memset(&trial, 0, sizeof trial);
    for (size_t i = 0; i < 8 * BODIES; i++)
        rows.v[i] = rows.a[i] = 0.1;
    for (size_t i = 0; i < BODIES; i++) {
        heat.capacity[i] = heat.inverse[i] = heat.conductance[i] = 1;
        heat.source[i] = calx_conform_random(&seed, 0, 1);
        heat.edge[0][i] = (int32_t)i, heat.edge[1][i] = (int32_t)i + 1;
    }
    for (size_t i = 0; i < 4 * BODIES; i++)
        heat.temperature[i] = 300, heat.inflow[i] = 0.1;
    if (c->plugin->kind == CALX_CONTACT || c->plugin->kind == CALX_CONDUCTANCE)
        calx_trial_fill(&trial, c, CALX_BATCH, SEED);
    if (c->plugin->kind == CALX_MOTION && c->motion.advance)
        calx_oscillators_begin(&oscillators, CALX_OSCILLATORS, 4, 1e-2, false);
}

static const struct {
    const char *name;
    void (*drive)(const struct calx_choice *);
} kinds[] = {[CALX_CONTACT] = {"contact", drive_batches},
             [CALX_CONDUCTANCE] = {"conductance", drive_batches},
             [CALX_MOTION] = {"motion", drive_motion},
             [CALX_TEMPERATURE] = {"temperature", drive_temperature}};

/* Its name is asked of callgrind. */
void drive(const struct calx_choice *c);
__attribute__((noinline)) void drive(const struct calx_choice *c)
{
    for (int turn = 0; turn < TURNS; turn++)
        kinds[c->plugin->kind].drive(c);
}

static size_t units(const struct calx_choice *c)
{
    if (c->plugin->kind <= CALX_CONDUCTANCE)
        return TURNS * CALX_BATCH;
    return TURNS * (c->plugin->kind == CALX_MOTION && c->motion.advance ? CALX_OSCILLATORS : BODIES);
}

/* FNV-1a. NaN is one value, whatever its bits: it stands in columns that the law has not asked for. */
static void mix(uint64_t *hash, const double *values, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        uint64_t bits = 0;
        if (!isnan(values[k]))
            memcpy(&bits, &values[k], sizeof bits);
        for (size_t byte = 0; byte < sizeof bits; byte++)
            *hash = (*hash ^ (bits >> 8 * byte & 255)) * 0x100000001b3u;
    }
}

static uint64_t hash_results(void)
{
    uint64_t hash = 0xcbf29ce484222325u;
    mix(&hash, trial.column[0], CALX_COL_COUNT * CALX_BATCH);
    mix(&hash, rows.x, sizeof rows.x / sizeof *rows.x);
    mix(&hash, rows.v, sizeof rows.v / sizeof *rows.v);
    mix(&hash, heat.temperature, sizeof heat.temperature / sizeof *heat.temperature);
    mix(&hash, oscillators.x, sizeof oscillators.x / sizeof *oscillators.x);
    return hash;
}

static void visit(struct calx_choice *c, struct calx_conformance *report)
{
    (void)report;
    if (strchr(c->where, ',')) /* two rows differ: no other kernels than those of each */
        return;
    fill(c);
    drive(c);
    printf("%s-%s\t%s\t%zu\t%016" PRIx64 "\n", kinds[c->plugin->kind].name, c->plugin->name, c->where, units(c),
           hash_results());
}

int main(int count, char **files)
{
    struct calx_registry *r = calx_registry_create(NULL);
    struct calx_conformance report = {0};
    struct calx_error error;
    for (int k = 1; k < count; k++) {
        const struct calx_plugin *p = calx_registry_load(r, files[k], &error);
        if (!p)
            return fprintf(stderr, "%s\n", error.text), 1;
        calx_choice_each(p, &calx_conform_setups[0], &report, visit, NULL);
    }
    calx_registry_free(r);
    return 0;
}

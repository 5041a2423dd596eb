/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The quantities that probes, expectations, stage conditions and the CSV may name.
 * Input: a frame (copy of the state in order of id) and the ledger of a simulation. Output: one
 * double. Method: the rows of core/measure_table.c; frame and ledger are made at the first use in a
 * step and kept for the others.
 */
#include "core/measure_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/lacey.h"

/* ---- cache ---- */

void calx_measure_clear(struct calx_measure_cache *cache)
{
    calx_frame_free(cache->frame);
    *cache = (struct calx_measure_cache){0};
}

const struct calx_frame *calx_measure_frame(struct calx_sim *sim)
{
    struct calx_measure_cache *cache = calx_sim_measure_cache(sim);
    int64_t step = calx_sim_step_count(sim);
    if (cache->frame && cache->frame_step == step)
        return cache->frame;
    struct calx_frame *frame = calx_frame_create(sim, true);
    if (!frame)
        return NULL;
    if (cache->frame && !cache->written && cache->frame->walls_changed)
        frame->walls_changed = true;
    calx_frame_free(cache->frame);
    cache->frame = frame;
    cache->frame_step = step;
    cache->written = false;
    return frame;
}

void calx_measure_mark_written(struct calx_sim *sim)
{
    calx_sim_measure_cache(sim)->written = true;
}

const struct calx_ledger *calx_measure_ledger(struct calx_sim *sim)
{
    struct calx_measure_cache *cache = calx_sim_measure_cache(sim);
    int64_t step = calx_sim_step_count(sim);
    if (!cache->has_ledger || cache->ledger_step != step)
        cache->ledger = calx_sim_ledger(sim);
    cache->has_ledger = true;
    cache->ledger_step = step;
    return &cache->ledger;
}

/* ---- one value ---- */

double calx_measure_step_share(struct calx_sim *sim, int64_t *id)
{
    struct calx_measure_cache *cache = calx_sim_measure_cache(sim);
    int64_t step = calx_sim_step_count(sim);
    if (!cache->has_share || cache->share_step != step)
        cache->share = calx_sim_step_share(sim, &cache->share_id);
    cache->has_share = true;
    cache->share_step = step;
    *id = cache->share_id;
    return cache->share;
}

/* The chosen component; the size of a vector if none is chosen. */
static double component(const double value[3], int components, char which)
{
    if (components == 1)
        return value[0];
    return which >= 'x' && which <= 'z' ? value[which - 'x'] : sqrt(calx_measure_square(value));
}

struct tally {
    double n, sum, min, max, spread; /* spread: sum of squares about the mean */
};

static double reduce_mean(const struct tally *t)
{
    return t->sum / t->n;
}
static double reduce_min(const struct tally *t)
{
    return t->min;
}
static double reduce_max(const struct tally *t)
{
    return t->max;
}
static double reduce_sum(const struct tally *t)
{
    return t->sum;
}
static double reduce_std(const struct tally *t)
{
    return sqrt(t->spread / t->n);
}

static const struct {
    const char *name;
    double (*take)(const struct tally *);
} reductions[] = {
    {"mean", reduce_mean}, {"min", reduce_min}, {"max", reduce_max},
    {"sum", reduce_sum},   {"std", reduce_std},
};

static bool particle_value(const struct calx_measure_row *row, const struct calx_frame *f,
                           const struct calx_probe *p, size_t i, double *value)
{
    double out[3] = {0, 0, 0};
    if (p->material >= 0 && (!f->material || f->material[i] != p->material))
        return false;
    if (!row->particle(f, i, out))
        return false;
    *value = component(out, row->measure.components, p->component);
    return true;
}

/* Two passes, so that the spread of hot grains (1e3 K) about their mean keeps its digits. */
static struct tally tally_particles(const struct calx_measure_row *row, const struct calx_frame *f,
                                    const struct calx_probe *p)
{
    struct tally t = {0, 0, INFINITY, -INFINITY, 0};
    double value;
    for (size_t i = 0; i < f->n; ++i) {
        if (!particle_value(row, f, p, i, &value))
            continue;
        t.n += 1;
        t.sum += value;
        t.min = fmin(t.min, value);
        t.max = fmax(t.max, value);
    }
    for (size_t i = 0; i < f->n; ++i)
        if (particle_value(row, f, p, i, &value))
            t.spread += (value - t.sum / t.n) * (value - t.sum / t.n);
    return t;
}

static double measure_particles(const struct calx_measure_row *row,
                                const struct calx_measure_view *v)
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    const struct calx_probe *p = v->probe;
    double value = NAN;
    if (!f)
        return NAN;
    if (p->particle >= 0)
        return (size_t)p->particle < f->n && particle_value(row, f, p, (size_t)p->particle, &value)
                   ? value
                   : NAN;
    struct tally t = tally_particles(row, f, p);
    if (t.n == 0)
        return NAN;
    for (size_t i = 0; i < sizeof reductions / sizeof reductions[0]; ++i)
        if (strcmp(reductions[i].name, p->reduce[0] ? p->reduce : "mean") == 0)
            return reductions[i].take(&t);
    return NAN;
}

double calx_sim_measure(struct calx_sim *sim, const struct calx_probe *probe)
{
    const struct calx_measure_row *row = calx_measure_row(probe->quantity);
    const struct calx_measure_view v = {sim, probe};
    double out[3] = {0, 0, 0};
    if (!row)
        return NAN;
    if (row->particle)
        return measure_particles(row, &v);
    if (row->entry)
        return ((const double *)calx_measure_ledger(sim))[row->entry - 1];
    return row->whole(&v, out) ? component(out, row->measure.components, probe->component) : NAN;
}

/* ---- names ---- */

/* Equal but for '-' and '_'. */
static bool same_name(const char *a, const char *b)
{
    for (; *a && *b; ++a, ++b)
        if (*a != *b && !(strchr("-_", *a) && strchr("-_", *b)))
            return false;
    return *a == *b;
}

static void plain_probe(struct calx_probe *p, const char *quantity, const char *reduce)
{
    *p = (struct calx_probe){.particle = -1, .material = -1, .wall = -1};
    strncpy(p->name, quantity, sizeof p->name - 1);
    strncpy(p->quantity, quantity, sizeof p->quantity - 1);
    strncpy(p->reduce, reduce, sizeof p->reduce - 1);
}

static int unknown_name(const struct calx_scene *scene, const char *of, struct calx_error *error)
{
    size_t n = 0, most = scene->probe_count + calx_column_count() + calx_measure_count();
    const char **names = malloc(most * sizeof *names);
    if (!names)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    for (size_t i = 0; i < scene->probe_count; ++i)
        names[n++] = scene->probes[i].name;
    for (size_t i = 0; i < calx_column_count(); ++i)
        names[n++] = calx_column_at(i)->title;
    for (size_t i = 0; i < calx_measure_count(); ++i)
        if (!calx_measure_at(i)->per_particle)
            names[n++] = calx_measure_at(i)->name;
    const char *nearest = calx_error_nearest(of, names, n);
    int code = calx_error_set(
        error, CALX_ERROR_INPUT, "'%s' is no probe, column of the CSV or quantity%s%s%s", of,
        nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
    free(names);
    return code;
}

int calx_measure_resolve(const struct calx_scene *scene, const char *of, struct calx_probe *probe,
                         struct calx_error *error)
{
    for (size_t i = 0; i < scene->probe_count; ++i)
        if (strcmp(scene->probes[i].name, of) == 0) {
            *probe = scene->probes[i];
            return CALX_OK;
        }
    for (size_t i = 0; i < calx_column_count(); ++i)
        if (same_name(calx_column_at(i)->title, of)) {
            plain_probe(probe, calx_column_at(i)->quantity, calx_column_at(i)->reduce);
            return CALX_OK;
        }
    for (size_t i = 0; i < calx_measure_count(); ++i)
        if (!calx_measure_at(i)->per_particle && same_name(calx_measure_at(i)->name, of)) {
            plain_probe(probe, calx_measure_at(i)->name, "");
            return CALX_OK;
        }
    return unknown_name(scene, of, error);
}

/* ---- what the engine watches ---- */

bool calx_measure_is_peak(const struct calx_probe *probe)
{
    return strcmp(probe->quantity, "peak-force") == 0 || strcmp(probe->quantity, "peak-force-time") == 0;
}

/* ---- classes ---- */

bool calx_measure_has_classes(const struct calx_probe *probe)
{
    return strcmp(probe->quantity, "lacey-index") == 0;
}

void calx_measure_begin_stage(struct calx_sim *sim, int stage)
{
    const struct calx_scene *scene = calx_sim_scene(sim);
    struct calx_measure_cache *cache = calx_sim_measure_cache(sim);
    double up[3];
    cache->frame_step = -1; /* a stage may move walls or change laws without a step */
    cache->has_ledger = cache->has_share = false;
    calx_measure_up(sim, up);
    for (size_t i = 0; i < scene->probe_count; ++i) {
        const struct calx_probe *p = &scene->probes[i];
        uint8_t *classes = calx_measure_has_classes(p) && p->stage == stage
                               ? calx_sim_probe_classes(sim, i)
                               : NULL;
        const struct calx_frame *f = classes ? calx_measure_frame(sim) : NULL;
        if (f)
            calx_lacey_classes(f, p->classes, up, classes);
    }
}

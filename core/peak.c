/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The largest normal force in a contact since the start, and when it was: looked for after every step, and only where something asks for
 * it, because a look costs about as much as an evaluation. Positions and velocities are those of the end of the step, so damping is too.
 * A smooth maximum lies between steps: where one contact has the largest force in three steps in a row, and most in the middle, the
 * parabola through the three stands for it, which leaves an error of fourth order in the step instead of second.
 */
#include <math.h>
#include <omp.h>

#include "core/columns.h"

static bool names_it(const struct calx_scene *scene, const char *name)
{
    struct calx_error unused;
    struct calx_probe probe;
    return !calx_measure_resolve(scene, name, &probe, &unused) && calx_measure_is_peak(&probe);
}

static bool asked_for(const struct calx_scene *scene)
{
    bool asked = false;
    for (size_t k = 0; k < scene->probe_count; k++)
        asked |= calx_measure_is_peak(&scene->probes[k]);
    for (size_t k = 0; k < scene->expect_count; k++)
        asked |= names_it(scene, scene->expects[k].of);
    for (size_t k = 0; k < scene->exact_count; k++)
        asked |= names_it(scene, scene->exacts[k].of);
    for (size_t k = 0; k < scene->stage_count; k++)
        asked |= scene->stages[k].condition[0] && names_it(scene, scene->stages[k].condition);
    return asked;
}

struct look {
    const struct calx_sim *s;
    struct calx_peak_sample largest;
};

static void take(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct look *l = context;
    double force = fabs(c->fn[lane]);
    if (!(force > l->largest.force))
        return;
    l->largest.force = force;
    l->largest.id[0] = calx_row_id(l->s, row_i);
    l->largest.id[1] = row_j >= 0 ? calx_row_id(l->s, row_j) : row_j;
}

static bool same_contact(const struct calx_peak_sample *a, const struct calx_peak_sample *b)
{
    return (a->id[0] == b->id[0] && a->id[1] == b->id[1]) || (a->id[0] == b->id[1] && a->id[1] == b->id[0]);
}

/* The top of the parabola through three samples of one contact, the middle one the largest; else the middle one. */
static struct calx_peak_sample top(const struct calx_peak_sample q[3])
{
    struct calx_peak_sample best = q[1];
    double h0 = q[1].time - q[0].time, h1 = q[2].time - q[1].time;
    bool one = same_contact(&q[0], &q[1]) && same_contact(&q[1], &q[2]) && q[0].force > 0 && q[2].force > 0;
    if (!one || q[0].force > q[1].force || q[2].force > q[1].force || !(h0 > 0) || !(h1 > 0))
        return best;
    double left = (q[1].force - q[0].force) / h0, right = (q[2].force - q[1].force) / h1;
    double bend = (right - left) / (h0 + h1), slope = (left * h1 + right * h0) / (h0 + h1);
    if (bend < 0) {
        best.time -= 0.5 * slope / bend;
        best.force -= 0.25 * slope * slope / bend;
    }
    return best;
}

static void keep(struct calx_peak *p, const struct calx_peak_sample *found)
{
    if (found->force > p->force) {
        p->force = found->force;
        p->time = found->time;
    }
}

void calx_peak_look(struct calx_sim *s)
{
    double begin = omp_get_wtime();
    struct calx_peak *p = &s->peak;
    struct look l = {.s = s, .largest = {.time = s->time}};
    const struct calx_sink sink = {&l, take};
    for (size_t b = 0; b < s->block_count && s->features.contacts; b++)
        s->engine->block_network(s, b, &sink);
    p->last[0] = p->last[1];
    p->last[1] = p->last[2];
    p->last[2] = l.largest;
    keep(p, &l.largest);
    const struct calx_peak_sample refined = top(p->last);
    keep(p, &refined);
    s->peak_seconds += omp_get_wtime() - begin;
}

void calx_sim_watch_peak(struct calx_sim *s)
{
    if (s->peak.watched)
        return;
    s->peak = (struct calx_peak){.watched = true, .time = s->time};
    calx_peak_look(s);
}

const struct calx_peak *calx_sim_peak(const struct calx_sim *s)
{
    return &s->peak;
}

double calx_sim_peak_seconds(const struct calx_sim *s)
{
    return s->peak_seconds;
}

void calx_peak_start(struct calx_sim *s)
{
    if (asked_for(s->scene))
        calx_sim_watch_peak(s);
}

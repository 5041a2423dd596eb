/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The network of contacts as springs and dashpots: each touching contact with the tangent stiffness and damping that its laws report at its
 * present overlap. Contacts come one by one from the engine's look at the network and are gathered again into batches of one
 * pair type, as the laws take them.
 */
#include "core/tangent.h"

#include <stdlib.h>
#include <string.h>

void calx_tangent_respond(const struct calx_plan *p, size_t type, struct calx_columns *c,
                          const struct calx_response *out)
{
    struct calx_contacts batch = {.size = sizeof batch, .n = c->n, .overlap = c->overlap, .vn = c->vn,
        .mass = c->mass, .curvature = {c->curvature[0], c->curvature[1]},
        .temperature = {c->temperature[0], c->temperature[1]}, .coulomb = p->cohesion ? c->coulomb : c->fn, .fn = c->fn,
        .work = c->work};
    for (int k = 0; k < 3; k++) {
        batch.normal[k] = c->normal[k];
        batch.vt[k] = c->vt[k];
        batch.spin[k] = c->spin[k];
        batch.ft[k] = c->ft[k];
        batch.torque[k] = c->torque[k];
    }
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        double *history[CALX_HISTORY_MAX];
        size_t vectors = 3 * law->own[type].history_vectors, first = law->first_history;
        for (size_t h = 0; h < vectors; h++)
            history[h] = c->history[first + h];
        for (size_t h = 0; h < law->own[type].history_scalars; h++)
            history[vectors + h] = c->history[first + 3 * law->demand.history_vectors + h];
        batch.history = history;
        law->law->response(law->params + law->plugin->params_size * type, &batch, out);
    }
}

struct collector {
    struct calx_sim *s;
    struct calx_tangents *out;
    struct calx_columns *c;
    const struct calx_row_block *block; /* that is looked at */
    size_t type;
    int32_t row[2][CALX_BATCH];
    double lever[2][CALX_BATCH]; /* m, from each centre to the contact point */
    bool failed;
};

static int grow(struct calx_tangents *t)
{
    size_t capacity = t->capacity ? 2 * t->capacity : 256;
    struct calx_tangent *list = realloc(t->list, capacity * sizeof *list);
    if (!list)
        return 1;
    t->list = list;
    t->capacity = capacity;
    return 0;
}

/* A ghost stands for the row it copies. */
static int32_t own_row(const struct collector *g, int32_t row)
{
    return row >= g->block->first + g->block->own ? g->s->r.source[row] : row;
}

static void add(struct collector *g, size_t lane, const double k[2][CALX_BATCH], const double d[2][CALX_BATCH])
{
    const struct calx_columns *c = g->c;
    struct calx_tangents *out = g->out;
    if (k[0][lane] <= 0.0 && k[1][lane] <= 0.0 && d[0][lane] <= 0.0 && d[1][lane] <= 0.0)
        return;
    if (out->count == out->capacity && grow(out)) {
        g->failed = true;
        return;
    }
    struct calx_tangent *t = &out->list[out->count++];
    *t = (struct calx_tangent){.row = {g->row[0][lane], g->row[1][lane]},
        .lever = {g->lever[0][lane], g->lever[1][lane]}, .stiffness = {k[0][lane], k[1][lane]},
        .damping = {d[0][lane], d[1][lane]}, .inverse_mass = c->mass[lane] > 0.0 ? 1.0 / c->mass[lane] : 0.0};
    for (int q = 0; q < 3; q++)
        t->normal[q] = c->normal[q][lane];
}

/* Evaluates what is in the batch. */
static void flush(struct collector *g)
{
    double k[2][CALX_BATCH] __attribute__((aligned(64))), d[2][CALX_BATCH] __attribute__((aligned(64)));
    memset(k, 0, sizeof k);
    memset(d, 0, sizeof d);
    struct calx_response out = {.size = sizeof out, .stiffness = {k[0], k[1]}, .damping = {d[0], d[1]}};
    for (size_t lane = g->c->n; lane < calx_padded(g->c->n); lane++)
        g->c->overlap[lane] = 0.0;
    calx_tangent_respond(g->s->plan, g->type, g->c, &out);
    for (size_t lane = 0; lane < g->c->n && !g->failed; lane++)
        add(g, lane, (const double(*)[CALX_BATCH])k, (const double(*)[CALX_BATCH])d);
    g->c->n = 0;
}

/* What the response of a law may read, and what is kept of the contact. */
static void copy_lane(const struct calx_columns *from, size_t lane, struct calx_columns *to, size_t columns)
{
    size_t n = to->n++;
    to->overlap[n] = from->overlap[lane];
    to->vn[n] = from->vn[lane];
    to->mass[n] = from->mass[lane];
    to->fn[n] = from->fn[lane];
    to->coulomb[n] = from->coulomb[lane];
    for (int b = 0; b < 2; b++) {
        to->curvature[b][n] = from->curvature[b][lane];
        to->temperature[b][n] = from->temperature[b][lane];
    }
    for (int k = 0; k < 3; k++) {
        to->normal[k][n] = from->normal[k][lane];
        to->vt[k][n] = from->vt[k][lane];
        to->spin[k][n] = from->spin[k][lane];
        to->ft[k][n] = from->ft[k][lane];
        to->torque[k][n] = from->torque[k][lane];
    }
    for (size_t h = 0; h < columns; h++)
        to->history[h][n] = from->history[h][lane];
}

static void take(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct collector *g = context;
    const struct calx_sim *s = g->s;
    size_t other = row_j < 0 ? (size_t)s->scene->walls[-1 - row_j].material : (size_t)s->r.material[row_j];
    size_t type = (size_t)s->r.material[row_i] * s->scene->material_count + other;
    if (g->c->n == CALX_BATCH || (g->c->n && type != g->type))
        flush(g);
    g->type = type;
    size_t n = g->c->n;
    g->row[0][n] = own_row(g, row_i);
    g->row[1][n] = own_row(g, row_j);
    g->lever[0][n] = row_j < 0 ? c->levers[lane] : 0.5 * (c->levers[lane] + c->excess[lane]);
    g->lever[1][n] = row_j < 0 ? 0.0 : 0.5 * (c->levers[lane] - c->excess[lane]);
    copy_lane(c, lane, g->c, s->plan->history);
}

int calx_tangents_collect(struct calx_sim *s, struct calx_tangents *out, struct calx_error *e)
{
    *out = (struct calx_tangents){0};
    struct collector g = {.s = s, .out = out, .c = calx_memory_zeroed(1, sizeof *g.c)};
    struct calx_sink sink = {&g, take};
    for (size_t h = 0; g.c && h < CALX_HISTORY_MAX; h++)
        g.c->history[h] = g.c->kept[h];
    for (size_t b = 0; g.c && s->plan->law_count && b < s->block_count; b++) {
        g.block = &s->blocks[b];
        s->engine->block_network(s, b, &sink);
    }
    if (g.c && g.c->n)
        flush(&g);
    bool failed = !g.c || g.failed;
    free(g.c);
    if (!failed)
        return 0;
    free(out->list);
    *out = (struct calx_tangents){0};
    return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the stiffness of the contacts");
}

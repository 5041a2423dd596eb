/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Pairs in reach that do not touch. A list within the list: those that could touch soon are looked at in every step, and moved among the pairs
 * that are evaluated when they do; all are sorted out anew when bodies may have come nearer than that by the inner skin. A pair that
 * has parted goes the other way. Order follows from the scene alone.
 */
#include "core/gather.h"
#include "core/vector.h"

/* Bit k is set where the bodies of pair k of eight, of which `count` exist, are nearer than the sum of radii and a margin. */
static unsigned nearer(const struct calx_block_view *b, const uint32_t *i, const uint32_t *j, size_t count, double margin)
{
    static const calx_v4 sign = {-1.0, -1.0, -1.0, 1.0};
    calx_v4 row[8];
    calx_v8 d[4];
    for (size_t k = 0; k < 8; k++) {
        size_t at = k < count ? k : 0;
        row[k] = calx_v4_load(calx_place_row(b->x, 4, i[at])) + sign * calx_v4_load(calx_place_row(b->x, 4, j[at]));
    }
    calx_rows_to_columns(row, d);
    calx_v8 reach = d[3] + margin, square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    unsigned exist = count < 8 ? (1u << count) - 1 : 0xffu;
    return calx_v8_less(square, reach * reach) & exist;
}

static void set_pair(struct calx_sim *s, size_t k, uint32_t i, uint32_t j, unsigned touching)
{
    s->pairs.i[k] = i;
    s->pairs.j[k] = j;
    s->pairs.touching[k / 8] = (uint8_t)((s->pairs.touching[k / 8] & ~(1u << k % 8)) | touching << k % 8);
}

/* The pair at place p of the group's apart pairs, one of the soon ones, is evaluated from now on. */
static void admit(struct calx_sim *s, struct calx_group *g, size_t p)
{
    uint32_t *i = s->pairs.apart_i + g->apart_first, *j = s->pairs.apart_j + g->apart_first;
    set_pair(s, g->first + g->count, i[p], j[p], 0);
    for (size_t h = 0; h < s->plan->history; h++)
        calx_group_history(s, g, h)[g->count] = 0.0;
    g->count++;
    size_t soon = --g->soon, last = --g->apart_count;
    i[p] = i[soon], j[p] = j[soon];
    i[soon] = i[last], j[soon] = j[last];
}

void CALX_ISA(calx_apart_admit)(const struct calx_block_view *b, struct calx_group *g)
{
    struct calx_sim *s = b->s;
    const uint32_t *i = s->pairs.apart_i + g->apart_first, *j = s->pairs.apart_j + g->apart_first;
    for (size_t end = g->soon; end > 0;) { /* from the back: what takes the place of an admitted pair has been looked at */
        size_t first = (end - 1) / 8 * 8;
        unsigned bits = nearer(b, i + first, j + first, end - first, s->plan->gap);
        for (; bits && g->count < g->room; bits &= ~(1u << (31 - __builtin_clz(bits))))
            admit(s, g, first + 31 - (size_t)__builtin_clz(bits));
        end = first;
    }
}

/* The pair at place p of the evaluated ones has parted: the last one takes its place. */
static void dismiss(struct calx_sim *s, struct calx_group *g, size_t p)
{
    size_t at = g->first + p, last = g->first + --g->count, to = g->apart_first + g->apart_count++;
    s->pairs.apart_i[to] = s->pairs.i[at];
    s->pairs.apart_j[to] = s->pairs.j[at];
    set_pair(s, at, s->pairs.i[last], s->pairs.j[last], s->pairs.touching[last / 8] >> last % 8 & 1u);
    set_pair(s, last, 0, 0, 0);
    for (size_t h = 0; h < s->plan->history; h++) {
        double *column = calx_group_history(s, g, h);
        column[p] = column[g->count];
        column[g->count] = 0.0;
    }
}

static void dismiss_parted(const struct calx_block_view *b, struct calx_group *g, double margin)
{
    struct calx_sim *s = b->s;
    for (size_t end = g->count; end > 0;) { /* from the back: the last pair has been looked at */
        size_t first = (end - 1) / 8 * 8, count = end - first, at = g->first + first;
        unsigned apart = ~(unsigned)s->pairs.touching[at / 8] & (count < 8 ? (1u << count) - 1 : 0xffu);
        if (apart)
            apart &= ~nearer(b, s->pairs.i + at, s->pairs.j + at, count, margin);
        for (; apart; apart &= ~(1u << (31 - __builtin_clz(apart))))
            dismiss(s, g, first + 31 - (size_t)__builtin_clz(apart));
        end = first;
    }
}

bool CALX_ISA(calx_apart_sift)(const struct calx_block_view *b, struct calx_group *g, double inner)
{
    double margin = inner + b->s->plan->gap;
    uint32_t *i = b->s->pairs.apart_i + g->apart_first, *j = b->s->pairs.apart_j + g->apart_first;
    dismiss_parted(b, g, margin);
    g->soon = 0;
    for (size_t first = 0; first < g->apart_count; first += 8) {
        unsigned bits = nearer(b, i + first, j + first, g->apart_count - first, margin);
        for (; bits; bits &= bits - 1) {
            size_t p = first + (size_t)__builtin_ctz(bits), to = g->soon++;
            uint32_t pi = i[p], pj = j[p];
            i[p] = i[to], j[p] = j[to];
            i[to] = pi, j[to] = pj;
        }
    }
    return g->count + g->soon <= g->room;
}

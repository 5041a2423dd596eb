/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From pairs of the whole scene to pairs of one block: partners in later blocks and periodic images become ghosts of the block, pairs are
 * oriented so that material(i) <= material(j) and grouped by pair of materials. Order follows from the found lists alone.
 */
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

/* A small open-addressing table from (place, shift) to ghost. */
struct ghost_table {
    size_t mask;
    int64_t *key;
    int32_t *slot;
};

static int table_create(struct ghost_table *t, size_t expected)
{
    size_t size = 64;
    while (size < 2 * expected + 2)
        size *= 2;
    t->mask = size - 1;
    t->key = malloc(size * sizeof *t->key);
    t->slot = malloc(size * sizeof *t->slot);
    if (!t->key || !t->slot)
        return 1;
    memset(t->key, 0xff, size * sizeof *t->key);
    return 0;
}

static int32_t ghost_slot(struct ghost_table *t, struct calx_local *l, int32_t place, uint8_t shift)
{
    int64_t key = (int64_t)place * 32 + shift;
    size_t at = (size_t)((uint64_t)key * 0x9e3779b97f4a7c15ull >> 20) & t->mask;
    while (t->key[at] >= 0 && t->key[at] != key)
        at = (at + 1) & t->mask;
    if (t->key[at] < 0) {
        t->key[at] = key;
        t->slot[at] = (int32_t)l->ghosts;
        l->ghost[l->ghosts] = place;
        l->ghost_shift[l->ghosts++] = shift;
    }
    return t->slot[at];
}

/* Where ghost g came from, and its number. */
struct numbered {
    int64_t key;
    int32_t old;
};

static int by_key(const void *a, const void *b)
{
    int64_t x = ((const struct numbered *)a)->key, y = ((const struct numbered *)b)->key;
    return (x > y) - (x < y);
}

/* Numbers the ghosts in the order of their sources, so that refreshing them reads memory in order. */
static int order_ghosts(struct calx_local *l, int32_t own)
{
    struct numbered *list = malloc((l->ghosts + 1) * sizeof *list);
    int32_t *renamed = malloc((l->ghosts + 1) * sizeof *renamed);
    int failed = !list || !renamed;
    for (size_t g = 0; !failed && g < l->ghosts; g++)
        list[g] = (struct numbered){(int64_t)l->ghost[g] * 32 + l->ghost_shift[g], (int32_t)g};
    if (!failed)
        qsort(list, l->ghosts, sizeof *list, by_key);
    for (size_t g = 0; !failed && g < l->ghosts; g++) {
        l->ghost[g] = (int32_t)(list[g].key / 32);
        l->ghost_shift[g] = (uint8_t)(list[g].key % 32);
        renamed[list[g].old] = (int32_t)g;
    }
    for (size_t k = 0; !failed && k < l->pairs; k++) {
        l->i[k] = l->i[k] < own ? l->i[k] : own + renamed[l->i[k] - own];
        l->j[k] = l->j[k] < own ? l->j[k] : own + renamed[l->j[k] - own];
    }
    free(list);
    free(renamed);
    return failed;
}

/* Nothing comes of the contact: both are held, neither is part of a plate that the other could move, and there is no heat. */
static bool both_fixed(const struct calx_rebuild *r, const struct calx_found *f)
{
    const struct calx_sim *s = r->sim;
    int32_t i = r->old_row[f->i], j = r->old_row[f->j];
    if (calx_row_v(s, i)[3] > 0.0 || calx_row_v(s, j)[3] > 0.0 || s->features.temperature)
        return false;
    const int32_t *carrier = s->scene->particles.carrier;
    int wall_i = carrier ? carrier[s->r.id[i]] : -1, wall_j = carrier ? carrier[s->r.id[j]] : -1;
    return wall_i == wall_j || !(calx_plates_ever(s->scene, wall_i) || calx_plates_ever(s->scene, wall_j));
}

struct raw_pair {
    int32_t i, j, type;
    enum calx_nearness nearness;
    int64_t kept;
    bool same_way;
};

/* Resolves rows and orientation; returns the number of pairs that count. */
static size_t resolve(const struct calx_rebuild *r, size_t block, struct ghost_table *t,
                      struct calx_local *l, struct raw_pair *raw)
{
    const struct calx_found_list *found = &r->found[block];
    const int32_t *material = r->sim->r.material;
    int32_t first = (int32_t)(block * CALX_BLOCK);
    size_t own = r->n - (size_t)first < CALX_BLOCK ? r->n - (size_t)first : CALX_BLOCK, count = 0;
    for (size_t k = 0; k < found->count; k++) {
        const struct calx_found *f = &found->list[k];
        if (r->sim->some_fixed && both_fixed(r, f))
            continue;
        int32_t i = f->i - first, j = f->j - first;
        if (f->shift != CALX_NO_SHIFT || (size_t)j >= own)
            j = (int32_t)own + ghost_slot(t, l, f->j, f->shift);
        int32_t mi = r->types > 1 ? material[r->old_row[f->i]] : 0, mj = r->types > 1 ? material[r->old_row[f->j]] : 0;
        int32_t type = (int32_t)calx_plan_pair_type(r->sim->scene->material_count, (size_t)mi, (size_t)mj);
        int64_t kept = calx_keep_find(r, f->i, f->j);
        enum calx_nearness nearness = kept >= 0 ? CALX_CLOSE : f->nearness; /* what touched is evaluated once more, wherever it is now */
        bool swap = mi > mj;
        bool same_way = kept >= 0 && r->kept[kept].i == (swap ? f->j : f->i);
        raw[count++] = (struct raw_pair){swap ? j : i, swap ? i : j, type, nearness, kept, same_way};
        l->type_count[type][nearness]++;
    }
    return count;
}

static void group_by_type(const struct calx_rebuild *r, const struct raw_pair *raw, size_t count,
                          struct calx_local *l, size_t *at)
{
    size_t sum = 0;
    for (size_t t = 0; t < r->types; t++)
        for (size_t q = 0; q < CALX_NEARNESSES; q++) {
            at[CALX_NEARNESSES * t + q] = sum;
            sum += l->type_count[t][q];
        }
    for (size_t k = 0; k < count; k++) {
        size_t to = at[CALX_NEARNESSES * (size_t)raw[k].type + raw[k].nearness]++;
        l->i[to] = raw[k].i;
        l->j[to] = raw[k].j;
        l->kept[to] = raw[k].kept;
        l->same_way[to] = raw[k].same_way;
    }
    l->pairs = count;
}

static int localise_block(const struct calx_rebuild *r, size_t block)
{
    struct calx_local *l = &r->local[block];
    size_t count = r->found[block].count + 1;
    struct ghost_table t = {0};
    struct raw_pair *raw = malloc(count * sizeof *raw);
    size_t *at = calloc(CALX_NEARNESSES * r->types, sizeof *at);
    l->i = malloc(count * sizeof *l->i);
    l->j = malloc(count * sizeof *l->j);
    l->kept = malloc(count * sizeof *l->kept);
    l->same_way = malloc(count * sizeof *l->same_way);
    l->ghost = malloc(count * sizeof *l->ghost);
    l->ghost_shift = malloc(count);
    l->type_count = calloc(r->types, sizeof *l->type_count);
    int failed = !raw || !at || !l->i || !l->j || !l->kept || !l->same_way || !l->ghost || !l->ghost_shift || !l->type_count ||
                 table_create(&t, count);
    if (!failed)
        group_by_type(r, raw, resolve(r, block, &t, l, raw), l, at);
    size_t first = block * CALX_BLOCK;
    failed = failed || order_ghosts(l, (int32_t)(r->n - first < CALX_BLOCK ? r->n - first : CALX_BLOCK));
    free(t.key);
    free(t.slot);
    free(raw);
    free(at);
    return failed;
}

int calx_localise(struct calx_rebuild *r)
{
    int failed = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(r->sim->team) if (r->sim->team > 1) reduction(| : failed)
    for (size_t b = 0; b < r->blocks; b++)
        failed |= localise_block(r, b);
    return failed;
}

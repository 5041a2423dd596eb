/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Who works on which blocks, and in which order. Threads get runs of consecutive blocks of equal work. Within a run come first the blocks that
 * add to another thread's, then those that stand alone, last those to which another thread's blocks add: when their turn comes, what they
 * wait for is done, and they can be finished while they are in cache. The bits depend on none of this: a block's forces do not depend on the
 * others', and what others add to it is collected in the order of blocks.
 */
#include <stdlib.h>
#include <string.h>

#include "core/state.h"

/* What a block costs in a step, in units of a pair that is evaluated. */
static size_t block_work(const struct calx_sim *s, const struct calx_row_block *b)
{
    size_t work = (size_t)(b->own + b->ghosts) + 2 * b->near_count;
    for (size_t g = b->group_first; g < b->group_first + b->group_count; g++)
        work += s->groups[g].count;
    return work;
}

/* Runs of equal work; returns how many threads get one. */
static size_t cut(struct calx_sim *s)
{
    size_t total = 0, done = 0, team = (size_t)s->threads < s->block_count ? (size_t)s->threads : s->block_count;
    for (size_t b = 0; b < s->block_count; b++)
        total += block_work(s, &s->blocks[b]);
    for (size_t b = 0, t = 0; b <= s->block_count; b++) {
        for (; t <= team && (b == s->block_count || done * team >= total * t); t++)
            s->share[t] = b;
        done += b < s->block_count ? block_work(s, &s->blocks[b]) : 0;
    }
    return team;
}

/* Which blocks add to each block: those that keep ghosts of its particles, in ascending order. */
static void list_adders(struct calx_sim *s)
{
    size_t count = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        struct calx_row_block *block = &s->blocks[b];
        int32_t from = -1;
        size_t at = 0; /* a block that may hold the ghost: contributions come in the order of blocks */
        block->adder_first = count;
        for (size_t k = block->collect_first; k < block->collect_first + block->collect_count; k++) {
            while (at + 1 < s->block_count && s->blocks[at + 1].first <= s->collect_from[k])
                at++;
            if ((int32_t)at != from)
                s->adders[count++] = from = (int32_t)at;
        }
        block->adder_count = count - block->adder_first;
    }
}

enum { GIVES, ALONE, TAKES, KINDS };

/* The kind of each block of the run first..last. */
static void sort_out(const struct calx_sim *s, size_t first, size_t last, uint8_t *kind)
{
    for (size_t b = 0; b < s->block_count; b++)
        for (size_t k = s->blocks[b].adder_first; k < s->blocks[b].adder_first + s->blocks[b].adder_count; k++) {
            size_t adder = (size_t)s->adders[k];
            bool inside = b >= first && b < last, from_inside = adder >= first && adder < last;
            if (from_inside && !inside)
                kind[adder] = GIVES;
            if (inside && !from_inside && kind[b] == ALONE)
                kind[b] = TAKES;
        }
}

static void order_run(struct calx_sim *s, size_t first, size_t last, uint8_t *kind)
{
    size_t at = first;
    memset(kind, ALONE, s->block_count);
    if (last - first < s->block_count)
        sort_out(s, first, last, kind);
    for (uint8_t k = 0; k < KINDS; k++)
        for (size_t b = first; b < last; b++)
            if (kind[b] == k)
                s->order[at++] = (int32_t)b;
}

int calx_team_form(struct calx_sim *s)
{
    size_t ghosts = s->r.rows > s->n ? s->r.rows - s->n : 0;
    free(s->adders);
    free(s->order);
    free(s->waiting);
    free(s->passed);
    s->adders = calx_memory_zeroed(ghosts, sizeof *s->adders);
    s->order = calx_memory_zeroed(s->block_count, sizeof *s->order);
    s->waiting = calx_memory_zeroed(s->block_count, sizeof *s->waiting);
    s->passed = calx_memory_zeroed(s->block_count, sizeof *s->passed);
    uint8_t *kind = malloc(s->block_count + 1);
    if (!s->adders || !s->order || !s->waiting || !s->passed || !kind) {
        free(kind);
        return 1;
    }
    list_adders(s);
    s->team = (int)cut(s);
    s->pass_number = 0;
    for (int t = 0; t < s->team; t++)
        order_run(s, s->share[t], s->share[t + 1], kind);
    free(kind);
    return 0;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Particle-wall candidates: for each particle the primitives it can reach before the next rebuild, and the wall contacts that live
 * on, moved to the particles' new rows.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

struct near_list {
    int32_t *row, *primitive;
    size_t count, capacity;
};

static int append(struct near_list *l, int32_t row, int32_t primitive)
{
    if (l->count == l->capacity) {
        size_t capacity = l->capacity ? 2 * l->capacity : 256;
        int32_t *a = realloc(l->row, capacity * sizeof *a);
        l->row = a ? a : l->row;
        int32_t *b = realloc(l->primitive, capacity * sizeof *b);
        l->primitive = b ? b : l->primitive;
        if (!a || !b)
            return 1;
        l->capacity = capacity;
    }
    l->row[l->count] = row;
    l->primitive[l->count++] = primitive;
    return 0;
}

struct bounds {
    double centre[3], radius, reach; /* a ball around the block's centres; largest reach of a particle */
};

static struct bounds block_bounds(const struct calx_sim *s, const struct calx_row_block *b)
{
    double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, hi[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    struct bounds out = {{0}, 0.0, 0.0};
    for (int32_t k = 0; k < b->own; k++) {
        const double *x = calx_row_x(s, b->first + k);
        for (int c = 0; c < 3; c++) {
            lo[c] = fmin(lo[c], x[c]);
            hi[c] = fmax(hi[c], x[c]);
        }
        out.reach = fmax(out.reach, x[3]);
    }
    for (int c = 0; c < 3; c++) {
        out.centre[c] = 0.5 * (lo[c] + hi[c]);
        out.radius += 0.25 * (hi[c] - lo[c]) * (hi[c] - lo[c]);
    }
    out.radius = sqrt(out.radius);
    return out;
}

static int block_near(const struct calx_sim *s, size_t block, struct near_list *l)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct bounds ball = block_bounds(s, b);
    size_t count = 0;
    int32_t *close = malloc((s->primitive_count + 1) * sizeof *close);
    int failed = !close;
    struct calx_touch t;
    for (size_t p = 0; !failed && p < s->primitive_count; p++) {
        calx_surface_nearest(&s->posed[p].p, s->scene->dimension, ball.centre, &t);
        if (t.distance < ball.radius + ball.reach + s->skin + s->plan->gap)
            close[count++] = (int32_t)p;
    }
    for (int32_t k = 0; !failed && k < b->own; k++) {
        const double *x = calx_row_x(s, b->first + k);
        for (size_t q = 0; !failed && q < count; q++) {
            calx_surface_nearest(&s->posed[close[q]].p, s->scene->dimension, x, &t);
            if (t.distance < x[3] + s->skin + s->plan->gap)
                failed = append(l, b->first + k, close[q]);
        }
    }
    free(close);
    return failed;
}

/* Lays the lists of all blocks end to end. */
static int join(struct calx_sim *s, struct near_list *lists)
{
    size_t total = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        s->blocks[b].near_first = total;
        s->blocks[b].near_count = lists[b].count;
        total += lists[b].count;
    }
    s->near_count = total;
    free(s->near_row);
    free(s->near_primitive);
    s->near_row = calx_memory_zeroed(total, sizeof *s->near_row);
    s->near_primitive = calx_memory_zeroed(total, sizeof *s->near_primitive);
    if (!s->near_row || !s->near_primitive)
        return 1;
    for (size_t b = 0; b < s->block_count; b++) {
        size_t first = s->blocks[b].near_first, bytes = lists[b].count * sizeof(int32_t);
        if (bytes) {
            memcpy(s->near_row + first, lists[b].row, bytes);
            memcpy(s->near_primitive + first, lists[b].primitive, bytes);
        }
    }
    return 0;
}

struct alive {
    struct calx_wall_contact *contacts;
    double *history;
};

/* Moves the contacts of each particle, found through first_of[old row], to its new block. */
static void carry(struct calx_sim *s, const struct calx_rebuild *r, const struct alive *old,
                  const int32_t *first_of, size_t old_total)
{
    size_t columns = s->plan->history;
    for (size_t b = 0; b < s->block_count; b++) {
        struct calx_row_block *block = &s->blocks[b];
        block->wall_count = 0;
        for (int32_t k = 0; k < block->own; k++) {
            int32_t old_row = r->old_row[b * CALX_BLOCK + (size_t)k];
            int32_t c = first_of[old_row];
            for (; c >= 0 && (size_t)c < old_total && old->contacts[c].row == old_row &&
                   block->wall_count < block->near_count; c++) {
                size_t to = block->near_first + block->wall_count++;
                s->wall_contacts[to] =
                    (struct calx_wall_contact){block->first + k, old->contacts[c].surface};
                if (columns)
                    memcpy(s->wall_history + columns * to, old->history + columns * (size_t)c,
                           columns * sizeof(double));
            }
        }
    }
}

static int carry_contacts(struct calx_sim *s, const struct calx_rebuild *r, size_t old_rows,
                          const struct calx_row_block *old_blocks, size_t old_block_count)
{
    struct alive old = {s->wall_contacts, s->wall_history};
    int32_t *first_of = malloc((old_rows + 1) * sizeof *first_of);
    s->wall_contacts = calx_memory_zeroed(s->near_count, sizeof *s->wall_contacts);
    s->wall_history = calx_memory_zeroed(s->near_count * s->plan->history, sizeof(double));
    free(s->wall_contacts_next);
    free(s->wall_history_next);
    s->wall_contacts_next = calx_memory_zeroed(s->near_count, sizeof *s->wall_contacts_next);
    s->wall_history_next = calx_memory_zeroed(s->near_count * s->plan->history, sizeof(double));
    int failed = !first_of || !s->wall_contacts || !s->wall_history || !s->wall_contacts_next ||
                 !s->wall_history_next;
    if (!failed) {
        size_t total = 0;
        for (size_t k = 0; k < old_rows; k++)
            first_of[k] = -1;
        for (size_t b = 0; b < old_block_count; b++) {
            const struct calx_row_block *block = &old_blocks[b];
            for (size_t c = block->near_first + block->wall_count; c-- > block->near_first;)
                first_of[old.contacts[c].row] = (int32_t)c;
            total = block->near_first + block->near_count;
        }
        carry(s, r, &old, first_of, total);
    }
    free(first_of);
    free(old.contacts);
    free(old.history);
    return failed;
}

int calx_near_build(struct calx_sim *s, const struct calx_rebuild *r)
{
    if (!s->features.wall_contacts)
        return 0;
    struct near_list *lists = calloc(s->block_count + 1, sizeof *lists);
    if (!lists)
        return 1;
    int failed = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(s->team) if (s->team > 1) reduction(| : failed)
    for (size_t b = 0; b < s->block_count; b++)
        failed |= block_near(s, b, &lists[b]);
    failed = failed || join(s, lists) ||
             carry_contacts(s, r, r->rows.rows, r->new_blocks, r->blocks);
    for (size_t b = 0; b < s->block_count; b++) {
        free(lists[b].row);
        free(lists[b].primitive);
    }
    free(lists);
    return failed;
}

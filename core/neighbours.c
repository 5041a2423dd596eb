/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A rebuild: wraps periodic positions, sorts particles along the space-filling curve, finds pairs, cuts the order into blocks with their
 * ghosts, lays rows and pairs out anew with their history, and lists particle-wall candidates. Called when the
 * largest displacement demands it. The result depends on the state alone, not on threads.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"
#include "core/sort.h"
#include "core/timing.h"

bool calx_neighbours_stale(const struct calx_sim *s)
{
    return !s->built || (s->features.search && 2.0 * s->drift > s->skin) ||
           (s->features.wall_contacts && s->drift + s->wall_drift > s->skin);
}

/* Puts one particle back into the box, counting the turns. Returns the axis along which it left a bounded domain, or -1. */
static int wrap(struct calx_sim *s, int32_t row)
{
    const struct calx_scene *scene = s->scene;
    double *x = calx_row_x(s, row);
    for (int k = 0; k < 3; k++) {
        double length = scene->high[k] - scene->low[k];
        if (scene->periodic[k]) {
            double turns = floor((x[k] - scene->low[k]) / length);
            x[k] -= turns * length;
            if (x[k] >= scene->high[k]) {
                x[k] = scene->low[k];
                turns += 1.0;
            }
            s->r.image[row][k] += (int32_t)turns;
        } else if (scene->bounded[k] && (x[k] < scene->low[k] || x[k] > scene->high[k])) {
            return k;
        }
    }
    return -1;
}

static int wrap_all(struct calx_sim *s, struct calx_error *e)
{
    int32_t gone = INT32_MAX; /* the first row that has left */
#pragma omp parallel for schedule(static) num_threads(s->team) if (s->team > 1) reduction(min : gone)
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            if (wrap(s, row) >= 0 && row < gone)
                gone = row;
    return gone == INT32_MAX ? 0 : calx_guard_left(s, gone, wrap(s, gone), e);
}

/* Fills old_row, new_place and x. */
static int sort_rows(struct calx_rebuild *r)
{
    struct calx_sim *s = r->sim;
    int32_t *from = malloc((r->n + 1) * sizeof *from), *order = malloc((r->n + 1) * sizeof *order);
    int failed = !from || !order;
    size_t count = 0;
    for (size_t b = 0; !failed && b < s->block_count; b++)
        for (int32_t k = 0; k < s->blocks[b].own; k++)
            from[count++] = s->blocks[b].first + k;
    double cell = 2.0 * s->radius_max < 8.0 * s->radius_min ? 2.0 * s->radius_max : 4.0 * s->radius_min;
    failed = failed || calx_sort_morton(s->r.x, from, r->n, cell, order);
#pragma omp parallel for schedule(static) num_threads(s->team) if (s->team > 1)
    for (size_t k = 0; k < (failed ? 0 : r->n); k++) {
        r->old_row[k] = from[order[k]];
        r->new_place[r->old_row[k]] = (int32_t)k;
        memcpy(r->x + 4 * k, calx_row_x(s, r->old_row[k]), 4 * sizeof(double));
    }
    free(from);
    free(order);
    return failed;
}

static int find_pairs(struct calx_rebuild *r)
{
    const struct calx_sim *s = r->sim;
    double trial = s->trial ? 2.0 * s->moved : 0.0; /* what touched before a trial is not forgotten because of it */
    double gap = s->plan->gap;
    struct calx_pairs_input in = {.x = r->x, .n = r->n, .block = CALX_BLOCK, .skin = s->skin + gap + trial,
                                  .near = {gap + CALX_CLOSE_SHARE * s->skin, gap + CALX_INNER_SHARE * s->skin},
                                  .dimension = s->scene->dimension, .threads = s->team};
    for (int k = 0; k < 3; k++) {
        in.periodic[k] = s->scene->periodic[k];
        in.low[k] = s->scene->low[k];
        in.length[k] = s->scene->high[k] - s->scene->low[k];
    }
    return s->engine->find_pairs(&in, r->found) || calx_keep_collect(r) || calx_localise(r);
}

/* Makes the group of one pair type in the block under way; the first type has one always, for the place where its block's pairs begin. */
static void number_group(struct calx_rebuild *r, const size_t count[CALX_NEARNESSES], size_t type)
{
    size_t total = count[CALX_CLOSE] + count[CALX_SOON] + count[CALX_LATER];
    size_t later = r->sim->roomy ? count[CALX_LATER] : count[CALX_LATER] / 4 + 4;
    size_t room = total ? calx_padded(count[CALX_CLOSE] + count[CALX_SOON] + later) : 0;
    if (!total && type)
        return;
    r->groups[r->group_count++] = (struct calx_group){
        .first = r->pairs.places, .room = room, .count = count[CALX_CLOSE], .apart_first = r->pairs.apart,
        .apart_count = total - count[CALX_CLOSE], .type = (int32_t)type};
    r->pairs.places += room;
    r->pairs.apart += total; /* any of them may part */
    r->pairs.reach += total;
}

/* Numbers the rows, pairs and groups of all blocks. Returns the rows. */
static size_t number_blocks(struct calx_rebuild *r)
{
    static const size_t none[CALX_NEARNESSES];
    size_t rows = 0;
    for (size_t b = 0; b < r->blocks; b++) {
        struct calx_row_block *block = &r->new_blocks[b];
        const struct calx_local *l = &r->local[b];
        block->first = (int32_t)rows;
        block->own = (int32_t)(r->n - b * CALX_BLOCK < CALX_BLOCK ? r->n - b * CALX_BLOCK : CALX_BLOCK);
        block->ghosts = (int32_t)l->ghosts;
        block->group_first = r->group_count;
        rows += (size_t)block->own + l->ghosts;
        for (size_t t = 0; t < r->types; t++)
            number_group(r, l->type_count ? l->type_count[t] : none, t);
        block->group_count = r->group_count - block->group_first;
    }
    return rows;
}

static int allocate_pairs(struct calx_rebuild *r)
{
    struct calx_pairs *p = &r->pairs;
    p->i = calx_memory_zeroed(p->places, sizeof *p->i);
    p->j = calx_memory_zeroed(p->places, sizeof *p->j);
    p->touching = calx_memory_zeroed(p->places / 8, 1);
    p->history = calx_memory_zeroed(p->places * r->sim->plan->history, sizeof(double));
    p->apart_i = calx_memory_zeroed(p->apart, sizeof *p->apart_i);
    p->apart_j = calx_memory_zeroed(p->apart, sizeof *p->apart_j);
    return !p->i || !p->j || !p->touching || !p->history || !p->apart_i || !p->apart_j;
}

static void copy_pairs(uint32_t *i, uint32_t *j, const struct calx_local *l, size_t from, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        i[k] = calx_place_of_row(l->i[from + k]);
        j[k] = calx_place_of_row(l->j[from + k]);
    }
}

/* Copies the rows, names the ghosts' sources and the pairs of one block. */
static void lay_block(struct calx_rebuild *r, size_t b)
{
    const struct calx_row_block *block = &r->new_blocks[b];
    const struct calx_local *l = &r->local[b];
    size_t first = (size_t)block->first;
    calx_rows_fill(r->sim, &r->rows, first, &r->sim->r, r->old_row + b * CALX_BLOCK, (size_t)block->own, l->ghosts);
    for (size_t g = 0; g < l->ghosts; g++) {
        size_t owner = (size_t)l->ghost[g] / CALX_BLOCK, row = first + (size_t)block->own + g;
        r->rows.source[row] = r->new_blocks[owner].first + l->ghost[g] % CALX_BLOCK;
        r->rows.material[row] = r->sim->r.material[r->old_row[l->ghost[g]]];
        if (r->rows.shift)
            r->rows.shift[row] = l->ghost_shift[g];
    }
    for (size_t g = block->group_first, at = 0; g < block->group_first + block->group_count; g++) {
        const struct calx_group *group = &r->groups[g];
        copy_pairs(r->pairs.i + group->first, r->pairs.j + group->first, l, at, group->count);
        calx_keep_apply(r, l, at, group);
        at += group->count;
        copy_pairs(r->pairs.apart_i + group->apart_first, r->pairs.apart_j + group->apart_first, l, at,
                   group->apart_count);
        at += group->apart_count;
    }
}

static int lay_out(struct calx_rebuild *r)
{
    r->groups = calloc(r->blocks * r->types + 1, sizeof *r->groups);
    r->new_blocks = calloc(r->blocks + 1, sizeof *r->new_blocks);
    if (!r->groups || !r->new_blocks)
        return 1;
    size_t rows = number_blocks(r);
    if (calx_rows_allocate(r->sim, &r->rows, rows) || allocate_pairs(r))
        return 1;
#pragma omp parallel for schedule(static) num_threads(r->sim->team) if (r->sim->team > 1)
    for (size_t b = 0; b < r->blocks; b++)
        lay_block(r, b);
    return 0;
}

/* For each block: which ghosts of which earlier blocks copy its particles (counting sort by block). */
static int list_contributions(struct calx_rebuild *r)
{
    struct calx_sim *s = r->sim;
    size_t *at = calloc(r->blocks + 2, sizeof *at), total = r->rows.rows - r->n;
    free(s->collect_to);
    free(s->collect_from);
    s->collect_to = calx_memory_to_fill(total, sizeof *s->collect_to);
    s->collect_from = calx_memory_to_fill(total, sizeof *s->collect_from);
    int failed = !at || !s->collect_to || !s->collect_from;
    for (size_t b = 0; !failed && b < r->blocks; b++)
        for (size_t g = 0; g < r->local[b].ghosts; g++)
            at[(size_t)r->local[b].ghost[g] / CALX_BLOCK + 1]++;
    for (size_t b = 0; !failed && b < r->blocks; b++) {
        r->new_blocks[b].collect_first = at[b];
        r->new_blocks[b].collect_count = at[b + 1];
        at[b + 1] += at[b];
    }
    for (size_t b = 0; !failed && b < r->blocks; b++)
        for (size_t g = 0; g < r->local[b].ghosts; g++) {
            int32_t row = r->new_blocks[b].first + r->new_blocks[b].own + (int32_t)g;
            size_t to = at[(size_t)r->local[b].ghost[g] / CALX_BLOCK]++;
            s->collect_to[to] = r->rows.source[row];
            s->collect_from[to] = row;
        }
    free(at);
    return failed;
}

/* The new layout takes the place of the old; the rebuild keeps the old blocks and rows for near.c and for freeing. */
static void exchange(struct calx_rebuild *r)
{
    struct calx_sim *s = r->sim;
    struct calx_rows_arrays rows = s->r;
    struct calx_pairs pairs = s->pairs;
    struct calx_row_block *blocks = s->blocks;
    struct calx_group *groups = s->groups;
    size_t block_count = s->block_count;
    s->r = r->rows;
    s->pairs = r->pairs;
    s->blocks = r->new_blocks;
    s->groups = r->groups;
    s->block_count = r->blocks;
    s->group_count = r->group_count;
    r->rows = rows;
    r->pairs = pairs;
    r->new_blocks = blocks;
    r->groups = groups;
    r->blocks = block_count;
}

static int prepare(struct calx_rebuild *r)
{
    struct calx_sim *s = r->sim;
    r->old_row = malloc((r->n + 1) * sizeof *r->old_row);
    r->new_place = malloc((s->r.rows + 1) * sizeof *r->new_place);
    r->x = calx_memory_to_fill(r->n, 4 * sizeof *r->x);
    r->found = calloc(r->blocks + 1, sizeof *r->found);
    r->local = calloc(r->blocks + 1, sizeof *r->local);
    return !r->old_row || !r->new_place || !r->x || !r->found || !r->local;
}

static void clear(struct calx_rebuild *r, size_t lists)
{
    for (size_t b = 0; b < lists; b++) {
        if (r->found)
            free(r->found[b].list);
        if (r->local) {
            free(r->local[b].i);
            free(r->local[b].j);
            free(r->local[b].kept);
            free(r->local[b].same_way);
            free(r->local[b].ghost);
            free(r->local[b].ghost_shift);
            free(r->local[b].type_count);
        }
    }
    calx_rows_free(&r->rows);
    void *all[] = {r->old_row, r->new_place, r->x, r->found, r->local, r->kept_first, r->kept,
                   r->pairs.i, r->pairs.j, r->pairs.touching, r->pairs.history, r->pairs.apart_i, r->pairs.apart_j,
                   r->new_blocks, r->groups};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
}

static int resize_tallies(struct calx_sim *s)
{
    free(s->tallies);
    free(s->block_wall_force);
    s->tallies = calx_memory_zeroed(s->block_count, sizeof *s->tallies);
    s->block_wall_force = calx_memory_zeroed(s->block_count * s->scene->wall_count,
                                             sizeof *s->block_wall_force);
    return !s->tallies || !s->block_wall_force || calx_slabs_room(s);
}

/* Rows of accelerations of the largest block, for each thread. */
static int resize_forces(struct calx_sim *s)
{
    size_t rows = 0;
    int failed = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        size_t here = (size_t)(s->blocks[b].own + s->blocks[b].ghosts);
        rows = here > rows ? here : rows;
    }
    for (int t = 0; t < s->threads; t++) {
        free(s->forces[t]);
        failed |= !(s->forces[t] = calx_memory_zeroed(rows * s->r.stride, sizeof **s->forces));
    }
    return failed;
}

static int resize_network(struct calx_sim *s)
{
    if (!s->features.heat_network)
        return 0;
    s->edge_capacity = s->pairs.places;
    s->boundary_capacity = s->near_count;
    void **all[] = {(void **)&s->edge_i, (void **)&s->edge_j, (void **)&s->edge_h,
                    (void **)&s->boundary_i, (void **)&s->boundary_h, (void **)&s->boundary_t,
                    (void **)&s->boundary_wall, (void **)&s->boundary_at};
    size_t bytes[] = {4, 4, 8, 4, 8, 8, 4, sizeof *s->boundary_at};
    int failed = 0;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        free(*all[k]);
        *all[k] = calx_memory_zeroed(k < 3 ? s->edge_capacity : s->boundary_capacity, bytes[k]);
        failed |= !*all[k];
    }
    return failed;
}

int calx_neighbours_build(struct calx_sim *s, struct calx_error *e)
{
    struct calx_clock *clock = calx_timing_clock(s);
    calx_timing_restart(clock);
    CALX_TRY(wrap_all(s, e));
    struct calx_rebuild r = {.sim = s, .n = s->n, .blocks = (s->n + CALX_BLOCK - 1) / CALX_BLOCK,
                             .types = s->scene->material_count * s->scene->material_count};
    size_t lists = r.blocks;
    calx_skin_tune(s);
    int failed = prepare(&r);
    failed = failed || sort_rows(&r);
    calx_timing_lap(clock, CALX_PHASE_SORT);
    failed = failed || (s->features.search && find_pairs(&r));
    failed = failed || lay_out(&r) || list_contributions(&r);
    if (!failed) {
        exchange(&r);
        failed = calx_near_build(s, &r) || resize_tallies(s) || resize_forces(s) || resize_network(s) || calx_team_form(s);
    }
    clear(&r, lists);
    if (failed)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the lists of %zu particles", s->n);
    CALX_TRY(calx_carried_list(s, e));
    s->drift = s->wall_drift = 0.0;
    calx_timing_lap(clock, CALX_PHASE_NEIGHBOURS);
    s->built = true;
    s->rebuilds++;
    return 0;
}

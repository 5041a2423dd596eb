/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Forces and heat flows of one block: refresh its ghosts, admit pairs that have come into reach, and, batch by batch of evaluated pairs, gather
 * rows into columns, run the laws, and scatter the results to the rows of the block in the order of its list.
 */
#include <omp.h>
#include <string.h>

#include "core/gather.h"
#include "core/vector.h"

/* Reads one number of each cache line, in order. */
static double read_through(const double *from, size_t count)
{
    double sum = 0.0;
    for (size_t k = 0; k < count; k += 8)
        sum += from[k];
    return sum;
}

/* Pairs read the rows of a block in no order that the processor could foresee. Read through in order first, they come at the speed of the
 * memory; plain reads, because prefetch instructions did not wake the hardware's own prefetcher: in a bed of 100000 the
 * selection took 21 ns per particle with them, and 10 with reads. */
static void fetch_block(const struct calx_sim *s, const struct calx_row_block *b)
{
    size_t own = (size_t)b->own;
    double sum = read_through(calx_row_x(s, b->first), 4 * own);
    sum += read_through(calx_row_v(s, b->first), s->r.stride * own);
    __asm__ volatile("" : : "m"(sum));
}

enum { AHEAD = 12 }; /* ghosts whose sources are fetched in advance */

/* By how much each image is shifted: x + 3 y + 9 z, each 0 to 2 for one period back, none, or one on. */
struct images {
    calx_v4 shift[27];
};

static void find_images(const struct calx_sim *s, struct images *m)
{
    const struct calx_scene *scene = s->scene;
    for (int k = 0; s->r.shift && k < 27; k++) {
        m->shift[k] = (calx_v4){0};
        for (int axis = 0; axis < 3; axis++) {
            int turns = calx_shift_turns(k, axis);
            m->shift[k][axis] = turns ? turns * (scene->high[axis] - scene->low[axis]) : 0.0;
        }
    }
}

/* A ghost goes where its source is, or that image of it. */
static inline void refresh_place(struct calx_sim *s, const struct images *m, int32_t row)
{
    calx_v4 at = calx_v4_load(calx_row_x(s, s->r.source[row]));
    calx_v4_store(calx_row_x(s, row), s->r.shift ? at + m->shift[s->r.shift[row]] : at);
}

static void refresh_places(struct calx_sim *s, const struct calx_row_block *b)
{
    struct images m;
    find_images(s, &m);
    for (int32_t row = b->first + b->own; row < b->first + b->own + b->ghosts; row++)
        refresh_place(s, &m, row);
}

static void refresh_ghosts(struct calx_sim *s, const struct calx_row_block *b)
{
    const int32_t end = b->first + b->own + b->ghosts, *source = s->r.source;
    const size_t stride = s->r.stride;
    const double *x = s->r.x;
    double *v = s->r.v;
    struct images m;
    find_images(s, &m);
    for (int32_t row = b->first + b->own; row < end; row++) {
        size_t from = (size_t)source[row], ahead = (size_t)source[row + AHEAD < end ? row + AHEAD : row];
        __builtin_prefetch(x + 4 * ahead);
        __builtin_prefetch(v + stride * ahead);
        refresh_place(s, &m, row);
        for (size_t lane = 0; lane < stride; lane += 4)
            calx_v4_store(v + stride * (size_t)row + lane, calx_v4_load(v + stride * from + lane));
    }
}

/* The edges of the network, for an integrator that solves for all temperatures at once. */
static void add_edges(const struct calx_block_view *b, const struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    const struct calx_row_block *rb = b->block;
    size_t first = s->groups[rb->group_first].first;
    for (size_t lane = 0; lane < c->n; lane++) {
        int32_t i = rb->first + calx_row_of_place(b->i[lane]), j = rb->first + calx_row_of_place(b->j[lane]);
        if (!(c->conductance[lane] > 0.0))
            continue;
        size_t e = first + b->tally->edges++;
        s->edge_i[e] = i < rb->first + rb->own ? i : s->r.source[i];
        s->edge_j[e] = j < rb->first + rb->own ? j : s->r.source[j];
        s->edge_h[e] = c->conductance[lane];
    }
}

static void process_batch(const struct calx_block_view *b, struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    CALX_ISA(calx_evaluate_laws)(s->plan, b->type, b->dt, b->conduct, c, b->clock);
    if (b->conduct && s->plan->global_heat)
        add_edges(b, c);
    CALX_ISA(calx_scatter_batch)(b, c);
    calx_timing_lap(b->clock, CALX_PHASE_SCATTER);
}

static struct calx_block_view view_block(struct calx_sim *s, size_t block, double dt, bool conduct, double *a)
{
    const struct calx_row_block *rb = &s->blocks[block];
    return (struct calx_block_view){.s = s, .block = rb, .tally = &s->tallies[block],
                                    .x = calx_row_x(s, rb->first), .v = calx_row_v(s, rb->first),
                                    .a = a, .dt = dt,
                                    .interval = s->heat_interval, .conduct = conduct};
}

/* Batches of the evaluated pairs of a block, in list order. */
static void each_batch(struct calx_block_view *b, struct calx_columns *c,
                       void (*use)(const struct calx_block_view *, struct calx_columns *))
{
    struct calx_sim *s = b->s;
    for (size_t g = 0; g < b->block->group_count; g++) {
        struct calx_group *group = &s->groups[b->block->group_first + g];
        if (!b->look && group->soon)
            CALX_ISA(calx_apart_admit)(b, group);
        calx_timing_lap(b->clock, CALX_PHASE_SELECT);
        b->type = (size_t)group->type;
        b->room = group->room;
        for (size_t at = 0; at < group->count; at += CALX_BATCH) {
            c->n = group->count - at < CALX_BATCH ? group->count - at : CALX_BATCH;
            b->first = group->first + at;
            b->i = s->pairs.i + b->first;
            b->j = s->pairs.j + b->first;
            b->history = (size_t)(calx_group_history(s, group, 0) - s->pairs.history) + at;
            CALX_ISA(calx_gather_batch)(b, c);
            calx_timing_lap(b->clock, CALX_PHASE_GATHER);
            use(b, c);
        }
    }
}

/* What belongs to particles of later blocks, which will collect it. */
static void leave_for_others(struct calx_sim *s, const struct calx_row_block *b, const double *a)
{
    double *kept = calx_row_a(s, b->first);
    size_t own = s->r.stride * (size_t)b->own;
    if (a != kept)
        memcpy(kept + own, a + own, s->r.stride * (size_t)b->ghosts * sizeof *a);
}

static void block_forces(struct calx_sim *s, size_t block, const struct calx_pass *pass, double *a)
{
    struct calx_block_view b = view_block(s, block, pass->dt, pass->conduct, a);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    size_t rows = (size_t)(b.block->own + b.block->ghosts);
    b.clock = calx_timing_clock(s);
    calx_timing_restart(b.clock);
    fetch_block(s, b.block);
    memset(b.tally, 0, sizeof *b.tally);
    memset(b.a, 0, rows * s->r.stride * sizeof(double));
    refresh_ghosts(s, b.block);
    calx_timing_lap(b.clock, CALX_PHASE_GHOSTS);
    c->solution = s->delivering ? calx_store_solution(s, block, &c->answer) : NULL;
    each_batch(&b, c, process_batch);
    CALX_ISA(calx_wall_contacts)(s, block, pass->dt, pass->conduct, a, c, NULL, NULL);
    c->solution = NULL;
    calx_timing_lap(b.clock, CALX_PHASE_WALLS);
    leave_for_others(s, b.block, a);
    calx_timing_lap(b.clock, CALX_PHASE_GHOSTS);
}

static bool block_sift(struct calx_sim *s, size_t block, double inner)
{
    struct calx_block_view b = view_block(s, block, 0.0, false, NULL);
    struct calx_clock *clock = calx_timing_clock(s);
    bool room = true;
    calx_timing_restart(clock);
    refresh_places(s, b.block);
    for (size_t g = 0; g < b.block->group_count; g++)
        room &= CALX_ISA(calx_apart_sift)(&b, &s->groups[b.block->group_first + g], inner);
    calx_timing_lap(clock, CALX_PHASE_SELECT);
    return room;
}

static void add_energy(const struct calx_block_view *b, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_energy)(b->s->plan, b->type, b->dt, c);
    for (size_t lane = 0; lane < c->n; lane++)
        b->tally->energy += c->overlap[lane] > -b->s->plan->gap ? c->energy[lane] : 0.0;
}

static void block_energy(struct calx_sim *s, size_t block, double *energy)
{
    struct calx_block_view b = view_block(s, block, 0.0, false, NULL);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.look = true;
    b.tally->energy = 0.0;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, add_energy);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, false, NULL, c, &b.tally->energy, NULL);
    *energy = b.tally->energy;
}

static void show_batch(const struct calx_block_view *b, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_laws)(b->s->plan, b->type, 0.0, b->conduct, c, NULL);
    for (size_t lane = 0; lane < c->n; lane++)
        if (c->overlap[lane] > -b->s->plan->gap)
            b->sink->take(b->sink->context, c, lane, b->block->first + calx_row_of_place(b->i[lane]),
                          b->block->first + calx_row_of_place(b->j[lane]));
}

static void show_block(struct calx_sim *s, size_t block, bool look, bool conduct, const struct calx_sink *sink)
{
    struct calx_block_view b = view_block(s, block, 0.0, conduct, NULL);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.look = look;
    b.sink = sink;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, show_batch);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, conduct, NULL, c, NULL, sink);
}

static void block_network(struct calx_sim *s, size_t block, const struct calx_sink *sink)
{
    show_block(s, block, true, s->plan->conductance != NULL, sink);
}

static void block_collect(struct calx_sim *s, size_t block, const struct calx_sink *sink)
{
    show_block(s, block, false, false, sink);
}

const struct calx_engine CALX_ISA(calx_engine) = {
    .block_forces = block_forces, .block_sift = block_sift, .block_energy = block_energy, .block_network = block_network,
    .block_collect = block_collect,
    .find_pairs = CALX_ISA(calx_pairs_find),
    .block_before = CALX_ISA(calx_block_before), .block_finish = CALX_ISA(calx_block_finish),
    .block_kernels = CALX_ISA(calx_block_kernels), .block_measure = CALX_ISA(calx_block_measure)};

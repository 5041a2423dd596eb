/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Forces and heat flows of one block: refresh its ghosts, pick the pairs that touch, gather them from rows into the
 * columns of a batch, evaluate, and add the results to the rows of the block in the order of its list.
 * Newton's third law, the lever arms and the antisymmetric heat flow are applied here and in wall_contacts.c, nowhere else.
 */
#include <math.h>
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
    size_t own = (size_t)b->own, stride = s->plan->history_stride;
    double sum = read_through(calx_row_x(s, b->first), 4 * own);
    sum += read_through(calx_row_v(s, b->first), s->r.stride * own);
    for (size_t g = b->group_first; g < b->group_first + b->group_count; g++)
        sum += read_through(s->pairs.history + stride * s->groups[g].first, stride * s->groups[g].close);
    __asm__ volatile("" : : "m"(sum));
}

enum { AHEAD = 12 }; /* ghosts whose sources are fetched in advance */

static void refresh_ghosts(struct calx_sim *s, const struct calx_row_block *b)
{
    const struct calx_scene *scene = s->scene;
    int32_t end = b->first + b->own + b->ghosts;
    for (int32_t row = b->first + b->own; row < end; row++) {
        int32_t ahead = s->r.source[row + AHEAD < end ? row + AHEAD : row];
        __builtin_prefetch(calx_row_x(s, ahead));
        __builtin_prefetch(calx_row_v(s, ahead));
        const double *x = calx_row_x(s, s->r.source[row]);
        calx_v4 at = calx_v4_load(x);
        if (s->r.shift) {
            int shift = s->r.shift[row];
            at[0] += (shift % 3 - 1) * (scene->high[0] - scene->low[0]);
            at[1] += (shift / 3 % 3 - 1) * (scene->high[1] - scene->low[1]);
            at[2] += (shift / 9 - 1) * (scene->high[2] - scene->low[2]);
        }
        calx_v4_store(calx_row_x(s, row), at);
        const double *from = calx_row_v(s, s->r.source[row]);
        double *to = calx_row_v(s, row);
        for (size_t lane = 0; lane < s->r.stride; lane += 4)
            calx_v4_store(to + lane, calx_v4_load(from + lane));
    }
}

static const double zeros[CALX_BATCH] __attribute__((aligned(64)));

/* Eight lanes of four columns, times sign, as rows. */
static inline void take_rows(const double *const column[4], size_t lane, double sign, calx_v4 row[8])
{
    calx_v8 v[4];
    for (int k = 0; k < 4; k++)
        v[k] = sign * calx_v8_load(column[k] + lane);
    calx_columns_to_rows(v, row);
}

/* Adds forces to the rows of one body of each contact; rows of four. */
static void add_half_rows(const struct calx_block_view *b, const struct calx_columns *c, int body,
                          const double *const force[4], double sign)
{
    calx_v4 row[8];
    for (size_t lane = 0; lane < c->n; lane += 8) {
        take_rows(force, lane, sign, row);
        for (size_t k = 0; k < 8 && lane + k < c->n; k++)
            calx_v4_add(b->a + 4 * (size_t)c->row[body][lane + k], row[k]);
    }
}

/* The same with couples and heat in the second half of the row: one cache line read and written per body. */
static void add_full_rows(const struct calx_block_view *b, const struct calx_columns *c, int body,
                          const double *const force[4], double sign, const double *const couple[4])
{
    calx_v4 first[8], second[8];
    for (size_t lane = 0; lane < c->n; lane += 8) {
        take_rows(force, lane, sign, first);
        take_rows(couple, lane, 1.0, second);
        for (size_t k = 0; k < 8 && lane + k < c->n; k++) {
            double *to = b->a + 8 * (size_t)c->row[body][lane + k];
            calx_v8_store(to, calx_v8_load(to) + calx_v8_join(first[k], second[k]));
        }
    }
}

/* couple = -lever*twist + sign*torque */
static void couples(size_t n, double sign, const double *restrict lever,
                    const double (*restrict twist)[CALX_BATCH], const double (*restrict torque)[CALX_BATCH],
                    double (*restrict couple)[CALX_BATCH])
{
    for (int k = 0; k < 3; k++)
        for (size_t c = 0; c < n; c++)
            couple[k][c] = sign * torque[k][c] - lever[c] * twist[k][c];
}

/* Forces, and what the second half of the rows holds if the scene has it. */
static void add_to_rows(const struct calx_block_view *b, const struct calx_columns *c, bool heat)
{
    bool rotation = b->s->plan->needs & CALX_NEEDS_ROTATION;
    const double *const force[4] = {c->force[0], c->force[1], c->force[2], zeros};
    double couple[3][CALX_BATCH] __attribute__((aligned(64)));
    for (int body = 0; body < 2; body++) {
        double sign = body ? -1.0 : 1.0;
        if (b->stride == 4) {
            add_half_rows(b, c, body, force, sign);
            continue;
        }
        if (rotation)
            couples(calx_padded(c->n), sign, c->lever[body], c->twist, c->torque, couple);
        const double *const second[4] = {rotation ? couple[0] : zeros, rotation ? couple[1] : zeros,
                                         rotation ? couple[2] : zeros, heat ? c->heat[body] : zeros};
        add_full_rows(b, c, body, force, sign, second);
    }
}

/* Heat into i and j by conduction. */
static void conduct_heat(size_t n, const double *restrict h, const double *restrict ti,
                         const double *restrict tj, double *restrict qi, double *restrict qj)
{
    for (size_t c = 0; c < n; c++) {
        qi[c] = h[c] * (tj[c] - ti[c]);
        qj[c] = -qi[c];
    }
}

/* The edges of the network, for an integrator that solves for all temperatures at once. */
static void add_edges(const struct calx_block_view *b, const struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    const struct calx_row_block *rb = b->block;
    size_t first = s->groups[rb->group_first].first;
    for (size_t lane = 0; lane < c->n; lane++) {
        int32_t i = rb->first + c->row[0][lane], j = rb->first + c->row[1][lane];
        if (!(c->conductance[lane] > 0.0))
            continue;
        size_t e = first + b->tally->edges++;
        s->edge_i[e] = c->row[0][lane] < rb->own ? i : s->r.source[i];
        s->edge_j[e] = c->row[1][lane] < rb->own ? j : s->r.source[j];
        s->edge_h[e] = c->conductance[lane];
    }
}

static void add_dissipation(const struct calx_block_view *b, struct calx_columns *c, size_t type)
{
    double share[2];
    size_t materials = b->s->scene->material_count, padded = calx_padded(c->n);
    CALX_ISA(calx_heat_shares)(b->s, type / materials, type % materials, share);
    for (int body = 0; body < 2; body++)
        for (size_t lane = 0; lane < padded; lane++)
            c->heat[body][lane] += share[body] / b->interval * c->work[lane];
}

/* Fills heat[]; false if no heat flows in rows. */
static bool heat_flows(const struct calx_block_view *b, struct calx_columns *c, size_t type)
{
    struct calx_sim *s = b->s;
    bool rows = b->conduct && !s->plan->global_heat;
    bool dissipation = s->features.temperature && s->scene->from_dissipation > 0.0 && b->dt > 0.0;
    if (b->conduct && !rows)
        add_edges(b, c);
    if (rows)
        conduct_heat(calx_padded(c->n), c->conductance, c->temperature[0], c->temperature[1], c->heat[0],
                     c->heat[1]);
    else if (dissipation)
        memset(c->heat, 0, sizeof c->heat);
    if (dissipation)
        add_dissipation(b, c, type);
    return rows || dissipation;
}

/* Sums in eight lanes, then across: the same order on every machine. */
static double sum_lanes(const double *restrict v, size_t n)
{
    calx_v8 sum = {0};
    for (size_t lane = 0; lane < n; lane += 8)
        sum += calx_v8_load(v + lane);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static double deepest(size_t n, const double *restrict overlap, const double (*restrict curvature)[CALX_BATCH])
{
    double most = 0.0;
    for (size_t c = 0; c < n; c++) {
        double k = curvature[0][c] > curvature[1][c] ? curvature[0][c] : curvature[1][c];
        double depth = overlap[c] * k;
        most = depth > most ? depth : most;
    }
    return most;
}

static void tally_pairs(const struct calx_block_view *b, struct calx_columns *c)
{
    struct calx_tally *t = b->tally;
    size_t padded = calx_padded(c->n);
    for (size_t lane = c->n; lane < padded; lane++)
        c->work[lane] = 0.0;
    t->work += sum_lanes(c->work, padded);
    for (size_t lane = 0; lane < c->n; lane++)
        t->contacts += c->overlap[lane] > 0.0;
    double depth = deepest(padded, c->overlap, c->curvature);
    if (!(depth > t->overlap))
        return;
    t->overlap = depth;
    for (size_t lane = 0; lane < c->n; lane++)
        if (c->overlap[lane] * fmax(c->curvature[0][lane], c->curvature[1][lane]) >= depth) {
            t->overlap_rows[0] = b->block->first + c->row[0][lane];
            t->overlap_rows[1] = b->block->first + c->row[1][lane];
        }
}

static void process_batch(const struct calx_block_view *b, size_t type, struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    CALX_ISA(calx_evaluate_batch)(s->plan, type, b->dt, b->conduct, c, b->clock);
    CALX_ISA(calx_gather_keep)(s, c);
    add_to_rows(b, c, heat_flows(b, c, type));
    tally_pairs(b, c);
    calx_timing_lap(b->clock, CALX_PHASE_SCATTER);
}

static struct calx_block_view view_block(struct calx_sim *s, size_t block, double dt, bool conduct)
{
    const struct calx_row_block *rb = &s->blocks[block];
    return (struct calx_block_view){.s = s, .block = rb, .tally = &s->tallies[block],
                                    .x = calx_row_x(s, rb->first), .v = calx_row_v(s, rb->first),
                                    .a = calx_row_a(s, rb->first), .stride = s->r.stride, .dt = dt,
                                    .interval = conduct ? s->heat_dt : dt, .conduct = conduct};
}

/* Batches of the touching pairs of a block, in list order. */
static void each_batch(const struct calx_block_view *b, struct calx_columns *c,
                       void (*use)(const struct calx_block_view *, size_t type, struct calx_columns *))
{
    struct calx_sim *s = b->s;
    for (size_t g = 0; g < b->block->group_count; g++) {
        const struct calx_group *group = &s->groups[b->block->group_first + g];
        size_t at = group->first, end = group->first + group->count;
        while (at < end) {
            at = CALX_ISA(calx_gather_select)(b, at, end, s->plan->gap, c);
            calx_timing_lap(b->clock, CALX_PHASE_SELECT);
            if (c->n == 0)
                continue;
            CALX_ISA(calx_gather_batch)(b, c);
            calx_timing_lap(b->clock, CALX_PHASE_GATHER);
            use(b, (size_t)group->type, c);
        }
    }
}

static void block_forces(struct calx_sim *s, size_t block, double dt, bool conduct)
{
    struct calx_block_view b = view_block(s, block, dt, conduct);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    size_t rows = (size_t)(b.block->own + b.block->ghosts);
    b.clock = calx_timing_clock(s);
    calx_timing_restart(b.clock);
    fetch_block(s, b.block);
    memset(b.tally, 0, sizeof *b.tally);
    memset(b.a, 0, rows * b.stride * sizeof(double));
    refresh_ghosts(s, b.block);
    calx_timing_lap(b.clock, CALX_PHASE_GHOSTS);
    each_batch(&b, c, process_batch);
    CALX_ISA(calx_wall_contacts)(s, block, dt, conduct, c, NULL, NULL);
    calx_timing_lap(b.clock, CALX_PHASE_WALLS);
}

static void add_energy(const struct calx_block_view *b, size_t type, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_energy)(b->s->plan, type, b->dt, c);
    for (size_t lane = 0; lane < c->n; lane++)
        b->tally->energy += c->overlap[lane] > -b->s->plan->gap ? c->energy[lane] : 0.0;
}

static void block_energy(struct calx_sim *s, size_t block, double *energy)
{
    struct calx_block_view b = view_block(s, block, 0.0, false);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.tally->energy = 0.0;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, add_energy);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, false, c, &b.tally->energy, NULL);
    *energy = b.tally->energy;
}

static void show_batch(const struct calx_block_view *b, size_t type, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_batch)(b->s->plan, type, 0.0, b->conduct, c, NULL);
    for (size_t lane = 0; lane < c->n; lane++)
        if (c->overlap[lane] > -b->s->plan->gap)
            b->sink->take(b->sink->context, c, lane, b->block->first + c->row[0][lane],
                          b->block->first + c->row[1][lane]);
}

static void block_network(struct calx_sim *s, size_t block, const struct calx_sink *sink)
{
    struct calx_block_view b = view_block(s, block, 0.0, s->plan->conductance != NULL);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.sink = sink;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, show_batch);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, b.conduct, c, NULL, sink);
}

const struct calx_engine CALX_ISA(calx_engine) = {
    .block_forces = block_forces, .block_energy = block_energy, .block_network = block_network,
    .block_before = CALX_ISA(calx_block_before), .block_finish = CALX_ISA(calx_block_finish)};

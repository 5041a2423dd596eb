/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Forces and heat flows of one block: refresh its ghosts, pick the pairs that touch, gather them from rows into the
 * columns of a batch, evaluate, and add the results to the rows of the block in the order of its list.
 * Newton's third law, the lever arms and the antisymmetric heat flow are applied here and in wall_contacts.c, nowhere else.
 */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/columns.h"
#include "core/vector.h"

/* The rows of one block, and where its results go. */
struct block_view {
    struct calx_sim *s;
    const struct calx_row_block *block;
    struct calx_tally *tally;
    const double *x, *v;
    double *a;
    size_t stride;
    double dt, interval; /* step of motion; time over which heat of this evaluation flows */
    bool conduct;
    const struct calx_sink *sink;
};

static void refresh_ghosts(struct calx_sim *s, const struct calx_row_block *b)
{
    const struct calx_scene *scene = s->scene;
    for (int32_t row = b->first + b->own; row < b->first + b->own + b->ghosts; row++) {
        const double *x = calx_row_x(s, s->r.source[row]);
        calx_v4 at = calx_v4_load(x);
        if (s->r.shift) {
            int shift = s->r.shift[row];
            at[0] += (shift % 3 - 1) * (scene->high[0] - scene->low[0]);
            at[1] += (shift / 3 % 3 - 1) * (scene->high[1] - scene->low[1]);
            at[2] += (shift / 9 - 1) * (scene->high[2] - scene->low[2]);
        }
        calx_v4_store(calx_row_x(s, row), at);
        memcpy(calx_row_v(s, row), calx_row_v(s, s->r.source[row]), s->r.stride * sizeof(double));
    }
}

/* Lists the pairs of a group that touch, or did at the last evaluation. */
static size_t select_pairs(const struct block_view *b, const struct calx_group *g, double gap,
                           uint32_t *list)
{
    const struct calx_pairs *p = &b->s->pairs;
    const calx_v4 sign = {-1.0, -1.0, -1.0, 1.0};
    size_t n = 0;
    for (size_t k = g->first; k < g->first + g->count; k++) {
        calx_v4 d = calx_v4_load(b->x + 4 * (size_t)p->i[k]) +
                    sign * calx_v4_load(b->x + 4 * (size_t)p->j[k]);
        double reach = d[3] + gap;
        calx_v4 q = d * d;
        list[n] = (uint32_t)(k - g->first);
        n += (size_t)((q[0] + q[1] + q[2] < reach * reach) | p->touching[k]);
    }
    return n;
}

/* Rows to columns for one lane. */
static void gather_lane(const struct block_view *b, struct calx_columns *c, size_t lane, size_t pair)
{
    const struct calx_pairs *p = &b->s->pairs;
    int32_t i = p->i[pair], j = p->j[pair];
    calx_v4 xi = calx_v4_load(b->x + 4 * (size_t)i), xj = calx_v4_load(b->x + 4 * (size_t)j);
    const double *vi = b->v + b->stride * (size_t)i, *vj = b->v + b->stride * (size_t)j;
    c->row[0][lane] = i;
    c->row[1][lane] = j;
    c->source[lane] = pair;
    for (int k = 0; k < 3; k++) {
        c->normal[k][lane] = xi[k] - xj[k];
        c->velocity[k][lane] = vi[k] - vj[k];
    }
    c->lever[0][lane] = xi[3];
    c->lever[1][lane] = xj[3];
    c->inverse_mass[lane] = vi[3] + vj[3];
    if (b->stride == 4)
        return;
    for (int k = 0; k < 3; k++) {
        c->omega[0][k][lane] = vi[4 + k];
        c->omega[1][k][lane] = vj[4 + k];
    }
    c->temperature[0][lane] = vi[7];
    c->temperature[1][lane] = vj[7];
}

/* From the difference of centres and the radii (in lever) to overlap, normal, curvatures, levers. `half` is 1/2 if the contact point is at the
 * middle of the overlap, 0 if the lever is the radius. */
static void pair_geometry(size_t n, double lag, double half, double (*restrict normal)[CALX_BATCH],
                          double (*restrict lever)[CALX_BATCH], double *restrict overlap,
                          double (*restrict curvature)[CALX_BATCH], double *restrict tilt,
                          double *restrict inverse_mass)
{
    for (size_t c = 0; c < n; c++) {
        double x = normal[0][c], y = normal[1][c], z = normal[2][c];
        double d = sqrt(x * x + y * y + z * z), ri = lever[0][c], rj = lever[1][c];
        double over = d > 0.0 ? 1.0 / d : 0.0, depth = ri + rj - d;
        normal[0][c] = d > 0.0 ? x * over : 1.0; /* coincident centres: any direction will do */
        normal[1][c] = y * over;
        normal[2][c] = z * over;
        overlap[c] = depth;
        tilt[c] = lag * over;
        curvature[0][c] = 1.0 / ri;
        curvature[1][c] = 1.0 / rj;
        lever[0][c] = ri - half * depth;
        lever[1][c] = rj - half * depth;
        inverse_mass[c] = inverse_mass[c] > 1e-200 ? inverse_mass[c] : 1e-200; /* both bodies fixed */
    }
}

static void load_history(const struct calx_sim *s, struct calx_columns *c)
{
    size_t columns = s->plan->history;
    for (size_t lane = 0; lane < c->n; lane++)
        for (size_t h = 0; h < columns; h++)
            c->history[h][lane] = s->pairs.history[columns * c->source[lane] + h];
}

/* Keeps the history of what touches, forgets that of what has parted. */
static void store_history(struct calx_sim *s, const struct calx_columns *c, double gap)
{
    size_t columns = s->plan->history;
    for (size_t lane = 0; lane < c->n; lane++) {
        bool touching = c->overlap[lane] > -gap;
        double *to = s->pairs.history + columns * c->source[lane];
        s->pairs.touching[c->source[lane]] = touching;
        for (size_t h = 0; h < columns; h++)
            to[h] = touching ? c->history[h][lane] : 0.0;
    }
}

static void gather(const struct block_view *b, const uint32_t *list, size_t n, size_t first,
                   struct calx_columns *c)
{
    const struct calx_plan *plan = b->s->plan;
    size_t padded = (n + CALX_WIDTH - 1) / CALX_WIDTH * CALX_WIDTH;
    double lag = plan->motion_law && !plan->models->lever_full ? plan->motion_law->velocity_lag * b->dt : 0.0;
    c->n = n;
    for (size_t lane = 0; lane < n; lane++)
        gather_lane(b, c, lane, first + list[lane]);
    for (size_t lane = n; lane < padded; lane++) {
        c->lever[0][lane] = c->lever[1][lane] = 0.5;
        c->normal[0][lane] = 1.0;
        c->normal[1][lane] = c->normal[2][lane] = 0.0;
    }
    pair_geometry(padded, lag, plan->models->lever_full ? 0.0 : 0.5, c->normal, c->lever, c->overlap,
                  c->curvature, c->tilt, c->inverse_mass);
    load_history(b->s, c);
}

static void scatter_forces(const struct block_view *b, const struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane++) {
        calx_v4 f = {c->force[0][lane], c->force[1][lane], c->force[2][lane], 0.0};
        calx_v4_add(b->a + b->stride * (size_t)c->row[0][lane], f);
        calx_v4_add(b->a + b->stride * (size_t)c->row[1][lane], -f);
    }
}

static void scatter_torques(const struct block_view *b, const struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane++) {
        calx_v4 t = {c->twist[0][lane], c->twist[1][lane], c->twist[2][lane], 0.0};
        calx_v4 li = {c->lever[0][lane], c->lever[0][lane], c->lever[0][lane], 0.0};
        calx_v4 lj = {c->lever[1][lane], c->lever[1][lane], c->lever[1][lane], 0.0};
        calx_v4_add(b->a + b->stride * (size_t)c->row[0][lane] + 4, -(li * t));
        calx_v4_add(b->a + b->stride * (size_t)c->row[1][lane] + 4, -(lj * t));
    }
}

static void scatter_couples(const struct block_view *b, const struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane++) {
        calx_v4 t = {c->torque[0][lane], c->torque[1][lane], c->torque[2][lane], 0.0};
        calx_v4_add(b->a + b->stride * (size_t)c->row[0][lane] + 4, t);
        calx_v4_add(b->a + b->stride * (size_t)c->row[1][lane] + 4, -t);
    }
}

/* Heat flows of conduction: into the rows, or as edges of the network for an integrator that solves for all temperatures. */
static void scatter_conduction(const struct block_view *b, const struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    size_t first = s->groups[b->block->group_first].first;
    for (size_t lane = 0; lane < c->n; lane++) {
        int32_t i = c->row[0][lane], j = c->row[1][lane];
        if (!s->plan->global_heat) {
            double q = c->conductance[lane] * (c->temperature[1][lane] - c->temperature[0][lane]);
            b->a[b->stride * (size_t)i + 7] += q;
            b->a[b->stride * (size_t)j + 7] -= q;
        } else if (c->conductance[lane] > 0.0) {
            size_t e = first + b->tally->edges++;
            s->edge_i[e] = i < b->block->own ? b->block->first + i : s->r.source[b->block->first + i];
            s->edge_j[e] = j < b->block->own ? b->block->first + j : s->r.source[b->block->first + j];
            s->edge_h[e] = c->conductance[lane];
        }
    }
}

static void scatter_dissipation(const struct block_view *b, const struct calx_columns *c, size_t type)
{
    double share[2];
    size_t materials = b->s->scene->material_count;
    CALX_ISA(calx_heat_shares)(b->s, type / materials, type % materials, share);
    for (size_t lane = 0; lane < c->n; lane++)
        for (int k = 0; k < 2; k++)
            b->a[b->stride * (size_t)c->row[k][lane] + 7] += share[k] * c->work[lane] / b->interval;
}

static void tally_pairs(const struct block_view *b, const struct calx_columns *c)
{
    struct calx_tally *t = b->tally;
    for (size_t lane = 0; lane < c->n; lane++) {
        double k = fmax(c->curvature[0][lane], c->curvature[1][lane]), depth = c->overlap[lane] * k;
        t->contacts += c->overlap[lane] > 0.0;
        t->work += c->work[lane];
        if (depth > t->overlap) {
            t->overlap = depth;
            t->overlap_rows[0] = b->block->first + c->row[0][lane];
            t->overlap_rows[1] = b->block->first + c->row[1][lane];
        }
    }
}

static void process_batch(const struct block_view *b, const struct calx_group *g, struct calx_columns *c)
{
    struct calx_sim *s = b->s;
    const struct calx_plan *plan = s->plan;
    size_t type = (size_t)g->type;
    CALX_ISA(calx_evaluate_batch)(plan, type, b->dt, b->conduct, c);
    store_history(s, c, plan->gap);
    scatter_forces(b, c);
    if (plan->needs & CALX_NEEDS_ROTATION)
        scatter_torques(b, c);
    if (plan->needs & CALX_NEEDS_SPIN)
        scatter_couples(b, c);
    if (b->conduct)
        scatter_conduction(b, c);
    if (s->features.temperature && s->scene->from_dissipation > 0.0 && b->dt > 0.0)
        scatter_dissipation(b, c, type);
    tally_pairs(b, c);
}

static struct block_view view_block(struct calx_sim *s, size_t block, double dt, bool conduct)
{
    const struct calx_row_block *rb = &s->blocks[block];
    return (struct block_view){.s = s, .block = rb, .tally = &s->tallies[block],
                               .x = calx_row_x(s, rb->first), .v = calx_row_v(s, rb->first),
                               .a = calx_row_a(s, rb->first), .stride = s->r.stride, .dt = dt,
                               .interval = conduct ? s->plan->heat_dt : dt, .conduct = conduct};
}

/* Batches of the touching pairs of a block, in list order. */
static void each_batch(const struct block_view *b, struct calx_columns *c,
                       void (*use)(const struct block_view *, const struct calx_group *, struct calx_columns *))
{
    struct calx_sim *s = b->s;
    uint32_t *list = s->selected[omp_get_thread_num()];
    for (size_t g = 0; g < b->block->group_count; g++) {
        const struct calx_group *group = &s->groups[b->block->group_first + g];
        size_t n = select_pairs(b, group, s->plan->gap, list);
        for (size_t k = 0; k < n; k += CALX_BATCH) {
            gather(b, list + k, n - k < CALX_BATCH ? n - k : CALX_BATCH, group->first, c);
            use(b, group, c);
        }
    }
}

static void block_forces(struct calx_sim *s, size_t block, double dt, bool conduct)
{
    struct block_view b = view_block(s, block, dt, conduct);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    size_t rows = (size_t)(b.block->own + b.block->ghosts);
    memset(b.tally, 0, sizeof *b.tally);
    memset(b.a, 0, rows * b.stride * sizeof(double));
    refresh_ghosts(s, b.block);
    each_batch(&b, c, process_batch);
    CALX_ISA(calx_wall_contacts)(s, block, dt, conduct, c, NULL, NULL);
}

static void add_energy(const struct block_view *b, const struct calx_group *g, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_energy)(b->s->plan, (size_t)g->type, b->dt, c);
    for (size_t lane = 0; lane < c->n; lane++)
        b->tally->energy += c->overlap[lane] > -b->s->plan->gap ? c->energy[lane] : 0.0;
}

static void block_energy(struct calx_sim *s, size_t block, double *energy)
{
    struct block_view b = view_block(s, block, 0.0, false);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.tally->energy = 0.0;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, add_energy);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, false, c, &b.tally->energy, NULL);
    *energy = b.tally->energy;
}

static void show_batch(const struct block_view *b, const struct calx_group *g, struct calx_columns *c)
{
    CALX_ISA(calx_evaluate_batch)(b->s->plan, (size_t)g->type, 0.0, b->conduct, c);
    for (size_t lane = 0; lane < c->n; lane++)
        if (c->overlap[lane] > -b->s->plan->gap)
            b->sink->take(b->sink->context, c, lane, b->block->first + c->row[0][lane],
                          b->block->first + c->row[1][lane]);
}

static void block_network(struct calx_sim *s, size_t block, const struct calx_sink *sink)
{
    struct block_view b = view_block(s, block, 0.0, s->plan->conductance != NULL);
    struct calx_columns *c = s->columns[omp_get_thread_num()];
    b.sink = sink;
    refresh_ghosts(s, b.block);
    each_batch(&b, c, show_batch);
    CALX_ISA(calx_wall_contacts)(s, block, 0.0, b.conduct, c, NULL, sink);
}

const struct calx_engine CALX_ISA(calx_engine) = {block_forces, block_energy, block_network};

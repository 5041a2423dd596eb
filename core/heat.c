/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One step of a global integrator of temperature, from the network of conductances that the contact pass left, gathered in block order so
 * that sums have a fixed order; and the check of a staged one, whose step is made block by block (integrate.c).
 * Source: m c dT/dt = sum H (T_j - T_i) + dissipation.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"

static int32_t place_of_row(const struct calx_sim *s, int32_t row)
{
    size_t lo = 0, hi = s->block_count;
    while (hi - lo > 1) {
        size_t mid = (lo + hi) / 2;
        if (s->blocks[mid].first <= row)
            lo = mid;
        else
            hi = mid;
    }
    return (int32_t)(lo * CALX_BLOCK) + row - s->blocks[lo].first;
}

static void release_store(struct calx_sim *s, const struct calx_row_block *b)
{
    for (int32_t row = b->first; s->r.heat_store && row < b->first + b->own; row++) {
        calx_row_a(s, row)[7] += s->r.heat_store[row] / s->heat_dt;
        s->r.heat_store[row] = 0.0;
    }
}

/* What walls gave in a step that was made block by block. */
static void take_wall_heat(struct calx_sim *s)
{
    for (size_t b = 0; b < s->block_count; b++)
        s->wall_heat += (long double)s->tallies[b].wall_heat * (long double)s->heat_dt;
}

/* Arrays of the network, compact: node k is the k-th particle in order. */
struct network_arrays {
    double *temperature, *capacity, *source, *h, *bh, *bt, *heat;
    int32_t *i, *j, *bi, *wall; /* wall: of a boundary, -1 if it is a body of given temperature; */
    double (*at)[3];            /* where it is on the wall */
    size_t edges, boundaries;
};

static int allocate(const struct calx_sim *s, struct network_arrays *a, size_t edges, size_t boundaries)
{
    a->temperature = malloc((s->n + 1) * sizeof(double));
    a->capacity = malloc((s->n + 1) * sizeof(double));
    a->source = malloc((s->n + 1) * sizeof(double));
    a->h = malloc((edges + 1) * sizeof(double));
    a->i = malloc((edges + 1) * sizeof(int32_t));
    a->j = malloc((edges + 1) * sizeof(int32_t));
    a->bh = malloc((boundaries + 1) * sizeof(double));
    a->bt = malloc((boundaries + 1) * sizeof(double));
    a->heat = calloc(boundaries + 1, sizeof(double));
    a->bi = malloc((boundaries + 1) * sizeof(int32_t));
    a->wall = malloc((boundaries + 1) * sizeof(int32_t));
    a->at = calloc(boundaries + 1, sizeof *a->at);
    return !a->temperature || !a->capacity || !a->source || !a->h || !a->i || !a->j || !a->bh || !a->bt ||
           !a->heat || !a->bi || !a->wall || !a->at;
}

static void release(struct network_arrays *a)
{
    void *all[] = {a->temperature, a->capacity, a->source, a->h, a->i, a->j, a->bh, a->bt, a->heat, a->bi, a->wall, a->at};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
}

static void fill_nodes(struct calx_sim *s, struct network_arrays *a)
{
    size_t k = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        release_store(s, &s->blocks[b]);
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++, k++) {
            a->temperature[k] = calx_row_v(s, row)[7];
            bool given = s->r.inverse_capacity[row] == 0.0; /* no edge reaches this node */
            a->capacity[k] = given ? 1.0 : 1.0 / s->r.inverse_capacity[row];
            a->source[k] = given ? 0.0 : calx_row_a(s, row)[7];
        }
    }
}

static void add_boundary(const struct calx_sim *s, struct network_arrays *a, int32_t row, double h, double t)
{
    size_t w = a->boundaries++;
    a->bi[w] = place_of_row(s, row);
    a->bh[w] = h;
    a->bt[w] = t;
    a->wall[w] = -1;
}

static void add_wall(const struct calx_sim *s, struct network_arrays *a, size_t k)
{
    size_t w = a->boundaries;
    add_boundary(s, a, s->boundary_i[k], s->boundary_h[k], s->boundary_t[k]);
    a->wall[w] = s->boundary_wall[k];
    memcpy(a->at[w], s->boundary_at[k], sizeof a->at[w]);
}

/* A body of given temperature is a boundary to the others. */
static void add_edge(const struct calx_sim *s, struct network_arrays *a, int32_t i, int32_t j, double h)
{
    bool i_given = s->r.inverse_capacity[i] == 0.0, j_given = s->r.inverse_capacity[j] == 0.0;
    if (i_given != j_given) {
        add_boundary(s, a, i_given ? j : i, h, calx_row_v(s, i_given ? i : j)[7]);
    } else if (!i_given) {
        a->i[a->edges] = place_of_row(s, i);
        a->j[a->edges] = place_of_row(s, j);
        a->h[a->edges++] = h;
    }
}

static void fill_edges(const struct calx_sim *s, struct network_arrays *a)
{
    for (size_t b = 0; b < s->block_count; b++) {
        size_t first = s->groups[s->blocks[b].group_first].first, near = s->blocks[b].near_first;
        for (size_t k = first; k < first + s->tallies[b].edges; k++)
            add_edge(s, a, s->edge_i[k], s->edge_j[k], s->edge_h[k]);
        for (size_t k = near; k < near + s->tallies[b].boundaries; k++)
            add_wall(s, a, k);
    }
}

static void take_temperatures(struct calx_sim *s, const struct network_arrays *a)
{
    size_t k = 0;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++, k++)
            calx_row_v(s, row)[7] = a->temperature[k];
    for (size_t w = 0; w < a->boundaries; w++)
        if (a->wall[w] >= 0 && calx_wall_has_slab(s, a->wall[w]))
            calx_slabs_add(s, a->wall[w], a->at[w], -a->heat[w]);
        else
            s->wall_heat += a->heat[w];
}

static int step_global(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    struct network_arrays a = {0};
    size_t edges = 0, boundaries = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        edges += s->tallies[b].edges;
        boundaries += s->tallies[b].boundaries;
    }
    if (allocate(s, &a, edges, boundaries + edges)) {
        release(&a);
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu thermal contacts", edges);
    }
    fill_nodes(s, &a);
    fill_edges(s, &a);
    struct calx_network net = {.size = sizeof net, .n = s->n, .dt = s->heat_dt, .temperature = a.temperature,
                               .capacity = a.capacity, .source = a.source, .edges = a.edges, .edge = {a.i, a.j},
                               .edge_conductance = a.h, .boundaries = a.boundaries, .boundary = a.bi,
                               .boundary_conductance = a.bh, .boundary_temperature = a.bt,
                               .boundary_heat = a.heat};
    char why[256] = "";
    int failed = p->heat_law->solve(p->heat_params, &net, why, sizeof why);
    if (!failed)
        take_temperatures(s, &a);
    release(&a);
    if (failed)
        return calx_error_set(e, CALX_ERROR_PHYSICS, "at t = %g s the integrator of temperature %s failed: %s",
                              s->time, p->heat->name, why);
    return 0;
}

int calx_heat_step(struct calx_sim *s, struct calx_error *e)
{
    if (!s->plan->heat_law)
        return 0;
    if ((s->stage_step - s->pace_step) % s->heat_every)
        return 0;
    if (s->plan->global_heat)
        CALX_TRY(step_global(s, e));
    else
        take_wall_heat(s);
    return calx_slabs_step(s, !s->plan->global_heat, e);
}

/* Sums of conductances by row; insulated walls take no heat. */
struct exchange {
    const struct calx_sim *s;
    double *sum;
};

static void add_exchange(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    const struct exchange *x = context;
    if (row_j < 0 && !calx_wall_conducts(x->s, -1 - row_j))
        return;
    x->sum[row_i] += c->conductance[lane];
    if (row_j >= 0)
        x->sum[row_j] += c->conductance[lane];
}

/* The body that exchanges heat fastest, and how fast, 1/s. */
static double fastest_exchange(const struct calx_sim *s, double *sum, int32_t *fastest)
{
    double most = 0.0;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t g = s->blocks[b].first + s->blocks[b].own, k = 0; k < s->blocks[b].ghosts; k++)
            sum[s->r.source[g + k]] += sum[g + k];
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            double rate = sum[row] * s->r.inverse_capacity[row];
            *fastest = rate > most ? row : *fastest;
            most = fmax(most, rate);
        }
    return most;
}

int calx_heat_limit(struct calx_sim *s, double *limit, int64_t *id, struct calx_error *e)
{
    struct exchange x = {s, calloc(s->r.rows + 1, sizeof *x.sum)};
    struct calx_sink sink = {&x, add_exchange};
    *limit = INFINITY;
    *id = -1;
    if (!x.sum)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory to check the heat step");
    for (size_t b = 0; s->plan->conductance && b < s->block_count; b++)
        s->engine->block_network(s, b, &sink);
    int32_t fastest = -1;
    double most = fastest_exchange(s, x.sum, &fastest);
    free(x.sum);
    if (fastest < 0)
        return 0;
    *limit = 1.0 / most;
    *id = s->r.id[fastest];
    return 0;
}

int calx_heat_check(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    double limit;
    int64_t id;
    if (!p->heat_law || !p->conductance || p->heat_law->unconditional)
        return 0;
    CALX_TRY(calx_heat_limit(s, &limit, &id, e));
    limit *= 0.5 * p->heat_law->stability;
    if (s->heat_dt <= limit)
        return 0;
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s the heat step of %g s is too long for %s: particle %lld exchanges heat so fast that temperatures "
        "overshoot beyond %g s. Give that integrator of temperature a shorter dt, or use heat-theta", s->time,
        s->heat_dt, p->heat->name, (long long)id, limit);
}

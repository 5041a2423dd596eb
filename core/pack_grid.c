/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The neighbour search of the packing. Input: positions, radii; output: candidates that may touch.
 * Cells of level l are as wide as the largest body of that level; a search visits few cells on its
 * own and coarser levels, so that the cost does not grow with the size ratio when large bodies are
 * placed first. Cells are hashed: the region may be any size.
 */
#include "core/pack_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool calx_pack_grid_create(struct calx_pack_grid *grid, const struct calx_region *region,
                           size_t count, double top, const double (*position)[3],
                           const double *radius)
{
    size_t buckets = 64;
    while (buckets < 2 * count)
        buckets *= 2;
    *grid = (struct calx_pack_grid){
        .dimension = region->dimension, .top = top, .position = position, .radius = radius};
    grid->mask = buckets - 1;
    for (uint32_t k = 0; k < region->dimension; k++) {
        grid->low[k] = isfinite(region->low[k]) ? region->low[k] : 0;
        grid->period[k] = region->periodic[k] ? region->high[k] - region->low[k] : 0;
        for (int l = 0; l < CALX_PACK_LEVELS; l++) {
            double width = ldexp(2 * top, -l);
            grid->cells[l][k] = (int64_t)fmax(grid->period[k] > 0, floor(grid->period[k] / width));
            grid->width[l][k] =
                grid->cells[l][k] ? grid->period[k] / (double)grid->cells[l][k] : width;
        }
    }
    grid->head = malloc(buckets * sizeof *grid->head);
    grid->next = malloc((count + 1) * sizeof *grid->next);
    grid->key = malloc((count + 1) * sizeof *grid->key);
    if (!grid->head || !grid->next || !grid->key)
        return false;
    calx_pack_grid_reset(grid);
    return true;
}

void calx_pack_grid_free(struct calx_pack_grid *grid)
{
    free(grid->head);
    free(grid->next);
    free(grid->key);
}

void calx_pack_grid_reset(struct calx_pack_grid *grid)
{
    memset(grid->head, -1, (grid->mask + 1) * sizeof *grid->head);
    memset(grid->population, 0, sizeof grid->population);
}

int calx_pack_grid_level(const struct calx_pack_grid *grid, double radius)
{
    int level = 0;
    for (double r = grid->top / 2; radius <= r && level < CALX_PACK_LEVELS - 1; r /= 2)
        level++;
    return level;
}

/* 19 bits per axis: cells that share a key are too far apart to be visited together. */
static uint64_t cell_key(int level, const int64_t cell[3])
{
    const uint64_t mask = (1u << 19) - 1;
    return (uint64_t)level << 57 | ((uint64_t)cell[0] & mask) << 38 |
           ((uint64_t)cell[1] & mask) << 19 | ((uint64_t)cell[2] & mask);
}

static size_t bucket_of(const struct calx_pack_grid *grid, uint64_t key)
{
    key = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    return (size_t)(key >> 20) & grid->mask;
}

static int64_t wrap(int64_t cell, int64_t cells)
{
    if (cells == 0)
        return cell;
    int64_t rest = cell % cells;
    return rest < 0 ? rest + cells : rest;
}

static int64_t cell_at(const struct calx_pack_grid *grid, int level, int k, double x)
{
    return (int64_t)floor((x - grid->low[k]) / grid->width[level][k]);
}

void calx_pack_grid_insert(struct calx_pack_grid *grid, int32_t i)
{
    int level = calx_pack_grid_level(grid, grid->radius[i]);
    int64_t cell[3] = {0};
    for (int k = 0; k < (int)grid->dimension; k++)
        cell[k] = wrap(cell_at(grid, level, k, grid->position[i][k]), grid->cells[level][k]);
    grid->key[i] = cell_key(level, cell);
    size_t bucket = bucket_of(grid, grid->key[i]);
    grid->next[i] = grid->head[bucket];
    grid->head[bucket] = i;
    grid->population[level]++;
}

static bool visit_cell(const struct calx_pack_grid *grid, uint64_t key,
                       bool (*visit)(void *context, int32_t j), void *context)
{
    for (int32_t j = grid->head[bucket_of(grid, key)]; j >= 0; j = grid->next[j])
        if (grid->key[j] == key && !visit(context, j))
            return false;
    return true;
}

/* The cells of a level that a search reaches along each axis, every cell once. */
static void find_range(const struct calx_pack_grid *grid, int level, const double x[3],
                       double reach, int64_t first[3], int64_t last[3])
{
    for (int k = 0; k < (int)grid->dimension; k++) {
        first[k] = cell_at(grid, level, k, x[k] - reach);
        last[k] = cell_at(grid, level, k, x[k] + reach);
        if (grid->cells[level][k] && last[k] - first[k] >= grid->cells[level][k])
            last[k] = first[k] + grid->cells[level][k] - 1;
    }
}

/* Where a search would visit more cells than there are buckets (a large body among small ones): every body of the level. */
static bool visit_whole_level(const struct calx_pack_grid *grid, int level,
                              bool (*visit)(void *context, int32_t j), void *context)
{
    for (size_t bucket = 0; bucket <= grid->mask; bucket++)
        for (int32_t j = grid->head[bucket]; j >= 0; j = grid->next[j])
            if (grid->key[j] >> 57 == (uint64_t)level && !visit(context, j))
                return false;
    return true;
}

static bool visit_level(const struct calx_pack_grid *grid, int level, const double x[3],
                        double reach, bool (*visit)(void *context, int32_t j), void *context)
{
    int64_t first[3] = {0}, last[3] = {0}, c[3], cell[3];
    const int64_t *cells = grid->cells[level];
    double count = 1;
    find_range(grid, level, x, reach, first, last);
    for (int k = 0; k < 3; k++)
        count *= (double)(last[k] - first[k] + 1);
    if (count > (double)grid->mask)
        return visit_whole_level(grid, level, visit, context);
    for (c[2] = first[2]; c[2] <= last[2]; c[2]++) {
        cell[2] = wrap(c[2], cells[2]);
        for (c[1] = first[1]; c[1] <= last[1]; c[1]++) {
            cell[1] = wrap(c[1], cells[1]);
            for (c[0] = first[0]; c[0] <= last[0]; c[0]++) {
                cell[0] = wrap(c[0], cells[0]);
                if (!visit_cell(grid, cell_key(level, cell), visit, context))
                    return false;
            }
        }
    }
    return true;
}

bool calx_pack_grid_visit(const struct calx_pack_grid *grid, const double x[3], double radius,
                          double margin, int deepest, bool (*visit)(void *context, int32_t j),
                          void *context)
{
    for (int level = 0; level <= deepest && level < CALX_PACK_LEVELS; level++) {
        double reach = radius + ldexp(grid->top, -level) + margin;
        if (grid->population[level] > 0 && !visit_level(grid, level, x, reach, visit, context))
            return false;
    }
    return true;
}

double calx_pack_grid_between(const struct calx_pack_grid *grid, const double x[3], int32_t j,
                              double d[3])
{
    double square = 0;
    for (int k = 0; k < (int)grid->dimension; k++) {
        d[k] = x[k] - grid->position[j][k];
        if (grid->period[k] > 0)
            d[k] -= grid->period[k] * nearbyint(d[k] / grid->period[k]);
        square += d[k] * d[k];
    }
    return square;
}

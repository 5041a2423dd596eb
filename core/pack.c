/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Random packings. Inputs: region, sizes, count or solid fraction, seed, bodies that are already
 * there; output: positions and radii without overlap. Method: largest first, random trials (random
 * sequential addition); bodies that find no place are put where they overlap least and the whole is
 * relaxed (pack_relax.c), which reaches solid fractions near random close packing.
 */
#include "core/pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/pack_parts.h"

/* Trials per body: many at first; few once bodies find no place, where relaxing is cheaper. */
enum {
    MANY_TRIALS = 200,
    FEW_TRIALS = 20,
    LOOSE_TRIALS = 2000,
    MOST_MISSES = 20,
    POINT_DRAWS = 10000
};

/* More than random trials ever place: how much is drawn when as many as they place are wanted. */
static const double densest = 0.9;

struct packer {
    struct calx_pack_set set;
    struct calx_random random;
    double low[3], high[3]; /* bounds of the region */
    double volume;          /* of the region */
    size_t *order;          /* of the bodies to place, largest first */
    size_t placed, misses;  /* free of overlap; found no place */
    double solid;           /* of the placed */
    bool loose;             /* as many as random trials place */
    bool *done;             /* per body: it has a place, free or overlapping */
    struct calx_error *error;
};

void calx_packing_free(struct calx_packing *packing)
{
    free(packing->position);
    free(packing->radius);
    *packing = (struct calx_packing){0};
}

/* ---- one body ---- */

/* A random point where a body of that radius is clear of the walls; false if none is found. */
static bool draw_point(struct packer *packer, double radius, double x[3])
{
    const struct calx_region *region = packer->set.region;
    for (int i = 0; i < POINT_DRAWS; i++) {
        for (uint32_t k = 0; k < region->dimension; k++) {
            double room = region->periodic[k] ? 0 : radius + region->clearance;
            double low = packer->low[k] + room, high = packer->high[k] - room;
            x[k] = low + (high - low) * calx_random_uniform(&packer->random);
        }
        if (calx_region_holds(region, x, radius))
            return true;
    }
    return false;
}

struct trial {
    const struct calx_pack_set *set;
    const double *x;
    double radius;
    double deepest; /* overlap with the others, relative to the smaller body */
};

static bool is_apart(void *context, int32_t j)
{
    const struct trial *trial = context;
    double d[3], sum = trial->radius + trial->set->radius[j];
    return calx_pack_grid_between(&trial->set->grid, trial->x, j, d) >= sum * sum;
}

static bool find_deepest(void *context, int32_t j)
{
    struct trial *trial = context;
    double d[3], other = trial->set->radius[j];
    double overlap =
        trial->radius + other - sqrt(calx_pack_grid_between(&trial->set->grid, trial->x, j, d));
    trial->deepest = fmax(trial->deepest, overlap / fmin(trial->radius, other));
    return true;
}

static bool visit_others(struct trial *trial, bool (*visit)(void *context, int32_t j))
{
    return calx_pack_grid_visit(&trial->set->grid, trial->x, trial->radius, 0, CALX_PACK_LEVELS,
                                visit, trial);
}

static void settle(struct packer *packer, size_t i, const double x[3])
{
    memcpy(packer->set.position[i], x, sizeof *packer->set.position);
    calx_pack_grid_insert(&packer->set.grid, (int32_t)i);
    packer->done[i] = true;
}

/* Gives body i the point of a few random ones where it overlaps least. */
static void squeeze(struct packer *packer, size_t i)
{
    double best[3] = {0}, least = INFINITY, x[3] = {0};
    for (int k = 0; k < FEW_TRIALS && draw_point(packer, packer->set.radius[i], x); k++) {
        struct trial trial = {&packer->set, x, packer->set.radius[i], 0};
        visit_others(&trial, find_deepest);
        if (trial.deepest < least) {
            least = trial.deepest;
            memcpy(best, x, sizeof best);
        }
    }
    settle(packer, i, best);
}

static int place(struct packer *packer, size_t i)
{
    double x[3] = {0}, radius = packer->set.radius[i];
    int trials = packer->loose                  ? LOOSE_TRIALS
                 : packer->misses < MOST_MISSES ? MANY_TRIALS
                                                : FEW_TRIALS;
    for (int k = 0; k < trials; k++) {
        if (!draw_point(packer, radius, x))
            return calx_error_set(packer->error, CALX_ERROR_INPUT,
                                  "a body of radius %g m does not fit into the region to fill (%g "
                                  "by %g by %g m): %zu were "
                                  "placed before it",
                                  radius, packer->high[0] - packer->low[0],
                                  packer->high[1] - packer->low[1],
                                  packer->high[2] - packer->low[2], packer->placed);
        struct trial trial = {&packer->set, x, radius, 0};
        if (visit_others(&trial, is_apart)) {
            settle(packer, i, x);
            packer->placed++;
            packer->solid += calx_pack_sizes_solid(packer->set.region->dimension, radius);
            return CALX_OK;
        }
    }
    packer->misses++;
    if (!packer->loose)
        squeeze(packer, i);
    return CALX_OK;
}

/* ---- all bodies ---- */

struct rank {
    double radius;
    size_t index;
};

static int compare_ranks(const void *a, const void *b)
{
    const struct rank *x = a, *y = b;
    if (x->radius != y->radius)
        return x->radius > y->radius ? -1 : 1;
    return x->index < y->index ? -1 : 1;
}

static bool rank_bodies(struct packer *packer)
{
    struct rank *ranks = malloc((packer->set.count + 1) * sizeof *ranks);
    if (!ranks)
        return false;
    for (size_t i = 0; i < packer->set.count; i++)
        ranks[i] = (struct rank){packer->set.radius[i], i};
    if (!packer->loose) /* as many as fit keep their distribution only in the order of drawing */
        qsort(ranks, packer->set.count, sizeof *ranks, compare_ranks);
    for (size_t i = 0; i < packer->set.count; i++)
        packer->order[i] = ranks[i].index;
    free(ranks);
    return true;
}

static int no_memory(struct packer *packer)
{
    return calx_error_set(packer->error, CALX_ERROR_MEMORY, "no memory to pack %zu bodies",
                          packer->set.count);
}

/* Takes over the drawn radii and appends the bodies that are there. */
static int fill_set(struct packer *packer, double *radius, size_t count,
                    const struct calx_bodies_at *avoid)
{
    struct calx_pack_set *set = &packer->set;
    size_t others = avoid ? avoid->count : 0;
    set->count = count;
    set->total = count + others;
    double *more = realloc(radius, (set->total + 1) * sizeof *radius);
    set->radius = more ? more : radius;
    set->position = calloc(set->total + 1, sizeof *set->position);
    packer->order = calloc(count + 1, sizeof *packer->order);
    packer->done = calloc(count + 1, sizeof *packer->done);
    if (!more || !set->position || !packer->order || !packer->done || set->total >= INT32_MAX)
        return no_memory(packer);
    if (others > 0) {
        memcpy(set->radius + count, avoid->radius, others * sizeof *set->radius);
        memcpy(set->position + count, avoid->position, others * sizeof *set->position);
    }
    set->least = INFINITY;
    for (size_t i = 0; i < set->total; i++) {
        set->least = fmin(set->least, set->radius[i]);
        set->largest = fmax(set->largest, set->radius[i]);
    }
    const struct calx_region *region = set->region;
    for (uint32_t k = 0; k < region->dimension; k++)
        if (region->periodic[k] && region->high[k] - region->low[k] < 2 * set->largest)
            return calx_error_set(
                packer->error, CALX_ERROR_INPUT,
                "a body of radius %g m would touch its own periodic image (period %g m)",
                set->largest, region->high[k] - region->low[k]);
    const double(*position)[3] = (const double(*)[3])set->position;
    if (!calx_pack_grid_create(&set->grid, region, set->total, set->largest, position,
                               set->radius) ||
        !rank_bodies(packer))
        return no_memory(packer);
    for (size_t i = count; i < set->total; i++)
        calx_pack_grid_insert(&set->grid, (int32_t)i);
    return CALX_OK;
}

static double solid_of(const struct packer *packer)
{
    double solid = 0;
    for (size_t i = 0; i < packer->set.count; i++)
        solid += calx_pack_sizes_solid(packer->set.region->dimension, packer->set.radius[i]);
    return solid;
}

/* Drops the bodies that overlap a wall or a kept body; what stays is a packing. Leaves `done` false
 * for the dropped. */
static size_t keep_apart(struct packer *packer)
{
    struct calx_pack_set *set = &packer->set;
    size_t kept = 0;
    calx_pack_grid_reset(&set->grid);
    for (size_t i = set->count; i < set->total; i++)
        calx_pack_grid_insert(&set->grid, (int32_t)i);
    for (size_t k = 0; k < set->count; k++) {
        size_t i = packer->order[k];
        struct trial trial = {set, set->position[i], set->radius[i], 0};
        packer->done[i] = packer->done[i] &&
                          calx_region_holds(set->region, trial.x, trial.radius) &&
                          visit_others(&trial, is_apart);
        if (!packer->done[i])
            continue;
        calx_pack_grid_insert(&set->grid, (int32_t)i);
        kept++;
    }
    return kept;
}

/* What was reached, and what would fit: all of them shrunk, or as much solid in bodies of the size
 * wanted. */
static int report(const struct packer *packer, double wanted, double shrink, size_t kept)
{
    size_t count = packer->set.count;
    double reached = pow(1 - fmin(1, shrink), packer->set.region->dimension);
    if (shrink == 0) /* something else is wrong with the rest, such as the wrong side of a wall */
        reached = (double)kept / (double)count;
    return calx_error_set(packer->error, CALX_ERROR_INPUT,
                          "%zu bodies, a solid fraction of %.3f, do not fit without overlap: "
                          "random trials placed %zu (%.3f), "
                          "and pushing all apart reached %.3f, with radii %.2f %% smaller; ask for "
                          "about %zu bodies, smaller "
                          "ones or a larger region",
                          count, wanted / packer->volume, packer->placed,
                          packer->solid / packer->volume, wanted * reached / packer->volume,
                          100 * shrink, (size_t)(reached * (double)count));
}

static int place_all(struct packer *packer)
{
    struct calx_pack_set *set = &packer->set;
    for (size_t k = 0; k < set->count && !(packer->loose && packer->misses >= MOST_MISSES); k++)
        CALX_TRY(place(packer, packer->order[k]));
    double wanted = solid_of(packer), shrink = 0;
    if (!packer->loose && packer->misses > 0)
        CALX_TRY(calx_pack_relax(set, &shrink, packer->error));
    size_t kept = keep_apart(packer);
    if (kept == set->count || (packer->loose && kept > 0))
        return CALX_OK;
    return report(packer, wanted, shrink, kept);
}

/* Hands the placed bodies over in the order of drawing. */
static int hand_over(const struct packer *packer, struct calx_packing *out)
{
    const struct calx_pack_set *set = &packer->set;
    double solid = 0;
    out->position = malloc((set->count + 1) * sizeof *out->position);
    out->radius = malloc((set->count + 1) * sizeof *out->radius);
    if (!out->position || !out->radius)
        return CALX_ERROR_MEMORY;
    for (size_t i = 0; i < set->count; i++) {
        if (!packer->done[i])
            continue;
        memcpy(out->position[out->count], set->position[i], sizeof *out->position);
        out->radius[out->count++] = set->radius[i];
        solid += calx_pack_sizes_solid(set->region->dimension, set->radius[i]);
    }
    out->fraction = solid / packer->volume;
    return CALX_OK;
}

static int check_arguments(struct packer *packer, const struct calx_sizes *sizes, size_t count,
                           double fill, const struct calx_bodies_at *avoid)
{
    const char *mistake = calx_pack_sizes_mistake(sizes);
    if (count > 0 && fill != 0)
        mistake = "give a count or a solid fraction, not both";
    else if (!(fill >= 0 && fill < 1))
        mistake = "the solid fraction must be between 0 and 1";
    else if (sizes->kind == CALX_SIZES_LIST && (fill != 0 || (count != 0 && count != sizes->count)))
        mistake = "a list of radii is its own count";
    for (size_t i = 0; avoid && i < avoid->count; i++) {
        const double *x = avoid->position[i];
        if (!(avoid->radius[i] > 0) || !isfinite(avoid->radius[i] + x[0] + x[1] + x[2]))
            mistake = "a body that is there has no finite position and positive radius";
    }
    return mistake
               ? calx_error_set(packer->error, CALX_ERROR_INPUT, "particles to pack: %s", mistake)
               : CALX_OK;
}

static int pack(struct packer *packer, const struct calx_sizes *sizes, size_t count, double fill,
                const struct calx_bodies_at *avoid, struct calx_packing *out)
{
    const struct calx_region *region = packer->set.region;
    CALX_TRY(check_arguments(packer, sizes, count, fill, avoid));
    CALX_TRY(calx_region_bounds(region, packer->low, packer->high, packer->error));
    packer->volume = calx_region_volume(region);
    if (!(packer->volume > 0))
        return calx_error_set(packer->error, CALX_ERROR_INPUT, "the region to fill has no inside");
    packer->loose = count == 0 && fill == 0 && sizes->kind != CALX_SIZES_LIST;
    double *radius, wanted = packer->loose ? densest : fill;
    size_t drawn;
    CALX_TRY(calx_pack_sizes_draw(sizes, region->dimension, count, wanted * packer->volume,
                                  &packer->random, &radius, &drawn, packer->error));
    if (drawn == 0)
        return calx_error_set(packer->error, CALX_ERROR_INPUT,
                              "particles to pack: not one body makes so small a solid fraction of "
                              "the region (%g m%u)",
                              packer->volume, region->dimension);
    CALX_TRY(fill_set(packer, radius, drawn, avoid));
    double solid = solid_of(packer);
    if (solid > packer->volume)
        return calx_error_set(packer->error, CALX_ERROR_INPUT,
                              "%zu bodies cannot fit: together they are %.2f times the region, of "
                              "which at most about %zu "
                              "fill 0.6; none was placed",
                              drawn, solid / packer->volume,
                              (size_t)(0.6 * packer->volume / solid * (double)drawn));
    CALX_TRY(place_all(packer));
    return hand_over(packer, out) ? no_memory(packer) : CALX_OK;
}

int calx_pack_region(const struct calx_region *region, const struct calx_sizes *sizes, size_t count,
                     double fill, uint64_t seed, const struct calx_bodies_at *avoid,
                     struct calx_packing *out, struct calx_error *error)
{
    struct packer packer = {.set.region = region, .error = error};
    *out = (struct calx_packing){0};
    calx_random_seed(&packer.random, seed);
    int code = pack(&packer, sizes, count, fill, avoid, out);
    calx_pack_grid_free(&packer.set.grid);
    free(packer.set.position);
    free(packer.set.radius);
    free(packer.order);
    free(packer.done);
    if (code)
        calx_packing_free(out);
    return code;
}

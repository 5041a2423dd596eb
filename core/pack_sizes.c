/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Radii of the bodies of a packing. Input: a distribution and how many or how much; output: radii
 * in m in random order. By mass fractions w_i of classes of radius r_i the numbers are n_i ~
 * w_i/v_i with v_i the area or volume of a body (in 2D, of a share f of an area A: n_i = 4 f w_i
 * A/(pi d_i^2)), by number fractions n_i ~ w_i: exact shares rounded by largest remainders, not
 * draws. Truncated distributions draw again what falls outside.
 */
#include <math.h>
#include <stdlib.h>

#include "core/pack_parts.h"

static const double pi = 3.14159265358979323846;
static const size_t most_bodies = 100000000;
static const int most_draws = 100000; /* of one radius, before the truncation is called empty */

double calx_pack_sizes_solid(uint32_t dimension, double radius)
{
    return dimension == 2 ? pi * radius * radius : 4.0 / 3.0 * pi * radius * radius * radius;
}

static bool positive(double x)
{
    return x > 0 && isfinite(x);
}

static const char *list_mistake(const struct calx_sizes *sizes)
{
    if (sizes->count == 0)
        return "no radii are given";
    for (size_t i = 0; i < sizes->count; i++) {
        if (!positive(sizes->list[i]))
            return "radii must be positive";
        if (sizes->kind != CALX_SIZES_LIST && !positive(sizes->weight[i]))
            return sizes->kind == CALX_SIZES_MASSES ? "mass fractions must be positive"
                                                    : "number fractions must be positive";
    }
    return NULL;
}

const char *calx_pack_sizes_mistake(const struct calx_sizes *sizes)
{
    if (sizes->kind >= CALX_SIZES_MASSES)
        return list_mistake(sizes);
    if (!positive(sizes->a))
        return "the radius must be positive";
    if (sizes->kind == CALX_SIZES_FIXED)
        return NULL;
    if (sizes->kind == CALX_SIZES_UNIFORM)
        return positive(sizes->b) && sizes->b >= sizes->a ? NULL
                                                          : "the largest radius is below the least";
    if (!positive(sizes->b))
        return "the standard deviation of the radius must be positive";
    if (!(sizes->min >= 0) || isnan(sizes->max) || (sizes->max != 0 && !(sizes->max > sizes->min)))
        return "the bounds of the radius must be 0 <= min < max";
    return NULL;
}

/* ---- one radius at a time ---- */

static double draw_fixed(const struct calx_sizes *sizes, struct calx_random *random)
{
    (void)random;
    return sizes->a;
}

static double draw_uniform(const struct calx_sizes *sizes, struct calx_random *random)
{
    return sizes->a + (sizes->b - sizes->a) * calx_random_uniform(random);
}

static double draw_normal(const struct calx_sizes *sizes, struct calx_random *random)
{
    return sizes->a + sizes->b * calx_random_normal(random);
}

static double draw_lognormal(const struct calx_sizes *sizes, struct calx_random *random)
{
    return calx_random_lognormal(random, sizes->a, sizes->b);
}

static double (*const draw_kind[])(const struct calx_sizes *, struct calx_random *) = {
    [CALX_SIZES_FIXED] = draw_fixed,
    [CALX_SIZES_UNIFORM] = draw_uniform,
    [CALX_SIZES_NORMAL] = draw_normal,
    [CALX_SIZES_LOGNORMAL] = draw_lognormal,
};

/* A radius within the bounds, or 0 if none comes. */
static double draw_within(const struct calx_sizes *sizes, struct calx_random *random)
{
    double low = 0, high = INFINITY;
    if (sizes->kind == CALX_SIZES_NORMAL || sizes->kind == CALX_SIZES_LOGNORMAL) {
        bool normal = sizes->kind == CALX_SIZES_NORMAL;
        low = sizes->min == 0 && normal ? sizes->a - 3 * sizes->b : sizes->min;
        high = sizes->max > 0 ? sizes->max : normal ? sizes->a + 3 * sizes->b : INFINITY;
    }
    for (int i = 0; i < most_draws; i++) {
        double r = draw_kind[sizes->kind](sizes, random);
        if (r > 0 && r >= low && r <= high)
            return r;
    }
    return 0;
}

/* ---- all of them ---- */

struct radii {
    double *list;
    size_t count, room;
};

static int append(struct radii *radii, double r, struct calx_error *error)
{
    if (radii->count >= most_bodies)
        return calx_error_set(error, CALX_ERROR_INPUT, "more than %zu bodies to place",
                              most_bodies);
    if (radii->count == radii->room) {
        size_t room = radii->room ? 2 * radii->room : 1024;
        double *more = realloc(radii->list, room * sizeof *more);
        if (!more)
            return calx_error_set(error, CALX_ERROR_MEMORY, "no memory for the radii of %zu bodies",
                                  room);
        radii->list = more;
        radii->room = room;
    }
    radii->list[radii->count++] = r;
    return CALX_OK;
}

static int draw_each(const struct calx_sizes *sizes, uint32_t dimension, size_t count, double solid,
                     struct calx_random *random, struct radii *radii, struct calx_error *error)
{
    double sum = 0;
    while (count > 0 ? radii->count < count : sum < solid) {
        double r = draw_within(sizes, random);
        if (r == 0)
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "the bounds of the radius leave nothing of its distribution");
        double own = calx_pack_sizes_solid(dimension, r);
        if (count == 0 && sum + own / 2 > solid) /* without this one it is nearer */
            return CALX_OK;
        sum += own;
        CALX_TRY(append(radii, r, error));
    }
    return CALX_OK;
}

/* In proportion to the number of bodies of class i. */
static double number_of(const struct calx_sizes *sizes, uint32_t dimension, size_t i)
{
    double own = calx_pack_sizes_solid(dimension, sizes->list[i]);
    return sizes->kind == CALX_SIZES_MASSES ? sizes->weight[i] / own : sizes->weight[i];
}

/* Of class i its share of `total` numbers, cumulated: rounding the sums makes the parts add up to
 * the whole. */
static int draw_shares(const struct calx_sizes *sizes, uint32_t dimension, size_t count,
                       double solid, struct radii *radii, struct calx_error *error)
{
    double numbers = 0, solids = 0, upto = 0;
    for (size_t i = 0; i < sizes->count; i++) {
        double number = number_of(sizes, dimension, i);
        solids += number * calx_pack_sizes_solid(dimension, sizes->list[i]);
        numbers += number;
    }
    double total = count > 0 ? (double)count : solid * numbers / solids;
    if (!(total <= (double)most_bodies))
        return calx_error_set(error, CALX_ERROR_INPUT, "more than %zu bodies to place",
                              most_bodies);
    for (size_t i = 0; i < sizes->count; i++) {
        upto += number_of(sizes, dimension, i) / numbers * total;
        while ((double)radii->count < nearbyint(upto))
            CALX_TRY(append(radii, sizes->list[i], error));
    }
    return CALX_OK;
}

static int draw_list(const struct calx_sizes *sizes, struct radii *radii, struct calx_error *error)
{
    for (size_t i = 0; i < sizes->count; i++)
        CALX_TRY(append(radii, sizes->list[i], error));
    return CALX_OK;
}

static void shuffle(struct radii *radii, struct calx_random *random)
{
    for (size_t i = radii->count; i > 1; i--) {
        size_t j = (size_t)calx_random_below(random, i);
        double r = radii->list[i - 1];
        radii->list[i - 1] = radii->list[j];
        radii->list[j] = r;
    }
}

int calx_pack_sizes_draw(const struct calx_sizes *sizes, uint32_t dimension, size_t count,
                         double solid, struct calx_random *random, double **radius, size_t *drawn,
                         struct calx_error *error)
{
    struct radii radii = {0};
    int code;
    if (sizes->kind == CALX_SIZES_LIST) {
        code = draw_list(sizes, &radii, error);
    } else if (sizes->kind == CALX_SIZES_MASSES || sizes->kind == CALX_SIZES_NUMBERS) {
        code = draw_shares(sizes, dimension, count, solid, &radii, error);
        shuffle(&radii, random);
    } else {
        code = draw_each(sizes, dimension, count, solid, random, &radii, error);
    }
    if (code)
        free(radii.list);
    *radius = code ? NULL : radii.list;
    *drawn = code ? 0 : radii.count;
    return code;
}

double calx_pack_largest(const struct calx_sizes *sizes)
{
    double largest = 0;
    if (sizes->kind == CALX_SIZES_FIXED)
        return sizes->a;
    if (sizes->kind == CALX_SIZES_UNIFORM)
        return sizes->b;
    if (sizes->kind < CALX_SIZES_MASSES && sizes->max > 0)
        return sizes->max;
    if (sizes->kind < CALX_SIZES_MASSES)
        return sizes->kind == CALX_SIZES_NORMAL ? sizes->a + 3 * sizes->b : INFINITY;
    for (size_t i = 0; i < sizes->count; i++)
        largest = fmax(largest, sizes->list[i]);
    return largest;
}

int calx_pack_radii(const struct calx_sizes *sizes, uint32_t dimension, size_t count, double solid,
                    uint64_t seed, double **radius, size_t *drawn, struct calx_error *error)
{
    struct calx_random random;
    const char *mistake = calx_pack_sizes_mistake(sizes);
    *radius = NULL;
    *drawn = 0;
    if (mistake)
        return calx_error_set(error, CALX_ERROR_INPUT, "%s", mistake);
    calx_random_seed(&random, seed);
    return calx_pack_sizes_draw(sizes, dimension, count, solid, &random, radius, drawn, error);
}

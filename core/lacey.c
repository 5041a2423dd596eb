/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The mixing index of Lacey (1954), M = (s0^2 - s^2)/(s0^2 - sr^2): 0 for grains apart, 1 on
 * average at random; bodies of rigid groups are no grains. Input: a frame and a class, 0 or 1, for each grain. Output: the index. Method:
 * cubic cells (squares in 2D) fixed in space, whatever the walls do. s^2 is the variance of the
 * share of class 1 over the occupied cells, each weighted by its grains, so that a cell at the rim
 * with two grains counts little. With C cells and N grains, grains shuffled at random have exactly
 * the mean sr^2 = p(1-p)(C-1)/(N-1).
 */
#include "core/lacey.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/measure.h"

/* ---- the index ---- */

struct grain_cell {
    int64_t at[3];
    double ones; /* 1 if the grain is of class 1 */
};

static int order_cells(const void *a, const void *b)
{
    const struct grain_cell *p = a, *q = b;
    for (int k = 0; k < 3; ++k)
        if (p->at[k] != q->at[k])
            return p->at[k] < q->at[k] ? -1 : 1;
    return 0;
}

/* The edge of a cell that holds 8 grains of mean radius at a packing of 0.8 (discs) or 0.6
 * (spheres). */
static double automatic_cell(const struct calx_frame *f)
{
    const double grains = 8, area = 0.8, volume = 0.6;
    double sum = 0, n = 0;
    for (size_t i = 0; i < f->n; ++i)
        if (calx_frame_is_grain(f, i)) {
            sum += f->radius[i];
            n += 1;
        }
    double r = sum / n;
    return f->dimension == 2 ? r * sqrt(grains * M_PI / area)
                             : r * cbrt(grains * 4.0 / 3.0 * M_PI / volume);
}

static struct grain_cell *sort_into_cells(const struct calx_frame *f, const uint8_t *classes,
                                          double cell, size_t *count)
{
    struct grain_cell *grains = calloc(f->n, sizeof *grains);
    *count = 0;
    for (size_t i = 0; grains && i < f->n; ++i) {
        if (!calx_frame_is_grain(f, i))
            continue;
        struct grain_cell *to = &grains[(*count)++];
        for (uint32_t k = 0; k < f->dimension; ++k)
            to->at[k] = (int64_t)floor(f->position[i][k] / cell);
        to->ones = classes[i];
    }
    if (grains)
        qsort(grains, *count, sizeof *grains, order_cells);
    return grains;
}

double calx_lacey_index(const struct calx_frame *f, const uint8_t *classes, double cell)
{
    double ones = 0, cells = 0, squares = 0;
    size_t count = 0;
    struct grain_cell *grains =
        f->n > 1 ? sort_into_cells(f, classes, cell > 0 ? cell : automatic_cell(f), &count) : NULL;
    if (count < 2) {
        free(grains);
        return NAN;
    }
    for (size_t i = 0; i < count; ++i)
        ones += grains[i].ones;
    double n = (double)count, p = ones / n;
    for (size_t i = 0, end; i < count; i = end) {
        double inside = 0;
        for (end = i; end < count && order_cells(&grains[i], &grains[end]) == 0; ++end)
            inside += grains[end].ones;
        double size = (double)(end - i), difference = inside / size - p;
        squares += size * difference * difference;
        cells += 1;
    }
    free(grains);
    double apart = p * (1 - p), random = apart * (cells - 1) / (n - 1);
    return apart > random ? (apart - squares / n) / (apart - random) : NAN;
}

/* ---- classes ---- */

static double start_height(const struct calx_frame *f, size_t i, const double up[3])
{
    return f->position[i][0] * up[0] + f->position[i][1] * up[1] + f->position[i][2] * up[2];
}

static double start_x(const struct calx_frame *f, size_t i, const double up[3])
{
    (void)up;
    return f->position[i][0];
}

static double start_radius(const struct calx_frame *f, size_t i, const double up[3])
{
    (void)up;
    return f->radius[i];
}

static double start_temperature(const struct calx_frame *f, size_t i, const double up[3])
{
    (void)up;
    return f->temperature ? f->temperature[i] : 0;
}

static double material(const struct calx_frame *f, size_t i, const double up[3])
{
    (void)up;
    return f->material ? f->material[i] : 0;
}

static const struct {
    const char *name;
    double (*key)(const struct calx_frame *, size_t i, const double up[3]);
    bool highest; /* class 1 is the highest value alone, not all above the median */
} kinds[] = {
    {"start-height", start_height, false},
    {"start-x", start_x, false},
    {"material", material, true},
    {"start-radius", start_radius, false},
    {"start-temperature", start_temperature, false},
};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

static size_t find_kind(const char *name)
{
    size_t kind = 0;
    while (kind < KINDS && strcmp(kinds[kind].name, name) != 0)
        ++kind;
    return kind;
}

bool calx_measure_is_class(const char *name)
{
    return find_kind(name) < KINDS;
}

const char *calx_measure_classes(void)
{
    return "start-height, start-x, material, start-radius, start-temperature";
}

static int order_doubles(const void *a, const void *b)
{
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

void calx_lacey_classes(const struct calx_frame *f, const char *name, const double up[3],
                        uint8_t *classes)
{
    size_t kind = find_kind(name), n = f->n;
    memset(classes, 0, n);
    double *sorted = kind < KINDS && n > 0 ? malloc(n * sizeof *sorted) : NULL;
    if (!sorted)
        return;
    size_t count = 0;
    for (size_t i = 0; i < n; ++i)
        if (calx_frame_is_grain(f, i))
            sorted[count++] = kinds[kind].key(f, i, up);
    qsort(sorted, count, sizeof *sorted, order_doubles);
    double bound = !count ? 0 : kinds[kind].highest ? sorted[count - 1] : sorted[count / 2];
    for (size_t i = 0; i < n; ++i)
        classes[i] = calx_frame_is_grain(f, i) && kinds[kind].key(f, i, up) >= bound &&
                     sorted[0] < bound;
    free(sorted);
}

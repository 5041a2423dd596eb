/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One step of heat conduction in a slab: rho c dT/dt = k (d2T/ds2 + d2T/dz2) by finite volumes, s along the face and z into the depth. The face
 * takes the heat it is given; the ends are insulated or meet, the far face is insulated or has a temperature.
 * Method: theta scheme split by axis (Douglas, Numer. Math. 4 (1962) 41), with S and Z the two conductions:
 *   (1 - theta dt S) Y = T + dt ((1 - theta) S + Z) T + q,   (1 - theta dt Z) T' = Y - theta dt Z T,
 * stable for any dt if theta >= 1/2, of second order in time if theta = 1/2. Tridiagonal systems, solved directly. What S and Z move between
 * cells adds up to nothing, so heat is conserved to rounding.
 */
#include "core/slab.h"

#include <string.h>

/* Of a tridiagonal matrix with `off` beside the diagonal: factors of the elimination, and, if its ends meet, the correction for that. */
struct line {
    size_t n;
    double off;
    bool meets;
    double *upper, *pivot; /* after elimination: -upper above a unit diagonal; 1/pivot */
    double *corner;        /* solution for the corners' column, if the ends meet */
    double gamma;
};

size_t calx_slab_scratch(const struct calx_slab *b)
{
    size_t longest = b->along > b->deep ? b->along : b->deep;
    return b->along * b->deep + 4 * longest;
}

static void solve_open(const struct line *l, double *x, size_t stride)
{
    x[0] *= l->pivot[0];
    for (size_t i = 1; i < l->n; i++)
        x[stride * i] = (x[stride * i] - l->off * x[stride * (i - 1)]) * l->pivot[i];
    for (size_t i = l->n - 1; i-- > 0;)
        x[stride * i] -= l->upper[i] * x[stride * (i + 1)];
}

/* diagonal: of the matrix; ends that meet are taken out by the Sherman-Morrison formula. */
static void factor(struct line *l, double *diagonal)
{
    if (l->meets) {
        l->gamma = -diagonal[0];
        diagonal[0] -= l->gamma;
        diagonal[l->n - 1] -= l->off * l->off / l->gamma;
    }
    for (size_t i = 0; i < l->n; i++) {
        double left = i ? l->off * l->upper[i - 1] : 0.0;
        l->pivot[i] = 1.0 / (diagonal[i] - left);
        l->upper[i] = l->off * l->pivot[i];
    }
    if (!l->meets)
        return;
    memset(l->corner, 0, l->n * sizeof *l->corner);
    l->corner[0] = l->gamma;
    l->corner[l->n - 1] = l->off;
    solve_open(l, l->corner, 1);
}

static void solve(const struct line *l, double *x, size_t stride)
{
    solve_open(l, x, stride);
    if (!l->meets)
        return;
    double ratio = l->off / l->gamma, *c = l->corner;
    double times = (x[0] + ratio * x[stride * (l->n - 1)]) / (1.0 + c[0] + ratio * c[l->n - 1]);
    for (size_t i = 0; i < l->n; i++)
        x[stride * i] -= times * c[i];
}

/* The matrix 1 - r D of a line of n cells, D the second difference; far: the last cell also meets a face of given temperature half a cell away. */
static void prepare(struct line *l, double r, bool far, double *diagonal)
{
    l->off = -r;
    for (size_t i = 0; i < l->n; i++) {
        bool first = i == 0, last = i + 1 == l->n;
        diagonal[i] = 1.0 + (first && !l->meets ? 0.0 : r) + (last ? far ? 2.0 * r : l->meets ? r : 0.0 : r);
    }
    if (l->n == 1)
        diagonal[0] = 1.0 + (far ? 2.0 * r : 0.0);
    factor(l, diagonal);
}

/* Cells of a line before and after cell i; itself where nothing flows. */
static size_t before(const struct calx_slab *b, size_t i)
{
    return i ? i - 1 : b->periodic ? b->along - 1 : 0;
}

static size_t after(const struct calx_slab *b, size_t i)
{
    return i + 1 < b->along ? i + 1 : b->periodic ? 0 : i;
}

/* dt Z T of a cell over r: what the second difference into the depth is. */
static double difference_deep(const struct calx_slab *b, const double *t, size_t i, size_t k)
{
    double here = t[i + b->along * k], up = k ? t[i + b->along * (k - 1)] - here : 0.0;
    double down = k + 1 < b->deep ? t[i + b->along * (k + 1)] - here : b->far_isothermal ? 2.0 * (b->far - here) : 0.0;
    return up + down;
}

/* The right side of the first half, into y. */
static void explicit_part(const struct calx_slab *b, const struct calx_slab_step *step, double rs, double rz, double *y)
{
    const double *t = step->temperature;
    double capacity = calx_slab_capacity(b);
    for (size_t k = 0; k < b->deep; k++)
        for (size_t i = 0; i < b->along; i++) {
            const double *row = t + b->along * k;
            double across = (row[before(b, i)] - row[i]) + (row[after(b, i)] - row[i]);
            y[i + b->along * k] = row[i] + (1.0 - b->theta) * rs * across + rz * difference_deep(b, t, i, k);
        }
    for (size_t i = 0; i < b->along; i++)
        y[i] += step->heat[i] / capacity;
}

/* The right side of the second half, in place of y. */
static void take_deep(const struct calx_slab *b, const double *t, double r, double *y)
{
    for (size_t k = 0; k < b->deep; k++)
        for (size_t i = 0; i < b->along; i++) {
            double z = difference_deep(b, t, i, k);
            bool last = b->far_isothermal && k + 1 == b->deep; /* what the far face gives stands on this side of both */
            y[i + b->along * k] -= r * (last ? z - 2.0 * b->far : z);
        }
}

void calx_slab_advance(const struct calx_slab *b, struct calx_slab_step *step)
{
    size_t cells = b->along * b->deep, longest = b->along > b->deep ? b->along : b->deep;
    double *y = step->scratch, *rest = y + cells, *diagonal = rest + 3 * longest, *t = step->temperature, far_cells = 0.0;
    double ds = b->length / (double)b->along, dz = b->depth / (double)b->deep, d = b->conductivity / b->capacity * step->dt;
    double rs = d / (ds * ds), rz = d / (dz * dz);
    struct line s = {.n = b->along, .meets = b->periodic && b->along > 2, .upper = rest, .pivot = rest + longest,
                     .corner = rest + 2 * longest};
    struct line z = {.n = b->deep, .upper = s.upper, .pivot = s.pivot};
    explicit_part(b, step, rs, rz, y);
    prepare(&s, b->theta * rs, false, diagonal);
    for (size_t k = 0; k < b->deep && b->along > 1; k++)
        solve(&s, y + b->along * k, 1);
    take_deep(b, t, b->theta * rz, y);
    prepare(&z, b->theta * rz, b->far_isothermal, diagonal);
    for (size_t i = 0; i < b->along; i++)
        solve(&z, y + i, b->along);
    for (size_t i = 0; i < b->along && b->far_isothermal; i++) {
        size_t last = i + b->along * (b->deep - 1);
        far_cells += b->far - (b->theta * y[last] + (1.0 - b->theta) * t[last]);
    }
    step->far_heat = 2.0 * rz * calx_slab_capacity(b) * far_cells;
    memcpy(t, y, cells * sizeof *t);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From rows to the columns of a batch: picks, eight pairs at a time, those that touch (or did at the last evaluation), then
 * turns the rows of their bodies and their history into columns.
 */
#include <math.h>

#include "core/gather.h"
#include "core/vector.h"

/* The eight pairs from `first`, of which `count` exist: appends to the batch those that count. */
static void select_eight(const struct calx_block_view *b, size_t first, unsigned exist, double gap,
                         struct calx_columns *c)
{
    static const calx_v4 sign = {-1.0, -1.0, -1.0, 1.0};
    const int32_t *i = b->s->pairs.i + first, *j = b->s->pairs.j + first;
    calx_v4 row[8];
    calx_v8 d[4];
    for (size_t k = 0; k < 8; k++)
        row[k] = calx_v4_load(b->x + 4 * (size_t)i[k]) + sign * calx_v4_load(b->x + 4 * (size_t)j[k]);
    calx_rows_to_columns(row, d);
    calx_v8 reach = d[3] + gap, distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    unsigned bits = calx_v8_less(distance2, reach * reach);
    bits = (bits | calx_bytes_to_bits(b->s->pairs.touching + first)) & exist;
    if (!bits)
        return;
    for (int k = 0; k < 3; k++)
        calx_v8_pick(c->normal[k] + c->n, d[k], bits);
    calx_v8_pick(c->reach + c->n, d[3], bits);
    for (; bits; bits &= bits - 1) {
        size_t k = (size_t)__builtin_ctz(bits);
        c->source[c->n] = first + k;
        c->row[0][c->n] = i[k];
        c->row[1][c->n++] = j[k];
    }
}

size_t CALX_ISA(calx_gather_select)(const struct calx_block_view *b, size_t first, size_t end, double gap,
                                    struct calx_columns *c)
{
    c->n = 0;
    for (; first < end && c->n <= CALX_BATCH - 8; first += 8)
        select_eight(b, first, end - first < 8 ? (1u << (end - first)) - 1 : 0xffu, gap, c);
    return first;
}

/* Velocities, spins and temperatures of lanes lane..lane+7. */
static void gather_velocities(const struct calx_block_view *b, struct calx_columns *c, size_t lane)
{
    static const calx_v4 sign = {-1.0, -1.0, -1.0, 1.0};
    calx_v4 row[8];
    calx_v8 v[4];
    for (size_t k = 0; k < 8; k++)
        row[k] = calx_v4_load(b->v + b->stride * (size_t)c->row[0][lane + k]) +
                 sign * calx_v4_load(b->v + b->stride * (size_t)c->row[1][lane + k]);
    calx_rows_to_columns(row, v);
    for (int k = 0; k < 3; k++)
        calx_v8_store(c->velocity[k] + lane, v[k]);
    calx_v8_store(c->inverse_mass + lane, v[3]);
    for (int body = 0; body < 2 && b->stride == 8; body++) {
        for (size_t k = 0; k < 8; k++)
            row[k] = calx_v4_load(b->v + 8 * (size_t)c->row[body][lane + k] + 4);
        calx_rows_to_columns(row, v);
        for (int k = 0; k < 3; k++)
            calx_v8_store(c->omega[body][k] + lane, v[k]);
        calx_v8_store(c->temperature[body] + lane, v[3]);
    }
}

/* Where the next row of four starts: the last one may overlap the one before. */
static size_t next_row(size_t first, size_t stride)
{
    return first + 8 <= stride || first + 4 >= stride ? first + 4 : stride - 4;
}

static void gather_history(const struct calx_sim *s, struct calx_columns *c, size_t lane)
{
    size_t stride = s->plan->history_stride;
    const double *from = s->pairs.history;
    calx_v4 row[8];
    calx_v8 h[4];
    for (size_t k = 0; k < 8 && stride == 1; k++)
        c->history[0][lane + k] = from[c->source[lane + k]];
    for (size_t first = 0; first + 4 <= stride; first = next_row(first, stride)) {
        for (size_t k = 0; k < 8; k++)
            row[k] = calx_v4_load_unaligned(from + stride * c->source[lane + k] + first);
        calx_rows_to_columns(row, h);
        for (size_t k = 0; k < 4; k++)
            calx_v8_store(c->history[first + k] + lane, h[k]);
    }
}

/* From the difference of centres (in normal), the sum of radii and the radii (in lever) to overlap, normal, curvatures, levers. `half` is 1/2
 * if the contact point is at the middle of the overlap, 0 if the lever is the radius. */
static void pair_geometry(size_t n, double lag, double half, double (*restrict normal)[CALX_BATCH],
                          const double *restrict reach, double (*restrict lever)[CALX_BATCH],
                          double *restrict overlap, double (*restrict curvature)[CALX_BATCH],
                          double *restrict tilt, double *restrict inverse_mass)
{
    for (size_t c = 0; c < n; c++) {
        double x = normal[0][c], y = normal[1][c], z = normal[2][c];
        double d = sqrt(x * x + y * y + z * z), ri = lever[0][c], rj = lever[1][c];
        double over = d > 0.0 ? 1.0 / d : 0.0, depth = reach[c] - d;
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

/* Lanes after the last repeat the first contact's bodies with overlap 0, so that nothing in them is undefined. */
static void pad(struct calx_columns *c, size_t padded)
{
    for (size_t lane = c->n; lane < padded; lane++) {
        c->source[lane] = c->source[0];
        c->row[0][lane] = c->row[0][0];
        c->row[1][lane] = c->row[1][0];
        c->normal[0][lane] = c->reach[lane] = 1.0;
        c->normal[1][lane] = c->normal[2][lane] = 0.0;
    }
}

void CALX_ISA(calx_gather_batch)(const struct calx_block_view *b, struct calx_columns *c)
{
    const struct calx_plan *plan = b->s->plan;
    size_t padded = calx_padded(c->n);
    bool centred = !plan->models->lever_full;
    double lag = centred ? c->lag : 0.0;
    pad(c, padded);
    for (size_t lane = 0; lane < padded; lane += 8) {
        gather_velocities(b, c, lane);
        gather_history(b->s, c, lane);
    }
    for (int body = 0; body < 2; body++)
        for (size_t lane = 0; lane < padded; lane++)
            c->lever[body][lane] = b->x[4 * (size_t)c->row[body][lane] + 3];
    pair_geometry(padded, lag, centred ? 0.5 : 0.0, c->normal, c->reach, c->lever, c->overlap, c->curvature,
                  c->tilt, c->inverse_mass);
}

/* History of what touches is kept, that of what has parted becomes 0. */
static void forget_parted(size_t n, double gap, const double *restrict overlap, double *restrict h)
{
    for (size_t c = 0; c < n; c++)
        h[c] = overlap[c] > -gap ? h[c] : 0.0;
}

static bool any_parted(size_t n, double gap, const double *overlap)
{
    bool any = false;
    for (size_t c = 0; c < n; c++)
        any |= !(overlap[c] > -gap);
    return any;
}

void CALX_ISA(calx_gather_keep)(struct calx_sim *s, struct calx_columns *c)
{
    size_t columns = s->plan->history, stride = s->plan->history_stride, padded = calx_padded(c->n);
    calx_v4 row[8];
    calx_v8 h[4];
    for (size_t lane = 0; lane < c->n; lane++)
        s->pairs.touching[c->source[lane]] = c->overlap[lane] > -s->plan->gap;
    bool parted = any_parted(c->n, s->plan->gap, c->overlap);
    for (size_t k = 0; k < columns && parted; k++)
        forget_parted(padded, s->plan->gap, c->overlap, c->history[k]);
    for (size_t lane = 0; lane < c->n && stride == 1; lane++)
        s->pairs.history[c->source[lane]] = c->history[0][lane];
    for (size_t first = 0; first + 4 <= stride; first = next_row(first, stride))
        for (size_t lane = 0; lane < padded; lane += 8) {
            for (size_t k = 0; k < 4; k++)
                h[k] = calx_v8_load(c->history[first + k] + lane);
            calx_columns_to_rows(h, row);
            for (size_t k = 0; k < 8 && lane + k < c->n; k++)
                calx_v4_store_unaligned(s->pairs.history + stride * c->source[lane + k] + first, row[k]);
        }
}

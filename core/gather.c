/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From rows to the columns of a batch: eight pairs at a time, the rows of their bodies are subtracted or added and turned into columns, from
 * which follow normal, overlap and velocities; history is turned with the normal where it is stored. Variants, chosen by what the
 * scene has: rows with or without a second half, with or without rotation, bodies of one or of several sizes.
 */
#include "core/gather.h"
#include "core/lanes.h"

#define CALX_INLINE static inline __attribute__((always_inline))

/* What does not change within a batch. */
struct constants {
    double lag, growth; /* s: of the velocities; by which the sum of levers grows per normal velocity until now */
    double half_step;   /* s */
    double gap, diameter;
    bool centred;       /* the contact point is at the middle of the overlap; else the levers are the radii */
};

static struct constants constants_of(const struct calx_block_view *b)
{
    const struct calx_plan *p = b->s->plan;
    bool centred = !p->models->lever_full;
    double lag = p->motion_law && centred ? p->motion_law->velocity_lag * b->dt : 0.0;
    return (struct constants){.lag = lag, .growth = lag, .half_step = 0.5 * b->dt, .gap = p->gap,
                              .diameter = 2.0 * b->s->radius_max, .centred = centred};
}

/* One number of each of eight rows. */
CALX_INLINE calx_v8 pick(const double *rows, size_t stride, const uint32_t *place, size_t lane)
{
    calx_v8 v;
    for (int k = 0; k < 8; k++)
        v[k] = calx_place_row(rows, stride, place[k])[lane];
    return v;
}

CALX_INLINE void store3(calx_column *to, size_t lane, const calx_v8 v[3])
{
    for (int k = 0; k < 3; k++)
        calx_v8_store(to[k] + lane, v[k]);
}

/* Differences of rows of four, from lane `at` of rows `stride` apart, as columns. */
CALX_INLINE void subtract(const double *rows, size_t stride, const uint32_t *i, const uint32_t *j, calx_v8 d[4])
{
    calx_v4 row[8];
    for (int k = 0; k < 8; k++)
        row[k] = calx_v4_load(calx_place_row(rows, stride, i[k])) - calx_v4_load(calx_place_row(rows, stride, j[k]));
    calx_rows_to_columns(row, d);
}

/* Velocity and temperature of i less those of j, and the sums of inverse masses and spins. */
CALX_INLINE void combine(const double *v, const uint32_t *i, const uint32_t *j, calx_v8 c[8])
{
    static const calx_v8 minus = {-0.0, -0.0, -0.0, 0.0, 0.0, 0.0, 0.0, -0.0};
    for (int k = 0; k < 8; k++)
        c[k] = calx_v8_load(calx_place_row(v, 8, i[k])) + calx_v8_flip(calx_v8_load(calx_place_row(v, 8, j[k])), minus);
    calx_transpose8(c);
}

CALX_INLINE void turn_history(const struct calx_plan *p, const calx_v8 n[3], const calx_v8 u[3], calx_v8 un,
                              calx_v8 turn, struct calx_columns *c, size_t lane)
{
    calx_v8 between[3] = {n[0], n[1], n[2]};
    calx_lanes_add(between, -turn, u);
    for (size_t h = 0; h < p->history; h++) {
        if (!p->history_is_vector[h])
            continue;
        calx_v8 v[3];
        for (int k = 0; k < 3; k++)
            v[k] = calx_v8_load(c->history[h + k] + lane);
        calx_lanes_turn(n, between, turn * un, v);
        for (int k = 0; k < 3; k++)
            calx_v8_store(c->history[h + k] + lane, v[k]);
    }
}

/* The bits of touch; those of lanes that do not exist are 0. */
static inline void note_touch(const struct calx_block_view *b, struct calx_columns *c, size_t lane, unsigned now)
{
    uint8_t *bits = b->s->pairs.touching + (b->first + lane) / 8;
    c->was[lane / 8] = *bits;
    c->is[lane / 8] = (uint8_t)now;
    if (!b->look)
        *bits = (uint8_t)now;
}

CALX_INLINE void gather(const struct calx_block_view *b, struct calx_columns *c, const bool wide,
                        const bool rotation, const bool one_size)
{
    const struct calx_plan *p = b->s->plan;
    const struct constants k = constants_of(b);
    const bool tangent = p->needs & CALX_NEEDS_TANGENT, spin = p->needs & CALX_NEEDS_SPIN;
    const bool curved = p->needs & CALX_NEEDS_CURVATURE || b->look;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        const uint32_t *i = b->i + lane, *j = b->j + lane;
        calx_v8 d[4], v[8], e[4], n[3], reach, excess = {0}, ri;
        subtract(b->x, 4, i, j, d);
        if (one_size) {
            reach = (calx_v8){0} + k.diameter;
            ri = 0.5 * reach;
        } else {
            ri = pick(b->x, 4, i, 3);
            excess = d[3];
            reach = 2.0 * ri - excess;
        }
        if (wide)
            combine(b->v, i, j, v);
        else {
            subtract(b->v, 4, i, j, v);
            v[3] = pick(b->v, 4, i, 3) + pick(b->v, 4, j, 3);
        }
        if (rotation && (!one_size || spin))
            subtract(b->v + 4, 8, i, j, e);

        calx_v8 square = calx_lanes_dot(d, d), one = (calx_v8){0} + 1.0;
        calx_v8 distance = calx_v8_sqrt(square);
        calx_v8 inverse = 1.0 / calx_v8_positive(square, distance, one);
        n[0] = calx_v8_positive(square, d[0] * inverse, one); /* coincident centres: any direction will do */
        n[1] = d[1] * inverse;
        n[2] = d[2] * inverse;
        calx_v8 overlap = reach - distance;
        unsigned exist = 0xff;
        if (lane + 8 > c->n) {
            overlap = calx_v8_first(overlap, c->n - lane);
            exist >>= lane + 8 - c->n;
        }
        note_touch(b, c, lane, calx_v8_less((calx_v8){0} - k.gap, overlap) & exist);

        calx_v8 un = calx_lanes_dot(n, v), u2 = {0}, tilt = {0}, vn = un;
        if (k.centred) {
            u2 = calx_lanes_dot(v, v);
            tilt = k.lag * inverse;
            vn = calx_lanes_approach(un, u2, tilt);
        }
        calx_v8_store(c->overlap + lane, overlap);
        store3(c->normal, lane, n);
        calx_v8_store(c->vn + lane, vn);
        calx_v8_store(c->mass + lane, calx_v8_positive(v[3], 1.0 / calx_v8_positive(v[3], v[3], one), (calx_v8){0}));
        if (wide && b->conduct)
            calx_v8_store(c->warmth + lane, v[7]);
        if (curved) {
            calx_v8_store(c->curvature[0] + lane, 1.0 / ri);
            calx_v8_store(c->curvature[1] + lane, 1.0 / (ri - excess));
        }
        if (!tangent)
            continue;
        calx_v8 m[3], w[3] = {{0}}, vt[3], levers = k.centred ? distance : reach;
        if (rotation) {
            calx_v8 half = 0.5 * (levers - k.growth * vn);
            for (int q = 0; q < 3; q++)
                w[q] = half * v[4 + q];
            for (int q = 0; q < 3 && !one_size; q++)
                w[q] += 0.5 * excess * e[q];
            calx_v8_store(c->levers + lane, levers);
            if (!one_size)
                calx_v8_store(c->excess + lane, excess);
            if (spin)
                store3(c->spin, lane, e);
        }
        if (k.centred) {
            calx_lanes_past_normal(n, v, un, u2, tilt, m);
            calx_lanes_slide(m, v, w, vt);
            calx_lanes_lay(n, vt);
        } else {
            calx_lanes_slide(n, v, w, vt);
        }
        store3(c->vt, lane, vt);
        turn_history(p, n, v, un, k.half_step * inverse, c, lane);
    }
}

/* Of both bodies, for laws that ask for them. */
static void gather_temperatures(const struct calx_block_view *b, struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8_store(c->temperature[0] + lane, pick(b->v, 8, b->i + lane, 7));
        calx_v8_store(c->temperature[1] + lane, pick(b->v, 8, b->j + lane, 7));
    }
}

static void gather_narrow(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, false, false, false); }
static void gather_narrow_one(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, false, false, true); }
static void gather_wide(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, true, false, false); }
static void gather_wide_one(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, true, false, true); }
static void gather_spins(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, true, true, false); }
static void gather_spins_one(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, true, true, true); }

/* By: second half of the rows, rotation, one size. */
static void (*const variants[2][2][2])(const struct calx_block_view *, struct calx_columns *) = {
    {{gather_narrow, gather_narrow_one}, {NULL, NULL}},
    {{gather_wide, gather_wide_one}, {gather_spins, gather_spins_one}}};

/* History in place, or a copy of it for whoever only looks. */
static void point_at_history(const struct calx_block_view *b, struct calx_columns *c)
{
    const struct calx_sim *s = b->s;
    for (size_t h = 0; h < s->plan->history; h++) {
        double *stored = s->pairs.history + b->history + h * b->room;
        c->history[h] = b->look ? c->kept[h] : stored;
        if (b->look)
            memcpy(c->kept[h], stored, calx_padded(c->n) * sizeof(double));
    }
}

void CALX_ISA(calx_gather_batch)(const struct calx_block_view *b, struct calx_columns *c)
{
    const struct calx_sim *s = b->s;
    bool wide = s->r.stride == 8, rotation = s->plan->needs & CALX_NEEDS_ROTATION;
    point_at_history(b, c);
    variants[wide][rotation][s->radius_min == s->radius_max](b, c);
    if (s->plan->needs & CALX_NEEDS_TEMPERATURE || (b->sink && s->features.temperature))
        gather_temperatures(b, c);
}

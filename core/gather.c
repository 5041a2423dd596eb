/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From rows to the columns of a batch: eight pairs at a time, the rows of their bodies are subtracted or added and turned into columns, from
 * which follow normal, overlap and velocities; history is turned with the normal where it is stored. Three short passes: in one long one the
 * processor would wait for roots and quotients, because it looks no further ahead than one group of eight. Variants, chosen by what the
 * scene has: rows with or without a second half, with or without rotation, bodies of one or of several sizes.
 */
#include "core/gather.h"
#include "core/lanes.h"

#define CALX_INLINE static inline __attribute__((always_inline))

/* What does not change within a batch. */
struct constants {
    double lag; /* s: of the velocities; the sum of levers grows by lag times the normal velocity until now */
    double gap, diameter;
    bool centred;       /* the contact point is at the middle of the overlap; else the levers are the radii */
};

static struct constants constants_of(const struct calx_block_view *b)
{
    const struct calx_plan *p = b->s->plan;
    bool centred = !p->models->lever_full;
    double lag = centred ? b->s->lag : 0.0;
    return (struct constants){.lag = lag, .gap = p->gap,
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

CALX_INLINE void load3(const calx_column *from, size_t lane, calx_v8 v[3])
{
    for (int k = 0; k < 3; k++)
        v[k] = calx_v8_load(from[k] + lane);
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

/* The bits of touch; those of lanes that do not exist are 0. */
static inline void note_touch(const struct calx_block_view *b, struct calx_columns *c, size_t lane, unsigned now)
{
    uint8_t *bits = b->s->pairs.touching + (b->first + lane) / 8;
    c->was[lane / 8] = *bits;
    c->is[lane / 8] = (uint8_t)now;
    if (!b->look && !b->s->trial)
        *bits = (uint8_t)now;
}

/* Turns the vectors of history with the normal. */
static void turn_history(const struct calx_block_view *b, struct calx_columns *c)
{
    const struct calx_plan *p = b->s->plan;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 n[3], u[3], between[3], turn = 0.5 * b->dt * calx_v8_load(c->inverse + lane);
        load3(c->normal, lane, n);
        load3(c->velocity, lane, u);
        for (int k = 0; k < 3; k++)
            between[k] = n[k];
        calx_lanes_add(between, -turn, u);
        calx_v8 q = turn * calx_lanes_dot(n, u);
        for (size_t h = 0; h < p->history; h++) {
            if (!p->history_is_vector[h])
                continue;
            calx_v8 v[3];
            for (int k = 0; k < 3; k++)
                v[k] = calx_v8_load(c->history[h + k] + lane);
            calx_lanes_turn(n, between, q, v);
            for (int k = 0; k < 3; k++)
                calx_v8_store(c->history[h + k] + lane, v[k]);
        }
    }
}

/* From the rows of places: normal, overlap, distance, levers, and which pairs touch. */
CALX_INLINE void gather_places(const struct calx_block_view *b, struct calx_columns *c, const bool one_size)
{
    const struct constants k = constants_of(b);
    const bool curved = b->s->plan->needs & CALX_NEEDS_CURVATURE || b->look;
    const calx_v8 one = (calx_v8){0} + 1.0;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        const uint32_t *i = b->i + lane, *j = b->j + lane;
        calx_v8 d[4], n[3], ri = 0.5 * k.diameter * one, excess = {0}, reach = k.diameter * one;
        subtract(b->x, 4, i, j, d);
        if (!one_size) {
            ri = pick(b->x, 4, i, 3);
            excess = d[3];
            reach = 2.0 * ri - excess;
            calx_v8_store(c->excess + lane, excess);
        }
        calx_v8 square = calx_lanes_dot(d, d), distance = calx_v8_sqrt(square);
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
        calx_v8_store(c->overlap + lane, overlap);
        store3(c->normal, lane, n);
        calx_v8_store(c->inverse + lane, inverse);
        calx_v8_store(c->levers + lane, k.centred ? distance : reach);
        if (curved) {
            calx_v8_store(c->curvature[0] + lane, 1.0 / ri);
            calx_v8_store(c->curvature[1] + lane, 1.0 / (ri - excess));
        }
    }
}

/* From the rows of velocities and, if the scene has it, spin: relative velocities, effective mass, difference of temperatures. */
CALX_INLINE void gather_speeds(const struct calx_block_view *b, struct calx_columns *c, const bool wide, const bool rotation,
                               const bool one_size)
{
    const struct constants k = constants_of(b);
    const uint32_t needs = b->s->plan->needs;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        const uint32_t *i = b->i + lane, *j = b->j + lane;
        calx_v8 v[8], e[4], n[3], zero = {0}, one = zero + 1.0;
        if (wide)
            combine(b->v, i, j, v);
        else {
            subtract(b->v, 4, i, j, v);
            v[3] = pick(b->v, 4, i, 3) + pick(b->v, 4, j, 3);
        }
        if (rotation && (!one_size || needs & CALX_NEEDS_SPIN))
            subtract(b->v + 4, 8, i, j, e);
        load3(c->normal, lane, n);
        calx_v8 un = calx_lanes_dot(n, v), u2 = zero, tilt = zero, vn = un;
        if (k.centred) {
            u2 = calx_lanes_dot(v, v);
            tilt = k.lag * calx_v8_load(c->inverse + lane);
            vn = calx_lanes_approach(un, u2, tilt);
        }
        calx_v8_store(c->vn + lane, vn);
        calx_v8_store(c->mass + lane, calx_v8_positive(v[3], 1.0 / calx_v8_positive(v[3], v[3], one), zero));
        if (wide && b->conduct)
            calx_v8_store(c->warmth + lane, v[7]);
        if (!(needs & CALX_NEEDS_TANGENT))
            continue;
        calx_v8 m[3] = {n[0], n[1], n[2]}, w[3] = {{0}}, vt[3];
        if (rotation) {
            calx_v8 half = 0.5 * (calx_v8_load(c->levers + lane) - k.lag * vn);
            for (int q = 0; q < 3; q++)
                w[q] = half * v[4 + q];
            if (!one_size)
                calx_lanes_add(w, 0.5 * calx_v8_load(c->excess + lane), e);
            if (needs & CALX_NEEDS_SPIN)
                store3(c->spin, lane, e);
        }
        if (k.centred)
            calx_lanes_past_normal(n, v, un, u2, tilt, m);
        calx_lanes_slide(m, v, w, vt);
        if (k.centred)
            calx_lanes_lay(n, vt);
        store3(c->vt, lane, vt);
        store3(c->velocity, lane, v);
    }
}

CALX_INLINE void gather(const struct calx_block_view *b, struct calx_columns *c, const bool wide, const bool rotation,
                        const bool one_size)
{
    gather_places(b, c, one_size);
    gather_speeds(b, c, wide, rotation, one_size);
    if (b->s->plan->needs & CALX_NEEDS_TANGENT)
        turn_history(b, c);
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

/* History in place, or a copy of it for trials and whoever only looks. */
static void point_at_history(const struct calx_block_view *b, struct calx_columns *c)
{
    const struct calx_sim *s = b->s;
    for (size_t h = 0; h < s->plan->history; h++) {
        double *stored = s->pairs.history + b->history + h * b->room;
        c->history[h] = b->look || s->trial ? c->kept[h] : stored;
        if (b->look || s->trial)
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

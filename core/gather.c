/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From rows to the columns of a batch: eight pairs at a time, the rows of their bodies are subtracted or added and turned into columns, from
 * which follow normal, overlap and velocities; history is turned with the normal where it is stored. Two passes: in one long one the
 * processor would wait for roots and quotients, because it looks no further ahead than one group of eight. Variants, chosen by what the
 * scene has: rows with or without a second half, with or without rotation, in a plane or in space, bodies of one or of several sizes.
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
    calx_v4 half[2];
    for (int k = 0; k < 2; k++, place += 4)
        half[k] = (calx_v4){calx_place_row(rows, stride, place[0])[lane], calx_place_row(rows, stride, place[1])[lane],
                            calx_place_row(rows, stride, place[2])[lane], calx_place_row(rows, stride, place[3])[lane]};
    return calx_v8_join(half[0], half[1]);
}

/* Vectors of a plane: the third column is 0 and stays. */
CALX_INLINE void store(const bool planar, calx_column *to, size_t lane, const calx_v8 v[3])
{
    for (int k = 0; k < (planar ? 2 : 3); k++)
        calx_v8_store(to[k] + lane, v[k]);
}

CALX_INLINE void load(const bool planar, const calx_column *from, size_t lane, calx_v8 v[3])
{
    for (int k = 0; k < (planar ? 2 : 3); k++)
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

/* Turns the vectors of history, whose first columns are `vectors`, with the normal; turn: half the step over the distance. */
CALX_INLINE void turn_history(const bool planar, struct calx_columns *c, size_t lane, const size_t *vectors, size_t count, const calx_v8 n[3],
                              const calx_v8 u[3], calx_v8 un, calx_v8 turn)
{
    calx_v8 between[3] = {n[0], n[1]}, q = turn * un;
    if (!planar)
        between[2] = n[2];
    calx_lanes_add(planar, between, -turn, u);
    for (size_t k = 0; k < count; k++) {
        double *const *column = c->history + vectors[k];
        calx_v8 h[3];
        for (int axis = 0; axis < (planar ? 2 : 3); axis++)
            h[axis] = calx_v8_load(column[axis] + lane);
        calx_lanes_turn(planar, n, between, q, h);
        for (int axis = 0; axis < (planar ? 2 : 3); axis++)
            calx_v8_store(column[axis] + lane, h[axis]);
    }
}

static size_t list_vectors(const struct calx_plan *p, size_t vectors[CALX_HISTORY_MAX])
{
    size_t count = 0;
    for (size_t h = 0; h < p->history; h++)
        if (p->history_is_vector[h])
            vectors[count++] = h;
    return count;
}

/* From the rows of places: normal, overlap, distance, levers, and which pairs touch. */
CALX_INLINE void gather_places(const struct calx_block_view *b, struct calx_columns *c, const bool planar, const bool one_size)
{
    const struct constants k = constants_of(b);
    const bool curved = b->s->plan->needs & CALX_NEEDS_CURVATURE || b->look, keep = !b->look && !b->s->trial;
    const calx_v8 one = (calx_v8){0} + 1.0;
    const double *x = b->x;
    const uint32_t *i = b->i, *j = b->j;
    uint8_t *touching = b->s->pairs.touching + b->first / 8; /* bits; those of lanes that do not exist are 0 */
    const size_t count = c->n;
    for (size_t lane = 0; lane < count; lane += 8) {
        calx_v8 d[4], n[3], ri = 0.5 * k.diameter * one, excess = {0}, reach = k.diameter * one;
        subtract(x, 4, i + lane, j + lane, d);
        if (!one_size) {
            ri = pick(x, 4, i + lane, 3);
            excess = d[3];
            reach = 2.0 * ri - excess;
            calx_v8_store(c->excess + lane, excess);
        }
        calx_v8 square = calx_lanes_dot(planar, d, d), distance = calx_v8_sqrt(square);
        calx_v8 inverse = 1.0 / calx_v8_positive(square, distance, one);
        n[0] = calx_v8_positive(square, d[0] * inverse, one); /* coincident centres: any direction will do */
        n[1] = d[1] * inverse;
        if (!planar)
            n[2] = d[2] * inverse;
        calx_v8 overlap = reach - distance;
        unsigned exist = 0xff;
        if (lane + 8 > count) {
            overlap = calx_v8_first(overlap, count - lane);
            exist >>= lane + 8 - count;
        }
        uint8_t touch = (uint8_t)(calx_v8_less((calx_v8){0} - k.gap, overlap) & exist);
        c->was[lane / 8] = touching[lane / 8];
        c->is[lane / 8] = touch;
        if (keep)
            touching[lane / 8] = touch;
        calx_v8_store(c->overlap + lane, overlap);
        store(planar, c->normal, lane, n);
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
                               const bool planar, const bool one_size, const bool spin)
{
    const struct constants k = constants_of(b);
    const bool tangent = b->s->plan->needs & CALX_NEEDS_TANGENT, conduct = b->conduct;
    const double elapsed = b->s->plan->nonsmooth ? 0.0 : b->dt; /* impulses are laid into the plane of the normal */
    const double *rows = b->v;
    const uint32_t *i = b->i, *j = b->j;
    const size_t count = c->n;
    size_t vectors[CALX_HISTORY_MAX], vector_count = list_vectors(b->s->plan, vectors);
    calx_v8 sum = {0}, mass = {0}; /* of inverse masses, and what it stands for: bodies of one mass need one division */
    for (size_t lane = 0; lane < count; lane += 8) {
        calx_v8 v[8], e[4], n[3], zero = {0}, one = zero + 1.0;
        if (wide)
            combine(rows, i + lane, j + lane, v);
        else {
            subtract(rows, 4, i + lane, j + lane, v);
            v[3] = pick(rows, 4, i + lane, 3) + pick(rows, 4, j + lane, 3);
        }
        if (rotation && (!one_size || spin))
            subtract(rows + 4, 8, i + lane, j + lane, e);
        load(planar, c->normal, lane, n);
        calx_v8 un = calx_lanes_dot(planar, n, v), u2 = zero, tilt = zero, vn = un;
        if (k.centred) {
            u2 = calx_lanes_dot(planar, v, v);
            tilt = k.lag * calx_v8_load(c->inverse + lane);
            vn = calx_lanes_approach(un, u2, tilt);
        }
        calx_v8_store(c->vn + lane, vn);
        if (calx_v8_less(v[3], sum) | calx_v8_less(sum, v[3])) {
            sum = v[3];
            mass = calx_v8_positive(sum, 1.0 / calx_v8_positive(sum, sum, one), zero);
        }
        calx_v8_store(c->mass + lane, mass);
        if (wide && conduct)
            calx_v8_store(c->warmth + lane, v[7]);
        if (!tangent)
            continue;
        calx_v8 m[3] = {n[0], n[1]}, w[3] = {{0}}, vt[3];
        if (!planar)
            m[2] = n[2];
        if (rotation) {
            calx_v8 half = 0.5 * (calx_v8_load(c->levers + lane) - k.lag * vn);
            for (int q = planar ? 2 : 0; q < 3; q++)
                w[q] = half * v[4 + q];
            if (!one_size)
                calx_lanes_add(false, w, 0.5 * calx_v8_load(c->excess + lane), e);
            if (spin)
                store(false, c->spin, lane, e);
        }
        if (k.centred)
            calx_lanes_past_normal(planar, n, v, un, u2, tilt, m);
        calx_lanes_slide(planar, m, v, w, vt);
        if (k.centred)
            calx_lanes_lay(planar, n, vt);
        store(planar, c->vt, lane, vt);
        turn_history(planar, c, lane, vectors, vector_count, n, v, un, 0.5 * elapsed * calx_v8_load(c->inverse + lane));
    }
}

CALX_INLINE void gather(const struct calx_block_view *b, struct calx_columns *c, const bool wide, const bool rotation,
                        const bool spin, const bool planar, const bool one_size)
{
    gather_places(b, c, planar, one_size);
    gather_speeds(b, c, wide, rotation, planar, one_size, spin);
}

/* Of both bodies, for laws that ask for them. */
static void gather_temperatures(const struct calx_block_view *b, struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8_store(c->temperature[0] + lane, pick(b->v, 8, b->i + lane, 7));
        calx_v8_store(c->temperature[1] + lane, pick(b->v, 8, b->j + lane, 7));
    }
}

/* Of one kind of rows and laws: in space or in a plane, of several sizes or one. */
#define CALX_VARIANTS(name, ...) \
    static void name(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, __VA_ARGS__, false, false); } \
    static void name##_one(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, __VA_ARGS__, false, true); } \
    static void name##_flat(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, __VA_ARGS__, true, false); } \
    static void name##_flat_one(const struct calx_block_view *b, struct calx_columns *c) { gather(b, c, __VA_ARGS__, true, true); }
CALX_VARIANTS(narrow, false, false, false)
CALX_VARIANTS(wide, true, false, false)
CALX_VARIANTS(turning, true, true, false)
CALX_VARIANTS(spinning, true, true, true)

/* By what the rows and laws have, each with what came before: second half of the rows, rotation, relative spin. */
static void (*const variants[4][2][2])(const struct calx_block_view *, struct calx_columns *) = {
    {{narrow, narrow_one}, {narrow_flat, narrow_flat_one}},
    {{wide, wide_one}, {wide_flat, wide_flat_one}},
    {{turning, turning_one}, {turning_flat, turning_flat_one}},
    {{spinning, spinning_one}, {spinning_flat, spinning_flat_one}}};

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
    const uint32_t needs = s->plan->needs;
    int kind = !(needs & CALX_NEEDS_ROTATION) ? s->r.stride == 8 : needs & CALX_NEEDS_SPIN ? 3 : 2;
    point_at_history(b, c);
    variants[kind][s->scene->dimension == 2][s->radius_min == s->radius_max](b, c);
    if (needs & CALX_NEEDS_TEMPERATURE || (b->sink && s->features.temperature))
        gather_temperatures(b, c);
}

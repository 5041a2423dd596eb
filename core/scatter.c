/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From the columns of a batch back to rows: forces, couples and heat flows of eight pairs at a time are turned into rows and added to both
 * bodies in the order of the list. Newton's third law, the lever arms and the antisymmetric heat flow are applied here and in
 * wall_contacts.c, nowhere else.
 */
#include "core/gather.h"
#include "core/lanes.h"

#define CALX_INLINE static inline __attribute__((always_inline))

/* Of a batch: the heat that flows, and whether the row of body j is that of body i with some signs changed. */
struct flows {
    bool conduct, dissipate;
    double share[2]; /* 1/s: of work, into i and into j */
    bool mirror;
};

static struct flows flows_of(const struct calx_block_view *b)
{
    struct calx_sim *s = b->s;
    size_t materials = s->scene->material_count;
    struct flows f = {.conduct = b->conduct && !s->plan->global_heat,
                      .dissipate = s->features.temperature && s->scene->from_dissipation > 0.0 && b->dt > 0.0 && !s->trial};
    if (f.dissipate) {
        CALX_ISA(calx_heat_shares)(s, b->type / materials, b->type % materials, f.share);
        for (int body = 0; body < 2; body++)
            f.share[body] /= b->interval;
    }
    f.mirror = s->radius_min == s->radius_max && !(s->plan->needs & CALX_NEEDS_SPIN) && !f.dissipate;
    return f;
}

CALX_INLINE void load(const bool planar, const calx_column *from, size_t lane, calx_v8 v[3])
{
    for (int k = 0; k < (planar ? 2 : 3); k++)
        v[k] = calx_v8_load(from[k] + lane);
}

/* Force on i, and n x ft if there are tangential forces. */
CALX_INLINE void forces(const struct calx_columns *c, size_t lane, const bool planar, bool tangent, calx_v8 force[3], calx_v8 twist[3])
{
    calx_v8 n[3], ft[3] = {{0}}, fn = calx_v8_load(c->fn + lane);
    load(planar, c->normal, lane, n);
    if (tangent)
        load(planar, c->ft, lane, ft);
    calx_lanes_force(planar, n, fn, ft, force);
    calx_lanes_twist(planar, n, ft, twist);
}

/* Heat into body 0 or 1. */
CALX_INLINE calx_v8 heat_into(const struct calx_columns *c, size_t lane, const struct flows *f, int body)
{
    calx_v8 q = {0};
    if (f->conduct) {
        q = calx_v8_load(c->conductance + lane) * calx_v8_load(c->warmth + lane);
        q = body ? q : -q;
    }
    if (f->dissipate)
        q += f->share[body] * calx_v8_load(c->work + lane);
    return q;
}

/* Rows of four: forces alone. */
static void scatter_narrow(const struct calx_block_view *b, const struct calx_columns *c)
{
    bool tangent = b->s->plan->needs & CALX_NEEDS_TANGENT;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 force[4] = {{0}}, twist[3];
        calx_v4 row[8];
        size_t end = c->n - lane < 8 ? c->n - lane : 8;
        forces(c, lane, false, tangent, force, twist);
        calx_columns_to_rows(force, row);
        for (size_t k = 0; k < end; k++) {
            calx_v4_add((double *)calx_place_row(b->a, 4, b->i[lane + k]), row[k]);
            calx_v4_add((double *)calx_place_row(b->a, 4, b->j[lane + k]), -row[k]);
        }
    }
}

CALX_INLINE void add(double *a, uint32_t place, calx_v8 row)
{
    double *to = (double *)calx_place_row(a, 8, place);
    calx_v8_store(to, calx_v8_load(to) + row);
}

CALX_INLINE void add_rows(double *a, const uint32_t *to, const calx_v8 row[8], size_t count)
{
    for (size_t k = 0; k < count; k++)
        add(a, to[k], row[k]);
}

/* Row k to body i of pair k, and with some signs changed to body j. */
CALX_INLINE void add_mirrored(double *a, const uint32_t *i, const uint32_t *j, const calx_v8 row[8], size_t count)
{
    static const calx_v8 minus = {-0.0, -0.0, -0.0, 0.0, 0.0, 0.0, 0.0, -0.0};
    for (size_t k = 0; k < count; k++) {
        add(a, i[k], row[k]);
        add(a, j[k], calx_v8_flip(row[k], minus));
    }
}

/* Bodies of one size, no couple of their own, heat that goes from one to the other: one set of rows serves both. */
CALX_INLINE void scatter_mirror(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f, const bool planar,
                               const bool tangent, const bool rotation, const bool conduct)
{
    const uint32_t *i = b->i, *j = b->j;
    double *a = b->a;
    const size_t n = c->n;
    for (size_t lane = 0; lane < n; lane += 8) {
        calx_v8 row[8] = {{0}}, twist[3];
        forces(c, lane, planar, tangent, row, twist);
        if (rotation) {
            calx_v8 lever = -0.5 * calx_v8_load(c->levers + lane);
            for (int k = planar ? 2 : 0; k < 3; k++)
                row[4 + k] = lever * twist[k];
        }
        if (conduct)
            row[7] = heat_into(c, lane, f, 0);
        calx_transpose8(row);
        if (n - lane >= 8)
            add_mirrored(a, i + lane, j + lane, row, 8);
        else
            add_mirrored(a, i + lane, j + lane, row, n - lane);
    }
}

static void mirror_spins(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f)
{
    scatter_mirror(b, c, f, false, true, true, false);
}

static void mirror_spins_flat(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f)
{
    scatter_mirror(b, c, f, true, true, true, false);
}

static void mirror_any(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f)
{
    uint32_t needs = b->s->plan->needs;
    scatter_mirror(b, c, f, false, needs & CALX_NEEDS_TANGENT, needs & CALX_NEEDS_ROTATION, f->conduct);
}

CALX_INLINE void scatter_both(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f, const bool planar)
{
    const uint32_t needs = b->s->plan->needs;
    double *a = b->a;
    const size_t n = c->n;
    bool several_sizes = b->s->radius_min < b->s->radius_max;
    for (size_t lane = 0; lane < n; lane += 8) {
        calx_v8 force[3], twist[3], torque[3] = {{0}};
        forces(c, lane, planar, needs & CALX_NEEDS_TANGENT, force, twist);
        if (needs & CALX_NEEDS_SPIN)
            load(false, c->torque, lane, torque);
        for (int body = 0; body < 2; body++) {
            calx_v8 row[8] = {{0}}, sign = (calx_v8){0} + (body ? -1.0 : 1.0);
            for (int k = 0; k < (planar ? 2 : 3); k++)
                row[k] = sign * force[k];
            if (needs & CALX_NEEDS_ROTATION) {
                calx_v8 lever = 0.5 * calx_v8_load(c->levers + lane);
                if (several_sizes)
                    lever += 0.5 * sign * calx_v8_load(c->excess + lane);
                for (int k = planar ? 2 : 0; k < 3; k++)
                    row[4 + k] = sign * torque[k] - lever * twist[k];
            }
            row[7] = heat_into(c, lane, f, body);
            calx_transpose8(row);
            const uint32_t *to = (body ? b->j : b->i) + lane;
            if (n - lane >= 8)
                add_rows(a, to, row, 8);
            else
                add_rows(a, to, row, n - lane);
        }
    }
}

static void both_in_space(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f)
{
    scatter_both(b, c, f, false);
}

static void both_flat(const struct calx_block_view *b, const struct calx_columns *c, const struct flows *f)
{
    scatter_both(b, c, f, true);
}

/* Overlap relative to the smaller radius. */
CALX_INLINE calx_v8 depth_of(const struct calx_block_view *b, const struct calx_columns *c, size_t lane)
{
    calx_v8 overlap = calx_v8_load(c->overlap + lane);
    if (b->s->radius_min == b->s->radius_max)
        return overlap * (1.0 / b->s->radius_min);
    /* reach - |excess| is twice the smaller radius; the levers sum up to reach, or to the distance */
    calx_v8 reach = calx_v8_load(c->levers + lane), excess = calx_v8_load(c->excess + lane);
    reach += b->s->plan->models->lever_full ? (calx_v8){0} : overlap;
    return 2.0 * overlap / (reach - calx_v8_max(excess, -excess));
}

/* Whose overlap is beyond the bound. */
static void note_deepest(const struct calx_block_view *b, const struct calx_columns *c)
{
    struct calx_tally *t = b->tally;
    t->overlap = 0.0;
    for (size_t lane = 0; lane < c->n; lane++) {
        double ri = calx_place_row(b->x, 4, b->i[lane])[3], rj = calx_place_row(b->x, 4, b->j[lane])[3];
        double depth = c->overlap[lane] / (ri < rj ? ri : rj);
        if (!(depth > t->overlap))
            continue;
        t->overlap = depth;
        t->overlap_rows[0] = b->block->first + calx_row_of_place(b->i[lane]);
        t->overlap_rows[1] = b->block->first + calx_row_of_place(b->j[lane]);
    }
}

/* Pairs that touch, of eight. Where laws act at a distance that is an overlap, where they are non-smooth an impulse. */
static int touching(const struct calx_block_view *b, const struct calx_columns *c, size_t lane, calx_v8 overlap)
{
    const struct calx_plan *p = b->s->plan;
    int count = 0;
    if (p->nonsmooth) {
        for (size_t k = lane; k < lane + 8 && k < c->n; k++)
            count += c->fn[k] != 0.0;
        return count;
    }
    return __builtin_popcount(p->gap > 0.0 ? calx_v8_less((calx_v8){0}, overlap) : c->is[lane / 8]);
}

static void tally(const struct calx_block_view *b, struct calx_columns *c)
{
    struct calx_tally *t = b->tally;
    calx_v8 work = {0}, deepest = {0};
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 w = calx_v8_load(c->work + lane), overlap = calx_v8_load(c->overlap + lane), depth = depth_of(b, c, lane);
        work += lane + 8 > c->n ? calx_v8_first(w, c->n - lane) : w;
        deepest = calx_v8_max(deepest, lane + 8 > c->n ? calx_v8_first(depth, c->n - lane) : depth);
        t->contacts += touching(b, c, lane, overlap);
    }
    t->work += calx_v8_sum(work);
    for (int lane = 0; lane < 8; lane++)
        t->overlap = deepest[lane] > t->overlap ? deepest[lane] : t->overlap;
    if (t->overlap > CALX_OVERLAP_BOUND)
        note_deepest(b, c);
}

/* History of pairs that have parted becomes 0. */
static void forget_parted(const struct calx_block_view *b, struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane += 8)
        for (unsigned bits = c->was[lane / 8] & ~c->is[lane / 8] & 0xffu; bits; bits &= bits - 1)
            for (size_t h = 0; h < b->s->plan->history; h++)
                c->history[h][lane + (size_t)__builtin_ctz(bits)] = 0.0;
}

void CALX_ISA(calx_scatter_batch)(const struct calx_block_view *b, struct calx_columns *c)
{
    const uint32_t needs = b->s->plan->needs;
    struct flows f = flows_of(b);
    forget_parted(b, c);
    const bool planar = b->s->scene->dimension == 2;
    if (b->s->r.stride == 4)
        scatter_narrow(b, c);
    else if (!f.mirror)
        (planar ? both_flat : both_in_space)(b, c, &f);
    else if (needs & CALX_NEEDS_ROTATION && !f.conduct)
        (planar ? mirror_spins_flat : mirror_spins)(b, c, &f);
    else
        mirror_any(b, c, &f);
    tally(b, c);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Pair search with one cell grid per size class, so that the cost per pair does not grow with the size ratio: a particle of radius R
 * is in class floor(log2(R_max/R)), the cells of a class are as wide as its largest diameter plus the skin, and a
 * particle looks into the cells around it in the grid of its own class (partners later in order) and of every coarser class (all),
 * at eight candidates at a time.
 * Reference: hierarchical grids, e.g. Ogarko and Luding, Comput. Phys. Commun. 183 (2012) 931.
 */
#include <float.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"
#include "core/pairs.h"
#include "core/vector.h"

enum { CLASSES = 24, PLACE = 4, COLUMNS };

struct grid {
    size_t members;
    double reach; /* largest radius */
    int cells[3];
    bool brief[3]; /* periodic with less than three cells: the nearest image is not that of the cell */
    double low[3], inverse[3];
    int32_t *start;           /* cells + 1 */
    double *member[COLUMNS];  /* of the members by cell: x, y, z, R and place in the order of particles */
};

struct search {
    const struct calx_pairs_input *in;
    uint8_t *class_of;
    int32_t *cell; /* of each particle, in the grid under way */
    int classes;
    struct grid grid[CLASSES];
};

static int size_class(double largest, double radius)
{
    int c = (int)floor(log2(largest / radius));
    return c < 0 ? 0 : c >= CLASSES ? CLASSES - 1 : c;
}

static void classify(struct search *s)
{
    const struct calx_pairs_input *in = s->in;
    double largest = 0.0;
    for (size_t i = 0; i < in->n; i++)
        largest = fmax(largest, in->x[4 * i + 3]);
    for (size_t i = 0; i < in->n; i++) {
        double radius = in->x[4 * i + 3];
        int c = size_class(largest, radius);
        s->class_of[i] = (uint8_t)c;
        s->grid[c].members++;
        s->grid[c].reach = fmax(s->grid[c].reach, radius);
        s->classes = c + 1 > s->classes ? c + 1 : s->classes;
    }
}

/* Cells at least `width` wide, no more of them than about one per particle of the search: then a row of three cells in a thin gas fills no more
 * than one group of eight candidates, as it does in a packing. */
static void shape_grid(const struct search *s, struct grid *g, const double lo[3], const double hi[3])
{
    const struct calx_pairs_input *in = s->in;
    double width = 2.0 * g->reach + in->skin, total;
    do {
        total = 1.0;
        for (int k = 0; k < 3; k++) {
            double length = in->periodic[k] ? in->length[k] : hi[k] - lo[k];
            double cells = fmin(floor(length / width), 1e6);
            g->cells[k] = cells < 1.0 ? 1 : (int)cells;
            g->low[k] = in->periodic[k] ? in->low[k] : lo[k];
            g->inverse[k] = length > 0.0 ? g->cells[k] / length : 0.0;
            g->brief[k] = in->periodic[k] && g->cells[k] < 3;
            total *= g->cells[k];
        }
        width *= 1.26;
    } while (total > 1.0 * (double)g->members + 64.0);
}

static int cell_along(const struct grid *g, int k, double x)
{
    int c = (int)floor((x - g->low[k]) * g->inverse[k]);
    return c < 0 ? 0 : c >= g->cells[k] ? g->cells[k] - 1 : c;
}

static size_t cell_of(const struct grid *g, const double *x)
{
    return ((size_t)cell_along(g, 2, x[2]) * g->cells[1] + cell_along(g, 1, x[1])) * g->cells[0] +
           cell_along(g, 0, x[0]);
}

static int fill_grid(const struct search *s, int c, struct grid *g)
{
    const struct calx_pairs_input *in = s->in;
    size_t cells = (size_t)g->cells[0] * g->cells[1] * g->cells[2];
    bool there = true;
    g->start = calloc(cells + 2, sizeof *g->start);
    for (int k = 0; k < COLUMNS; k++)
        there &= (g->member[k] = calx_memory_to_fill(g->members, sizeof **g->member)) != NULL;
    if (!g->start || !there)
        return 1;
#pragma omp parallel for schedule(static) num_threads(in->threads) if (in->threads > 1)
    for (size_t i = 0; i < in->n; i++)
        s->cell[i] = s->class_of[i] == c ? (int32_t)cell_of(g, in->x + 4 * i) : -1;
    for (size_t i = 0; i < in->n; i++)
        if (s->cell[i] >= 0)
            g->start[s->cell[i] + 2]++;
    for (size_t k = 0; k < cells; k++)
        g->start[k + 2] += g->start[k + 1];
    for (size_t i = 0; i < in->n; i++)
        if (s->cell[i] >= 0)
            g->member[PLACE][g->start[s->cell[i] + 1]++] = (double)i;
#pragma omp parallel for schedule(static) num_threads(in->threads) if (in->threads > 1)
    for (size_t at = 0; at < g->members; at++)
        for (size_t k = 0; k < PLACE; k++)
            g->member[k][at] = in->x[4 * (size_t)g->member[PLACE][at] + k];
    return 0;
}

static int make_grids(struct search *s)
{
    const struct calx_pairs_input *in = s->in;
    double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, hi[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    for (size_t i = 0; i < in->n; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], in->x[4 * i + k]);
            hi[k] = fmax(hi[k], in->x[4 * i + k]);
        }
    for (int c = 0; c < s->classes; c++)
        if (s->grid[c].members) {
            shape_grid(s, &s->grid[c], lo, hi);
            if (fill_grid(s, c, &s->grid[c]))
                return 1;
        }
    return 0;
}

/* Makes room for `more` pairs. */
static int reserve(struct calx_found_list *l, size_t more)
{
    if (l->count + more <= l->capacity)
        return 0;
    size_t capacity = l->capacity ? 2 * l->capacity : 8192;
    struct calx_found *p = realloc(l->list, capacity * sizeof *p);
    if (!p)
        return 1;
    l->list = p;
    l->capacity = capacity;
    return 0;
}

static const int shift_weight[3] = {1, 3, 9};

/* The turns along the axes that are too short for three cells, packed: the nearest image of member m. */
static int short_turns(const struct calx_pairs_input *in, const struct grid *g, const double *a, size_t m)
{
    int packed = 0;
    for (int k = 0; k < 3; k++) {
        double d = a[k] - g->member[k][m];
        if (g->brief[k]) /* both are inside the box: at most one turn apart */
            packed += shift_weight[k] * ((d > 0.5 * in->length[k]) - (d < -0.5 * in->length[k]));
    }
    return packed;
}

/* A particle that looks for partners: itself as seen from the cells looked into, which are `shift` away. */
struct seeker {
    double place, after; /* its own; partners come later in order than the second */
    double at[3], radius;
    int shift;
};

/* Of eight members: squares of distances, sums of radii. */
struct eight {
    calx_v8 square, reach;
};

static inline __attribute__((always_inline)) struct eight eight_at(const struct calx_pairs_input *in, const struct grid *g,
                                                                   const struct seeker *p, size_t first, const bool any_brief)
{
    calx_v8 zero = {0};
    struct eight e = {zero, calx_v8_load_unaligned(g->member[3] + first) + p->radius};
    for (int k = 0; k < 3; k++) {
        calx_v8 d = p->at[k] - calx_v8_load_unaligned(g->member[k] + first);
        if (any_brief && g->brief[k]) {
            calx_v8 half = zero + 0.5 * in->length[k];
            d -= calx_v8_positive(d - half, zero + in->length[k], zero);
            d += calx_v8_positive(-half - d, zero + in->length[k], zero);
        }
        e.square += d * d;
    }
    return e;
}

/* Bit k is set where member k is nearer than the sum of radii and a margin. */
static inline __attribute__((always_inline)) unsigned nearer(const struct eight *e, double margin)
{
    calx_v8 reach = e->reach + margin;
    return calx_v8_less(e->square, reach * reach);
}

static uint8_t opposite(uint8_t shift)
{
    return (uint8_t)(26 - shift);
}

/* Partners among the members first..last of a grid. */
static int match(const struct calx_pairs_input *in, const struct grid *g, const struct seeker *p, int32_t first, int32_t last,
                 struct calx_found_list *out)
{
    const bool any_brief = g->brief[0] || g->brief[1] || g->brief[2];
    for (int32_t m = first; m < last; m += 8) {
        struct eight e = any_brief ? eight_at(in, g, p, (size_t)m, true) : eight_at(in, g, p, (size_t)m, false);
        unsigned bits = nearer(&e, in->skin) & calx_v8_less((calx_v8){0} + p->after, calx_v8_load_unaligned(g->member[PLACE] + m));
        bits &= last - m < 8 ? (1u << (last - m)) - 1 : 0xffu;
        if (!bits)
            continue;
        if (reserve(out, 8))
            return 1;
        unsigned close = nearer(&e, in->near[0]), soon = nearer(&e, in->near[1]);
        for (; bits; bits &= bits - 1) {
            unsigned k = (unsigned)__builtin_ctz(bits);
            int32_t i = (int32_t)p->place, j = (int32_t)g->member[PLACE][m + (int32_t)k];
            uint8_t shift = (uint8_t)(p->shift + (any_brief ? short_turns(in, g, p->at, (size_t)m + k) : 0));
            uint8_t nearness = (uint8_t)(CALX_LATER - (close >> k & 1) - (soon >> k & 1));
            out->list[out->count++] = j < i ? (struct calx_found){j, i, opposite(shift), nearness} : (struct calx_found){i, j, shift, nearness};
        }
    }
    return 0;
}

/* The cells to visit along one axis, each once: that of x and its neighbours, and how many turns away they are. Joined, those next to each other
 * are one run. */
struct visit {
    int count, cell[3], run[3], turns[3];
};

static void visit_axis(const struct calx_pairs_input *in, const struct grid *g, int k, double x, bool joined, struct visit *v)
{
    int c = cell_along(g, k, x), n = g->cells[k], seen = 0;
    if (c > 0 && c < n - 1) {
        *v = joined ? (struct visit){1, {c - 1}, {3}, {0}} : (struct visit){3, {c - 1, c, c + 1}, {1, 1, 1}, {0}};
        return;
    }
    v->count = 0;
    for (int d = -1; d <= 1; d++) {
        int e = c + d, turns = (e >= n) - (e < 0), last = v->count - 1;
        if ((turns && !in->periodic[k]) || seen == n)
            continue;
        e -= turns * n;
        turns = g->brief[k] ? 0 : turns;
        seen++;
        if (joined && last >= 0 && e == v->cell[last] + v->run[last] && turns == v->turns[last]) {
            v->run[last]++;
            continue;
        }
        v->cell[v->count] = e;
        v->run[v->count] = 1;
        v->turns[v->count++] = turns;
    }
}

/* Sees the particle at x from cells whose turns along the axes are tx, ty, tz; from those with none it is seen as it is. */
static void place_seeker(const struct calx_pairs_input *in, const double *x, const int turns[3], struct seeker *p)
{
    if (p->shift == CALX_NO_SHIFT && !(turns[0] | turns[1] | turns[2]))
        return;
    p->shift = CALX_NO_SHIFT;
    for (int k = 0; k < 3; k++) {
        p->at[k] = turns[k] ? x[k] - turns[k] * in->length[k] : x[k];
        p->shift += shift_weight[k] * turns[k];
    }
}

static int search_grid(const struct search *s, const struct grid *g, int32_t i, bool later,
                       struct calx_found_list *out)
{
    const double *a = s->in->x + 4 * (size_t)i;
    struct seeker p = {.place = i, .after = later ? i : -1, .at = {a[0], a[1], a[2]}, .radius = a[3], .shift = CALX_NO_SHIFT};
    struct visit v[3], *vx = &v[0], *vy = &v[1], *vz = &v[2];
    for (int k = 0; k < 3; k++)
        visit_axis(s->in, g, k, a[k], k == 0, &v[k]);
    for (int z = 0; z < vz->count; z++)
        for (int y = 0; y < vy->count; y++) {
            const int32_t *line = g->start + ((size_t)vz->cell[z] * g->cells[1] + vy->cell[y]) * g->cells[0];
            for (int x = 0; x < vx->count; x++) {
                int32_t first = line[vx->cell[x]], last = line[vx->cell[x] + vx->run[x]];
                if (first == last)
                    continue;
                place_seeker(s->in, a, (const int[3]){vx->turns[x], vy->turns[y], vz->turns[z]}, &p);
                if (match(s->in, g, &p, first, last, out))
                    return 1;
            }
        }
    return 0;
}

static int search_block(const struct search *s, size_t block, struct calx_found_list *out)
{
    size_t first = block * s->in->block, last = first + s->in->block;
    for (size_t i = first; i < last && i < s->in->n; i++)
        for (int c = 0; c <= s->class_of[i]; c++)
            if (s->grid[c].members &&
                search_grid(s, &s->grid[c], (int32_t)i, c == s->class_of[i], out))
                return 1;
    return 0;
}

/* Hands pairs found by a later block to the block of their i, in the order of the finding blocks. */
static int redistribute(size_t blocks, size_t block, struct calx_found_list *lists)
{
    for (size_t b = 0; b < blocks; b++) {
        size_t kept = 0;
        for (size_t k = 0; k < lists[b].count; k++) {
            struct calx_found f = lists[b].list[k];
            size_t owner = (size_t)f.i / block;
            if (owner == b)
                lists[b].list[kept++] = f;
            else if (reserve(&lists[owner], 1))
                return 1;
            else
                lists[owner].list[lists[owner].count++] = f;
        }
        lists[b].count = kept;
    }
    return 0;
}

int CALX_ISA(calx_pairs_find)(const struct calx_pairs_input *in, struct calx_found_list *lists)
{
    struct search s = {.in = in, .class_of = malloc(in->n + 1), .cell = malloc((in->n + 1) * sizeof *s.cell)};
    size_t blocks = (in->n + in->block - 1) / in->block;
    int failed = !s.class_of || !s.cell;
    if (!failed) {
        classify(&s);
        failed = make_grids(&s);
    }
    if (!failed) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(in->threads) if (in->threads > 1) reduction(| : failed)
        for (size_t b = 0; b < blocks; b++)
            failed |= search_block(&s, b, &lists[b]);
    }
    if (!failed && s.classes > 1)
        failed = redistribute(blocks, in->block, lists);
    for (int c = 0; c < CLASSES; c++) {
        free(s.grid[c].start);
        for (int k = 0; k < COLUMNS; k++)
            free(s.grid[c].member[k]);
    }
    free(s.class_of);
    free(s.cell);
    return failed;
}

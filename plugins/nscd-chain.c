/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Chains: contacts one behind the other over bodies that have no more than two, as in a column, a string of beads or a bridge of force through
 * rattlers. Through them an impulse moves by one body in a sweep, and a column of N takes of the order of N^2 sweeps. The normal impulses of a
 * chain are found at once instead: its part of W is tridiagonal, w_n on the diagonal and between neighbours that share body b
 * +-(n_k . n_l)/m_b, and is solved by elimination, all other impulses being as they are. Where that would ask for a pull the chain is
 * left to the sweep; as is one between two held ends that has more contacts than bodies (W has no inverse there).
 * With friction or without it is an exact step of descent in the normal impulses; the sweep that follows mends the rest.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plugins/nscd.h"

static const double SINGULAR = 1e-10; /* pivot, of the diagonal */

/* The contacts of each body, as long as there are no more than two. */
struct joints {
    const struct nscd_solver *s;
    int32_t (*at)[2];
    uint8_t *degree; /* 3: three or more */
    uint8_t *used;   /* per contact */
};

static int moves(const struct nscd_solver *s, int32_t row)
{
    return row >= 0 && s->v[8 * (size_t)row + 3] > 0;
}

static void join(struct joints *t, size_t k, int32_t row)
{
    if (row < 0)
        return;
    if (t->degree[row] < 2)
        t->at[row][t->degree[row]] = (int32_t)k;
    if (t->degree[row] < 3)
        t->degree[row]++;
}

static int32_t across(const struct nscd_contact *c, int32_t row)
{
    return c->i == row ? c->j : c->i;
}

static int is_free(const struct nscd_contact *c, int32_t row)
{
    return c->axis[c->i != row] < 0;
}

/* The contact behind body `row` as one comes from contact k; -1 at the end of a chain. */
static int32_t behind(const struct joints *t, size_t k, int32_t row)
{
    if (!moves(t->s, row) || t->degree[row] != 2 || !is_free(&t->s->list[k], row))
        return -1;
    return t->at[row][0] == (int32_t)k ? t->at[row][1] : t->at[row][0];
}

/* What an impulse of b does to the velocity of a through the body that both have. */
static double coupling(const struct nscd_solver *s, const struct nscd_contact *a, const struct nscd_contact *b, int32_t row)
{
    double dot = a->n[0] * b->n[0] + a->n[1] * b->n[1] + a->n[2] * b->n[2];
    return ((a->i == row) == (b->i == row) ? 1 : -1) * s->v[8 * (size_t)row + 3] * dot;
}

/* The chain that contact k is of, from one end to the other. A ring is cut where it closes: that contact stays with the sweep. */
static void collect(struct joints *t, struct nscd_chains *chains, size_t k)
{
    const struct nscd_contact *list = t->s->list;
    size_t first = chains->first[chains->count], n = first, at = k;
    int32_t row = list[k].i, next;
    while ((next = behind(t, at, row)) >= 0 && (size_t)next != k) {
        at = (size_t)next;
        row = across(&list[at], row);
    }
    const int32_t start = row;
    for (next = (int32_t)at; next >= 0 && !t->used[next]; next = behind(t, at, row)) {
        if (n > first)
            chains->coupling[n - 1] = coupling(t->s, &list[at], &list[next], row);
        at = (size_t)next;
        t->used[at] = 1;
        chains->contact[n++] = at;
        row = across(&list[at], row);
    }
    n -= row == start && moves(t->s, row); /* both ends hang on one body */
    if (n - first > 1)
        chains->first[++chains->count] = n;
}

int nscd_chains_find(struct nscd_solver *s)
{
    struct nscd_chains *chains = &s->chains;
    struct joints t = {.s = s, .at = malloc((s->problem->bodies + 1) * sizeof *t.at), .degree = calloc(s->problem->bodies + 1, 1),
                       .used = calloc(s->n + 1, 1)};
    chains->first = calloc(s->n + 2, sizeof *chains->first);
    chains->contact = malloc((s->n + 1) * sizeof *chains->contact);
    chains->coupling = malloc((s->n + 1) * sizeof *chains->coupling);
    chains->change = malloc(2 * (s->n + 1) * sizeof *chains->change);
    int failed = !t.at || !t.degree || !t.used || !chains->first || !chains->contact || !chains->coupling || !chains->change;
    for (size_t k = 0; !failed && k < s->n; k++) {
        join(&t, k, s->list[k].i);
        join(&t, k, s->list[k].j);
    }
    for (size_t k = 0; !failed && k < s->n; k++)
        if (!t.used[k])
            collect(&t, chains, k);
    free(t.at);
    free(t.degree);
    free(t.used);
    return failed;
}

void nscd_chains_free(struct nscd_chains *chains)
{
    free(chains->first);
    free(chains->contact);
    free(chains->coupling);
    free(chains->change);
}

/* The changes x of the normal impulses that bring all contacts of a chain to u_n + bias = 0, by elimination; `pivot` is room for as many.
 * Returns whether there are such. */
static int eliminate(const struct nscd_solver *s, const size_t *contact, const double *coupling, size_t n, double *x, double *pivot)
{
    for (size_t k = 0; k < n; k++) {
        const struct nscd_contact *c = &s->list[contact[k]];
        double ut[3], share = k ? coupling[k - 1] / pivot[k - 1] : 0;
        x[k] = -(nscd_relative(c, s->v, c->wall, ut) + c->bias) - (k ? share * x[k - 1] : 0);
        pivot[k] = c->w[0] - (k ? share * coupling[k - 1] : 0);
        if (!(pivot[k] > SINGULAR * c->w[0]))
            return 0;
    }
    for (size_t k = n; k-- > 0;)
        x[k] = (x[k] - (k + 1 < n ? coupling[k] * x[k + 1] : 0)) / pivot[k];
    return 1;
}

/* Returns the square of the change: 0 where one of the contacts would pull. */
static double apply(struct nscd_solver *s, const size_t *contact, size_t n, const double *x)
{
    static const double none[3];
    double change2 = 0;
    for (size_t k = 0; k < n; k++)
        if (s->list[contact[k]].r[0] + x[k] < 0)
            return 0;
    for (size_t k = 0; k < n; k++) {
        struct nscd_contact *c = &s->list[contact[k]];
        c->r[0] += x[k];
        change2 += x[k] * x[k];
        nscd_push(c, s->v, x[k], none);
    }
    return change2;
}

double nscd_chains_solve(struct nscd_solver *s)
{
    const struct nscd_chains *chains = &s->chains;
    double change2 = 0;
    for (size_t k = 0; k < chains->count; k++) {
        size_t first = chains->first[k], n = chains->first[k + 1] - first;
        double *x = chains->change, *pivot = chains->change + s->n;
        if (eliminate(s, chains->contact + first, chains->coupling + first, n, x, pivot))
            change2 += apply(s, chains->contact + first, n, x);
    }
    return change2;
}

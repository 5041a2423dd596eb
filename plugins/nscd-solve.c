/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact problem of a step: W r - v = -v_free with the conditions of all contacts, W = H^T M^-1 H. Non-smooth Gauss-Seidel sweeps
 * (Jean 1999) give contact after contact the impulse that its own condition asks for, all others being as they are, and its bodies the
 * velocity that follows; where a contact's own block of W is diagonal that impulse is exact. Or the accelerated descent of nscd-apgd.c.
 *
 * The measure of what is left is the natural map of De Saxce (Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical Systems (2008),
 * ch. 13). It must be small against the impulses, and against those that would stop the bodies as they approach freely: under a heavy body
 * on a light one impulses build up so slowly that the first alone would be content while nearly all of them is missing; but where
 * grains are wedged they may creep for ever along stresses that move nobody, and that is no reason to go on.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "plugins/nscd.h"

static const double ROUND_OFF = 1e-13; /* of velocities, as impulses, and of the impulses at the start */
static const double NEAR = 4;          /* a change of so many times the goal is a reason to look */
static const double RISE = 1e-6, CALMER = 0.7, CALMEST = 0.1;
enum { WATCHED = 500 };                /* sweeps */
enum { NSGS, APGD };                   /* solver */
enum { LISTED, BOTTOM_UP, COLOURED };  /* order */

/* ---- one contact ---- */

/* Brings one contact to its condition; returns the square of the change. */
static inline double relax(struct nscd_contact *c, double *v, double omega)
{
    double ut[3], to[4], un = nscd_relative(c, v, c->wall, ut);
    nscd_project(c, c->r, un, ut, omega, to);
    double step = to[0] - c->r[0], change[3] = {to[1] - c->r[1], to[2] - c->r[2], to[3] - c->r[3]};
    double change2 = step * step + nscd_square(change);
    if (!(change2 > 0))
        return 0;
    nscd_push(c, v, step, change);
    for (int k = 0; k < 4; k++)
        c->r[k] = to[k];
    return change2;
}

/* The square of what the natural map leaves: r - P(r - (u + mu |u_t| n)/w_n), P the projection on the cone |r_t| <= mu r_n. */
static double unmet(const struct nscd_contact *c, const double *v)
{
    double ut[3], t[3], un = nscd_relative(c, v, c->wall, ut), mu = c->mu;
    double z = c->r[0] - c->inverse[0] * (un + c->bias + mu * sqrt(nscd_square(ut))), left = 0;
    for (int k = 0; k < 3; k++)
        t[k] = mu > 0 ? c->r[1 + k] - c->inverse[0] * ut[k] : 0;
    double size = sqrt(nscd_square(t)), share = 1;
    if (mu * size <= -z) {
        z = share = 0;
    } else if (size > mu * z) {
        z = (z + mu * size) / (1 + mu * mu);
        share = size > 0 ? mu * z / size : 0;
    }
    for (int k = 0; k < 3; k++)
        left += (c->r[1 + k] - share * t[k]) * (c->r[1 + k] - share * t[k]);
    return left + (c->r[0] - z) * (c->r[0] - z);
}

/* ---- the problem ---- */

/* Newton's restitution acts between bodies that touch: where there is one a gap may close, and bodies overlap by less than they approach in a
 * step. Without it the gap is 0 where it is looked for next, h later. Returns whether an impulse may act. */
static int set_bias(struct nscd_contact *c, const struct calx_problem *q, size_t k)
{
    double ut[3], wall[3];
    int touch = !(q->gap[k] > 0), bounces = q->restitution[k] > 0;
    for (int d = 0; d < 3; d++)
        wall[d] = q->wall_before[d][k];
    c->bias = !touch ? q->gap[k] / q->dt : bounces ? q->restitution[k] * nscd_relative(c, q->before, wall, ut) : 0;
    return c->inverse[0] > 0 && (touch || !bounces);
}

/* Adds what a body gives to the diagonal. One that is free along an axis with the components n and t of the contact gives n^2, n t, t^2 times
 * 1/m: a diagonal of n^2 + |n t| and t^2 + |n t| is nowhere less. */
static void weigh_body(struct nscd_contact *c, const double *v, int b)
{
    double turning = v[7] * c->lever[b] * c->lever[b];
    if (c->axis[b] < 0) {
        c->w[0] += v[3];
        c->w[1] += v[3] + turning;
        return;
    }
    double n = fabs(c->n[c->axis[b]]), t = c->mu > 0 ? sqrt(fmax(0, 1 - n * n)) : 0;
    c->w[0] += v[3] * n * (n + t);
    c->w[1] += v[3] * t * (n + t) + turning;
}

static void weigh(struct nscd_contact *c, const double *v)
{
    weigh_body(c, v + 8 * (size_t)c->i, 0);
    if (c->j >= 0)
        weigh_body(c, v + 8 * (size_t)c->j, 1);
    for (int k = 0; k < 2; k++)
        c->inverse[k] = c->w[k] > 0 ? 1 / c->w[k] : 0;
}

static int8_t axis_of(const struct calx_problem *q, int32_t row)
{
    size_t particles = q->bodies - q->walls;
    return row < 0 || (size_t)row < particles ? -1 : q->axis[(size_t)row - particles];
}

/* Of the contact point, against gravity, from a body that has a place. */
static double height(const struct nscd_contact *c, const struct calx_problem *q)
{
    int b = c->axis[0] < 0 ? 0 : 1;
    int32_t row = b ? c->j : c->i;
    double sum = 0;
    for (size_t d = 0; d < 3 && row >= 0 && c->axis[b] < 0; d++)
        sum -= q->gravity[d] * (q->position[4 * (size_t)row + d] + (b ? 1 : -1) * c->lever[b] * c->n[d]);
    return sum;
}

/* Contact k of the problem; returns whether an impulse may act. */
static int fill(struct nscd_contact *c, const struct nscd *p, const struct calx_problem *q, size_t k)
{
    *c = (struct nscd_contact){.mu = q->friction[k], .i = q->body[0][k], .j = q->body[1][k], .index = k};
    for (int b = 0; b < 2; b++)
        c->lever[b] = q->lever[b][k];
    for (int d = 0; d < 3; d++) {
        c->n[d] = q->normal[d][k];
        c->wall[d] = q->wall_after[d][k];
    }
    c->axis[0] = axis_of(q, c->i);
    c->axis[1] = axis_of(q, c->j);
    c->height = height(c, q);
    weigh(c, q->velocity);
    c->pull = c->inverse[0] > 0 ? q->pull[k] * q->dt : 0;
    if (!set_bias(c, q, k))
        return 0;
    c->r[0] = p->warm > 0 ? fmax(0, q->normal_impulse[k] + c->pull) : 0;
    for (int d = 0; d < 3; d++)
        c->r[1 + d] = p->warm > 0 && c->mu > 0 ? q->impulse[d][k] : 0;
    return 1;
}

static int lower(const void *a, const void *b)
{
    const struct nscd_contact *c = a, *d = b;
    return c->height < d->height ? -1 : c->height > d->height ? 1 : c->index < d->index ? -1 : c->index > d->index;
}

static double size(const struct nscd_solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++)
        sum += s->list[k].r[0] * s->list[k].r[0] + nscd_square(s->list[k].r + 1);
    return sqrt(sum);
}

/* Size of the impulses that would stop the contacts as they approach freely. */
static double stopping(const struct nscd_solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++) {
        const struct nscd_contact *c = &s->list[k];
        double ut[3], un = nscd_relative(c, s->v, c->wall, ut), closes = -(un + c->bias);
        sum += closes > 0 ? c->inverse[0] * c->inverse[0] * (closes * closes + nscd_square(ut)) : 0;
    }
    return sqrt(sum);
}

/* Of the numbers that conditions are made of, as impulses. */
static double speeds(const struct nscd_solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++) {
        const struct nscd_contact *c = &s->list[k];
        double ut[3], un = nscd_relative(c, s->v, c->wall, ut);
        sum += c->inverse[0] * c->inverse[0] * (un * un + c->bias * c->bias + nscd_square(ut));
    }
    return sqrt(sum);
}

/* Contacts that an impulse may act in come first; velocities become those with what all contacts start with. */
static void set_up(struct nscd_solver *s)
{
    struct calx_problem *q = s->problem;
    size_t end = s->total = q->n;
    s->v = q->velocity;
    for (size_t k = 0; k < q->n; k++) {
        struct nscd_contact c;
        if (fill(&c, s->p, q, k))
            s->list[s->n++] = c;
        else
            s->list[--end] = c;
    }
    if (s->p->order == BOTTOM_UP)
        qsort(s->list, s->n, sizeof *s->list, lower);
    s->stopping = stopping(s);
    s->scale = speeds(s) + size(s);
    for (size_t k = 0; k < s->total; k++)
        nscd_push(&s->list[k], s->v, s->list[k].r[0] - s->list[k].pull, s->list[k].r + 1);
}

static void hand_back(const struct nscd_solver *s)
{
    struct calx_problem *q = s->problem;
    for (size_t k = 0; k < s->total; k++) {
        const struct nscd_contact *c = &s->list[k];
        q->normal_impulse[c->index] = c->r[0] - c->pull;
        for (int d = 0; d < 3; d++)
            q->impulse[d][c->index] = c->r[1 + d];
    }
}

/* ---- the solution ---- */

/* What may be left. */
static double goal(const struct nscd_solver *s)
{
    return fmax(ROUND_OFF * s->scale, fmin(s->p->tolerance * size(s), s->p->accuracy * s->stopping));
}

int nscd_is_solved(struct nscd_solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++)
        sum += unmet(&s->list[k], s->v);
    s->left = sqrt(sum);
    s->problem->residual = s->left > ROUND_OFF * s->scale ? s->left / size(s) : 0;
    return s->left <= goal(s);
}

struct stretch { /* of the list */
    struct nscd_solver *s;
    size_t first;
};

static void relax_some(void *context, size_t first, size_t last)
{
    const struct stretch *t = context;
    struct nscd_solver *s = t->s;
    for (size_t k = t->first + first; k < t->first + last; k++)
        s->change2[k] = relax(&s->list[k], s->v, s->relaxation);
}

/* Returns the size of the change. */
static double sweep(struct nscd_solver *s)
{
    double sum = nscd_chains_solve(s);
    struct stretch t = {s, 0};
    size_t alone = 0; /* from here on one after the other */
    for (size_t k = 0; s->p->order == COLOURED && k < NSCD_COLOURS && s->first[k] < s->first[k + 1]; k++) {
        t.first = s->first[k];
        alone = s->first[k + 1];
        s->host->parallel(s->host->engine, alone - t.first, relax_some, &t);
    }
    t.first = alone;
    relax_some(&t, 0, s->n - alone);
    for (size_t k = 0; k < s->n; k++)
        sum += s->change2[k];
    s->problem->sweeps++;
    return sqrt(sum);
}

static int unsolved(const struct nscd_solver *s, char *why, size_t why_size)
{
    const struct calx_problem *q = s->problem;
    snprintf(why, why_size,
             "after %.0f sweeps over %zu contacts the residual is %.2g of the impulses (tolerance %g) and %.2g of those that would stop the "
             "bodies (accuracy %g). Either there is no solution, as for a body wedged between walls that close in, or sweeps converge slowly, as "
             "in tall columns and for heavy bodies on light ones: try solver=\"apgd\" and more sweeps; unsolved=\"go-on\" runs it all the same",
             q->sweeps, s->n, q->residual, s->p->tolerance, s->stopping > 0 ? s->left / s->stopping : INFINITY, s->p->accuracy);
    return 1;
}

/* Sweeps until that suffices; returns whether it did. With friction sweeps may go round in circles, sticking and sliding in turn: there
 * changes rise again and again, and shorter steps lead out. */
static int sweep_on(struct nscd_solver *s)
{
    double before = INFINITY;
    size_t rises = 0, sweeps = 0;
    while (s->problem->sweeps < s->p->sweeps) {
        double change = sweep(s);
        if (change <= NEAR * goal(s) && nscd_is_solved(s))
            return 1;
        rises += change > before * (1 + RISE);
        before = change;
        if (++sweeps % WATCHED)
            continue;
        if (20 * rises > WATCHED)
            s->relaxation = fmax(CALMER * s->relaxation, CALMEST);
        rises = 0;
    }
    return nscd_is_solved(s);
}

/* Descends; where descent gives up, sweeps go on. */
static int solve(struct nscd_solver *s, char *why, size_t why_size)
{
    if (s->p->solver == APGD && nscd_descend(s)) {
        snprintf(why, why_size, "not enough memory for %zu bodies", s->problem->bodies);
        return 1;
    }
    if ((s->p->solver == APGD && nscd_is_solved(s)) || sweep_on(s) || s->p->unsolved > 0)
        return 0;
    return unsolved(s, why, why_size);
}

int nscd_solve(const struct nscd *p, const struct calx_motion_host *host, struct calx_problem *q, char *why, size_t why_size)
{
    struct nscd_solver s = {.p = p, .host = host, .problem = q, .relaxation = p->relaxation};
    s.list = malloc((q->n + 1) * sizeof *s.list);
    s.change2 = malloc((q->n + 1) * sizeof *s.change2);
    int failed = !s.list || !s.change2;
    if (!failed) {
        set_up(&s);
        failed = (p->order == COLOURED && nscd_colour(&s)) || (p->chains > 0 && nscd_chains_find(&s));
    }
    if (failed)
        snprintf(why, why_size, "not enough memory for %zu contacts", q->n);
    else if (s.n)
        failed = solve(&s, why, why_size);
    if (s.list)
        hand_back(&s);
    free(s.list);
    free(s.change2);
    nscd_chains_free(&s.chains);
    return failed;
}

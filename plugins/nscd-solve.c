/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact problem of a step: W r - v = -v_free with the conditions of all contacts, W = H^T M^-1 H. It is solved by non-smooth
 * Gauss-Seidel sweeps (Jean 1999): contact after contact gets the impulse that its own condition asks for, all others being as they are, and
 * its bodies the velocity that follows. The lever of a contact of spheres is along the normal, so a contact's own block of W is diagonal,
 * 1/w_n, 1/w_t, 1/w_t, and its solution exact: the normal impulse is projected on r_n >= 0, then the tangential one on |r_t| <= mu r_n.
 *
 * Sweeps end when the natural map of De Saxce leaves a small residual (Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical
 * Systems (2008), ch. 13), and when the changes, taken for a geometric series, sum up to little: a heavy body on a light one has a residual of
 * 1e-4 while nearly all of the impulse is missing.
 *
 * Cohesion: with a pull the law is Signorini's for r_n + pull h. That is what r_n means below.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "plugins/nscd.h"

static const double ROUND_OFF = 1e-14; /* relative changes that say nothing of a rate */

struct contact {
    double n[3], lever[2];
    double inverse[2];   /* kg: 1/w_n, 1/w_t; 0 if neither body can move */
    double bias, mu;     /* m/s: u_n + bias >= 0 */
    double r[4];         /* N s: r_n, r_t */
    double pull;         /* N s */
    double wall[3];
    double *vi, *vj;     /* rows of eight; vj NULL for a wall */
    double height;
    size_t index;        /* in the problem */
};

struct solver {
    const struct nscd *p;
    struct calx_problem *problem;
    size_t n; /* contacts whose impulse is asked for, the others only pull */
    struct contact *list;
};

/* ---- one contact ---- */

/* Adds the impulse rn n + rt to body i, the opposite to j. */
static inline void push(const struct contact *c, double rn, const double rt[3])
{
    double r[3], twist[3];
    for (int k = 0; k < 3; k++) {
        r[k] = rn * c->n[k] + rt[k];
        twist[k] = c->n[(k + 1) % 3] * rt[(k + 2) % 3] - c->n[(k + 2) % 3] * rt[(k + 1) % 3];
    }
    for (int k = 0; k < 3; k++) {
        c->vi[k] += c->vi[3] * r[k];
        c->vi[4 + k] -= c->vi[7] * c->lever[0] * twist[k];
    }
    for (int k = 0; c->vj && k < 3; k++) {
        c->vj[k] -= c->vj[3] * r[k];
        c->vj[4 + k] -= c->vj[7] * c->lever[1] * twist[k];
    }
}

/* Velocity of i relative to j at the contact point: normal, tangential. */
static inline double relative(const struct contact *c, const double *vi, const double *vj, const double wall[3], double ut[3])
{
    double u[3], w[3], un = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = vi[k] - (vj ? vj[k] : wall[k]);
        w[k] = c->lever[0] * vi[4 + k] + (vj ? c->lever[1] * vj[4 + k] : 0);
        un += u[k] * c->n[k];
    }
    for (int k = 0; k < 3; k++)
        ut[k] = u[k] - un * c->n[k] + (c->n[(k + 1) % 3] * w[(k + 2) % 3] - c->n[(k + 2) % 3] * w[(k + 1) % 3]);
    return un;
}

static inline double square(const double v[3])
{
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/* Brings one contact to its condition; returns the square of the change. */
static inline double relax(struct contact *c, double omega)
{
    double ut[3], change[3] = {0}, un = relative(c, c->vi, c->vj, c->wall, ut);
    double rn = fmax(0, c->r[0] - omega * c->inverse[0] * (un + c->bias)), step = rn - c->r[0];
    c->r[0] = rn;
    if (c->mu > 0) {
        double t[3], limit = c->mu * rn;
        for (int k = 0; k < 3; k++)
            t[k] = c->r[1 + k] - omega * c->inverse[1] * ut[k];
        double size2 = square(t), share = size2 > limit * limit ? limit / sqrt(size2) : 1;
        for (int k = 0; k < 3; k++) {
            change[k] = share * t[k] - c->r[1 + k];
            c->r[1 + k] = share * t[k];
        }
    }
    double change2 = step * step + square(change);
    if (change2 > 0)
        push(c, step, change);
    return change2;
}

/* The square of what the natural map leaves: r - P(r - (u + mu |u_t| n)/w_n), P the projection on the cone |r_t| <= mu r_n. */
static double unmet(const struct contact *c)
{
    double ut[3], t[3], un = relative(c, c->vi, c->vj, c->wall, ut), mu = c->mu;
    double z = c->r[0] - c->inverse[0] * (un + c->bias + mu * sqrt(square(ut))), left = 0;
    for (int k = 0; k < 3; k++)
        t[k] = mu > 0 ? c->r[1 + k] - c->inverse[0] * ut[k] : 0;
    double size = sqrt(square(t)), share = 1;
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

static double inverse(double w)
{
    return w > 0 ? 1 / w : 0;
}

/* What is to be kept from passing through, and what bounces: Newton's restitution acts between bodies that touch, so where there is one a
 * gap may close, by less than bodies come in a step; without it the gap is closed to the point. Returns whether an impulse may act. */
static int set_bias(struct contact *c, const struct nscd *p, const struct calx_problem *q, size_t k)
{
    double ut[3], wall[3];
    for (int d = 0; d < 3; d++)
        wall[d] = q->wall_before[d][k];
    const double *vi = q->before + 8 * (size_t)q->body[0][k];
    const double *vj = q->body[1][k] < 0 ? NULL : q->before + 8 * (size_t)q->body[1][k];
    if (q->gap[k] > 0)
        c->bias = q->gap[k] / (p->theta * q->dt);
    else
        c->bias = q->restitution[k] > 0 ? q->restitution[k] * relative(c, vi, vj, wall, ut) : 0;
    return c->inverse[0] > 0 && (!(q->gap[k] > 0) || !(q->restitution[k] > 0));
}

/* Contact k of the problem; returns whether an impulse may act. */
static int fill(struct contact *c, const struct nscd *p, const struct calx_problem *q, size_t k)
{
    double height = 0, weight[2];
    *c = (struct contact){.mu = q->friction[k], .pull = q->pull[k] * q->dt, .index = k};
    c->vi = q->velocity + 8 * (size_t)q->body[0][k];
    c->vj = q->body[1][k] < 0 ? NULL : q->velocity + 8 * (size_t)q->body[1][k];
    for (int b = 0; b < 2; b++)
        c->lever[b] = q->lever[b][k];
    for (int d = 0; d < 3; d++) {
        c->n[d] = q->normal[d][k];
        c->wall[d] = q->wall_after[d][k];
        height -= q->gravity[d] * (q->position[4 * (size_t)q->body[0][k] + (size_t)d] - c->lever[0] * c->n[d]);
    }
    weight[0] = c->vi[3] + (c->vj ? c->vj[3] : 0);
    weight[1] = weight[0] + c->vi[7] * c->lever[0] * c->lever[0] + (c->vj ? c->vj[7] * c->lever[1] * c->lever[1] : 0);
    c->inverse[0] = inverse(weight[0]);
    c->inverse[1] = inverse(weight[1]);
    c->height = height;
    if (!(c->inverse[0] > 0))
        c->pull = 0;
    int acts = set_bias(c, p, q, k);
    for (int d = 0; acts && p->warm > 0 && d < 3; d++)
        c->r[1 + d] = c->mu > 0 ? q->impulse[d][k] : 0;
    if (acts && p->warm > 0)
        c->r[0] = fmax(0, q->normal_impulse[k] + c->pull);
    return acts;
}

static int lower(const void *a, const void *b)
{
    const struct contact *c = a, *d = b;
    return c->height < d->height ? -1 : c->height > d->height ? 1 : c->index < d->index ? -1 : c->index > d->index;
}

/* Contacts that an impulse may act in come first; velocities become those with what all contacts start with. */
static void set_up(struct solver *s)
{
    struct calx_problem *q = s->problem;
    size_t end = q->n;
    for (size_t k = 0; k < q->n; k++) {
        struct contact c;
        if (fill(&c, s->p, q, k))
            s->list[s->n++] = c;
        else
            s->list[--end] = c;
    }
    if (s->p->order > 0)
        qsort(s->list, s->n, sizeof *s->list, lower);
    for (size_t k = 0; k < q->n; k++)
        push(&s->list[k], s->list[k].r[0] - s->list[k].pull, s->list[k].r + 1);
}

static void hand_back(const struct solver *s)
{
    struct calx_problem *q = s->problem;
    for (size_t k = 0; k < q->n; k++) {
        const struct contact *c = &s->list[k];
        q->normal_impulse[c->index] = c->r[0] - c->pull;
        for (int d = 0; d < 3; d++)
            q->impulse[d][c->index] = c->r[1 + d];
    }
}

/* ---- sweeps ---- */

static double size(const struct solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++)
        sum += s->list[k].r[0] * s->list[k].r[0] + square(s->list[k].r + 1);
    return sqrt(sum);
}

static double residual(const struct solver *s)
{
    double sum = 0, scale = size(s);
    for (size_t k = 0; k < s->n; k++)
        sum += unmet(&s->list[k]);
    return sum > 0 ? sqrt(sum) / scale : 0;
}

static double sweep(struct solver *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->n; k++)
        sum += relax(&s->list[k], s->p->relaxation);
    return sqrt(sum);
}

/* What is still to come if changes go on to shrink as the last did. */
static double still_to_come(double change, double before, double scale)
{
    return change <= ROUND_OFF * scale ? 0 : change < before ? change * change / (before - change) : INFINITY;
}

static int unsolved(const struct solver *s, double left, char *why, size_t why_size)
{
    const struct calx_problem *q = s->problem;
    snprintf(why, why_size,
             "after %.0f sweeps over %zu contacts the residual is %.2g (tolerance %g) and what is still to come %.2g of the impulses (accuracy "
             "%g). Either there is no solution, as for a body wedged between walls that close in, or sweeps converge slowly, as in tall "
             "columns and for heavy bodies on light ones: try relaxation=\"1.5\" and more sweeps; unsolved=\"go-on\" runs it all the same",
             q->sweeps, s->n, q->residual, s->p->tolerance, left, s->p->accuracy);
    return 1;
}

static int solve(struct solver *s, char *why, size_t why_size)
{
    struct calx_problem *q = s->problem;
    double before = 0, left = 0;
    for (q->sweeps = 1; q->sweeps <= s->p->sweeps; q->sweeps++) {
        double change = sweep(s), scale = size(s);
        left = still_to_come(change, before, scale) / (scale > 0 ? scale : 1);
        before = change;
        if (change > s->p->tolerance * scale || left > s->p->accuracy)
            continue;
        q->residual = residual(s);
        if (q->residual <= s->p->tolerance)
            return 0;
    }
    q->sweeps--;
    q->residual = residual(s);
    return s->p->unsolved > 0 ? 0 : unsolved(s, left, why, why_size);
}

int nscd_solve(const struct nscd *p, struct calx_problem *q, char *why, size_t why_size)
{
    struct solver s = {.p = p, .problem = q, .list = malloc((q->n + 1) * sizeof *s.list)};
    if (!s.list) {
        snprintf(why, why_size, "not enough memory for %zu contacts", q->n);
        return 1;
    }
    set_up(&s);
    int failed = s.n ? solve(&s, why, why_size) : 0;
    hand_back(&s);
    free(s.list);
    return failed;
}

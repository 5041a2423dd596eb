/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Accelerated projected gradient descent for a contact problem: all contacts step at once from an extrapolated point y, each by 1/L of what its
 * own condition asks for, and y runs ahead of the result as Nesterov's series says, until that leads uphill. L, the largest stretch of W
 * against its diagonal, is found by trial. The square root of the condition number takes the place that the condition number has for sweeps.
 * Reference: Mazhar, Heyn, Negrut and Tasora, ACM Trans. Graphics 34 (2015) 47; restarts: O'Donoghue and Candes, Found. Comput. Math. 15
 * (2015) 715. Friction is projected on the disc of Coulomb, so that a point that stays is a solution without dilatation of the contact; but
 * then nothing says that there is a descent, and where it turns in circles it gives up and leaves the rest to sweeps.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plugins/nscd.h"

enum { LOOK_EVERY = 5, PATIENCE = 200 }; /* iterations; without a smaller residual */
static const double SHRINK = 0.95, GROW = 1.5;

struct point {
    double *r; /* four for each contact */
    double *v; /* rows of eight, the velocities with these impulses */
};

struct descent {
    struct nscd_solver *s;
    struct point y, now, next;
    double *free; /* velocities with the impulses that the list had */
    double stretch, pace;
};

static void point_at(struct point *p, double *memory, size_t contacts)
{
    p->r = memory;
    p->v = memory + 4 * contacts;
}

static void copy(const struct descent *d, const struct point *from, struct point *to)
{
    memcpy(to->r, from->r, (4 * d->s->n + 8 * d->s->problem->bodies) * sizeof(double));
}

/* From y to next: a step of 1/stretch. Returns by how much the quadratic form of W exceeds `stretch` times that of its diagonal. */
static double step(struct descent *d)
{
    const struct nscd_solver *s = d->s;
    size_t numbers = 8 * s->problem->bodies;
    double form = 0, diagonal = 0;
    memcpy(d->next.v, d->y.v, numbers * sizeof(double));
    for (size_t k = 0; k < s->n; k++) {
        const struct nscd_contact *c = &s->list[k];
        const double *from = d->y.r + 4 * k;
        double *to = d->next.r + 4 * k, ut[3], un = nscd_relative(c, d->y.v, c->wall, ut);
        nscd_project(c, from, un, ut, 1 / d->stretch, to);
        double change = to[0] - from[0], turn[3] = {to[1] - from[1], to[2] - from[2], to[3] - from[3]};
        diagonal += c->w[0] * change * change + c->w[1] * nscd_square(turn);
        nscd_push(c, d->next.v, change, turn);
    }
    for (size_t k = 0; k < numbers; k += 8) {
        const double *a = d->next.v + k, *b = d->y.v + k;
        const double dv[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]}, dw[3] = {a[4] - b[4], a[5] - b[5], a[6] - b[6]};
        form += (a[3] > 0 ? nscd_square(dv) / a[3] : 0) + (a[7] > 0 ? nscd_square(dw) / a[7] : 0);
    }
    return form - d->stretch * diagonal * (1 + 1e-9);
}

/* Whether the way from now to next goes against the descent from y to next. */
static int uphill(const struct descent *d)
{
    double sum = 0;
    for (size_t k = 0; k < d->s->n; k++)
        for (size_t q = 0; q < 4; q++) {
            size_t at = 4 * k + q;
            sum += d->s->list[k].w[q > 0] * (d->y.r[at] - d->next.r[at]) * (d->next.r[at] - d->now.r[at]);
        }
    return sum > 0;
}

/* y runs ahead of next, which becomes now. */
static void run_ahead(struct descent *d)
{
    double pace = 0.5 * (1 + sqrt(1 + 4 * d->pace * d->pace)), ahead = uphill(d) ? 0 : (d->pace - 1) / pace;
    size_t numbers = 4 * d->s->n + 8 * d->s->problem->bodies;
    d->pace = ahead > 0 || d->pace <= 1 ? pace : 1;
    for (size_t k = 0; k < numbers; k++)
        d->y.r[k] = d->next.r[k] + ahead * (d->next.r[k] - d->now.r[k]);
    struct point p = d->now;
    d->now = d->next;
    d->next = p;
}

/* Impulses and velocities of now into the list and the problem, velocities from those at the start so that nothing adds up. */
static void deliver(struct descent *d)
{
    struct nscd_solver *s = d->s;
    memcpy(s->v, d->free, 8 * s->problem->bodies * sizeof(double));
    for (size_t k = 0; k < s->n; k++) {
        memcpy(s->list[k].r, d->now.r + 4 * k, sizeof s->list[k].r);
        nscd_push(&s->list[k], s->v, s->list[k].r[0], s->list[k].r + 1);
    }
}

static void begin(struct descent *d)
{
    static const double none[3];
    struct nscd_solver *s = d->s;
    memcpy(d->now.v, s->v, 8 * s->problem->bodies * sizeof(double));
    memcpy(d->free, s->v, 8 * s->problem->bodies * sizeof(double));
    for (size_t k = 0; k < s->n; k++) {
        const struct nscd_contact *c = &s->list[k];
        const double rt[3] = {-c->r[1], -c->r[2], -c->r[3]};
        memcpy(d->now.r + 4 * k, c->r, sizeof c->r);
        nscd_push(c, d->free, -c->r[0], c->mu > 0 ? rt : none);
    }
    copy(d, &d->now, &d->y);
}

static void descend(struct descent *d)
{
    struct calx_problem *q = d->s->problem;
    double least = INFINITY;
    for (int k = 1, last = 0; q->sweeps < d->s->p->sweeps && k - last < PATIENCE; k++) {
        for (q->sweeps++; step(d) > 0 && d->stretch < 1e6; q->sweeps++)
            d->stretch *= GROW;
        run_ahead(d);
        d->stretch = fmax(1, SHRINK * d->stretch);
        if (k % LOOK_EVERY)
            continue;
        deliver(d);
        if (nscd_is_solved(d->s))
            return;
        last = d->s->left < least ? k : last;
        least = fmin(least, d->s->left);
    }
    deliver(d);
}

int nscd_descend(struct nscd_solver *s)
{
    size_t numbers = 4 * s->n + 8 * s->problem->bodies;
    double *memory = malloc(4 * (numbers + 1) * sizeof *memory);
    struct descent d = {.s = s, .stretch = 1, .pace = 1, .free = memory + 3 * numbers};
    if (!memory)
        return 1;
    point_at(&d.y, memory, s->n);
    point_at(&d.now, memory + numbers, s->n);
    point_at(&d.next, memory + 2 * numbers, s->n);
    begin(&d);
    descend(&d);
    free(memory);
    return 0;
}

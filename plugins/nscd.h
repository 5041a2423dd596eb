/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files of the integrator nscd share: its parameters, and the contacts of the problem that is being solved. The lever of a contact of
 * spheres is along the normal, so its own block of W = H^T M^-1 H is diagonal: w_n, w_t, w_t. Where a wall that is free along an axis is
 * one of the bodies and the normal is oblique to that, the diagonal is one that is nowhere less than the block.
 * With a pull the law is Signorini's for r_n + pull h (Renouf et al.): that is what r_n means here.
 */
#ifndef CALX_PLUGINS_NSCD_H
#define CALX_PLUGINS_NSCD_H

#include "core/plugin.h"

struct nscd { /* from the table */
    double theta, solver, tolerance, accuracy, sweeps, unsolved, relaxation, order, chains, warm, reach;
};

struct nscd_contact {
    double n[3], lever[2];
    double w[2];         /* 1/kg: normal, tangential */
    double inverse[2];   /* kg: 1/w_n, 1/w_t; 0 if neither body can move */
    double bias, mu;     /* m/s: u_n + bias >= 0 */
    double r[4];         /* N s: r_n, r_t */
    double pull;         /* N s */
    double wall[3];      /* m/s */
    int32_t i, j;        /* rows; j < 0: a wall */
    int8_t axis[2];      /* of body i, j: along which alone impulses move it; -1: along all */
    double height;
    size_t index;        /* in the problem */
};

enum { NSCD_COLOURS = 64 };

struct nscd_chains { /* of contacts, one behind the other */
    size_t count;
    size_t *first;    /* where each begins in the arrays that follow; count + 1 */
    size_t *contact;  /* places in the list */
    double *coupling; /* 1/kg: of normal impulse and velocity, contact and the next of its chain */
    double *change;   /* N s: room for two numbers per contact */
};

struct nscd_solver {
    const struct nscd *p;
    const struct calx_motion_host *host;
    struct calx_problem *problem;
    double *v;       /* velocities, rows of eight: those of the impulses in the list */
    size_t n, total; /* contacts whose impulse is asked for, and behind them those that only pull */
    struct nscd_contact *list;
    double relaxation;
    double scale;    /* N s: rounding is relative to this */
    double stopping; /* N s: size of the impulses that would stop the contacts as they approach freely, each alone */
    double left;     /* N s: what is left of the conditions, as of the last look */
    size_t first[NSCD_COLOURS + 2]; /* where the contacts of each colour begin, and those without, which come last */
    struct nscd_chains chains;
    double *change2; /* N2 s2: square of the change of each contact in a sweep */
};

/* nscd-solve.c: fills the impulses and velocities of the problem. Returns 0, or 1 with text: no memory, or no solution within the limits. */
int nscd_solve(const struct nscd *, const struct calx_motion_host *, struct calx_problem *, char *why, size_t why_size);

/* nscd-colour.c: sorts the contacts by colours. Returns 0, or 1 without memory. */
int nscd_colour(struct nscd_solver *);

/* nscd-chain.c: finds the chains of the list; 0, or 1 without memory. To be freed in any case. */
int nscd_chains_find(struct nscd_solver *);
void nscd_chains_free(struct nscd_chains *);
/* Brings the normal impulses of each chain to their conditions at once; returns the square of the change. */
double nscd_chains_solve(struct nscd_solver *);

/* Looks at what the impulses in the list leave of the conditions; returns whether that is little enough. */
int nscd_is_solved(struct nscd_solver *);

/* nscd-apgd.c: iterates until the problem is solved, or that gets no nearer, or problem->sweeps is at the limit. Returns 0, or 1 without
 * memory. */
int nscd_descend(struct nscd_solver *);

static inline double nscd_square(const double v[3])
{
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

/* Velocity of i relative to j at the contact point, bodies moving as the rows v say: normal, tangential. */
static inline double nscd_relative(const struct nscd_contact *c, const double *v, const double wall[3], double ut[3])
{
    const double *vi = v + 8 * (size_t)c->i, *vj = c->j < 0 ? NULL : v + 8 * (size_t)c->j;
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

/* Adds the impulse, or its opposite, to a body that may be free along one axis only. */
static inline void nscd_push_along(double *v, int axis, const double r[3], double sign)
{
    for (int k = 0; k < 3; k++)
        if (axis < 0 || axis == k)
            v[k] += sign * v[3] * r[k];
}

/* Adds the impulse rn n + rt to body i, the opposite to j. */
static inline void nscd_push(const struct nscd_contact *c, double *v, double rn, const double rt[3])
{
    double *vi = v + 8 * (size_t)c->i, *vj = c->j < 0 ? NULL : v + 8 * (size_t)c->j, r[3], twist[3];
    for (int k = 0; k < 3; k++) {
        r[k] = rn * c->n[k] + rt[k];
        twist[k] = c->n[(k + 1) % 3] * rt[(k + 2) % 3] - c->n[(k + 2) % 3] * rt[(k + 1) % 3];
    }
    if (c->axis[0] >= 0 || c->axis[1] >= 0) {
        nscd_push_along(vi, c->axis[0], r, 1);
        if (vj)
            nscd_push_along(vj, c->axis[1], r, -1);
        for (int k = 0; k < 3; k++) { /* a wall does not turn */
            vi[4 + k] -= vi[7] * c->lever[0] * twist[k];
            if (vj)
                vj[4 + k] -= vj[7] * c->lever[1] * twist[k];
        }
        return;
    }
    for (int k = 0; k < 3; k++) {
        vi[k] += vi[3] * r[k];
        vi[4 + k] -= vi[7] * c->lever[0] * twist[k];
    }
    for (int k = 0; vj && k < 3; k++) {
        vj[k] -= vj[3] * r[k];
        vj[4 + k] -= vj[7] * c->lever[1] * twist[k];
    }
}

/* The impulse that the contact's own condition asks for where the present one is `from` and leaves u: a step of `share` (1 solves it where
 * nothing else changes), the normal part projected on r_n >= 0, then the tangential one on |r_t| <= mu r_n. */
static inline void nscd_project(const struct nscd_contact *c, const double from[4], double un, const double ut[3], double share,
                                double to[4])
{
    double t[3], rn = from[0] - share * c->inverse[0] * (un + c->bias);
    to[0] = rn > 0 ? rn : 0;
    for (int k = 0; k < 3; k++)
        t[k] = c->mu > 0 ? from[1 + k] - share * c->inverse[1] * ut[k] : 0;
    double limit = c->mu * to[0], size2 = nscd_square(t);
    double shorter = size2 > limit * limit ? limit / __builtin_sqrt(size2) : 1;
    for (int k = 0; k < 3; k++)
        to[1 + k] = shorter * t[k];
}

#endif

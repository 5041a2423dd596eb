/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The stages of velocity Verlet, for the integrators that are this scheme and differ in what the engine does at contacts: half a kick, a
 * drift, the forces, half a kick; for spins the kicks alone. Reference: Swope, Andersen, Berens and Wilson, J. Chem. Phys. 76 (1982) 637.
 */
#ifndef CALX_KICK_DRIFT_H
#define CALX_KICK_DRIFT_H

#include "core/plugin.h"

CALX_KERNEL static void kick(size_t n, size_t stride, const double *restrict dt, double *restrict v,
                             const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            v[i * stride + k] += 0.5 * dt[k] * a[i * stride + k];
}

CALX_KERNEL static void kick_and_drift(size_t n, size_t stride, const double *restrict dt,
                                       double *restrict x, double *restrict v,
                                       const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double half = v[i * stride + k] + 0.5 * dt[k] * a[i * stride + k];
            v[i * stride + k] = half;
            x[4 * i + k] += dt[k] * half;
        }
}

/* Rows of eight: translation and spin. */
CALX_KERNEL static void kick_whole(size_t n, const double *restrict dt, double *restrict v,
                                   const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 8; k++)
            v[8 * i + k] += 0.5 * dt[k] * a[8 * i + k];
}

CALX_KERNEL static void drift(size_t n, size_t stride, const double *restrict dt,
                              double *restrict x, const double *restrict v)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++)
            x[4 * i + k] += dt[k] * v[i * stride + k];
}

/* The second half of one step's kick, the first of the next, the drift. */
CALX_KERNEL static void kick_twice(size_t n, size_t stride, const double *restrict dt, double *restrict x,
                                   double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 4; k++) {
            double kick = 0.5 * dt[k] * a[i * stride + k], half = v[i * stride + k] + kick + kick;
            v[i * stride + k] = half;
            x[4 * i + k] += dt[k] * half;
        }
}

/* The same with spins. */
CALX_KERNEL static void kick_twice_whole(size_t n, const double *restrict dt, double *restrict x,
                                         double *restrict v, const double *restrict a)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 4; k++) {
            double kick = 0.5 * dt[k] * a[8 * i + k], half = v[8 * i + k] + kick + kick;
            v[8 * i + k] = half;
            x[4 * i + k] += dt[k] * half;
        }
        for (size_t k = 4; k < 8; k++) {
            double kick = 0.5 * dt[k] * a[8 * i + k];
            v[8 * i + k] = v[8 * i + k] + kick + kick;
        }
    }
}

static void move(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_and_drift(r->n, r->stride, r->dt, r->x, r->v, r->a);
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r->n, r->stride, r->dt, r->v, r->a);
}

static void move_whole(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_whole(r->n, r->dt, r->v, r->a);
    drift(r->n, r->stride, r->dt, r->x, r->v);
}

static void turn_whole(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_whole(r->n, r->dt, r->v, r->a);
}

static void pass(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_twice(r->n, r->stride, r->dt, r->x, r->v, r->a);
}

static void pass_whole(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick_twice_whole(r->n, r->dt, r->x, r->v, r->a);
}

static const struct calx_stage translation[] = {{.before = move, .after = turn, .between = pass}};
static const struct calx_stage rotation[] = {{.before = turn, .after = turn}};
static const struct calx_stage whole[] = {{.before = move_whole, .after = turn_whole, .between = pass_whole}};

#endif

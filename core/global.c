/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A global integrator of motion drives the step itself: here are the services it does so with.
 * Kernels run over disjoint blocks, results do not depend on threads. How far bodies go is
 * measured, so that lists are built anew in time. Each evaluation that is kept is a sub-step of its
 * own for history, dissipated work and the work of walls. An integrator that solves for impulses
 * gets the contacts in the place of an evaluation, and hands back their impulses (store.c).
 */
#include <math.h>
#include <string.h>

#include "core/state.h"

struct drive {
    struct calx_sim *s;
    struct calx_error *e;
    double t, end, walls; /* s: end of the step, as the engine and the integrator round it; where
                             the walls are */
    bool failed, kept_at_end;
};

static void each(void *engine, double dt, calx_rows_kernel *translation, calx_rows_kernel *rotation,
                 const void *params)
{
    struct calx_sim *s = ((struct drive *)engine)->s;
    double largest = 0.0;
    s->rows_dt = dt;
#pragma omp parallel for schedule(static) num_threads(s->team)                                     \
    reduction(max                                                                                  \
              : largest) if (s->team > 1)
    for (size_t b = 0; b < s->block_count; b++) {
        double moved2 = s->engine->block_kernels(s, b, 0, params, translation, rotation);
        largest = moved2 > largest ? moved2 : largest;
    }
    s->drift += sqrt(largest);
    s->moved += sqrt(largest);
    s->speed = fmax(s->speed, sqrt(largest) / s->dt);
}

static double largest(void *engine, double dt,
                      double (*translation)(const void *, const struct calx_rows *),
                      double (*rotation)(const void *, const struct calx_rows *),
                      const void *params)
{
    struct calx_sim *s = ((struct drive *)engine)->s;
    double most = 0.0, nothing = 0.0; /* nothing: 0, or NaN */
    s->rows_dt = dt;
#pragma omp parallel for schedule(static) num_threads(s->team) reduction(max : most) reduction(+ : nothing) if (s->team > 1)
    for (size_t b = 0; b < s->block_count; b++) {
        double value = s->engine->block_measure(s, b, params, translation, rotation);
        most = value > most ? value : most;
        nothing += isnan(value) ? value : 0.0;
    }
    return most + nothing;
}

/* A sub-step is over: the force on the walls that the last one ended with acts for half of this one
 * too. */
static void book(struct calx_sim *s, double elapsed)
{
    double assumed = s->dt_now > 0.0 ? s->dt_now : s->dt;
    s->wall_work += 0.5L * (long double)s->wall_power * (long double)(elapsed - assumed);
    s->dt_now = elapsed;
    calx_ledger_step(s, elapsed);
}

/* Heat of dissipation of a sub-step before the last waits for the next heat step. */
static void keep_heat(struct calx_sim *s, double elapsed)
{
    for (size_t b = 0; s->r.heat_store && b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            s->r.heat_store[row] += calx_row_a(s, row)[7] * elapsed;
}

static int evaluate(struct drive *d, const struct calx_evaluation *ask)
{
    struct calx_sim *s = d->s;
    bool end = ask->keep && ask->time >= d->end;
    double t = end ? d->t : ask->time;
    s->trial = !ask->keep;
    s->lag = ask->lag;
    calx_step_set_gravity(s, t);
    calx_walls_move(s, t, t - d->walls);
    d->walls = t;
    struct calx_pass pass = {.dt = ask->elapsed, .stage = -1};
    if (end)
        pass = calx_step_end_pass(s, ask->elapsed, -1, false);
    CALX_TRY(calx_step_forces(s, &pass, d->e));
    CALX_TRY(calx_guard_finite(s, d->e));
    if (!ask->keep)
        return 0;
    book(s, ask->elapsed);
    if (!end)
        keep_heat(s, ask->elapsed);
    d->kept_at_end = end;
    return 0;
}

static int forces(void *engine, const struct calx_evaluation *ask)
{
    struct drive *d = engine;
    d->failed = evaluate(d, ask) != 0;
    d->s->trial = false;
    d->s->lag = 0.0;
    return d->failed;
}

static double change(void *engine, double time)
{
    struct drive *d = engine;
    calx_walls_move(d->s, time, time - d->walls);
    d->walls = time;
    d->failed = calx_step_lists(d->s, d->e) != 0;
    return d->failed ? NAN : calx_change_distance(d->s);
}

/* ---- impulses ---- */

static int collect(struct drive *d, const struct calx_moments *at)
{
    struct calx_sim *s = d->s;
    CALX_TRY(calx_store_begin(s, d->e));
    calx_step_set_gravity(s, at->forces);
    s->lag = at->positions - at->velocities;
    calx_walls_move(s, at->positions, at->positions - d->walls);
    s->lag = 0.0;
    d->walls = at->positions;
    CALX_TRY(calx_step_lists(s, d->e));
    return calx_store_collect(s, at->forces, s->dt, d->e);
}

static int contacts(void *engine, const struct calx_moments *at, struct calx_problem **problem)
{
    struct drive *d = engine;
    d->failed = collect(d, at) != 0;
    if (!d->failed)
        *problem = calx_store_problem(d->s);
    return d->failed;
}

static int deliver(struct drive *d)
{
    struct calx_sim *s = d->s;
    struct calx_pass pass = calx_step_end_pass(s, s->dt, -1, false);
    calx_store_work(s);
    s->delivering = true;
    int failed = calx_step_forces(s, &pass, d->e);
    s->delivering = false;
    CALX_TRY(failed);
    CALX_TRY(calx_guard_finite(s, d->e));
    s->wall_work -= 0.5L * (long double)s->wall_power * (long double)s->dt_now; /* of a stage before */
    s->dt_now = s->dt;
    calx_ledger_step(s, s->dt);
    d->kept_at_end = true;
    return 0;
}

static int impulses(void *engine)
{
    struct drive *d = engine;
    d->failed = deliver(d) != 0;
    return d->failed;
}

static void parallel(void *engine, size_t n, void (*part)(void *context, size_t first, size_t last), void *context)
{
    enum { PIECE = 256 }; /* contacts: what takes a thread longer than to be called */
    const struct calx_sim *s = ((struct drive *)engine)->s;
    size_t pieces = (n + PIECE - 1) / PIECE;
    if (pieces < 2 || s->threads < 2) {
        part(context, 0, n);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(s->threads)
    for (size_t k = 0; k < pieces; k++)
        part(context, k * PIECE, k + 1 < pieces ? (k + 1) * PIECE : n);
}

/* Positions are those of the end of the step now: walls, and what they carry, get there too. */
static void end_impulses(struct calx_sim *s, const struct drive *d)
{
    calx_walls_move(s, d->t, d->t - d->walls);
    s->speed = s->moved / s->dt;
}

int calx_motion_step_global(struct calx_sim *s, double t, struct calx_error *e)
{
    const struct calx_plan *p = s->plan;
    struct drive d = {.s = s, .e = e, .t = t, .end = (t - s->dt) + s->dt, .walls = t - s->dt};
    struct calx_motion_host host = {.size = sizeof host,
                                    .engine = &d,
                                    .t = t - s->dt,
                                    .dt = s->dt,
                                    .memory = s->memory,
                                    .each = each,
                                    .largest = largest,
                                    .forces = forces,
                                    .change = change,
                                    .contacts = contacts,
                                    .impulses = impulses,
                                    .parallel = parallel};
    char why[512] = "";
    s->speed = 0.0;
    int failed = p->motion_law->advance(p->motion_params, &host, why, sizeof why);
    if (d.failed)
        return e ? (int)e->code : CALX_ERROR_PHYSICS;
    if (failed)
        return calx_error_set(e, CALX_ERROR_PHYSICS,
                              "at t = %g s the integrator of motion %s failed: %s", s->time,
                              p->motion->name, why);
    if (!d.kept_at_end)
        return calx_error_set(e, CALX_ERROR_PHYSICS,
                              "the integrator of motion %s ends its step without evaluating the "
                              "forces there",
                              p->motion->name);
    if (p->nonsmooth)
        end_impulses(s, &d);
    return 0;
}

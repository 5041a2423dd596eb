/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One batch of contacts, whatever the bodies: the stack of laws and the conductance. And for wall contacts, which come as single lanes, what
 * gather.c does for pairs: velocities at the contact point and the turning of history.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/columns.h"
#include "core/lanes.h"
#include "core/onset.h"
#include "core/timing.h"

static void load3(const calx_column *from, size_t lane, calx_v8 v[3])
{
    for (int k = 0; k < 3; k++)
        v[k] = calx_v8_load(from[k] + lane);
}

static void store3(calx_column *to, size_t lane, const calx_v8 v[3])
{
    for (int k = 0; k < 3; k++)
        calx_v8_store(to[k] + lane, v[k]);
}

static void turn_history(const struct calx_plan *p, const calx_v8 n[3], struct calx_columns *c, size_t lane)
{
    for (size_t h = 0; h < p->history; h++) {
        if (!p->history_is_vector[h])
            continue;
        calx_v8 v[3];
        for (int k = 0; k < 3; k++)
            v[k] = calx_v8_load(c->history[h + k] + lane);
        calx_lanes_turn_flat(n, v);
        for (int k = 0; k < 3; k++)
            calx_v8_store(c->history[h + k] + lane, v[k]);
    }
}

void CALX_ISA(calx_evaluate_motion)(const struct calx_plan *p, double lag, struct calx_columns *c)
{
    double growth = p->models->lever_full ? 0.0 : lag;
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 n[3], u[3], omega[3], w[3] = {{0}}, vt[3];
        load3(c->normal, lane, n);
        load3(c->velocity, lane, u);
        calx_v8 vn = calx_lanes_dot(false, n, u);
        calx_v8_store(c->vn + lane, vn);
        if (!(p->needs & CALX_NEEDS_TANGENT))
            continue;
        if (p->needs & CALX_NEEDS_ROTATION) {
            load3(c->omega, lane, omega);
            calx_v8 lever = calx_v8_load(c->levers + lane) - 0.5 * growth * vn;
            for (int k = 0; k < 3; k++)
                w[k] = lever * omega[k];
            if (p->needs & CALX_NEEDS_SPIN)
                store3(c->spin, lane, omega);
        }
        calx_lanes_slide(false, n, u, w, vt);
        store3(c->vt, lane, vt);
        turn_history(p, n, c, lane);
    }
}

void CALX_ISA(calx_evaluate_force)(const struct calx_plan *p, struct calx_columns *c)
{
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 n[3], ft[3] = {{0}}, force[3], twist[3];
        load3(c->normal, lane, n);
        if (p->needs & CALX_NEEDS_TANGENT)
            load3(c->ft, lane, ft);
        calx_lanes_force(false, n, calx_v8_load(c->fn + lane), ft, force);
        calx_lanes_twist(false, n, ft, twist);
        store3(c->force, lane, force);
        store3(c->twist, lane, twist);
    }
}

/* The batch as a plugin sees it: columns it has not asked for are NULL. */
static struct calx_contacts view(const struct calx_plan *p, uint32_t needs, struct calx_columns *c)
{
    struct calx_contacts v = {.size = sizeof v, .overlap = c->overlap, .vn = c->vn, .mass = c->mass, .fn = c->fn,
                              .work = c->work};
    for (int k = 0; k < 2; k++) {
        v.curvature[k] = needs & CALX_NEEDS_CURVATURE ? c->curvature[k] : NULL;
        v.temperature[k] = needs & CALX_NEEDS_TEMPERATURE ? c->temperature[k] : NULL;
    }
    for (int k = 0; k < 3; k++) {
        v.normal[k] = c->normal[k];
        if (needs & CALX_NEEDS_TANGENT) {
            v.vt[k] = c->vt[k];
            v.ft[k] = c->ft[k];
        }
        if (needs & CALX_NEEDS_SPIN) {
            v.spin[k] = c->spin[k];
            v.torque[k] = c->torque[k];
        }
    }
    v.coulomb = p->cohesion ? c->coulomb : c->fn;
    return v;
}

static void make_views(const struct calx_plan *p, struct calx_columns *c)
{
    for (size_t l = 0; l < p->law_count; l++) {
        c->views[l] = view(p, p->laws[l].demand.needs, c);
        c->views[l].history = c->law_history[l];
    }
    if (p->conductance) {
        c->views[p->law_count] = view(p, p->conductance_demand.needs, c);
        c->views[p->law_count].overlap = p->nonsmooth ? c->energy : c->overlap;
    }
    c->viewed = p;
}

static void *pair_params(const struct calx_plugin *plugin, const char *params, size_t type)
{
    return (void *)(params + plugin->params_size * type);
}

/* The batch as law l sees it now. Its history columns are those that it asked for with this pair type: vectors, then, after the vectors of
 * the union, scalars. */
static const struct calx_contacts *present(const struct calx_plan *p, size_t l, size_t type, double dt,
                                           struct calx_columns *c)
{
    c->views[l].n = c->n;
    c->views[l].dt = dt;
    if (l == p->law_count)
        return &c->views[l];
    const struct calx_law *law = &p->laws[l];
    const struct calx_demand *own = &law->own[type];
    size_t vectors = 3 * own->history_vectors, scalars = law->first_history + 3 * law->demand.history_vectors;
    for (size_t h = 0; h < vectors; h++)
        c->law_history[l][h] = c->history[law->first_history + h];
    for (size_t h = 0; h < own->history_scalars; h++)
        c->law_history[l][vectors + h] = c->history[scalars + h];
    return &c->views[l];
}

static void run_laws(const struct calx_plan *p, size_t type, double dt, struct calx_columns *c,
                     struct calx_clock *clock)
{
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        if (p->cohesion && law->law->provides & CALX_COHESION)
            memcpy(c->coulomb, c->fn, sizeof c->coulomb);
        law->law->force(pair_params(law->plugin, law->params, type), present(p, l, type, dt, c));
        if (p->resolves && l == p->normal)
            CALX_ISA(calx_onset_normal)(p, l, type, c);
        calx_timing_law(clock, l);
    }
}

/* ---- non-smooth laws ---- */

static void run_conditions(const struct calx_plan *p, size_t type, struct calx_columns *c)
{
    struct calx_condition condition = {.size = sizeof condition, .friction = c->condition[0], .restitution = c->condition[1],
                                       .pull = c->condition[2], .reach = c->condition[3]};
    for (size_t k = 0; k < 4; k++)
        memset(c->condition[k], 0, calx_padded(c->n) * sizeof(double));
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        law->law->condition(pair_params(law->plugin, law->params, type), present(p, l, type, 0.0, c), &condition);
    }
}

/* The impulses of a lane, into its history too if they are new; and the work. */
static void take_impulse(const struct calx_plan *p, struct calx_columns *c, size_t lane, double impulse[4])
{
    bool within = c->overlap[lane] > -p->gap, solved = within && c->solution;
    for (size_t k = 0; k < 4; k++) {
        double *kept = &c->history[p->impulse + k][lane];
        if (solved)
            *kept = c->solution->impulse[k][c->answer];
        impulse[k] = within ? *kept : 0.0;
    }
    if (solved)
        c->work[lane] = c->solution->work[c->answer++];
}

/* Impulses as mean forces of the step. */
static void take_impulses(const struct calx_plan *p, struct calx_columns *c)
{
    double rate = 1.0 / p->dt;
    for (size_t lane = 0; lane < c->n; lane++) {
        double impulse[4];
        take_impulse(p, c, lane, impulse);
        c->fn[lane] = rate * impulse[3];
        c->coulomb[lane] = c->fn[lane] + (-c->overlap[lane] <= c->condition[3][lane] ? c->condition[2][lane] : 0.0);
        for (size_t k = 0; p->needs & CALX_NEEDS_TANGENT && k < 3; k++)
            c->ft[k][lane] = rate * impulse[k];
    }
}

/* Rigid bodies touch where they press on each other, whatever rounding has left between them: to conductances that is an overlap. */
static void show_touch(struct calx_columns *c)
{
    memset(c->energy, 0, sizeof c->energy);
    for (size_t lane = 0; lane < c->n; lane++)
        c->energy[lane] = c->fn[lane] > 0.0 ? fmax(c->overlap[lane], DBL_MIN) : fmin(c->overlap[lane], 0.0);
}

static void run_nonsmooth(const struct calx_plan *p, size_t type, struct calx_columns *c)
{
    run_conditions(p, type, c);
    take_impulses(p, c);
    show_touch(c);
}

/* ---- all laws ---- */

static void clear(calx_column *columns, size_t count, size_t n)
{
    for (size_t k = 0; k < count; k++)
        for (size_t lane = 0; lane < n; lane += 8)
            calx_v8_store(columns[k] + lane, (calx_v8){0});
}

void CALX_ISA(calx_evaluate_laws)(const struct calx_plan *p, size_t type, double dt, bool conduct,
                                  struct calx_columns *c, struct calx_clock *clock)
{
    (p->resolves && dt > 0.0 ? CALX_ISA(calx_onset_laws) : CALX_ISA(calx_evaluate_stack))(p, type, dt, conduct, c, clock);
}

void CALX_ISA(calx_evaluate_stack)(const struct calx_plan *p, size_t type, double dt, bool conduct,
                                   struct calx_columns *c, struct calx_clock *clock)
{
    if (c->viewed != p)
        make_views(p, c);
    clear(&c->fn, 1, c->n);
    clear(&c->work, 1, c->n);
    if (p->needs & CALX_NEEDS_TANGENT)
        clear(c->ft, 3, c->n);
    if (p->needs & CALX_NEEDS_SPIN)
        clear(c->torque, 3, c->n);
    if (p->nonsmooth)
        run_nonsmooth(p, type, c);
    else
        run_laws(p, type, dt, c, clock);
    if (conduct) {
        const struct calx_conductance_law *law = p->conductance->law;
        law->conductance(pair_params(p->conductance, p->conductance_params, type),
                         present(p, p->law_count, type, dt, c), c->conductance);
        calx_timing_lap(clock, CALX_PHASE_CONDUCTANCE);
    }
}

void CALX_ISA(calx_evaluate_energy)(const struct calx_plan *p, size_t type, double dt, struct calx_columns *c)
{
    struct calx_response response = {.size = sizeof response, .energy = c->energy};
    if (c->viewed != p)
        make_views(p, c);
    memset(c->energy, 0, sizeof c->energy);
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        law->law->response(pair_params(law->plugin, law->params, type), present(p, l, type, dt, c), &response);
    }
}

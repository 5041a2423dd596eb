/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One batch of contacts, whatever the bodies: kinematics of the contact point, the turning of history with the normal, the stack of laws,
 * the conductance. The normal used for the tangential velocity is that of the moment the velocity belongs to (half a step
 * back for velocity Verlet), then the result is turned to the present normal; without this, friction at large size ratios
 * sticks where it should slip (Vyas et al., Comput. Phys. Commun. 310 (2025) 109524).
 */
#include <math.h>
#include <string.h>

#include "core/columns.h"
#include "core/timing.h"

typedef double column[CALX_BATCH];

/* u.m with m the normal when the velocity u was, to first order in the turn since: what is lost and stored then balances to second order. */
static void normal_velocity(size_t n, const column *restrict normal, const column *restrict velocity,
                            const double *restrict tilt, double *restrict vn)
{
    for (size_t c = 0; c < n; c++) {
        double x = velocity[0][c], y = velocity[1][c], z = velocity[2][c];
        double un = x * normal[0][c] + y * normal[1][c] + z * normal[2][c];
        vn[c] = un - tilt[c] * (x * x + y * y + z * z - un * un);
    }
}

/* Velocity of i relative to j at the contact point, tangential: u - (u.m) m with m the normal when u was, then laid into the plane of n.
 * w: sum of lever times spin; a point at -l n from i moves with v_i - l w_i x n. */
static void tangential_velocity(size_t n, const column *restrict normal,
                                const column *restrict velocity, const column *restrict w,
                                const double *restrict tilt, column *restrict vt)
{
    for (size_t c = 0; c < n; c++) {
        double x = normal[0][c] - tilt[c] * velocity[0][c], y = normal[1][c] - tilt[c] * velocity[1][c],
               z = normal[2][c] - tilt[c] * velocity[2][c];
        double s = 1.0 / sqrt(x * x + y * y + z * z);
        x *= s;
        y *= s;
        z *= s;
        double ux = velocity[0][c] - (w[1][c] * z - w[2][c] * y);
        double uy = velocity[1][c] - (w[2][c] * x - w[0][c] * z);
        double uz = velocity[2][c] - (w[0][c] * y - w[1][c] * x);
        double un = ux * x + uy * y + uz * z;
        ux -= un * x;
        uy -= un * y;
        uz -= un * z;
        un = ux * normal[0][c] + uy * normal[1][c] + uz * normal[2][c];
        vt[0][c] = ux - un * normal[0][c];
        vt[1][c] = uy - un * normal[1][c];
        vt[2][c] = uz - un * normal[2][c];
    }
}

/* The levers are those of when the spins were: they grow by `back` times vn until the present. */
static void lever_spin(size_t n, double back, const double *restrict vn, const column *restrict lever,
                       const column *restrict wi, const column *restrict wj, column *restrict w)
{
    for (int k = 0; k < 3; k++)
        for (size_t c = 0; c < n; c++)
            w[k][c] = (lever[0][c] - back * vn[c]) * wi[k][c] + (lever[1][c] - back * vn[c]) * wj[k][c];
}

static void relative_spin(size_t n, const column *restrict wi, const column *restrict wj,
                          column *restrict spin)
{
    for (int k = 0; k < 3; k++)
        for (size_t c = 0; c < n; c++)
            spin[k][c] = wi[k][c] - wj[k][c];
}

/* Turns a history vector with the normal since the evaluation before, and keeps its length: by the least rotation, h - (h.n)/(m.n) m with m along the normal half
 * way. m is that of the velocity (lag 1/2); with another lag, and at walls, m = n: h is laid into the plane of n, first order in the turn. */
static void turn_vector(size_t n, const column *restrict normal, const column *restrict velocity,
                        const double *restrict tilt, column *restrict h)
{
    for (size_t c = 0; c < n; c++) {
        double mx = normal[0][c] - tilt[c] * velocity[0][c], my = normal[1][c] - tilt[c] * velocity[1][c],
               mz = normal[2][c] - tilt[c] * velocity[2][c];
        double before = h[0][c] * h[0][c] + h[1][c] * h[1][c] + h[2][c] * h[2][c];
        double hn = h[0][c] * normal[0][c] + h[1][c] * normal[1][c] + h[2][c] * normal[2][c];
        double f = hn / (mx * normal[0][c] + my * normal[1][c] + mz * normal[2][c]);
        double x = h[0][c] - f * mx, y = h[1][c] - f * my, z = h[2][c] - f * mz;
        double after = x * x + y * y + z * z;
        double s = after > 0.0 ? sqrt(before / after) : 0.0;
        h[0][c] = s * x;
        h[1][c] = s * y;
        h[2][c] = s * z;
    }
}

/* force = fn n + ft; twist = n x ft. */
static void assemble(size_t n, const double *restrict fn, const column *restrict ft,
                     const column *restrict normal, column *restrict force, column *restrict twist)
{
    for (size_t c = 0; c < n; c++) {
        double x = normal[0][c], y = normal[1][c], z = normal[2][c];
        force[0][c] = fn[c] * x + ft[0][c];
        force[1][c] = fn[c] * y + ft[1][c];
        force[2][c] = fn[c] * z + ft[2][c];
        twist[0][c] = y * ft[2][c] - z * ft[1][c];
        twist[1][c] = z * ft[0][c] - x * ft[2][c];
        twist[2][c] = x * ft[1][c] - y * ft[0][c];
    }
}

static void normal_force_only(size_t n, const double *restrict fn, const column *restrict normal,
                              column *restrict force)
{
    for (int k = 0; k < 3; k++)
        for (size_t c = 0; c < n; c++)
            force[k][c] = fn[c] * normal[k][c];
}

/* Half the way that bodies part at unit speed between the moment of the velocities and now; levers of R do not grow. */
static double lever_growth(const struct calx_plan *p, double lag)
{
    return p->models->lever_full ? 0.0 : 0.5 * lag;
}

static void kinematics(const struct calx_plan *p, struct calx_columns *c, size_t padded)
{
    normal_velocity(padded, c->normal, c->velocity, c->tilt, c->vn);
    if (!(p->needs & CALX_NEEDS_TANGENT))
        return;
    column w[3];
    if (p->needs & CALX_NEEDS_ROTATION)
        lever_spin(padded, lever_growth(p, c->lag), c->vn, c->lever, c->omega[0], c->omega[1], w);
    else
        memset(w, 0, sizeof w);
    tangential_velocity(padded, c->normal, c->velocity, w, c->tilt, c->vt);
    if (p->needs & CALX_NEEDS_SPIN)
        relative_spin(padded, c->omega[0], c->omega[1], c->spin);
    for (size_t h = 0; h < p->history; h++)
        if (p->history_is_vector[h])
            turn_vector(padded, c->normal, c->velocity, c->tilt, &c->history[h]);
}

/* The batch as a plugin sees it: columns it has not asked for are NULL. */
static struct calx_contacts view(const struct calx_plan *p, uint32_t needs, double dt,
                                 struct calx_columns *c)
{
    struct calx_contacts v = {.size = sizeof v, .n = c->n, .dt = dt, .overlap = c->overlap, .vn = c->vn,
                              .inverse_mass = c->inverse_mass, .fn = c->fn, .work = c->work};
    for (int k = 0; k < 2; k++) {
        v.curvature[k] = c->curvature[k];
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

static void *pair_params(const struct calx_plugin *plugin, const char *params, size_t type)
{
    return (void *)(params + plugin->params_size * type);
}

/* The history columns of a law as it asked for them for this pair type: vectors, then, after the vectors of the union, scalars. */
static void history_columns(const struct calx_law *law, size_t type, struct calx_columns *c, double **out)
{
    const struct calx_demand *own = &law->own[type];
    size_t vectors = 3 * own->history_vectors, scalars = law->first_history + 3 * law->demand.history_vectors;
    for (size_t h = 0; h < vectors; h++)
        out[h] = c->history[law->first_history + h];
    for (size_t h = 0; h < own->history_scalars; h++)
        out[vectors + h] = c->history[scalars + h];
}

static void run_laws(const struct calx_plan *p, size_t type, double dt, struct calx_columns *c,
                     struct calx_clock *clock)
{
    double *history[CALX_HISTORY_MAX];
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        struct calx_contacts v = view(p, law->demand.needs, dt, c);
        history_columns(law, type, c, history);
        v.history = history;
        if (p->cohesion && law->law->provides & CALX_COHESION)
            memcpy(c->coulomb, c->fn, sizeof c->coulomb);
        law->law->force(pair_params(law->plugin, law->params, type), &v);
        calx_timing_law(clock, l);
    }
}

void CALX_ISA(calx_evaluate_batch)(const struct calx_plan *p, size_t type, double dt, bool conduct,
                                   struct calx_columns *c, struct calx_clock *clock)
{
    size_t padded = (c->n + CALX_WIDTH - 1) / CALX_WIDTH * CALX_WIDTH;
    memset(c->fn, 0, sizeof c->fn);
    memset(c->work, 0, sizeof c->work);
    if (p->needs & CALX_NEEDS_TANGENT)
        memset(c->ft, 0, sizeof c->ft);
    if (p->needs & CALX_NEEDS_SPIN)
        memset(c->torque, 0, sizeof c->torque);
    kinematics(p, c, padded);
    calx_timing_lap(clock, CALX_PHASE_KINEMATICS);
    run_laws(p, type, dt, c, clock);
    if (p->needs & CALX_NEEDS_TANGENT)
        assemble(padded, c->fn, c->ft, c->normal, c->force, c->twist);
    else
        normal_force_only(padded, c->fn, c->normal, c->force);
    calx_timing_lap(clock, CALX_PHASE_KINEMATICS);
    if (conduct) {
        const struct calx_conductance_law *law = p->conductance->law;
        struct calx_contacts v = view(p, p->conductance_demand.needs, dt, c);
        law->conductance(pair_params(p->conductance, p->conductance_params, type), &v, c->conductance);
        calx_timing_lap(clock, CALX_PHASE_CONDUCTANCE);
    }
}

void CALX_ISA(calx_evaluate_energy)(const struct calx_plan *p, size_t type, double dt,
                                    struct calx_columns *c)
{
    double *history[CALX_HISTORY_MAX];
    memset(c->energy, 0, sizeof c->energy);
    struct calx_response response = {.size = sizeof response, .energy = c->energy};
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_law *law = &p->laws[l];
        struct calx_contacts v = view(p, law->demand.needs, dt, c);
        history_columns(law, type, c, history);
        v.history = history;
        law->law->response(pair_params(law->plugin, law->params, type), &v, &response);
    }
}

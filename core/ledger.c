/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The ledger: what went in and out in each step, summed in block order, and the energies of the present state. Dissipated
 * work and heat flows are summed as they happen; kinetic, elastic and potential energies are worked out when asked.
 * The work of walls is force times wall speed at each evaluation; the last evaluation has acted for half a step only. Impulses of non-smooth
 * laws are those of the whole step, which is over.
 */
#include <math.h>
#include <string.h>

#include "core/state.h"

struct sums {
    long double kinetic, rotational, potential, heat, momentum[3];
};

static void add_particle(const struct calx_sim *s, int32_t row, struct sums *out)
{
    const double *x = calx_row_x(s, row), *v = calx_row_v(s, row);
    double inertia = calx_particle_inertia_factor(s->scene) * x[3] * x[3];
    if (s->r.inverse_capacity && s->r.inverse_capacity[row] > 0.0)
        out->heat += (long double)v[7] / (long double)s->r.inverse_capacity[row];
    if (v[3] <= 0.0)
        return;
    double mass = 1.0 / v[3];
    out->kinetic += 0.5 * mass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (s->features.rotation)
        out->rotational += 0.5 * mass * inertia * (v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
    for (int k = 0; k < 3; k++) {
        double turns = s->r.image ? s->r.image[row][k] * (s->scene->high[k] - s->scene->low[k]) : 0.0;
        out->potential -= mass * s->gravity[k] * (x[k] + (s->scene->periodic[k] ? turns : 0.0));
        out->momentum[k] += mass * v[k];
    }
}

/* Of bodies, of slabs, and of plates as far as they are free. */
static struct sums sum_bodies(const struct calx_sim *s)
{
    struct sums out = {0};
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            add_particle(s, row, &out);
    out.heat += calx_slabs_content(s);
    out.kinetic += calx_plates_kinetic(s);
    out.potential += calx_plates_potential(s);
    return out;
}

static long double sum_elastic(struct calx_sim *s)
{
    long double elastic = 0.0;
    if (!s->plan->law_count || s->plan->nonsmooth)
        return 0.0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(s->team) if (s->team > 1)
    for (size_t b = 0; b < s->block_count; b++) {
        double ignored;
        s->engine->block_energy(s, b, &ignored);
    }
    for (size_t b = 0; b < s->block_count; b++)
        elastic += s->tallies[b].energy;
    return elastic;
}

struct calx_ledger calx_sim_ledger(struct calx_sim *s)
{
    struct sums p = sum_bodies(s);
    struct calx_ledger l = {.kinetic = (double)p.kinetic, .rotational = (double)p.rotational,
                            .elastic = (double)sum_elastic(s), .potential = (double)p.potential,
                            .dissipated = (double)s->dissipated, .gravity_work = (double)s->outside_work};
    long double half_step = 0.5L * s->wall_power * s->dt_now;
    long double mechanical = p.kinetic + p.rotational + l.elastic + p.potential;
    l.wall_work = (double)(s->wall_work - half_step);
    l.residual = (double)(mechanical + s->dissipated - s->energy0 - (s->wall_work - half_step) -
                          s->outside_work);
    double moved = fabs(l.potential - s->potential0);
    s->scale = fmax(s->scale, fmax(l.kinetic + l.rotational + l.elastic, fmax(l.dissipated, moved)));
    l.scale = s->scale;
    l.heat = (double)p.heat;
    l.wall_heat = (double)s->wall_heat;
    l.heat_of_dissipation = (double)s->dissipation_heat;
    l.heat_residual = (double)(p.heat - s->heat0 - s->wall_heat - s->dissipation_heat);
    s->heat_scale = fmax(s->heat_scale, fabs(l.heat));
    l.heat_scale = s->heat_scale;
    for (int k = 0; k < 3; k++)
        l.momentum[k] = (double)p.momentum[k];
    return l;
}

double calx_ledger_mechanical(struct calx_sim *s)
{
    struct sums p = sum_bodies(s);
    return (double)(p.kinetic + p.rotational + p.potential + sum_elastic(s));
}

void calx_ledger_begin(struct calx_sim *s)
{
    struct sums p = sum_bodies(s);
    s->potential0 = (double)p.potential;
    s->energy0 = p.kinetic + p.rotational + p.potential + sum_elastic(s);
    s->heat0 = p.heat;
}

double calx_ledger_wall_power(const struct calx_sim *s)
{
    double power = 0.0;
    for (size_t b = 0; b < s->block_count; b++)
        power += s->tallies[b].wall_power;
    return power + calx_plates_power(s);
}

void calx_ledger_step(struct calx_sim *s, double dt)
{
    double power = calx_ledger_wall_power(s);
    long double work = 0.0, lost = 0.0;
    for (size_t b = 0; b < s->block_count; b++) {
        const struct calx_tally *t = &s->tallies[b];
        work += t->work;
        lost += t->wall_heat_lost;
    }
    s->dissipated += work;
    s->wall_work += (long double)power * (long double)dt;
    s->wall_power = s->plan->nonsmooth ? 0.0 : power;
    if (s->features.temperature) {
        s->dissipation_heat += work * (long double)s->scene->from_dissipation;
        s->wall_heat -= lost;
        calx_slabs_take_dissipation(s);
    }
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The table of quantities: name, unit, sentence, and the function that reads it.
 * Input: a frame (copy of the state in order of id) and the ledger of a simulation. Output: up to
 * three doubles. A quantity is that of one particle, an entry of the ledger, or one of the whole
 * scene.
 */
#include "core/measure_table.h"

#include <math.h>
#include <string.h>

#include "core/heap.h"
#include "core/lacey.h"

/* ---- quantities of one particle ---- */

static bool copy3(const double (*rows)[3], size_t i, double out[3])
{
    if (rows)
        memcpy(out, rows[i], sizeof rows[i]);
    return rows != NULL;
}

static bool copy1(const double *column, size_t i, double out[3])
{
    if (column)
        out[0] = column[i];
    return column != NULL;
}

double calx_measure_square(const double v[3])
{
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

static bool position(const struct calx_frame *f, size_t i, double out[3])
{
    return copy3((const double(*)[3])f->position, i, out);
}

static bool velocity(const struct calx_frame *f, size_t i, double out[3])
{
    return copy3((const double(*)[3])f->velocity, i, out);
}

static bool spin(const struct calx_frame *f, size_t i, double out[3])
{
    return copy3((const double(*)[3])f->spin, i, out);
}

static bool force(const struct calx_frame *f, size_t i, double out[3])
{
    return copy3((const double(*)[3])f->force, i, out);
}

static bool temperature(const struct calx_frame *f, size_t i, double out[3])
{
    return copy1(f->temperature, i, out);
}

static bool heat_flow(const struct calx_frame *f, size_t i, double out[3])
{
    return copy1(f->heat, i, out);
}

static bool mass(const struct calx_frame *f, size_t i, double out[3])
{
    return copy1(f->mass, i, out);
}

static bool radius(const struct calx_frame *f, size_t i, double out[3])
{
    return copy1(f->radius, i, out);
}

static bool speed(const struct calx_frame *f, size_t i, double out[3])
{
    if (f->velocity)
        out[0] = sqrt(calx_measure_square(f->velocity[i]));
    return f->velocity != NULL;
}

static bool coordination(const struct calx_frame *f, size_t i, double out[3])
{
    if (f->contacts)
        out[0] = f->contacts[i];
    return f->contacts != NULL;
}

/* ---- quantities of the whole scene ---- */

static bool time_now(const struct calx_measure_view *v, double out[3])
{
    out[0] = calx_sim_time(v->sim);
    return true;
}

static bool step(const struct calx_measure_view *v, double out[3])
{
    out[0] = (double)calx_sim_step_count(v->sim);
    return true;
}

static bool solver_sweeps(const struct calx_measure_view *v, double out[3])
{
    double residual;
    out[0] = calx_sim_solver(v->sim, &residual);
    return true;
}

static bool solver_residual(const struct calx_measure_view *v, double out[3])
{
    double residual;
    calx_sim_solver(v->sim, &residual);
    out[0] = residual;
    return true;
}

static bool count(const struct calx_measure_view *v, double out[3])
{
    out[0] = (double)calx_sim_particle_count(v->sim);
    return true;
}

static bool contacts(const struct calx_measure_view *v, double out[3])
{
    out[0] = (double)calx_sim_contact_count(v->sim);
    return true;
}

/* Each pair is two entries of the particles' contact counts, a contact with a wall is one. */
static bool pair_contacts(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    out[0] = f && f->contacts ? -(double)calx_sim_contact_count(v->sim) : NAN;
    for (size_t i = 0; f && f->contacts && i < f->n; i++)
        out[0] += f->contacts[i];
    return true;
}

static double relative(double residual, double scale)
{
    return scale > 0 ? residual / scale : residual;
}

static bool residual_relative(const struct calx_measure_view *v, double out[3])
{
    const struct calx_ledger *l = calx_measure_ledger(v->sim);
    out[0] = relative(l->residual, l->scale);
    return true;
}

static bool heat_residual_relative(const struct calx_measure_view *v, double out[3])
{
    const struct calx_ledger *l = calx_measure_ledger(v->sim);
    out[0] = relative(l->heat_residual, l->heat_scale);
    return true;
}

static bool momentum(const struct calx_measure_view *v, double out[3])
{
    memcpy(out, calx_measure_ledger(v->sim)->momentum, 3 * sizeof out[0]);
    return true;
}

static bool step_share(const struct calx_measure_view *v, double out[3])
{
    int64_t id;
    out[0] = calx_measure_step_share(v->sim, &id);
    return true;
}

static bool step_share_particle(const struct calx_measure_view *v, double out[3])
{
    int64_t id;
    calx_measure_step_share(v->sim, &id);
    out[0] = (double)id;
    return true;
}

/* The largest overlap, divided by the smaller radius if `by_radius`; 0 without contacts. */
static bool largest_overlap(const struct calx_measure_view *v, bool by_radius, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    if (!f)
        return false;
    out[0] = 0;
    for (size_t c = 0; c < f->contact_count; ++c) {
        double r = f->radius[f->pair[c][0]];
        if (f->pair[c][1] >= 0)
            r = fmin(r, f->radius[f->pair[c][1]]);
        out[0] = fmax(out[0], f->overlap[c] / (by_radius ? r : 1));
    }
    return true;
}

static bool max_overlap(const struct calx_measure_view *v, double out[3])
{
    return largest_overlap(v, false, out);
}

static bool max_overlap_relative(const struct calx_measure_view *v, double out[3])
{
    return largest_overlap(v, true, out);
}

static bool peak_force(const struct calx_measure_view *v, double out[3])
{
    const struct calx_peak *p = calx_sim_peak(v->sim);
    out[0] = p->force;
    return p->watched;
}

static bool peak_force_time(const struct calx_measure_view *v, double out[3])
{
    const struct calx_peak *p = calx_sim_peak(v->sim);
    out[0] = p->time;
    return p->watched;
}

/* The classes belong to the probe of that name, which the caller may hold a copy of. */
static const uint8_t *classes_of(struct calx_sim *sim, const struct calx_probe *probe)
{
    const struct calx_scene *scene = calx_sim_scene(sim);
    for (size_t i = 0; i < scene->probe_count; ++i)
        if (strcmp(scene->probes[i].name, probe->name) == 0)
            return calx_sim_probe_classes(sim, i);
    return NULL;
}

static bool lacey_index(const struct calx_measure_view *v, double out[3])
{
    const uint8_t *classes = classes_of(v->sim, v->probe);
    const struct calx_frame *f = classes ? calx_measure_frame(v->sim) : NULL;
    out[0] = f ? calx_lacey_index(f, classes, v->probe->cell) : NAN;
    return true;
}

static bool slope(const struct calx_measure_view *v, int side, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    out[0] = f ? calx_heap_slope(f, side) : NAN;
    return true;
}

static bool slope_left(const struct calx_measure_view *v, double out[3])
{
    return slope(v, -1, out);
}

static bool slope_right(const struct calx_measure_view *v, double out[3])
{
    return slope(v, 1, out);
}

/* The direction against gravity in the present stage; y without gravity. */
void calx_measure_up(struct calx_sim *sim, double up[3])
{
    const struct calx_scene *scene = calx_sim_scene(sim);
    const double origin[3] = {0, 0, 0};
    size_t stage = (size_t)calx_sim_stage(sim);
    double g[3] = {0, 0, 0};
    for (size_t k = 0; k < 3 && stage < scene->stage_count; ++k)
        g[k] = calx_evaluate(&scene->stages[stage].gravity[k], calx_sim_time(sim), origin);
    double size = sqrt(calx_measure_square(g));
    for (int k = 0; k < 3; ++k)
        up[k] = size > 0 ? -g[k] / size : k == 1;
}

static bool bed_height(const struct calx_measure_view *v, double out[3])
{
    const struct calx_frame *f = calx_measure_frame(v->sim);
    double up[3];
    calx_measure_up(v->sim, up);
    out[0] = f ? calx_heap_height(f, up) : NAN;
    return true;
}

/* ---- the table ---- */

#define PARTICLE(name, unit, components, get, doc)                                                 \
    {                                                                                              \
        {name, unit, doc, 1, components}, get, NULL, 0                                             \
    }
#define WHOLE(name, unit, components, get, doc)                                                    \
    {                                                                                              \
        {name, unit, doc, 0, components}, NULL, get, 0                                             \
    }
#define LEDGER(name, unit, field, doc)                                                             \
    {                                                                                              \
        {name, unit, doc, 0, 1}, NULL, NULL,                                                       \
            1 + offsetof(struct calx_ledger, field) / sizeof(double)                               \
    }

static const struct calx_measure_row rows[] = {
    PARTICLE("position", "m", 3, position, "centre of a particle"),
    PARTICLE("velocity", "m/s", 3, velocity, "velocity of a particle"),
    PARTICLE("speed", "m/s", 1, speed, "size of the velocity of a particle"),
    PARTICLE("spin", "rad/s", 3, spin, "angular velocity of a particle"),
    PARTICLE("force", "N", 3, force, "sum of the contact forces on a particle"),
    PARTICLE("temperature", "K", 1, temperature, "temperature of a particle"),
    PARTICLE("heat-flow", "W", 1, heat_flow, "net heat flow into a particle"),
    PARTICLE("mass", "kg", 1, mass, "mass of a particle"),
    PARTICLE("radius", "m", 1, radius, "radius of a particle"),
    PARTICLE("coordination-number", "1", 1, coordination, "contacts of a particle"),
    WHOLE("time", "s", 1, time_now, "time of the run"),
    WHOLE("step", "1", 1, step, "steps made"),
    WHOLE("step-share", "1", 1, step_share,
          "time step over the longest stable one, of the contacts there are and those to be expected"),
    WHOLE("step-share-particle", "1", 1, step_share_particle,
          "the particle whose contacts set the longest stable step; -1: the stiffest contact to be expected"),
    WHOLE("solver-sweeps", "1", 1, solver_sweeps, "sweeps over the rigid contacts in the last step; 0 without any"),
    WHOLE("solver-residual", "1", 1, solver_residual, "what they left of the conditions, relative to the impulses"),
    WHOLE("count", "1", 1, count, "particles"),
    WHOLE("contacts", "1", 1, contacts, "touching pairs, walls included"),
    WHOLE("pair-contacts", "1", 1, pair_contacts, "touching pairs of particles"),
    WHOLE("max-overlap", "m", 1, max_overlap, "largest overlap of a contact"),
    WHOLE("max-overlap-relative", "1", 1, max_overlap_relative,
          "largest overlap of a contact over the smaller radius"),
    WHOLE("peak-force", "N", 1, peak_force,
          "the largest normal force in a contact since the start, between steps too; watching it "
          "about doubles the cost of a step"),
    WHOLE("peak-force-time", "s", 1, peak_force_time, "when that force was"),
    WHOLE("momentum", "kg m/s", 3, momentum, "total momentum"),
    WHOLE("wall-force", "N", 3, calx_measure_wall_force, "force of the grains on a wall"),
    WHOLE("wall-displacement", "m", 3, calx_measure_wall_displacement,
          "way of a wall, or a rigid group, since the start: of what was at the origin of space then"),
    WHOLE("wall-velocity", "m/s", 3, calx_measure_wall_velocity, "velocity of the same point"),
    WHOLE("wall-friction", "1", 3, calx_measure_wall_friction,
          "force of the grains along a wall over the force normal to it; the component is the axis normal to the wall"),
    WHOLE("wall-temperature", "K", 1, calx_measure_wall_temperature, "temperature of a wall; of the face of its slab, the mean"),
    WHOLE("slab-mean-temperature", "K", 1, calx_measure_slab_mean, "mean temperature of the slab behind a wall"),
    WHOLE("slab-max-temperature", "K", 1, calx_measure_slab_largest, "temperature of the hottest cell of the slab behind a wall"),
    WHOLE("layer-velocity", "m/s", 3, calx_measure_layer_velocity, "of a layer of a profile, in its last complete window"),
    WHOLE("layer-temperature", "K", 1, calx_measure_layer_temperature, "likewise"),
    WHOLE("layer-solid-fraction", "1", 1, calx_measure_layer_solid_fraction, "likewise"),
    WHOLE("layer-traction", "Pa", 3, calx_measure_layer_traction,
          "likewise: force over area across the planes of the layer, of contacts and fluctuations; positive in compression along the axis"),
    WHOLE("steady-drift", "1", 1, calx_measure_steady_drift,
          "of a signal that is watched, the column NAME_drift: the change from one half of its window to the other with its 95 % doubt, over the "
          "change that counts as none; steady where at most 1, NaN before the first window is complete"),
    WHOLE("steady-since", "s", 1, calx_measure_steady_since,
          "likewise, the column NAME_since: from when on it has been steady; NaN while it is not"),
    WHOLE("residual-relative", "1", 1, residual_relative,
          "imbalance of mechanical energy over the largest energy that took part"),
    WHOLE("heat-residual-relative", "1", 1, heat_residual_relative,
          "imbalance of heat over the largest heat that took part"),
    WHOLE("lacey-index", "1", 1, lacey_index,
          "mixing of two classes of grains: 0 apart, 1 at random; cells fixed in space, "
          "automatically of about 8 grains"),
    WHOLE("surface-slope-left", "degree", 1, slope_left,
          "slope of a 2D heap's surface left of its top"),
    WHOLE("surface-slope-right", "degree", 1, slope_right,
          "slope of a 2D heap's surface right of its top"),
    WHOLE("bed-height", "m", 1, bed_height,
          "from the lowest to the highest point of the grains, against gravity"),
    LEDGER("kinetic-energy", "J", kinetic, "kinetic energy"),
    LEDGER("rotational-energy", "J", rotational, "kinetic energy of rotation"),
    LEDGER("elastic-energy", "J", elastic, "energy stored in contacts"),
    LEDGER("potential-energy", "J", potential, "energy in the field of gravity"),
    LEDGER("dissipated", "J", dissipated, "mechanical energy dissipated since the start"),
    LEDGER("wall-work", "J", wall_work, "work of the walls on the grains since the start"),
    LEDGER("gravity-work", "J", gravity_work, "work of a gravity that changes, since the start"),
    LEDGER("residual", "J", residual, "imbalance of mechanical energy"),
    LEDGER("heat-content", "J", heat, "sum of mass, specific heat and temperature"),
    LEDGER("wall-heat", "J", wall_heat, "heat from the walls since the start"),
    LEDGER("heat-of-dissipation", "J", heat_of_dissipation,
           "heat from dissipated work since the start"),
    LEDGER("heat-residual", "J", heat_residual, "imbalance of heat"),
};

static const size_t row_count = sizeof rows / sizeof rows[0];

static const struct calx_column columns[] = {
    {"time", "time", "", false},
    {"step", "step", "", false},
    {"kinetic", "kinetic-energy", "", false},
    {"rotational", "rotational-energy", "", false},
    {"elastic", "elastic-energy", "", false},
    {"potential", "potential-energy", "", false},
    {"dissipated", "dissipated", "", false},
    {"wall_work", "wall-work", "", false},
    {"residual", "residual", "", false},
    {"residual_relative", "residual-relative", "", false},
    {"heat_content", "heat-content", "", true},
    {"wall_heat", "wall-heat", "", true},
    {"dissipation_heat", "heat-of-dissipation", "", true},
    {"heat_residual_relative", "heat-residual-relative", "", true},
    {"contacts", "contacts", "", false},
    {"coordination_number", "coordination-number", "mean", false},
    {"max_overlap_relative", "max-overlap-relative", "", false},
    {"step_share", "step-share", "", false},
    {"step_share_particle", "step-share-particle", "", false},
    {"temperature_min", "temperature", "min", true},
    {"temperature_mean", "temperature", "mean", true},
    {"temperature_max", "temperature", "max", true},
    {"particles", "count", "", false},
};

size_t calx_column_count(void)
{
    return sizeof columns / sizeof columns[0];
}

const struct calx_column *calx_column_at(size_t i)
{
    return &columns[i];
}

size_t calx_measure_count(void)
{
    return row_count;
}

const struct calx_measure *calx_measure_at(size_t i)
{
    return &rows[i].measure;
}

const struct calx_measure_row *calx_measure_row(const char *name)
{
    for (size_t i = 0; i < row_count; ++i)
        if (strcmp(rows[i].measure.name, name) == 0)
            return &rows[i];
    return NULL;
}

const struct calx_measure *calx_measure_find(const char *name)
{
    const struct calx_measure_row *row = calx_measure_row(name);
    return row ? &row->measure : NULL;
}

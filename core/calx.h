/* SPDX-License-Identifier: BSD-3-Clause
 *
 * libcalx: make a simulation from a scene, step it, look at it, save it. No global mutable state: several simulations can
 * live in one process. Not thread-safe per simulation.
 */
#ifndef CALX_CALX_H
#define CALX_CALX_H

#include <stdbool.h>
#include <stdio.h>

#include "core/error.h"
#include "core/loader.h"
#include "core/scene.h"

#define CALX_VERSION "0.1.0"

struct calx_sim;

/* Builds the plan and the state of the scene, which must outlive the simulation, with forces at t = 0.
 * threads: 0 for all cores. NULL with an error. */
struct calx_sim *calx_sim_create(const struct calx_scene *, struct calx_registry *, int threads, struct calx_error *);
void calx_sim_free(struct calx_sim *);

/* One step; a stage that has ended hands over to the next. Errors: CALX_ERROR_PHYSICS with time, particles, reason and remedy. */
int calx_sim_step(struct calx_sim *, struct calx_error *);

/* Up to `steps` steps that nobody looks at in between: the same bits as so many calls of calx_sim_step(), sooner. Stops before a step that
 * ends a stage or that a guard looks at, which are for calx_sim_step(): *made may be 0. */
int calx_sim_advance(struct calx_sim *, int64_t steps, int64_t *made, struct calx_error *);

/* All guards now, also those that a step makes only now and then: before a state is kept. CALX_ERROR_PHYSICS. */
int calx_sim_guard(struct calx_sim *, struct calx_error *);

bool calx_sim_done(const struct calx_sim *);    /* the last stage has ended */
double calx_sim_time(const struct calx_sim *);  /* s */
double calx_sim_end(const struct calx_sim *);   /* s, the latest end of the last stage; infinite if only a condition ends it */
int64_t calx_sim_step_count(const struct calx_sim *);
int64_t calx_sim_evaluation_count(const struct calx_sim *); /* of all forces, since the simulation was made: the work */
size_t calx_sim_particle_count(const struct calx_sim *);
size_t calx_sim_contact_count(const struct calx_sim *);
double calx_sim_dt(const struct calx_sim *);
/* The step over the longest stable one, of the contacts there are and of those to be expected; 0 if nothing limits it. *id (may be NULL):
 * the particle that sets it, -1 if it is the stiffest contact to be expected. NaN without memory. */
double calx_sim_step_share(struct calx_sim *, int64_t *id);
/* Sweeps that the solution of rigid contacts took in the last step, and the residual that it left; 0 and 0 without any. */
double calx_sim_solver(const struct calx_sim *, double *residual);
int calx_sim_stage(const struct calx_sim *);    /* index of the current stage */
bool calx_sim_stage_began(const struct calx_sim *); /* the step just made ended a stage */

/* A hash of the physical state (positions, velocities, spins, temperatures, history, in order of id): equal bits, equal hash. */
uint64_t calx_sim_hash(const struct calx_sim *);

/* What will be computed, what is left out and why, the critical step and which contact sets it, Biot number, memory. */
void calx_sim_describe(const struct calx_sim *, FILE *);

/* ---- the plan, as data (what exists in memory) ------------------------------------------------------- */

struct calx_features {
    bool motion, rotation, temperature, history, search, periodic, contacts, wall_contacts, heat_network, ledger;
    uint32_t dimension;
    size_t history_columns; /* doubles kept per touching pair */
    size_t bytes;           /* of all arrays of the state */
};
struct calx_features calx_sim_features(const struct calx_sim *);

/* ---- frames: a copy of the state in order of id, for output ----------------------------------------- */

/* Absent fields are NULL. Arrays are owned by the frame. */
struct calx_frame {
    double time;
    int64_t step;
    uint32_t dimension;
    size_t n;
    int64_t *id;
    double (*position)[3];
    double *radius;
    double (*velocity)[3];
    double (*spin)[3];
    double (*force)[3];      /* N, mass times acceleration without gravity: the sum of contact forces */
    double *temperature;
    double *heat;            /* W, net heat flow into the body */
    double *mass;
    int32_t *material;
    int32_t *contacts;       /* coordination number */
    int32_t *group;          /* number of the rigid group, -1: none; NULL without groups */
    /* contact network */
    size_t contact_count;
    int64_t (*pair)[2];            /* ids; a wall w is -1 - w */
    double (*pair_position)[2][3]; /* centre of i; centre of j or the point of the wall, of the same periodic image */
    double *normal_force, *tangential_force, *heat_flow, *overlap; /* N, N, W (into i), m */
    int32_t *status; /* 0 stick, 1 slip (friction fully mobilised), 2 cohesive: pulls (of non-smooth laws) */
    /* walls: primitives at their present pose; arcs of circles, cylinders and spheres as flat pieces */
    size_t wall_points, wall_cells;
    double (*wall_position)[3];
    int32_t (*wall_cell)[4];  /* point indices; lines use 2, the rest -1 */
    int32_t *wall_of_cell;    /* wall index */
    double (*wall_velocity)[3]; /* per point, m/s */
    double *wall_temperature; /* per cell, K; NaN if insulated; NULL without temperature */
    double (*wall_force)[3];  /* per cell: the force of the grains on its wall, N */
    bool walls_changed;       /* since the frame before */
    /* per wall of the scene, groups included: the same numbers once more */
    size_t walls;
    double (*force_on_wall)[3];
    double (*displacement_of_wall)[3], (*velocity_of_wall)[3]; /* m since the start, m/s; of what was at the origin of space then */
    double *temperature_of_wall;
};

/* Whether body i is a grain: bodies of rigid groups serve as walls. */
static inline bool calx_frame_is_grain(const struct calx_frame *f, size_t i)
{
    return !f->group || f->group[i] < 0;
}

/* with_contacts: fill the contact network too. NULL without memory. */
struct calx_frame *calx_frame_create(struct calx_sim *, bool with_contacts);
void calx_frame_free(struct calx_frame *);

/* ---- quantities --------------------------------------------------------------------------------------- */

/* The energies of the ledger, J. residual = (kinetic + elastic + potential + dissipated) - initial - work of walls; heat_residual =
 * heat - initial heat - wall heat - heat of dissipation. `scale`: the largest energy that took part. */
struct calx_ledger {
    double kinetic, rotational, elastic, potential, dissipated, wall_work, gravity_work, residual, scale;
    double heat, wall_heat, heat_of_dissipation, heat_residual, heat_scale;
    double momentum[3];
};
struct calx_ledger calx_sim_ledger(struct calx_sim *);

/* Every quantity by name that probes, expectations, stage conditions and the CSV may use; unit as UDUNITS-2 text. */
struct calx_measure {
    const char *name, *unit, *doc;
    int per_particle; /* 1: a particle or a reduction must be chosen; components: 3 */
    int components;
};
size_t calx_measure_count(void);
const struct calx_measure *calx_measure_at(size_t);
const struct calx_measure *calx_measure_find(const char *name);

/* The present value of a probe (a quantity with its choices). NaN if it does not exist in this scene. */
double calx_sim_measure(struct calx_sim *, const struct calx_probe *);

/* The largest normal force in a contact since it is watched, N, and when it was, s. */
struct calx_peak {
    bool watched;
    double force, time;
    struct calx_peak_sample { double time, force; int64_t id[2]; } last[3]; /* the largest after each of the last three steps; a wall is -1 - w */
};
/* Watches it from now on, at about twice the cost of a step; a scene that names it (a probe, an expectation, a solution) does from its start. */
void calx_sim_watch_peak(struct calx_sim *);
const struct calx_peak *calx_sim_peak(const struct calx_sim *);
double calx_sim_peak_seconds(const struct calx_sim *); /* s of the clock that watching took */

/* ---- profiles ----------------------------------------------------------------------------------------- */

/* Means over a window in one layer: of a velocity, a temperature, a coordination number weighted by the volume of each body's slice in the
 * layer (NaN if no body reaches into it), of forces and momentum over the volume of the layer. Stress is positive in compression; the first
 * index is that of the force, the second that of the direction across which it acts. */
struct calx_layer {
    double position;          /* m, of its middle */
    double solid_fraction;
    double velocity[3];       /* m/s */
    double fluctuation[3];    /* m/s, root mean square about that velocity */
    double temperature;       /* K; NaN in a scene without */
    double coordination;
    double contact_stress[9]; /* Pa, sum of f_a l_b of contacts, shared out along the branch l */
    double kinetic_stress[9]; /* Pa, sum of m v_a v_b about the layer's mean momentum */
};

/* The last window that is complete. */
struct calx_profile_view {
    int64_t windows;    /* complete so far */
    double end;         /* s: when the last of them ended; minus infinity if there is none */
    const struct calx_layer *layers; /* of scene.profiles[k], lowest first; valid until the next step */
};
struct calx_profile_view calx_sim_profile(const struct calx_sim *, size_t profile);

/* ---- what is watched until it is stationary ------------------------------------------------------------ */

/* The last window of blocks, of the layer that is farthest from steady if it is of layers: see calx_steady_verdict in core/steady.h. NaN before
 * the first window is complete, and where the signal is not a number. */
struct calx_steady_view {
    double mean, error, change, doubt, drift;
    double since; /* s: where the first of the windows began that all, until now, were steady; NaN if the last is not */
    size_t layer; /* from 0 */
};
const struct calx_steady_view *calx_sim_steady(const struct calx_sim *, size_t watch);

/* ---- meshes: cells with numbers in them, for output -------------------------------------------------- */

struct calx_mesh_array {
    const char *name, *unit; /* unit NULL: pure numbers */
    size_t components;
    double *value; /* per cell; owned by the mesh */
};

/* Quadrilaterals (corners 4, in order around) or hexahedra (corners 8: one side in order around, then the other). */
struct calx_mesh {
    double time;
    size_t points, cells, corners;
    double (*position)[3];
    int64_t *corner; /* points of each cell */
    size_t array_count;
    struct calx_mesh_array arrays[8];
};
/* With room for points and cells, zeroed; no arrays yet. NULL without memory. */
struct calx_mesh *calx_mesh_create(size_t points, size_t cells, size_t corners);
/* Room for an array, zeroed, owned by the mesh; NULL without memory. name and unit must outlive the mesh. */
double *calx_mesh_add(struct calx_mesh *, const char *name, const char *unit, size_t components);
void calx_mesh_free(struct calx_mesh *);

/* The slab behind a wall that has one, at its present pose, with the temperature of its cells: quadrilaterals, in 3D hexahedra. NULL without
 * memory. */
struct calx_mesh *calx_sim_slab_mesh(const struct calx_sim *, int wall);
/* K, the mean or the largest of its cells; NaN if there is no slab. */
double calx_sim_slab_temperature(const struct calx_sim *, int wall, bool largest);

/* ---- where the time goes ------------------------------------------------------------------------------ */

enum calx_phase {
    CALX_PHASE_SORT, CALX_PHASE_NEIGHBOURS, CALX_PHASE_GHOSTS, CALX_PHASE_SELECT, CALX_PHASE_GATHER,
    CALX_PHASE_LAWS, CALX_PHASE_CONDUCTANCE, CALX_PHASE_SCATTER, CALX_PHASE_WALLS,
    CALX_PHASE_INTEGRATE, CALX_PHASE_HEAT, CALX_PHASE_OTHER, CALX_PHASE_COUNT
};

/* Seconds per phase, summed over threads, since calx_sim_timing_start(); timing costs a few per cent of a step. */
struct calx_timing {
    double seconds[CALX_PHASE_COUNT];
    double law_seconds[8];       /* of each contact law, in the order of the plan; part of CALX_PHASE_LAWS */
    const char *law[8];
    int64_t steps, rebuilds;
    size_t pairs, contacts, bytes; /* now */
    double skin;                 /* m */
    const char *kernels;         /* instruction set */
    int threads;
};
int calx_sim_timing_start(struct calx_sim *); /* 0, or 1 without memory */
struct calx_timing calx_sim_timing(const struct calx_sim *);
const char *calx_phase_name(enum calx_phase);

/* ---- restart ------------------------------------------------------------------------------------------ */

/* The whole state as named blocks of bytes, pointers valid until the next call on sim. The file format is io/restart.c. */
struct calx_block {
    char name[32];
    const void *data;
    size_t bytes;
};
int calx_sim_save(struct calx_sim *, struct calx_block **blocks, size_t *count, struct calx_error *); /* free(*blocks) */
/* Replaces the state of a simulation made from the same scene. On error the simulation must be freed. */
int calx_sim_restore(struct calx_sim *, const struct calx_block *blocks, size_t count, struct calx_error *);

#endif

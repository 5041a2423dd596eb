/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the plan (what is computed), the state (arrays), the simulation.
 *
 * Particles live in rows, cut into blocks of consecutive rows along a space-filling order. A block owns `own` rows and after
 * them keeps `ghosts`: copies of particles of later blocks, or of periodic images, that its pairs touch. A pair belongs
 * to the block that owns its particle of lower order, so blocks are independent while forces are computed: each adds into
 * its own rows and its ghosts' rows, and a block then collects what earlier blocks left on their copies of its particles, in block
 * order. Blocks depend on the scene only, never on the number of threads: the bits do not either.
 */
#ifndef CALX_STATE_H
#define CALX_STATE_H

#include "core/calx.h"
#include "core/measure.h"

enum {
    CALX_BLOCK = 1024,        /* own rows per block */
    CALX_LAWS_MAX = 8,       /* contact laws in one stack */
    CALX_HISTORY_MAX = 24,   /* history columns of one stack */
    CALX_EXTRA_MAX = 8,
    CALX_SELDOM = 256        /* steps between the dearer guards */
};

/* ---- plan --------------------------------------------------------------------------------------------- */

struct calx_law {
    const struct calx_plugin *plugin;
    const struct calx_contact_law *law;
    char *params;            /* one struct per pair type, params_size apart */
    size_t first_history;    /* column */
    struct calx_demand demand; /* the union over pair types */
    struct calx_demand *own;   /* per pair type: its scalars come after the vectors of the union, whatever it keeps of them */
};

/* The plan of one set of models. */
struct calx_plan {
    const struct calx_models *models;
    size_t law_count;
    struct calx_law laws[CALX_LAWS_MAX];
    const struct calx_plugin *conductance;
    char *conductance_params;
    struct calx_demand conductance_demand;
    const struct calx_plugin *motion;
    const struct calx_motion_integrator *motion_law;
    void *motion_params;
    const struct calx_plugin *heat;
    const struct calx_temperature_integrator *heat_law;
    void *heat_params;
    uint32_t needs;           /* union of enum calx_need */
    size_t history;           /* columns */
    size_t history_stride;    /* doubles per pair: the columns, and at least a row of four if more than one */
    uint8_t history_is_vector[CALX_HISTORY_MAX]; /* 1 at the first column of a vector */
    double gap;
    double dt;
    double critical_dt;       /* s; infinite without contact laws */
    char critical_text[256];  /* which contact sets it */
    int64_t heat_every;       /* steps of motion per heat step */
    double heat_dt;
    bool cohesion;            /* the Coulomb limit differs from fn */
    bool global_heat;
};

/* ---- state -------------------------------------------------------------------------------------------- */

struct calx_group {      /* pairs of one block and one pair type */
    size_t first, count, close; /* close: those that touched when the list was built, which come first */
    int32_t type;
};

struct calx_row_block {
    int32_t first, own, ghosts;
    size_t group_first, group_count;
    size_t collect_first, collect_count; /* contributions from earlier blocks' ghosts */
    size_t earliest;                     /* the first block that contributes, or the block itself */
    size_t near_first, near_count;       /* particle-wall candidates */
    size_t wall_count, wall_next;        /* wall contacts alive, in wall_contacts[near_first...]; of the evaluation under way */
};

struct calx_wall_contact {
    int32_t row, surface;
};

/* The wall's pose and speed now. x = turn*(x0) + shift. */
struct calx_pose {
    double turn[9], shift[3];
    double speed[3];  /* m/s at the origin of space */
    double spin[3];   /* rad/s */
    double ago, past_speed[3], past_spin[3]; /* the same velocity_lag*dt = ago (s) before: what the laws see */
};

struct calx_posed { /* a primitive in its present place */
    struct calx_primitive p;
    int32_t wall;
};

/* What one block found in one step; summed in block order. */
struct calx_tally {
    int64_t contacts, wall_contacts;
    double work, wall_power, wall_heat, wall_heat_lost; /* J, W, W, J: dissipation that heats the wall */
    double overlap;                     /* largest overlap relative to the smaller radius */
    int32_t overlap_rows[2];            /* whose; -1 - wall for a wall */
    double finite;                      /* 0, or NaN if a state is not finite */
    double speed2;                      /* m2/s2, largest, if the block went ahead */
    size_t edges, boundaries;
    double energy;            /* J, elastic; when asked for */
};

struct calx_rows_arrays {
    size_t rows;              /* own and ghosts of all blocks */
    size_t stride;            /* doubles per row of v and a: 4, or 8 with spin or temperature */
    double *x;                /* {x, y, z, R} */
    double *v;                /* {vx, vy, vz, 1/m [, wx, wy, wz, T]} */
    double *a;                /* {Fx, Fy, Fz, 0 [, torque, heat]}; accelerations once integrated */
    double *extra[2 * CALX_EXTRA_MAX]; /* of the integrator: translation, then rotation */
    int64_t *id;
    int32_t *material;
    double *inverse_capacity; /* K/J; NULL without temperature */
    double *heat_store;       /* J, dissipation waiting for the next heat step; NULL if each step is one */
    int32_t (*image)[3];      /* NULL if not periodic */
    int32_t *source;          /* ghosts: the row they copy */
    uint8_t *shift;           /* ghosts: (sx+1) + 3*(sy+1) + 9*(sz+1) */
};

struct calx_pairs {
    size_t count;
    int32_t *i, *j;      /* rows within the block */
    uint8_t *touching;   /* at the last evaluation */
    double *history;     /* history_stride doubles per pair */
};

struct calx_sim {
    const struct calx_scene *scene;
    struct calx_registry *registry;
    int threads;
    int team;                    /* threads that have blocks to work on */
    size_t plan_count;
    struct calx_plan *plans;    /* one per set of models */
    const struct calx_plan *plan;
    struct calx_features features;
    const struct calx_engine *engine;

    uint8_t *material_used;     /* per material: 1 by particles, 2 by walls */

    /* time */
    double time, stage_start, dt_now;
    double held;                /* s: for how long the stage's condition holds */
    int64_t step, stage_step;
    int64_t evaluations;        /* of forces, since the simulation was made */
    int stage;
    bool done, stage_began;
    bool ahead;                 /* the kernels before the next evaluation have run: only inside calx_sim_advance */

    /* particles */
    size_t n;
    struct calx_rows_arrays r;
    struct calx_pairs pairs;
    size_t block_count, group_count;
    struct calx_row_block *blocks;
    struct calx_group *groups;
    int32_t *collect_to, *collect_from;
    struct calx_tally *tallies;
    double speed;              /* m/s, the largest of the last step */
    double skin, drift;        /* m: skin, displacement since the list was built (upper bound) */
    double wall_drift, wall_step; /* m: wall_step: the farthest that a wall came in the last step, */
    int wall_fastest;             /* and which */
    bool skin_tuned;           /* the case does not fix it */
    double skin_least, skin_most;
    int64_t built_step;        /* when the list was built */
    double clearance;          /* m: nobody is nearer to the border of a bounded domain */
    double radius_min, radius_max;
    int64_t rebuilds;
    bool built;
    double gravity[3];

    /* walls */
    size_t primitive_count;
    struct calx_posed *posed;
    struct calx_pose *poses, *stage_poses;
    double *wall_angle;         /* rad since the stage began */
    double (*wall_shift)[3];    /* m since the stage began */
    double *wall_temperature;   /* K now; NULL without temperature */
    double wall_reach;          /* m: no grain is farther from anything */
    int32_t *near_row, *near_primitive;
    size_t near_count;
    struct calx_wall_contact *wall_contacts, *wall_contacts_next;
    double *wall_history, *wall_history_next;
    double (*wall_force)[3];    /* N on each wall, of the last force evaluation; by block then summed */
    double (*block_wall_force)[3];
    bool walls_changed;

    /* heat network, for global integrators of temperature */
    size_t edge_capacity, boundary_capacity;
    int32_t *edge_i, *edge_j, *boundary_i;
    double *edge_h, *boundary_h, *boundary_t;

    /* ledger */
    long double dissipated, wall_work, outside_work; /* J; outside: gravity and models that change */
    long double wall_heat, dissipation_heat;         /* J */
    double wall_power;                               /* W, at the last force evaluation */
    long double energy0, heat0;
    double potential0, scale, heat_scale;

    /* timing; NULL while it is off */
    struct calx_clock *clocks;
    struct calx_timing_from { double seconds; uint64_t tick; int64_t step, rebuilds; } timing_from;

    /* scratch, one per thread */
    struct calx_columns **columns;

    /* probes */
    uint8_t **classes;          /* per probe, by id; NULL if the probe has none */
    struct calx_measure_cache measure;
    void *saved; /* scalars of the last calx_sim_save */
};

/* Kernels compiled once per instruction set (contacts.c). */
struct calx_columns;

/* Who looks at contacts: lane of the columns, row of body i, row of body j or -1 - wall. */
struct calx_sink {
    void *context;
    void (*take)(void *context, const struct calx_columns *, size_t lane, int32_t row_i, int32_t row_j);
};

struct calx_engine {
    void (*block_forces)(struct calx_sim *, size_t block, double dt, bool conduct);
    void (*block_energy)(struct calx_sim *, size_t block, double *energy);
    /* The stage's kernels before the evaluation; returns the square of the largest speed. */
    double (*block_before)(struct calx_sim *, size_t block, size_t stage);
    /* Of one block, once every block that adds to it has its forces: ghosts' forces to their particles, forces to accelerations, the
     * stage's kernel after the evaluation (stage < 0: none) and, if nobody looks at the state in between, the next step's before. */
    void (*block_finish)(struct calx_sim *, size_t block, int stage, bool ahead);
    /* Shows each touching contact with its present forces; changes nothing. */
    void (*block_network)(struct calx_sim *, size_t block, const struct calx_sink *);
};
/* engine.c: the best copy for this processor. name may be NULL. */
const struct calx_engine *calx_engine_pick(const char **name);

/* ---- the parts, in the order of the data flow ---------------------------------------------------------- */

/* memory.c: zeroed, aligned to 64 bytes; NULL without memory. */
void *calx_memory_zeroed(size_t count, size_t size);

/* plan.c */
int calx_plan_create(struct calx_sim *, struct calx_error *);
void calx_plan_free(struct calx_sim *);
static inline size_t calx_plan_pair_type(size_t materials, size_t a, size_t b)
{
    return a <= b ? a * materials + b : b * materials + a;
}
double calx_plan_material_value(const struct calx_scene *, size_t material, const char *name);

/* critical.c: the largest stable step of a plan, from the stiffest pair of bodies. */
int calx_critical_step(struct calx_sim *, struct calx_plan *, struct calx_error *);

/* particles.c: mass, moment of inertia and heat capacity of a body. */
double calx_particle_mass(const struct calx_scene *, double radius, double density);
double calx_particle_inertia_factor(const struct calx_scene *); /* I = factor m R^2 */
int calx_particles_create(struct calx_sim *, struct calx_error *);

/* neighbours.c: sort, lists, ghosts, blocks; keeps history. Fails if a body left the domain. */
int calx_neighbours_build(struct calx_sim *, struct calx_error *);
void calx_neighbours_team(struct calx_sim *); /* how many threads have blocks to work on */
bool calx_neighbours_stale(const struct calx_sim *);

/* skin.c: the first width, and a better one at each rebuild. Choosing fails if a periodic length is too short. */
int calx_skin_choose(struct calx_sim *, struct calx_error *);
void calx_skin_tune(struct calx_sim *);

/* walls.c, surface.c */
int calx_walls_create(struct calx_sim *, struct calx_error *);
void calx_walls_begin_stage(struct calx_sim *);
void calx_walls_move(struct calx_sim *, double t, double dt);
void calx_walls_velocity(const struct calx_sim *, int wall, const double at[3], double out[3]);
/* At the moment that the velocities of the grains belong to, of what was then under the grain that now touches `at` and moves with `carried`. */
void calx_walls_past_velocity(const struct calx_sim *, int wall, const double at[3], const double carried[3],
                              double out[3]);
struct calx_touch { double distance, normal[3], point[3]; bool end; };
void calx_surface_nearest(const struct calx_primitive *, uint32_t dimension, const double x[3], struct calx_touch *);

/* heat.c */
int calx_heat_step(struct calx_sim *, struct calx_error *); /* after the forces of step s->stage_step */
int calx_heat_check(struct calx_sim *, struct calx_error *); /* fails if the heat step is unstable: max sum H/C, Gershgorin */

/* ledger.c */
void calx_ledger_begin(struct calx_sim *);
void calx_ledger_step(struct calx_sim *, double dt);
double calx_ledger_mechanical(struct calx_sim *); /* kinetic + rotational + elastic + potential now, J */

/* guard.c */
int calx_guard_step(struct calx_sim *, struct calx_error *);
int calx_guard_left(const struct calx_sim *, int32_t row, int axis, struct calx_error *);

/* step.c */
/* All forces at the present positions, then accelerations and the stage's kernel after (stage < 0: none). dt: of the step that ends
 * here, 0 if none does. */
int calx_step_forces(struct calx_sim *, double dt, bool conduct, int stage, bool ahead, struct calx_error *);
int calx_step_begin_stage(struct calx_sim *, int stage, struct calx_error *);

/* rows.c: the id of the body of a row, own or ghost. */
int64_t calx_row_id(const struct calx_sim *, int32_t row);

/* The row a frame or message calls particle `id`. */
static inline double *calx_row_x(const struct calx_sim *s, int32_t row) { return s->r.x + 4 * (size_t)row; }
static inline double *calx_row_v(const struct calx_sim *s, int32_t row) { return s->r.v + s->r.stride * (size_t)row; }
static inline double *calx_row_a(const struct calx_sim *s, int32_t row) { return s->r.a + s->r.stride * (size_t)row; }

#endif

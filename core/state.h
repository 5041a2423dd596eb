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
#include "core/pairs.h"

enum {
    CALX_BLOCK = 2048,       /* own rows per block: fewer make more ghosts, more leave the cache */
    CALX_LAWS_MAX = 8,       /* contact laws in one stack */
    CALX_HISTORY_MAX = 24,   /* history columns of one stack */
    CALX_EXTRA_MAX = 8,
    CALX_SELDOM = 256        /* steps between the dearer guards */
};

/* Of the skin: a pair with a smaller gap counts as close when the list is built, or as one that may touch soon until bodies may have
 * approached by that much. */
#define CALX_CLOSE_SHARE 0.02
#define CALX_INNER_SHARE 0.125
#define CALX_OVERLAP_BOUND 0.5 /* of the smaller radius: beyond it a run stops */

/* ---- plan --------------------------------------------------------------------------------------------- */

struct calx_law {
    const struct calx_plugin *plugin;
    const struct calx_model *model;
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
    const struct calx_motion_integrator *motion_law; /* NULL, or motion_actual: the plugin's law for these parameters */
    struct calx_motion_integrator motion_actual;
    const struct calx_model *motion_model;
    void *motion_params;
    bool uses_velocity;       /* a contact law's forces depend on velocities */
    const struct calx_plugin *heat;
    const struct calx_temperature_integrator *heat_law;
    void *heat_params;
    uint32_t needs;           /* union of enum calx_need */
    size_t history;           /* columns */
    uint8_t history_is_vector[CALX_HISTORY_MAX]; /* 1 at the first column of a vector */
    double gap;
    double dt;
    double critical_dt;       /* s; infinite without contact laws */
    double shortest;          /* s: half a period of the stiffest single contact to be expected */
    char critical_text[256];  /* which contact sets it */
    int64_t heat_every;       /* steps of motion per heat step, at dt */
    double heat_dt;
    bool adapts;              /* dt is the longest that is taken: the step follows the contacts */
    bool resolves;            /* onset and end of contacts inside a step (onset.c): */
    size_t normal, owed, past; /* the last normal law; columns of history: the force owed to a contact, and what is kept of its velocity */
    bool cohesion;            /* the Coulomb limit differs from fn */
    bool nonsmooth;           /* the laws say conditions, and the integrator solves for impulses: */
    size_t impulse;           /* first column of history: the tangential impulse of the last step, then the normal one */
    bool global_heat;
};

/* ---- state -------------------------------------------------------------------------------------------- */

/* Pairs of one block and one pair type, all within reach until the next rebuild. Those that touch, or nearly, are evaluated; the others are
 * apart, the first `soon` of them to be looked at in every step. */
struct calx_group {
    size_t first, room, count; /* evaluated: places first..first+count of first..first+room; both multiples of 8 */
    size_t apart_first, apart_count, soon;
    int32_t type;
};

struct calx_row_block {
    int32_t first, own, ghosts;
    size_t group_first, group_count;
    size_t collect_first, collect_count; /* contributions from earlier blocks' ghosts */
    size_t adder_first, adder_count;     /* the earlier blocks that contribute */
    size_t near_first, near_count;       /* particle-wall candidates */
    size_t carried_first, carried_count; /* bodies that walls carry, in order of rows */
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

/* The one degree of freedom of a wall whose motion has `free` (plates.c), at the last evaluation of forces that was kept. Whoever wants
 * to solve for plates and contacts together finds here all that there is: mass and axis are in struct calx_motion of the stage. */
struct calx_plate {
    double time;          /* s: of that evaluation */
    double shift, speed;  /* m since the stage began; m/s, along the axis */
    double risen;         /* m: by how much before this stage, while it was free: shift + risen is against gravity */
    double contact, load; /* N along the axis: of the grains; given */
    double acceleration;  /* m/s2 */
    double power;         /* W: of the grains' force, with the speed that the contacts saw */
};

struct calx_carried { /* a body that a wall carries */
    int32_t row, wall;
};

struct calx_posed { /* a primitive in its present place */
    struct calx_primitive p;
    int32_t wall;
};

/* Sums over the samples of a window in one layer, see profile.c. */
struct calx_layer_sums {
    double volume, velocity[3], square[3], temperature, contacts; /* weighted by the volume of slices */
    double mass, momentum[3], flux[9], contact[9];
};

struct calx_profile_clock {
    int64_t taken;            /* multiples of the interval so far */
    int64_t samples, windows; /* in this window; complete ones */
    double end;               /* s, of the last window */
};

struct calx_steady_clock {
    int64_t taken, blocks;    /* samples so far; complete blocks */
    struct calx_steady_view view;
};

/* What the contacts of one block do to a cell of a slab's face. */
struct calx_face {
    double flow, conductance; /* W into the slab, W/K: when heat conducts */
    double lost;              /* J: dissipation that heats the slab, since the last evaluation */
};

/* What one block found in one step; summed in block order. */
struct calx_tally {
    int64_t contacts, wall_contacts;
    double work, wall_power, wall_heat, wall_heat_lost; /* J, W, W, J: dissipation that heats the wall */
    double overlap;                     /* largest overlap relative to the smaller radius */
    int32_t overlap_rows[2];            /* whose; -1 - wall for a wall */
    double finite;                      /* 0, or NaN if a state is not finite */
    double speed2;                      /* m2/s2, largest, if the block went ahead */
    double moved2;                      /* m2, largest displacement by the kernel after the evaluation */
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
    double *inverse_capacity; /* K/J; 0 if the temperature is given; NULL without temperature */
    double *heat_store;       /* J, dissipation waiting for the next heat step; NULL if each step is one */
    int32_t (*image)[3];      /* NULL if not periodic */
    int32_t *source;          /* ghosts: the row they copy */
    uint8_t *shift;           /* ghosts: (sx+1) + 3*(sy+1) + 9*(sz+1) */
};

struct calx_pairs {
    size_t reach;                /* pairs in reach: evaluated and apart */
    size_t places, apart;        /* room for them in all groups */
    uint32_t *i, *j;             /* of evaluated pairs: places of rows within the block, see calx_place_row(); 0, 0 beyond count */
    uint8_t *touching;           /* at the last evaluation: a bit per place */
    double *history;             /* see calx_group_history() */
    uint32_t *apart_i, *apart_j;
};

struct calx_sim {
    const struct calx_scene *scene;
    struct calx_registry *registry;
    int threads;
    int team;                    /* threads that have blocks to work on */
    size_t *share;               /* per thread: where its blocks begin in `order`; one more for the end */
    size_t *left;                /* per thread: how many of its blocks still wait in a sweep */
    int32_t *order;              /* blocks */
    int32_t *adders, *waiting;   /* blocks: by adder_first; scratch of a sweep, by share */
    int64_t *passed, pass_number; /* per block: the last evaluation that has its forces; atomic. The number of this one */
    size_t plan_count;
    struct calx_plan *plans;    /* one per set of models */
    const struct calx_plan *plan;
    struct calx_features features;
    const struct calx_engine *engine;

    uint8_t *material_used;     /* per material: 1 by particles, 2 by walls */

    /* time */
    double time, stage_start, dt_now;
    double rows_dt;             /* s: the step that integrator kernels see */
    double evaluated;           /* s: the time of the evaluation under way, where walls are */
    double lag;                 /* s: of the evaluation under way, velocities are those of so long before; 0 in between */
    bool trial;                 /* the evaluation under way leaves history and books as they are; false in between */
    double memory[CALX_MEMORY]; /* of a global integrator */
    double dt, heat_dt;         /* s, the steps now */
    double heat_interval;       /* s: over which the evaluation under way spreads what is dissipated: the heat step that it ends, or its own */
    int64_t heat_every;
    double pace_time;           /* s: when steps of this length began, */
    int64_t pace_step;          /* and the step of the stage then */
    int64_t pace_level;         /* on the ladder of steps, 0: the plan's */
    int64_t pace_due;           /* step after which the step must be chosen again, -1: none */
    double pace_overlap;        /* of the smaller radius: the deepest when it was chosen */
    double checked;             /* s: when the stage's condition was looked at */
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
    double speed;              /* m/s, the largest of the last step: of a velocity, or a displacement in one stage over dt */
    double moved;              /* m: nobody has come farther in the last step */
    double skin, drift;        /* m: skin, displacement since the list was built (upper bound) */
    double sifted;             /* m: the drift when pairs that are apart were last sorted out */
    bool roomy;                /* the lists that are being built get room for every pair in reach */
    double wall_drift, wall_step; /* m: wall_step: the farthest that a wall came in the last step, */
    int wall_fastest;             /* and which */
    bool skin_tuned;           /* the case does not fix it */
    double skin_least, skin_most;
    int64_t built_step;        /* when the list was built */
    double clearance;          /* m: nobody is nearer to the border of a bounded domain */
    double radius_min, radius_max;
    bool some_fixed;            /* there are bodies that contacts do not move */
    int64_t rebuilds;
    bool built;
    double gravity[3];

    /* walls */
    size_t primitive_count;
    struct calx_posed *posed;
    struct calx_pose *poses, *stage_poses;
    double *wall_angle;         /* rad since the stage began */
    double (*wall_shift)[3];    /* m since the stage began */
    struct calx_plate *plates;  /* per wall */
    double *wall_temperature;   /* K now; NULL without temperature */
    double wall_reach;          /* m: no grain is farther from anything */
    int32_t *near_row, *near_primitive;
    size_t near_count;
    struct calx_wall_contact *wall_contacts, *wall_contacts_next;
    double *wall_history, *wall_history_next;
    double (*wall_force)[3];    /* N on each wall, of the last force evaluation; by block then summed */
    double (*block_wall_force)[3];
    bool walls_changed;
    size_t slab_cells, slab_faces; /* of all slabs, in the order of walls */
    size_t *slab_cell, *slab_face; /* per wall: its first */
    double *slab_temperature;      /* K */
    double *slab_heat;             /* J per cell of a face: waits for the next heat step */
    struct calx_face *block_faces; /* by block */
    size_t carried_count;
    struct calx_carried *carried; /* made anew whenever rows change places */

    struct calx_store *store;     /* contacts of non-smooth laws, NULL before the first */
    bool delivering;              /* the evaluation under way takes their impulses from there */
    double sweeps, residual;      /* of the last solution */

    /* heat network, for global integrators of temperature */
    size_t edge_capacity, boundary_capacity;
    int32_t *edge_i, *edge_j, *boundary_i, *boundary_wall;
    double *edge_h, *boundary_h, *boundary_t, (*boundary_at)[3]; /* at: the point on the wall */

    /* ledger */
    long double dissipated, wall_work, outside_work; /* J; outside: gravity and models that change */
    long double wall_heat, dissipation_heat;         /* J */
    double wall_power;                               /* W, at the last force evaluation */
    long double energy0, heat0;
    double potential0, scale, heat_scale;

    /* guards */
    double coldest, hottest;    /* K: of the start, and of the walls since then */
    double overlap_seen;        /* of the smaller radius: the deepest when contacts were last looked at */
    double trusted;             /* the limit of the contacts over its quick bound, as the iterations found it, less a margin; 0: not made */
    int64_t contacts_seen;      /* and how many there were */
    int64_t look_from;          /* the step from which new contacts are a reason to look again */
    int64_t look_due;           /* and that from which the next look is due without one */

    struct calx_peak peak;      /* the largest force (peak.c) */
    double peak_seconds;        /* that looking for it took */

    /* timing; NULL while it is off */
    struct calx_clock *clocks;
    struct calx_timing_from { double seconds; uint64_t tick; int64_t step, rebuilds; } timing_from;

    /* scratch, one per thread */
    struct calx_columns **columns; /* two each: the batch, and what onset.c tries */
    double **forces;             /* rows of accelerations of the block under way, when they need not be kept */

    /* probes */
    uint8_t **classes;          /* per probe, by id; NULL if the probe has none */
    struct calx_measure_cache measure;

    /* profiles; layers of all of them, one profile after the other */
    struct calx_profile_clock *profile_clocks;
    struct calx_layer_sums *layer_sums;
    struct calx_layer *layers;

    /* signals that are watched */
    struct calx_steady_clock *steady_clocks;
    double *steady_numbers; /* see steady.c */
    void *saved; /* scalars of the last calx_sim_save */
};

/* Kernels compiled once per instruction set (contacts.c). */
struct calx_columns;

typedef double calx_rows_measure(const void *params, const struct calx_rows *);

/* Impulses of all contacts, N s, and the work they dissipate, J. */
struct calx_solution {
    const double *impulse[4]; /* tangential, normal */
    const double *work;
};

/* Who looks at contacts: lane of the columns, row of body i, row of body j or -1 - wall. */
struct calx_sink {
    void *context;
    void (*take)(void *context, const struct calx_columns *, size_t lane, int32_t row_i, int32_t row_j);
};

/* One force evaluation and what follows it. */
struct calx_pass {
    double dt;    /* s: since the last evaluation that was kept, 0 for a mere look */
    bool conduct;
    bool heats;   /* a heat step follows, with or without conduction */
    int stage;    /* entry of the integrator's tables whose kernel comes after; < 0: none */
    bool ahead;   /* nobody looks before the next step: its kernel before comes as well */
    bool warm;    /* the staged integrator of temperature makes its step */
    bool store;   /* heat of dissipation waits for that step */
};

struct calx_engine {
    /* a: rows of accelerations of the block, ghosts included, to be filled with forces, couples and heat flows. */
    void (*block_forces)(struct calx_sim *, size_t block, const struct calx_pass *, double *a);
    /* Sorts out which pairs may touch before bodies have approached by `inner` (m); false if a group has no room for them. */
    bool (*block_sift)(struct calx_sim *, size_t block, double inner);
    void (*block_energy)(struct calx_sim *, size_t block, double *energy);
    /* The stage's kernels before the evaluation; returns the square of the largest speed, or displacement over dt. */
    double (*block_before)(struct calx_sim *, size_t block, size_t stage);
    /* Of one block, once every block that adds to it has its forces (in a): ghosts' forces to their particles, forces to accelerations,
     * the kernels that follow. */
    void (*block_finish)(struct calx_sim *, size_t block, const struct calx_pass *, double *a);
    /* Any kernels; returns the square of the largest displacement. */
    double (*block_kernels)(struct calx_sim *, size_t block, size_t stage, const void *params, calx_rows_kernel *translation,
                            calx_rows_kernel *rotation);
    /* The larger of what the two say of the block's rows; NaN if one does. */
    double (*block_measure)(struct calx_sim *, size_t block, const void *params, calx_rows_measure *translation,
                            calx_rows_measure *rotation);
    calx_pairs_finder *find_pairs;
    /* Shows each touching contact with its present forces; changes nothing. */
    void (*block_network)(struct calx_sim *, size_t block, const struct calx_sink *);
    /* The same as a trial: pairs that have come into reach are among them. */
    void (*block_collect)(struct calx_sim *, size_t block, const struct calx_sink *);
};
/* engine.c: the best copy for this processor. name may be NULL. */
const struct calx_engine *calx_engine_pick(const char **name);

/* ---- the parts, in the order of the data flow ---------------------------------------------------------- */

/* memory.c: aligned to 64 bytes; NULL without memory. */
void *calx_memory_zeroed(size_t count, size_t size);
void *calx_memory_to_fill(size_t count, size_t size); /* the elements are for the caller to write; what follows them is zero */

/* plan.c */
int calx_plan_create(struct calx_sim *, struct calx_error *);
void calx_plan_free(struct calx_sim *);
static inline size_t calx_plan_pair_type(size_t materials, size_t a, size_t b)
{
    return a <= b ? a * materials + b : b * materials + a;
}

/* critical.c: the largest stable step of a plan, from the stiffest pair of bodies. */
int calx_critical_step(struct calx_sim *, struct calx_plan *, struct calx_error *);

/* The fastest approach to expect, m/s: the fastest bodies, and a fall through the scene. */
double calx_critical_speed(const struct calx_scene *);

/* pace.c: the step of the run. */
void calx_pace_begin_stage(struct calx_sim *, const struct calx_plan *before); /* time and plan are those of the stage */
int calx_pace_begin(struct calx_sim *, struct calx_error *); /* refuses a fixed step above the limit of the contacts at the start */
void calx_pace_resume(struct calx_sim *); /* a fixed step that the case has changed since the restart point */
void calx_pace_watch(struct calx_sim *);  /* in each step: notes that contacts may have become stiffer */
int calx_pace_step(struct calx_sim *, struct calx_error *); /* when nobody has gone ahead */
/* Whether the step follows the contacts closely enough that each is resolved by so many steps. */
bool calx_pace_resolves(const struct calx_plan *, double steps);
/* Time since the stage began after so many more steps, s. */
static inline double calx_pace_elapsed(const struct calx_sim *s, int64_t steps)
{
    return (s->pace_time - s->stage_start) + (double)(s->stage_step - s->pace_step + steps) * s->dt;
}

/* particles.c: mass, moment of inertia and heat capacity of a body. */
double calx_particle_mass(const struct calx_scene *, double radius, double density);
double calx_particle_inertia_factor(const struct calx_scene *); /* I = factor m R^2 */
int calx_particles_create(struct calx_sim *, struct calx_error *);

/* neighbours.c: sort, lists, ghosts, blocks; keeps history. Fails if a body left the domain. */
int calx_neighbours_build(struct calx_sim *, struct calx_error *);
bool calx_neighbours_stale(const struct calx_sim *);

/* team.c: deals the blocks out to threads, after each rebuild and restart. 0, or 1 without memory. */
int calx_team_form(struct calx_sim *);

/* skin.c: the first width, and a better one at each rebuild. Choosing fails if a periodic length is too short. */
int calx_skin_choose(struct calx_sim *, struct calx_error *);
void calx_skin_tune(struct calx_sim *);

/* walls.c, surface.c */
int calx_walls_create(struct calx_sim *, struct calx_error *);
void calx_walls_begin_stage(struct calx_sim *);
/* To time t from t - dt; s->lag: of the evaluation to come. */
void calx_walls_move(struct calx_sim *, double t, double dt);
void calx_walls_velocity(const struct calx_sim *, int wall, const double at[3], double out[3]);
struct calx_touch { double distance, normal[3], point[3]; bool end; };
void calx_surface_nearest(const struct calx_primitive *, uint32_t dimension, const double x[3], struct calx_touch *);

/* plates.c: walls that are free along an axis. */
void calx_plates_begin_stage(struct calx_sim *, const struct calx_stage_spec *before); /* NULL at the start; s->stage is the new one */
bool calx_plates_ever(const struct calx_scene *, int wall); /* free in any stage; false for -1 */
void calx_plates_place(const struct calx_sim *, size_t wall, double t, double shift[3]); /* adds where it is expected at time t */
double calx_plates_speed(const struct calx_sim *, size_t wall, double t); /* m/s, expected */
/* After an evaluation that is kept, at time t, when the forces on walls are known. */
void calx_plates_take(struct calx_sim *, double t);
/* Among rigid bodies: the speed after dt if no contact acts, gravity and load being those of time t; returns the inverse of the mass that impulses
 * find, 1/kg. Then the speed that contacts leave it, to be known when it is taken. */
double calx_plates_expect(struct calx_sim *, size_t wall, double t, double dt, double *speed);
void calx_plates_settle(struct calx_sim *, size_t wall, double speed);
double calx_plates_power(const struct calx_sim *); /* W: what grains give to plates, which the power of walls has as loss */
double calx_plates_kinetic(const struct calx_sim *);
double calx_plates_potential(const struct calx_sim *);

/* carried.c: bodies that walls carry. Listing: whenever rows have changed places. */
int calx_carried_list(struct calx_sim *, struct calx_error *);
void calx_carried_move(struct calx_sim *); /* into the present poses of their walls */
/* Their part of the block's tally and of the forces on walls; a: forces, couples and heat flows of the block. */
void calx_carried_take(struct calx_sim *, size_t block, const struct calx_pass *, const double *a);
/* Back into the poses, with the velocity at the moment of the positions: those in n rows from `first` on. */
void calx_carried_settle(struct calx_sim *, const struct calx_row_block *, size_t first, size_t n);

/* heat.c */
int calx_heat_step(struct calx_sim *, struct calx_error *); /* after the forces of step s->stage_step: what is not done block by block */
/* The step beyond which explicit temperatures overshoot, min C/sum H, and whose it is (-1: nobody's, infinite). */
int calx_heat_limit(struct calx_sim *, double *limit, int64_t *id, struct calx_error *);
int calx_heat_check(struct calx_sim *, struct calx_error *); /* fails if the heat step is unstable: max sum H/C, Gershgorin */

/* slabs.c: solids behind walls. */
static inline bool calx_wall_has_slab(const struct calx_sim *s, int wall)
{
    return s->scene->walls[wall].slab.along > 0;
}
/* Whether heat flows between the wall and grains on it. */
static inline bool calx_wall_conducts(const struct calx_sim *s, int wall)
{
    return s->scene->walls[wall].isothermal || calx_wall_has_slab(s, wall);
}
int calx_slabs_create(struct calx_sim *, struct calx_error *);
int calx_slabs_room(struct calx_sim *); /* for as many blocks as there are now; 1 without memory */
void calx_slabs_take_dissipation(struct calx_sim *); /* of the last evaluation, once it is booked */
/* Heat (J) into the slab of a wall at a point of its face. */
void calx_slabs_add(struct calx_sim *, int wall, const double point[3], double heat);
/* The heat step of all slabs; flows: those of the last evaluation count (else they were added). Fails if a face exchanges too fast. */
int calx_slabs_step(struct calx_sim *, bool flows, struct calx_error *);
double calx_slabs_content(const struct calx_sim *); /* J */
double calx_slabs_mean(const struct calx_sim *, int wall, bool face); /* K, of all cells or of those at the face */

/* ledger.c */
void calx_ledger_begin(struct calx_sim *);
void calx_ledger_step(struct calx_sim *, double dt);
double calx_ledger_wall_power(const struct calx_sim *); /* W, of walls whose motion is given, at the last evaluation */
double calx_ledger_mechanical(struct calx_sim *); /* kinetic + rotational + elastic + potential now, J */

/* profile.c */
int calx_profile_create(struct calx_sim *, struct calx_error *);
bool calx_profile_due(const struct calx_sim *, double t); /* at the step that ends at time t */
int calx_profile_step(struct calx_sim *, struct calx_error *); /* takes the samples that are due */
void calx_profile_resume(struct calx_sim *);
/* Multiples of an interval that begins at `after` up to time t. */
int64_t calx_profile_multiples(const struct calx_sim *, double after, double every, double t);

/* steady.c */
int calx_steady_create(struct calx_sim *, struct calx_error *);
size_t calx_steady_signals(const struct calx_scene *, const struct calx_steady *); /* how many: 1, or the layers of its profile */
size_t calx_steady_numbers(const struct calx_scene *, size_t watches);             /* doubles that so many watches keep */
bool calx_steady_due(const struct calx_sim *, double t);
void calx_steady_step(struct calx_sim *);
void calx_steady_resume(struct calx_sim *);

/* guard.c */
/* What the state at t = 0 allows. */
void calx_guard_begin(struct calx_sim *);
int calx_guard_step(struct calx_sim *, struct calx_error *);
int calx_guard_finite(struct calx_sim *, struct calx_error *); /* accelerations of the last evaluation */
/* The dearer ones: energy, temperatures, finite rows, how well contacts are resolved. */
int calx_guard_all(struct calx_sim *, struct calx_error *);
int calx_guard_left(const struct calx_sim *, int32_t row, int axis, struct calx_error *);

/* step.c */
/* Brings the lists of neighbours up to date. */
int calx_step_lists(struct calx_sim *, struct calx_error *);
/* All forces at the present positions, then accelerations and what follows. s->trial and s->lag say what kind of evaluation it is. */
int calx_step_forces(struct calx_sim *, const struct calx_pass *, struct calx_error *);
/* The evaluation at the end of the step under way, `dt` after the last that was kept. */
struct calx_pass calx_step_end_pass(const struct calx_sim *, double dt, int stage, bool ahead);
int calx_step_begin_stage(struct calx_sim *, int stage, struct calx_error *);
/* Gravity at time t. */
void calx_step_set_gravity(struct calx_sim *, double t);

/* motion.c: the integrator of motion. Starting: the stages before the first step, at the present state. */
int calx_motion_start(struct calx_sim *, struct calx_error *);
void calx_motion_forget(struct calx_sim *); /* what an integrator kept, before another takes over */
/* Whether the integrator of a plan resolves onset and end of contacts, and the history that takes; fails if that has no room. */
int calx_motion_resolve(struct calx_plan *, struct calx_error *);
int calx_motion_step(struct calx_sim *, double t, bool ahead, struct calx_error *); /* to time t */
/* change.c: see `change` in struct calx_motion_host; lists must be fresh and walls in place. */
double calx_change_distance(const struct calx_sim *);
/* global.c: the same for a global integrator. */
int calx_motion_step_global(struct calx_sim *, double t, struct calx_error *);

/* peak.c: watches the largest force from the start if the scene asks for it; looks at the present state. */
void calx_peak_start(struct calx_sim *);
void calx_peak_look(struct calx_sim *);
/* store.c: contacts of non-smooth laws. Collecting: before walls move, then at the present rows, lists being up to date; walls then have the
 * mean velocities of the step. */
int calx_store_begin(struct calx_sim *, struct calx_error *);
int calx_store_collect(struct calx_sim *, double forces, double dt, struct calx_error *); /* forces: s, the time whose loads act */
/* The work that each contact has dissipated, and the speeds of plates, from what the solver left. */
void calx_store_work(struct calx_sim *);
struct calx_problem *calx_store_problem(struct calx_sim *);
void calx_store_free(struct calx_sim *);
/* What the contacts of a block take their impulses from: the first of them is *first. */
const struct calx_solution *calx_store_solution(const struct calx_sim *, size_t block, size_t *first);

/* rows.c: the id of the body of a row, own or ghost. */
int64_t calx_row_id(const struct calx_sim *, int32_t row);

/* The row a frame or message calls particle `id`. */
static inline double *calx_row_x(const struct calx_sim *s, int32_t row) { return s->r.x + 4 * (size_t)row; }
static inline double *calx_row_v(const struct calx_sim *s, int32_t row) { return s->r.v + s->r.stride * (size_t)row; }
static inline double *calx_row_a(const struct calx_sim *s, int32_t row) { return s->r.a + s->r.stride * (size_t)row; }

/* History column h of a group: one number per place. */
static inline double *calx_group_history(const struct calx_sim *s, const struct calx_group *g, size_t h)
{
    return s->pairs.history + s->plan->history * g->first + h * g->room;
}
/* A place in the lists of pairs says where a row of its block is, in bytes of x: kernels reach it without arithmetic. */
static inline uint32_t calx_place_of_row(int32_t row) { return 32 * (uint32_t)row; }
static inline int32_t calx_row_of_place(uint32_t place) { return (int32_t)(place / 32); }
static inline const double *calx_place_row(const double *rows, size_t stride, uint32_t place)
{
    return (const double *)((const char *)rows + stride / 4 * place);
}

static inline bool calx_pair_touches(const struct calx_sim *s, size_t place)
{
    return s->pairs.touching[place / 8] >> place % 8 & 1;
}

#endif

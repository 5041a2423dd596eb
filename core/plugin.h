/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The plugin interface of calx: the only header a physical model includes.
 *
 * A plugin is one shared object that exports one constant symbol, `calx_plugin` (CALX_PLUGIN_SYMBOL): a
 * descriptor of type struct calx_plugin. It describes itself (name, reference, equation, a table of
 * parameters, what it needs) and points to batched kernels over structures of arrays.
 *
 * Conventions, the same everywhere in calx: SI units; the unit normal points from body j to body i; overlap is
 * positive when touching; v_n = (v_i - v_j).n is positive when separating; forces, tangential forces and
 * torques are those on body i. The host applies the opposite to j, the lever arms, the turning of
 * tangential history with the normal, and the antisymmetric heat flow.
 *
 * Phases: [prepare] single thread, may allocate and fail with text; [kernel] any thread, disjoint batches at once, must not
 * allocate, fail, lock, print or touch globals.
 */
#ifndef CALX_PLUGIN_H
#define CALX_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#define CALX_PLUGIN_MAGIC 0x786c6163u /* "calx" */
#define CALX_PLUGIN_ABI 4u
#define CALX_PLUGIN_SYMBOL "calx_plugin"

/* Columns of a batch hold a whole number of groups of CALX_WIDTH doubles and are aligned to 64 bytes. */
#define CALX_WIDTH 8
/* Most contacts in one batch. */
#define CALX_BATCH 64

/* Put before a static leaf function whose `restrict` parameters are the columns: it is then compiled for
 * several instruction sets and the best one is taken when the plugin is loaded. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(CALX_NO_CLONES)
#define CALX_KERNEL __attribute__((target_clones("avx512f,arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CALX_KERNEL
#endif

/* Length of a column of n values with its padding: the bound of a kernel's loop, which then needs no remainder. */
static inline size_t calx_padded(size_t n)
{
    return (n + CALX_WIDTH - 1) / CALX_WIDTH * CALX_WIDTH;
}

enum calx_kind { CALX_CONTACT = 1, CALX_CONDUCTANCE, CALX_MOTION, CALX_TEMPERATURE };

enum calx_bodies { CALX_SPHERES, CALX_DISCS };

/* ---- parameters ------------------------------------------------------------------------------------- */

enum calx_scope {
    CALX_RUN,      /* one value for the run: attribute of the model's element */
    CALX_MATERIAL, /* attribute of <material>; the field is double[2]: value of body i, value of body j */
    CALX_PAIR      /* attribute of the model's element, overridden by <pair> */
};

enum calx_parameter_flags {
    CALX_REQUIRED = 1,  /* no default */
    CALX_OPTIONAL = 2,  /* no default: the field is NaN if not given */
    CALX_SWITCH = 4,    /* "no" or "yes": 0 or 1 */
    CALX_CHOICE = 8,    /* one of the words of `choices` ("a|b|c"): the field holds its index */
    CALX_OPEN_MIN = 16, /* the value must be greater than min, not equal */
    CALX_OPEN_MAX = 32  /* the value must be less than max, not equal */
};

/* One row of a plugin's parameter table. The field at `offset` of the plugin's struct is a double
 * (double[2] for CALX_MATERIAL). Without CALX_REQUIRED and CALX_OPTIONAL, `initial` is the default. */
struct calx_parameter {
    const char *name;   /* as in the case file: lower case, hyphens */
    const char *symbol; /* as in the equation: "k_n" */
    const char *unit;   /* UDUNITS-2 text, "1" for a number */
    const char *doc;    /* one sentence */
    double initial, min, max;
    uint32_t flags; /* enum calx_parameter_flags */
    uint32_t scope; /* enum calx_scope */
    size_t offset;
    const char *choices; /* for CALX_CHOICE, else NULL */
};

/* ---- what a plugin may know when it prepares --------------------------------------------------------- */

struct calx_setup {
    size_t size;         /* sizeof(struct calx_setup) */
    uint32_t dimension;  /* 2 or 3 */
    uint32_t bodies;     /* enum calx_bodies */
    double thickness;    /* length of discs, m; 0 for spheres */
    double velocity_lag; /* the velocities a law sees are those of lag*dt before the positions */
    uint32_t uses_velocity; /* for integrators: 1 if a contact law has declared CALX_USES_VELOCITY */
};

enum calx_need {
    CALX_NEEDS_TANGENT = 1,      /* vt; gives ft a meaning */
    CALX_NEEDS_ROTATION = 2,     /* bodies spin; vt is that of the contact point */
    CALX_NEEDS_TEMPERATURE = 4,  /* temperature_i, temperature_j */
    CALX_NEEDS_NORMAL_FORCE = 8, /* fn is that of the laws before */
    CALX_NEEDS_SPIN = 16,        /* spin: relative angular velocity, and torque */
    CALX_NEEDS_CURVATURE = 32,   /* curvature of both bodies */
    CALX_USES_VELOCITY = 64      /* forces depend on velocities, by damping or friction: some integrators take other coefficients */
};

/* Filled from the descriptor before prepare; prepare may change it to what these parameter values need. */
struct calx_demand {
    uint32_t needs;         /* enum calx_need */
    size_t history_vectors; /* tangential vectors kept while the contact lasts, turned by the host */
    size_t history_scalars; /* scalars kept while the contact lasts */
    double gap;             /* the law acts from this gap before touch, m */
};

/* ---- contact laws ------------------------------------------------------------------------------------ */

/* A batch of contacts of one stack of laws and one pair of materials.
 * n contacts; each column has n values and padding up to a multiple of CALX_WIDTH whose values are finite and
 * whose results are ignored (padding has overlap 0). Columns that a plugin has not asked for are NULL.
 * A contact is seen from its first evaluation with overlap > -gap to one evaluation after its end: there
 * overlap <= -gap, and the law must return zero force and book the work of its last half step. */
struct calx_contacts {
    size_t size; /* sizeof(struct calx_contacts) */
    size_t n;
    double dt;                  /* s, since the evaluation that left the history; trial evaluations may have a negative one */
    const double *overlap;      /* m */
    const double *normal[3];    /* 1, from j to i */
    const double *vn;           /* m/s, > 0 separating */
    const double *vt[3];        /* m/s, tangential velocity of i relative to j at the contact point */
    const double *spin[3];      /* rad/s, omega_i - omega_j */
    const double *mass;         /* kg, effective mass 1/(1/m_i + 1/m_j), that of i at a wall; 0 if both bodies are held */
    const double *curvature[2]; /* 1/m, 1/R_i and 1/R_j; 0 for a wall */
    const double *temperature[2]; /* K */
    const double *coulomb; /* N, the force whose size limits friction: fn without cohesion */
    double *fn;            /* N, in/out: add the normal force, > 0 pushes apart */
    double *ft[3];         /* N, in/out: add the tangential force on i */
    double *torque[3];     /* N m, in/out: add the couple on i (on j: the opposite) */
    double *work;          /* J, in/out: add the energy dissipated since the last evaluation: the trapezoid of
                            * old and new dissipative force times the relative velocity times dt */
    double *const *history; /* this law's columns, in/out: x, y, z of each vector, then the scalars; 0 at onset */
};

/* Where elastic energy, tangent stiffness and damping are asked for (not in every step). Columns as in the batch. */
struct calx_response {
    size_t size;
    double *energy;       /* J, in/out: add the stored elastic energy; NULL if not asked for */
    double *stiffness[2]; /* N/m, in/out: add d fn/d overlap, d ft/d u; NULL if not asked for */
    double *damping[2];   /* N s/m, in/out: normal, tangential; NULL if not asked for */
};

/* What the non-smooth laws of a stack say of each contact of a batch, together: columns as in the batch, 0 where none has said anything yet.
 * With the step h, the impulse r on body i, the velocity u of i relative to j at the contact point, v- at the start of the step and v+ at its
 * end, a contact obeys
 *     0 <= rn + pull h,   un+ + b >= 0,   (rn + pull h) (un+ + b) = 0,   |rt| <= friction (rn + pull h), against ut+ where it slips,
 * b = restitution un- if it touches; if it does not, b is what keeps it from passing through. pull is 0 where the gap is above reach. */
struct calx_condition {
    size_t size;
    double *friction;    /* 1, in/out */
    double *restitution; /* 1, in/out, Newton's, 0 to 1 */
    double *pull;        /* N, in/out: attraction, whatever the gap, up to: */
    double *reach;       /* m, in/out; the law's demand.gap must be no less */
};

enum calx_part { CALX_NORMAL = 1, CALX_COHESION = 2, CALX_TANGENTIAL = 4, CALX_ROLLING = 8 };

struct calx_contact_law {
    uint32_t provides;          /* enum calx_part: laws act in this order */
    uint32_t depends;           /* parts that another law of the stack must provide */
    uint32_t nonsmooth;         /* 1: the law says a condition, and needs an integrator that solves for impulses */
    struct calx_demand demand;  /* what the law needs at most */
    const char *const *history; /* names of the history: vectors, then scalars */
    /* [prepare] params is the plugin's struct for one material pair, filled from the table; returns 0, or 1 with text
     * in why. May be NULL. */
    int (*prepare)(const struct calx_setup *, void *params, struct calx_demand *, char *why, size_t why_size);
    void (*release)(void *params);                                         /* [prepare] may be NULL */
    /* Of smooth laws: */
    void (*force)(const void *params, const struct calx_contacts *);      /* [kernel] */
    void (*response)(const void *params, const struct calx_contacts *, const struct calx_response *); /* [kernel] */
    /* [kernel] Of non-smooth ones. Nobody has worked out velocities or forces yet: vn, vt, spin and the results of the batch mean nothing,
     * and it has no history. */
    void (*condition)(const void *params, const struct calx_contacts *, const struct calx_condition *);
};

/* ---- help for prepare --------------------------------------------------------------------------------- */

/* Restitution of a contact with the fraction b of critical damping whose force is clipped at zero: it ends when
 * the force vanishes, at w t = 2 acos b. Schwager and Poeschel, Granular Matter 9 (2007) 465; the same for
 * Hertz with Tsuji's damping. (Builtins, because this header depends on no other than the two above.) */
static inline double calx_clipped_restitution(double b)
{
    double w2 = 1 - b * b;
    if (w2 > 1e-8)
        return __builtin_exp(-2 * b * __builtin_acos(b) / __builtin_sqrt(w2));
    if (w2 < -1e-8)
        return __builtin_exp(-2 * b * __builtin_acosh(b) / __builtin_sqrt(-w2));
    return __builtin_exp(-2.0);
}

/* The fraction of critical damping, c/(2 sqrt(k m)), that gives a restitution coefficient e in [0, 1]. If the force
 * may attract: -ln e/sqrt(pi^2 + ln^2 e), and 1 for e up to 1e-4. If it is clipped at zero: the inverse of
 * calx_clipped_restitution(), above 1 for e < exp(-2), and the value for 1e-4 (about 50) below that. */
static inline double calx_damping_ratio(double e, int clipped)
{
    const double least = 1e-4, pi = 3.14159265358979323846;
    if (!clipped) {
        double l = __builtin_log(e > least ? e : least);
        return e > least ? -l / __builtin_sqrt(pi * pi + l * l) : 1;
    }
    double low = 0, high = 64, target = e > least ? e : least;
    for (int k = 0; k < 64 && target < 1; k++) {
        double b = 0.5 * (low + high);
        if (calx_clipped_restitution(b) > target)
            low = b;
        else
            high = b;
    }
    return low;
}

/* Effective modulus of two bodies, Pa: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2. Johnson, Contact Mechanics (1985), ch. 4. */
static inline double calx_effective_modulus(const double young[2], const double poisson[2])
{
    return 1 / ((1 - poisson[0] * poisson[0]) / young[0] + (1 - poisson[1] * poisson[1]) / young[1]);
}

/* Conductivity of two half-spaces in series, W/(m K): 2 k1 k2/(k1 + k2), k for equal ones, 0 if one insulates. */
static inline double calx_pair_conductivity(const double k[2])
{
    return k[0] + k[1] > 0 ? 2 * k[0] * k[1] / (k[0] + k[1]) : 0;
}

/* ---- conductances ------------------------------------------------------------------------------------ */

struct calx_conductance_law {
    struct calx_demand demand; /* history is not available to conductances */
    int (*prepare)(const struct calx_setup *, void *params, struct calx_demand *, char *why, size_t why_size);
    void (*release)(void *params);
    /* [kernel] conductance: W/K, one column; 0 where overlap <= 0. The heat flow to i is H (T_j - T_i). Under non-smooth laws bodies have an
     * overlap, if only the smallest number, where fn > 0, and none elsewhere. */
    void (*conductance)(const void *params, const struct calx_contacts *, double *conductance);
};

/* ---- integrators of motion --------------------------------------------------------------------------- */

/* A range of n particles as rows of four: x = {x, y, z, R}, v = {vx, vy, vz, 1/m}, a = {ax, ay, az, 0}; for rotation
 * x is NULL, v = {wx, wy, wz, *}, a the angular acceleration. Row i of v and a starts at i*stride doubles, of x and extra at 4*i.
 * dt[k] is the step for lane k: 0 in lanes that must not move (the fourth; z in 2D), so that a kernel
 * is a plain loop over four lanes, v[k] += dt[k]*a[k]. Integrator kernels may not assume a dt of zero elsewhere.
 * Kernels of both at once see rows of eight, v = {vx, vy, vz, 1/m, wx, wy, wz, *}, a likewise, with a dt for each lane; x stays rows of four. */
struct calx_rows {
    size_t size;
    size_t n;
    size_t stride;
    double dt[8];
    double *x;
    double *v;
    const double *a;
    double *const *extra; /* extra state of this integrator, rows of four, 0 at the start */
    size_t stage;         /* index of the stage in the integrator's tables */
};

/* A kernel over a range of rows. [kernel] */
typedef void calx_rows_kernel(const void *params, const struct calx_rows *);

/* One force evaluation with what comes before and after it. The last stage of a step is evaluated at the end of the step: it
 * alone changes contact history and books dissipated work, for the whole step. The others are trials: each sees the
 * history of the start of the step and the time elapsed since, and leaves no trace but its accelerations. */
struct calx_stage {
    calx_rows_kernel *before; /* may be NULL */
    calx_rows_kernel *after;  /* may be NULL */
    /* Of the last stage, in the tables of translation and of whole rows: `after` and then `before` of a step's first stage in one, with the
     * same bits and less time. May be NULL. */
    calx_rows_kernel *between;
    /* Of a trial: its positions are those at t + time*dt, its velocities those of lag*dt before. The last stage has 1 and velocity_lag. */
    double time, lag;
};

struct calx_motion_host;

/* What an integrator of motion is. prepare may change what depends on parameters. */
struct calx_motion_integrator {
    uint32_t order;
    uint32_t stages;         /* force evaluations per step; 0: a global integrator (advance) */
    uint32_t reversible;     /* 1: turning all velocities leads back */
    uint32_t symplectic;     /* 1: the energy of an oscillator does not drift */
    uint32_t solves_impulses; /* 1: takes non-smooth laws */
    /* 1: `before` moves each body by dt times the velocity that it leaves, `after` moves none: the engine then knows how far
     * bodies went; else it measures. */
    uint32_t drifts;
    /* Stages that come first in the tables and are gone through once, before the first step (and when models change): trials, which
     * leave positions and velocities as they were (to round-off) and what they found in extra. */
    uint32_t start;
    /* Largest omega*dt at which the energy of an undamped oscillator does not double within a period (a contact lasts half of
     * one), and largest c/m*dt of a damper alone that brings a body to rest. With a fraction z of critical damping
     * sqrt(1 + y^2) - y times `stability` is safe, y = z*stability/damping. Of a global integrator: of its longest step. */
    double stability, damping;
    double velocity_lag;     /* at a force evaluation velocities are those of lag*dt before the positions; not changed by prepare
                              * when setup.uses_velocity is */
    /* 1: wants contacts that begin or end inside a step resolved: the engine then answers with kicks whose sum over equal steps is the
     * impulse, as if it knew the moments, and with damping at the velocity of the moment of the positions. One stage, whose evaluation
     * acts as one kick, v += dt a, at the moment of its positions, and with velocities half a step before (velocity_lag 0.5). */
    uint32_t resolves_contacts;
    /* Of those that solve for impulses: contacts are of interest from this gap on, in units of the smallest radius. */
    double reach;
    uint32_t constant_step;  /* 1: the step may not change during a run, for the extra state is that of one step */
    uint32_t extra_translation, extra_rotation; /* rows of extra state per particle, 8 at most */
    const char *const *extra; /* their names */
    const struct calx_stage *translation; /* `start + stages` entries */
    const struct calx_stage *rotation;    /* `start + stages` entries */
    /* NULL, or as many: translation and rotation at once, with the same bits and less time; only without extra state */
    const struct calx_stage *whole;
    /* [prepare] The third argument is a copy of this struct for these parameter values. Called again, after release, once it is known that
     * laws use velocities. May be NULL. */
    int (*prepare)(const struct calx_setup *, void *params, struct calx_motion_integrator *, char *why, size_t why_size);
    void (*release)(void *params);
    /* Global, called from one thread: takes all bodies from host->t to host->t + host->dt with the host's services; returns 0, or 1
     * with text. NULL for staged ones. */
    int (*advance)(const void *params, const struct calx_motion_host *, char *why, size_t why_size);
};

/* A force evaluation that a global integrator asks for. */
struct calx_evaluation {
    double time;     /* s: the positions are those of this moment; gravity and walls are put there */
    double lag;      /* s: velocities are those of so long before */
    double elapsed;  /* s: since the last evaluation that was kept */
    uint32_t keep;   /* 1: changes contact history and books work; the last of a step must, at t + dt. 0: a trial */
};

/* For an integrator that solves for impulses: what belongs to which moment, s. The positions are the present ones. */
struct calx_moments {
    double positions;  /* walls are put where they are then */
    double forces;     /* gravity of then acts during the whole step */
    double velocities; /* of the end of the step: walls move as they do then */
};

/* All contacts of the step, in an order that does not depend on threads; and the bodies in rows of eight, {vx, vy, vz, 1/m, wx, wy, wz, 1/I},
 * inverse mass and inertia 0 for those that are held or carried. Walls that are free along an axis are the last of the bodies: impulses move
 * them along that axis only, and 1/m holds for it. Body i gets the impulse rn n + rt, at -lever[0] n from its centre, body j
 * the opposite, at lever[1] n from its own. Everything is 0 where it does not apply. The solver fills `velocity`, `normal_impulse` and
 * `impulse`. */
struct calx_problem {
    size_t size;
    size_t n;      /* contacts */
    size_t bodies; /* rows, some of them of no meaning */
    double dt;     /* s */
    const double *position;       /* m: rows of four, {x, y, z, R} */
    const double *before;         /* velocities at the start of the step */
    double *velocity;             /* in: at its end if no contact acted; out: with the impulses */
    const int32_t *body[2];       /* rows of i and j; j is -1 for a wall */
    const double *normal[3];      /* 1, from j to i */
    const double *lever[2];       /* m */
    const double *gap;            /* m, not positive where bodies touch */
    const double *wall_before[3]; /* m/s: of the wall at the contact point, at the start of the step */
    const double *wall_after[3];  /* m/s: at its end */
    const double *friction, *restitution, *pull; /* see calx_condition; pull in N, 0 beyond its reach */
    double *normal_impulse;       /* N s, in/out: that of the last step comes in, 0 of a new contact */
    double *impulse[3];           /* N s, in/out: tangential */
    /* of the solution, for output: sweeps, or iterations, and the residual that is left; 0 at the start */
    double sweeps, residual;
    double gravity[3];            /* m/s2 */
    size_t walls;                 /* so many of the bodies are walls, the last ones; they have no position */
    const int8_t *axis;           /* of each of them: 0, 1, 2; -1: no impulse moves it */
};

/* The services of the engine to a global integrator, valid during advance. Later versions may add services at the end: look at
 * size. At the start accelerations (rows.a) are those of the state at t, and evaluated as kept. */
struct calx_motion_host {
    size_t size;
    void *engine;   /* first argument of the services */
    double t, dt;   /* s */
    double *memory; /* CALX_MEMORY numbers of the integrator, 0 at the start, kept from step to step and through restarts */
    /* Runs the kernels over the rows of all bodies, rows.dt made of `dt`; `rotation` only where bodies spin. Either may be NULL. */
    void (*each)(void *engine, double dt, calx_rows_kernel *translation, calx_rows_kernel *rotation, const void *params);
    /* The largest, over all ranges, of what the kernels return; 0 without any body. NaN if any is. */
    double (*largest)(void *engine, double dt, double (*translation)(const void *params, const struct calx_rows *),
                      double (*rotation)(const void *params, const struct calx_rows *), const void *params);
    /* Evaluates all forces at the present rows: fills a. Returns 0, or 1 if the run must stop: return 1 then, `why` left empty. */
    int (*forces)(void *engine, const struct calx_evaluation *);
    /* How far, m, contacts are from a change since the last evaluation that was kept, at the present rows and with walls where they are at
     * `time`: the smallest gap of what was apart and the smallest overlap of what touched; < 0: how far a change lies behind; infinite
     * where there is nothing. NaN if the run must stop: return 1 then, `why` left empty. */
    double (*change)(void *engine, double time);
    /* For integrators that solve for impulses, once per step each. The first collects the contacts at the present rows; the problem is the
     * engine's, and valid until the end of the step. The second takes the solution: books history, dissipated work, heat and the work of
     * walls, and fills a with the mean accelerations of the step, by impulses and gravity: it stands for the evaluation that is kept.
     * Return 0, or 1 if the run must stop: return 1 then, `why` left empty. */
    int (*contacts)(void *engine, const struct calx_moments *, struct calx_problem **);
    int (*impulses)(void *engine);
    /* Runs part(context, first, last) over ranges that make up 0 to n, on several threads at once where that is worth it: parts must not depend
     * on each other, nor results on how they are cut. */
    void (*parallel)(void *engine, size_t n, void (*part)(void *context, size_t first, size_t last), void *context);
};

enum { CALX_MEMORY = 8 };

/* ---- integrators of temperature ---------------------------------------------------------------------- */

/* The heat network at one instant: C_i dT_i/dt = source_i + sum_edges H (T_j - T_i) + sum_walls H (T_w - T_i). */
struct calx_network {
    size_t size;
    size_t n;                       /* bodies */
    double dt;                      /* s */
    double *temperature;            /* K, in/out */
    const double *capacity;         /* J/K */
    const double *source;           /* W: heat of dissipation */
    size_t edges;                   /* contacts between bodies */
    const int32_t *edge[2];         /* body i, body j */
    const double *edge_conductance; /* W/K */
    size_t boundaries;              /* contacts with walls of given temperature */
    const int32_t *boundary;        /* body */
    const double *boundary_conductance;
    const double *boundary_temperature;
    double *boundary_heat; /* J, out: heat that went from the wall into the body in this step */
};

struct calx_temperature_integrator {
    uint32_t order;         /* in a network that stays */
    uint32_t exact;         /* 1: no error in a network that stays, but for a tolerance of 1e-10 or better by default */
    uint32_t unconditional; /* 1: stable for any step */
    double stability;       /* largest lambda*dt, lambda the fastest decay rate; ignored if unconditional */
    int (*prepare)(const struct calx_setup *, void *params, char *why, size_t why_size);
    void (*release)(void *params);
    /* One of the two. Staged [kernel]: n bodies, T += ..., strides in doubles, q the net heat flow in W, inverse_capacity in K/J. */
    void (*advance)(const void *params, size_t n, double dt, double *temperature, size_t temperature_stride,
                    const double *q, size_t q_stride, const double *inverse_capacity);
    /* Global, called from one thread once per heat step; may allocate; returns 0, or 1 with text. */
    int (*solve)(const void *params, const struct calx_network *, char *why, size_t why_size);
};

/* ---- the descriptor ---------------------------------------------------------------------------------- */

struct calx_plugin {
    /* frozen prefix, the same in every ABI version */
    uint32_t magic; /* CALX_PLUGIN_MAGIC */
    uint32_t abi;   /* CALX_PLUGIN_ABI */
    uint64_t size;  /* sizeof(struct calx_plugin) */
    /* end of prefix */
    uint32_t kind; /* enum calx_kind */
    const char *name;
    const char *summary;   /* one line */
    const char *reference; /* paper and equation */
    const char *equation;  /* plain text */
    size_t parameter_count;
    const struct calx_parameter *parameters;
    size_t params_size; /* bytes of the plugin's own struct */
    const void *law;    /* struct of its kind: calx_contact_law, calx_conductance_law, ... */
};

/* Visibility of the one exported symbol: CALX_EXPORT const struct calx_plugin calx_plugin = {...}; */
#define CALX_EXPORT __attribute__((visibility("default"))) extern const struct calx_plugin calx_plugin; \
    __attribute__((visibility("default")))
#define CALX_DESCRIPTOR_PREFIX .magic = CALX_PLUGIN_MAGIC, .abi = CALX_PLUGIN_ABI, .size = sizeof(struct calx_plugin)

#endif

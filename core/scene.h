/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The scene: what a case file says, validated and in SI units, without any solver data. The reader (io/case.c) fills it, the
 * plan reads it. What varies is a callback, so that core knows no expression library.
 * Ownership: the scene owns everything it points to (strings and arrays by malloc), and calx_scene_free() frees it; contexts
 * of functions are owned by `attachments`.
 */
#ifndef CALX_SCENE_H
#define CALX_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/error.h"
#include "core/plugin.h"

/* A number that may vary: eval(context, t, x) if eval is set, else value. t in s, x in m. eval is called from one thread. */
struct calx_function {
    double (*eval)(const void *context, double t, const double x[3]);
    const void *context;
    double value;
};

static inline double calx_evaluate(const struct calx_function *f, double t, const double x[3])
{
    return f->eval ? f->eval(f->context, t, x) : f->value;
}

/* A named number of a material or of a model's element: raw, in SI, checked against the plugin's table by the reader. */
struct calx_value {
    char name[48];
    double value;
    int pair[2]; /* materials a <= b it is for; -1, -1: all */
    struct calx_place place;
};

struct calx_material {
    char name[48];
    double density, specific_heat; /* NaN if not given */
    size_t value_count;
    struct calx_value *values; /* the rest: parameters of scope CALX_MATERIAL (conductivity, young, poisson, ...) */
    struct calx_place place;
};

/* One use of a plugin. */
struct calx_model {
    enum calx_kind kind;
    char plugin[48];
    size_t value_count;
    struct calx_value *values;
    struct calx_place place;
};

/* A choice of models, complete: several contact laws, at most one conductance, one integrator of motion and one of temperature. */
struct calx_models {
    size_t count;
    struct calx_model *list;
    double dt;          /* s; 0: automatic */
    double dt_fraction; /* of the critical step, when automatic (0.1 to 1) */
    double safety;      /* share of the stability limit of all contacts that an automatic step keeps to; 0: 0.5 */
    double heat_dt;     /* s; 0: the step of motion */
    bool forced;        /* a step above the limit is taken all the same */
    bool lever_full;    /* lever arm R instead of R - overlap/2 (to reproduce other codes) */
    bool frozen;        /* no integrator of motion: bodies do not move */
};

/* ---- walls -------------------------------------------------------------------------------------------- */

enum calx_shape { CALX_SEGMENT, CALX_PLANE, CALX_CYLINDER, CALX_SPHERE };

/* One primitive. A segment is the line a-b in 2D, and in 3D the strip that it sweeps along z. A plane (in 2D: a line) goes through a with
 * the unit normal n, which points to the grains. A cylinder (in 2D: a circle) has the axis through a along n, a sphere the
 * centre a; grains are inside or outside. Walls are infinitely thin and segments act on both sides. */
struct calx_primitive {
    enum calx_shape shape;
    bool inside;
    double a[3], b[3], n[3], radius;
    double length;    /* of a cylinder, centred at a along n; 0: endless */
    int32_t surface;  /* primitives of one smooth surface share a number, so that friction survives the joints */
};

/* The motion of a wall during a stage, relative to its pose when the stage began; t counts from there for `rate`s that are
 * constant, and is the time of the run inside functions. The parts add up. */
struct calx_motion {
    bool moves;
    struct calx_function velocity[3]; /* m/s */
    struct calx_function rate;        /* rad/s about the axis through `about` along `axis`; in 2D along z */
    double about[3], axis[3];
    double amplitude[3], frequency, phase;     /* oscillation: amplitude*(sin(2 pi f tau + phase) - sin(phase)); m, 1/s, rad */
    bool has_displacement;
    struct calx_function displacement[3]; /* m, of the time of the run; minus its value when the stage began */
    /* A loaded plate (core/plates.c): along one axis the wall is a body of finite mass that moves under contacts, load and gravity. Nothing
     * above prescribes that axis, and the wall does not turn. */
    bool free;
    int free_axis;                    /* 0, 1, 2 */
    double mass, damping;             /* kg; N s/m, of its speed along the axis */
    struct calx_function load;        /* N along the axis */
};

/* The solid behind a wall, in the pose at the start: from `corner` it reaches by `length` along axis[0] on the face, by `depth` along axis[1] into
 * it and by `width` along axis[2], in which direction nothing changes. `along` by `deep` cells. */
struct calx_slab {
    size_t along, deep;    /* 0: the wall has no slab */
    double corner[3], axis[3][3], length, depth, width; /* m */
    bool periodic;         /* the ends of the face meet */
    bool far_isothermal;   /* else insulated */
    double far, start;     /* K: of the far face; of the slab at the start */
    double conductivity, capacity; /* W/(m K); J/(m3 K) */
    double theta;
};

struct calx_wall {
    char name[48];
    int material;
    bool isothermal;                  /* false: insulated */
    struct calx_function temperature; /* K */
    size_t primitive_count;
    struct calx_primitive *primitives;
    bool closed;           /* the segments bound an inside */
    bool carries;          /* it has no surface: a group of particles, which it carries */
    struct calx_slab slab; /* a wall with one is not isothermal: its temperature is that of the slab's face */
    struct calx_place place;
};

/* ---- particles ---------------------------------------------------------------------------------------- */

/* Structure of arrays; ids are the indices. velocity, spin, temperature are NULL if nothing says them (0, 0, 293.15 K). */
struct calx_particles {
    size_t count;
    double (*position)[3];
    double *radius;
    int32_t *material;
    double (*velocity)[3];
    double (*spin)[3];
    double *temperature;
    uint8_t *fixed; /* NULL: all free */
    int32_t *carrier; /* wall that carries the body, as it carries its primitives, or -1; NULL: none */
};

/* ---- stages, output, expectations --------------------------------------------------------------------- */

enum calx_relation { CALX_BELOW, CALX_ABOVE };

/* Complete settings of a stage: what the case does not change is that of the stage before. */
struct calx_stage_spec {
    char name[48];
    double duration;       /* s: the end, or the latest end if there is a condition (infinite allowed) */
    char condition[64];    /* quantity, as in calx_measure_find(); "" for none */
    enum calx_relation relation;
    double bound;          /* SI */
    double hold;           /* s for which the condition must hold without a break */
    struct calx_function gravity[3]; /* m/s2 */
    struct calx_motion *motion;      /* one per wall */
    struct calx_function *wall_temperature; /* one per wall, K */
    int models;                      /* index into scene.models */
    double output_every;             /* s; 0: only start and end of the stage */
    struct calx_place place;
};

enum calx_field {
    CALX_FIELD_VELOCITY = 1, CALX_FIELD_SPIN = 2, CALX_FIELD_TEMPERATURE = 4, CALX_FIELD_MATERIAL = 8,
    CALX_FIELD_CONTACTS = 16, CALX_FIELD_FORCE = 32, CALX_FIELD_MASS = 64, CALX_FIELD_HEAT = 128,
    CALX_FIELD_GROUP = 256, CALX_FIELD_ALL = 511
};

struct calx_output {
    uint32_t fields;   /* enum calx_field; fields that do not exist in the scene are left out silently */
    bool network;      /* write the contact network */
    bool single;       /* 32-bit floats */
    int compression;   /* zlib level, 0 to 9 */
    double csv_every;  /* s; 0: as frames */
};

/* A user's column of the CSV. */
struct calx_probe {
    char name[48];
    char quantity[64];  /* as in calx_measure_find() */
    int64_t particle;   /* id, or -1 */
    int material;       /* restrict means to one material, or -1 */
    int wall;           /* for wall quantities, or -1 */
    int profile;        /* for quantities of layers, */
    int64_t layer;      /* from 1, the lowest; else 0, 0 */
    size_t steady;      /* for quantities of a watch: its number from 1; else 0 */
    char component;     /* 'x', 'y', 'z', 'm' (magnitude) or 0 */
    char reduce[12];    /* mean, min, max, sum, std */
    char classes[32];   /* lacey-index: what divides the grains: start-height, start-x, material, start-radius, start-temperature */
    double cell;        /* lacey-index: size of a cell, m; 0: automatic */
    int stage;          /* lacey-index: the classes are those at the start of this stage (since="name"); default 0 */
    struct calx_place place;
};

enum calx_when { CALX_AT_END, CALX_AT_TIME, CALX_ALWAYS, CALX_MINIMUM, CALX_MAXIMUM, CALX_CHANGE };

/* What must come out. Exactly one of value, above, below or the pair above and below is set (has_value, above, below: NaN if not). */
struct calx_expect {
    char of[64];  /* a probe or a column of the CSV */
    enum calx_when when;
    double time; /* for CALX_AT_TIME */
    char stage[48]; /* only during or at the end of this stage; "" for the run */
    bool has_value;
    struct calx_function value; /* of t */
    double rtol, atol, above, below;
    char source[256];
    struct calx_place place;
};

/* A solution that is known: what the quantity is at any time from `from` on. `calx report` measures errors against it. */
struct calx_exact {
    char of[64]; /* a probe or a column of the CSV */
    struct calx_function value; /* of t, SI */
    double from;                /* s */
    char source[256];
    struct calx_place place;
};

/* Layers of equal thickness across one axis, and means over windows of time in each (core/profile.c). */
struct calx_profile {
    char name[48];
    int axis;                /* 0, 1, 2 */
    size_t layers;
    double low[3], high[3];  /* m: of all layers together; in 2D their depth along z */
    double every, over;      /* s: between samples; length of a window, a whole number of samples */
    double after;            /* s: the first window begins */
    bool groups;             /* bodies of rigid groups count too */
    struct calx_place place;
};

enum { CALX_STEADY_MOST = 1000 }; /* blocks */

/* A signal that is watched until it is stationary (core/steady.c). */
struct calx_steady {
    char name[48];
    struct calx_probe signal; /* with a profile (not -1): of each of its layers */
    double every, over;       /* s: between samples; length of a block, a whole number of samples */
    double after;             /* s: the first block begins */
    double within;            /* the change that counts as none, in the unit of the signal */
    size_t blocks;            /* of the window that is looked at: even */
    struct calx_place place;
};

struct calx_scene {
    char *title;
    char *file;      /* path of the case file */
    char *directory; /* its folder */
    uint32_t dimension;
    uint32_t bodies; /* enum calx_bodies */
    double thickness;
    bool periodic[3];
    bool bounded[3]; /* extent given: leaving it is an error that names the particle */
    double low[3], high[3];
    double from_dissipation; /* share of the dissipated work that becomes heat: 0 to 1 */
    bool split_effusivity;   /* else half and half */
    double skin;             /* m; 0: automatic */
    uint64_t seed;
    size_t material_count;
    struct calx_material *materials;
    size_t models_count;
    struct calx_models *models;
    size_t wall_count;
    struct calx_wall *walls;
    struct calx_particles particles;
    size_t stage_count;
    struct calx_stage_spec *stages;
    struct calx_output output;
    size_t probe_count;
    struct calx_probe *probes;
    size_t expect_count;
    struct calx_expect *expects;
    size_t exact_count;
    struct calx_exact *exacts;
    size_t profile_count;
    struct calx_profile *profiles;
    size_t steady_count;
    struct calx_steady *steady;
    size_t attachment_count;
    struct calx_attachment { void *what; void (*release)(void *); } *attachments;
    size_t file_count;
    char **files; /* the names that places point to */
};

/* A new empty scene (3D, spheres, no periodic axis), or NULL without memory. */
struct calx_scene *calx_scene_create(void);
void calx_scene_free(struct calx_scene *);

/* The scene keeps `what` and calls release(what) when it is freed. Returns 0 or CALX_ERROR_MEMORY. */
int calx_scene_attach(struct calx_scene *, void *what, void (*release)(void *));

/* Index of the material or wall of that name, or -1. */
int calx_scene_material(const struct calx_scene *, const char *name);
int calx_scene_wall(const struct calx_scene *, const char *name);

/* What the case says of a material under that name, in SI; NaN if nothing. */
double calx_scene_material_value(const struct calx_scene *, size_t material, const char *name);

/* How deep the plane is in which the bodies of a 2D scene move, m: as discs are long, or as the largest sphere is thick. */
double calx_scene_depth(const struct calx_scene *);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the parts of the conformance suite share: the report, choices of parameters, batches, random
 * numbers. Private to core/conform*.c.
 */
#ifndef CALX_CONFORM_PARTS_H
#define CALX_CONFORM_PARTS_H

#include <stdint.h>

#include "core/conform.h"

/* ---- the report ---- */

/* Notes a figure for the check `name` (a literal): the worst per check is kept; NaN is worst of
 * all. */
void calx_conform_note(struct calx_conformance *, const char *name, double figure, double bound,
                       const char *where);

/* ---- one choice of parameters ---- */

struct calx_choice {
    const struct calx_plugin *plugin;
    struct calx_setup setup;
    void *params;              /* prepared */
    struct calx_demand demand; /* as prepare left it */
    struct calx_motion_integrator motion; /* of integrators of motion: as prepare left it */
    char where[200];
};

/* The value that stands for a row when nothing else is asked for: its default, NaN if optional,
 * else one inside the range. */
double calx_choice_typical(const struct calx_parameter *);

typedef void calx_choice_visit(struct calx_choice *, struct calx_conformance *);

/* Calls visit for the typical values, then with one row, then two rows, at another value inside
 * their range. Choices that prepare refuses are left out. Returns how many were visited; why (of
 * 256) is the text of the last refusal. */
size_t calx_choice_each(const struct calx_plugin *, const struct calx_setup *,
                        struct calx_conformance *, calx_choice_visit *, char *why);

/* The same with each row at each end of its range, one at a time (words: every one). */
size_t calx_choice_each_bound(const struct calx_plugin *, const struct calx_setup *,
                              struct calx_conformance *, calx_choice_visit *);

/* Exchanges the materials of bodies i and j and prepares anew; returns what prepare returns. */
int calx_choice_exchange(struct calx_choice *);

/* Spheres in 3D, discs in 2D: what a law is tried with. It must accept one of them. */
extern const struct calx_setup calx_conform_setups[2];

/* ---- batches ---- */

enum calx_column {
    CALX_COL_OVERLAP,
    CALX_COL_NORMAL,
    CALX_COL_VN = CALX_COL_NORMAL + 3,
    CALX_COL_VT,
    CALX_COL_SPIN = CALX_COL_VT + 3,
    CALX_COL_MASS = CALX_COL_SPIN + 3,
    CALX_COL_CURVATURE,
    CALX_COL_TEMPERATURE = CALX_COL_CURVATURE + 2,
    CALX_COL_COULOMB = CALX_COL_TEMPERATURE + 2,
    CALX_COL_FN,
    CALX_COL_FT,
    CALX_COL_TORQUE = CALX_COL_FT + 3,
    CALX_COL_WORK = CALX_COL_TORQUE + 3,
    CALX_COL_ENERGY,
    CALX_COL_STIFFNESS,
    CALX_COL_DAMPING = CALX_COL_STIFFNESS + 2,
    CALX_COL_CONDUCTANCE = CALX_COL_DAMPING + 2,
    CALX_COL_HISTORY,
    CALX_COL_COUNT = CALX_COL_HISTORY + 24
};

/* A batch with all its columns. */
struct calx_trial {
    size_t n;
    double dt;
    _Alignas(64) double column[CALX_COL_COUNT][CALX_BATCH];
};

/* n contacts of bodies of a few millimetres, with speeds up to 1 m/s; one in four does not touch,
 * one in four is with a wall. History is what a few evaluations left. Inputs that the choice has
 * not declared are NaN. */
void calx_trial_fill(struct calx_trial *, const struct calx_choice *, size_t n, uint64_t seed);

/* Sets outputs to zero (fn to the normal force of the laws before, if the law asked for it). */
void calx_trial_clear(struct calx_trial *, const struct calx_choice *);

/* Exchanges bodies i and j of all contacts: curvatures and temperatures, the normal turned. */
void calx_trial_exchange(struct calx_trial *);

/* Calls the plugin: force of a contact law, condition of a non-smooth one into the columns of energy,
 * stiffness and damping, or conductance. */
void calx_trial_evaluate(struct calx_trial *, const struct calx_choice *);

/* Calls the response of a contact law into energy, stiffness and damping, from zero. */
void calx_trial_respond(struct calx_trial *, const struct calx_choice *);

/* Whether the choice has declared the column; those without a need are always there. */
bool calx_trial_declared(const struct calx_choice *, size_t column);

/* Checks that hold for every kernel over a batch: bitwise equal when cut or permuted, padding
 * ignored, undeclared inputs unused, undeclared outputs untouched. */
void calx_trial_check_batches(const struct calx_choice *, struct calx_conformance *);

/* Whether the plugin's outputs are finite, for overlaps down to the smallest number. */
void calx_trial_check_finite(struct calx_choice *, struct calx_conformance *);

/* A number in [low, high). */
double calx_conform_random(uint64_t *state, double low, double high);

/* ---- the kinds ---- */

calx_choice_visit calx_conform_contact, calx_conform_conductance, calx_conform_motion,
    calx_conform_temperature;

/* Stability and long-time energy of integrators of motion (conform_stability.c). */
calx_choice_visit calx_conform_stability;

/* Non-smooth contact laws (conform_condition.c). */
calx_choice_visit calx_conform_condition;

/* Energy over closed paths (conform_cycle.c). */
calx_choice_visit calx_conform_cycles;

#endif

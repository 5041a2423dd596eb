/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance of a contact law, by evaluations that stand alone: nothing without overlap, the
 * same physics in every direction, Coulomb's limit, and reported energy, stiffness and damping that
 * are the derivatives of the forces. Paths in time are in conform_cycle.c.
 */
#include <math.h>
#include <string.h>

#include "core/conform_parts.h"

enum { SEED = 31415 };

/* Round-off of a few dozen operations on numbers that are rotated, relative to the largest of a
 * column. */
static const double ROUND_OFF = 1e-11;
/* Central differences with a relative step h: error of order h^2, and of order 1e-16/h. */
static const double STEP = 1e-4, DERIVATIVE = 1e-6;

static double largest(const struct calx_trial *t, size_t column, size_t count)
{
    double most = 0;
    for (size_t k = column; k < column + count; k++)
        for (size_t c = 0; c < t->n; c++)
            most = fmax(most, fabs(t->column[k][c]));
    return most;
}

/* ---- nothing without overlap ---- */

/* Evaluates contacts at `overlap` with and without the history of a real contact: forces must be
 * exactly zero, and without history the work too. */
static void check_apart(const struct calx_choice *c, struct calx_conformance *report,
                        double overlap)
{
    struct calx_trial t;
    size_t forces = 0, works = 0;
    calx_trial_fill(&t, c, CALX_BATCH, SEED);
    for (int history = 1; history >= 0; history--) {
        if (!history)
            memset(t.column[CALX_COL_HISTORY], 0,
                   sizeof t.column[0] * (CALX_COL_COUNT - CALX_COL_HISTORY));
        for (size_t i = 0; i < t.n; i++)
            t.column[CALX_COL_OVERLAP][i] = overlap;
        calx_trial_clear(&t, c);
        struct calx_trial before = t;
        calx_trial_evaluate(&t, c);
        for (size_t k = CALX_COL_FN; k < CALX_COL_WORK; k++)
            for (size_t i = 0; i < t.n; i++)
                forces += calx_trial_declared(c, k) && t.column[k][i] != before.column[k][i];
        for (size_t i = 0; i < t.n && !history; i++)
            works += t.column[CALX_COL_WORK][i] != 0;
    }
    calx_conform_note(report, "no force without overlap", (double)forces, 0, c->where);
    calx_conform_note(report, "no work without a contact before", (double)works, 0, c->where);
}

/* A law that does nothing would pass every other check. (A force that is clipped may be 0 in a few
 * contacts that separate.) */
static void check_acts(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial t;
    double idle = 0;
    calx_trial_fill(&t, c, CALX_BATCH, SEED);
    struct calx_trial before = t;
    calx_trial_evaluate(&t, c);
    for (size_t i = 0; i < t.n; i++) {
        bool acts = false;
        for (size_t k = CALX_COL_FN; k < CALX_COL_WORK; k++)
            acts |= calx_trial_declared(c, k) && t.column[k][i] != before.column[k][i];
        idle += !acts;
    }
    calx_conform_note(report, "contacts act", idle / (double)t.n, 0.9, c->where);
}

/* Integrators take other coefficients where forces depend on velocities: a law must say so. */
static void check_velocities(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial slow, fast;
    size_t differ = 0;
    if (c->demand.needs & CALX_USES_VELOCITY)
        return;
    calx_trial_fill(&slow, c, CALX_BATCH, SEED);
    fast = slow;
    for (size_t k = CALX_COL_VN; k < CALX_COL_MASS; k++)
        for (size_t i = 0; i < fast.n; i++)
            fast.column[k][i] *= 2;
    calx_trial_evaluate(&slow, c);
    calx_trial_evaluate(&fast, c);
    for (size_t k = CALX_COL_FN; k < CALX_COL_WORK; k++)
        for (size_t i = 0; i < slow.n; i++)
            differ += calx_trial_declared(c, k) && slow.column[k][i] != fast.column[k][i];
    calx_conform_note(report, "forces use velocities only if declared", (double)differ, 0, c->where);
}

/* ---- objectivity ---- */

static void rotate(double (*v)[CALX_BATCH], size_t c)
{
    /* a quarter turn about (1, 1, 1)/sqrt(3), then one of 0.6, 0.8 about z: no axis stays */
    double x = v[2][c], y = v[0][c], z = v[1][c];
    v[0][c] = 0.6 * x - 0.8 * y;
    v[1][c] = 0.8 * x + 0.6 * y;
    v[2][c] = z;
}

static void rotate_all(struct calx_trial *t, const struct calx_choice *choice)
{
    static const size_t vectors[] = {CALX_COL_NORMAL, CALX_COL_VT, CALX_COL_SPIN, CALX_COL_FT,
                                     CALX_COL_TORQUE};
    for (size_t c = 0; c < t->n; c++) {
        for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
            rotate(&t->column[vectors[k]], c);
        for (size_t k = 0; k < choice->demand.history_vectors; k++)
            rotate(&t->column[CALX_COL_HISTORY + 3 * k], c);
    }
}

static void check_objectivity(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial a, b;
    double worst = 0;
    calx_trial_fill(&a, c, CALX_BATCH, SEED + 1);
    b = a;
    rotate_all(&b, c);
    calx_trial_evaluate(&a, c);
    calx_trial_evaluate(&b, c);
    rotate_all(&a, c);
    for (size_t k = CALX_COL_FN; k < CALX_COL_COUNT; k++) {
        double scale = largest(&a, k, 1) + 1e-300;
        for (size_t i = 0; i < a.n && calx_trial_declared(c, k); i++)
            worst = fmax(worst, fabs(a.column[k][i] - b.column[k][i]) / scale);
    }
    calx_conform_note(report, "same physics in every direction", worst, ROUND_OFF, c->where);
}

/* ---- friction ---- */

/* A choice of words may say that friction limits something else: only the first word of each is
 * checked. */
static bool other_words(const struct calx_choice *c)
{
    for (size_t i = 0; i < c->plugin->parameter_count; i++) {
        const struct calx_parameter *row = &c->plugin->parameters[i];
        if (row->flags & CALX_CHOICE &&
            *(const double *)((const char *)c->params + row->offset) != row->initial)
            return true;
    }
    return false;
}

static void check_friction(const struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_plugin *p = c->plugin;
    struct calx_trial t;
    double worst = 0;
    if (!(c->demand.needs & CALX_NEEDS_TANGENT) || other_words(c))
        return;
    calx_trial_fill(&t, c, CALX_BATCH, SEED + 2);
    calx_trial_evaluate(&t, c);
    for (size_t i = 0; i < p->parameter_count; i++) {
        if (strcmp(p->parameters[i].name, "friction") != 0)
            continue;
        double mu = *(const double *)((const char *)c->params + p->parameters[i].offset);
        for (size_t k = 0; k < t.n; k++) {
            double limit = mu * fabs(t.column[CALX_COL_COULOMB][k]);
            double ft = sqrt(t.column[CALX_COL_FT][k] * t.column[CALX_COL_FT][k] +
                             t.column[CALX_COL_FT + 1][k] * t.column[CALX_COL_FT + 1][k] +
                             t.column[CALX_COL_FT + 2][k] * t.column[CALX_COL_FT + 2][k]);
            worst = fmax(worst, (ft - limit) / (limit + 1e-300));
        }
        calx_conform_note(report, "|ft| <= mu |fn|", worst, ROUND_OFF, c->where);
    }
}

/* ---- derivatives ---- */

/* A batch of new contacts at rest, all of them touching. */
static void fill_rest(struct calx_trial *t, const struct calx_choice *c)
{
    calx_trial_fill(t, c, CALX_BATCH, SEED + 3);
    for (size_t i = 0; i < t->n; i++)
        t->column[CALX_COL_OVERLAP][i] = fabs(t->column[CALX_COL_OVERLAP][i]);
    memset(t->column[CALX_COL_VN], 0, sizeof t->column[0]);
    memset(t->column[CALX_COL_HISTORY], 0,
           sizeof t->column[0] * (CALX_COL_COUNT - CALX_COL_HISTORY));
    for (size_t k = CALX_COL_VT; k < CALX_COL_SPIN + 3; k++)
        if (calx_trial_declared(c, k))
            memset(t->column[k], 0, sizeof t->column[0]);
}

/* Evaluates and responds with the overlap times `factor` and the normal velocity vn[i] (NULL: 0).
 */
static void probe(const struct calx_trial *rest, const struct calx_choice *c, double factor,
                  const double *vn, double sign, struct calx_trial *out)
{
    *out = *rest;
    for (size_t i = 0; i < rest->n; i++) {
        out->column[CALX_COL_OVERLAP][i] *= factor;
        out->column[CALX_COL_VN][i] = vn ? sign * vn[i] : 0;
    }
    calx_trial_clear(out, c);
    calx_trial_evaluate(out, c);
    calx_trial_respond(out, c);
}

static void check_normal_derivatives(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial rest, mid, up, down;
    double energy = 0, stiffness = 0, damping = 0, vn[CALX_BATCH];
    fill_rest(&rest, c);
    probe(&rest, c, 1, NULL, 0, &mid);
    probe(&rest, c, 1 + STEP, NULL, 0, &up);
    probe(&rest, c, 1 - STEP, NULL, 0, &down);
    for (size_t i = 0; i < rest.n; i++) {
        double d = rest.column[CALX_COL_OVERLAP][i],
               f = mid.column[CALX_COL_FN][i] - rest.column[CALX_COL_FN][i];
        double k = mid.column[CALX_COL_STIFFNESS][i], ct = mid.column[CALX_COL_DAMPING][i];
        double slope = (up.column[CALX_COL_FN][i] - down.column[CALX_COL_FN][i]) / (2 * STEP * d);
        double release =
            (up.column[CALX_COL_ENERGY][i] - down.column[CALX_COL_ENERGY][i]) / (2 * STEP * d);
        energy = fmax(energy, fabs(release - f) / (fabs(f) + 1e-300));
        stiffness = fmax(stiffness, fabs(slope - k) / (fabs(k) + fabs(f) / d + 1e-300));
        vn[i] = 1e-3 * fabs(f) / (ct > 0 ? ct : 1);
    }
    probe(&rest, c, 1, vn, 1, &up);
    probe(&rest, c, 1, vn, -1, &down);
    for (size_t i = 0; i < rest.n; i++) {
        double ct = mid.column[CALX_COL_DAMPING][i];
        double measured = (down.column[CALX_COL_FN][i] - up.column[CALX_COL_FN][i]) / (2 * vn[i]);
        damping = fmax(damping, fabs(measured - ct) / (ct > 0 ? ct : 1));
    }
    calx_conform_note(report, "normal force = -d energy/d overlap", energy, DERIVATIVE, c->where);
    calx_conform_note(report, "reported normal stiffness", stiffness, DERIVATIVE, c->where);
    calx_conform_note(report, "reported normal damping", damping, DERIVATIVE, c->where);
}

/* The size of the tangential force after one step dt at a small speed, over that speed: kt dt + ct.
 */
static void tangential_slope(const struct calx_trial *rest, const struct calx_choice *c,
                             const double *speed, double dt, double *slope)
{
    struct calx_trial t = *rest;
    t.dt = dt;
    for (size_t i = 0; i < t.n; i++) { /* any direction across the normal */
        double x = t.column[CALX_COL_NORMAL][i], y = t.column[CALX_COL_NORMAL + 1][i],
               s = sqrt(x * x + y * y);
        t.column[CALX_COL_VT][i] = -speed[i] * y / s;
        t.column[CALX_COL_VT + 1][i] = speed[i] * x / s;
    }
    calx_trial_clear(&t, c);
    calx_trial_evaluate(&t, c);
    for (size_t i = 0; i < t.n; i++)
        slope[i] = sqrt(t.column[CALX_COL_FT][i] * t.column[CALX_COL_FT][i] +
                        t.column[CALX_COL_FT + 1][i] * t.column[CALX_COL_FT + 1][i] +
                        t.column[CALX_COL_FT + 2][i] * t.column[CALX_COL_FT + 2][i]) /
                   speed[i];
}

static void check_tangential_derivatives(const struct calx_choice *c,
                                         struct calx_conformance *report)
{
    struct calx_trial rest, mid;
    double speed[CALX_BATCH], one[CALX_BATCH], two[CALX_BATCH], worst = 0;
    fill_rest(&rest, c);
    probe(&rest, c, 1, NULL, 0, &mid);
    const double *kt = mid.column[CALX_COL_STIFFNESS + 1], *ct = mid.column[CALX_COL_DAMPING + 1];
    double dt = kt[0] > 0 && ct[0] > 0 ? ct[0] / kt[0] : 1e-3;
    for (size_t i = 0; i < rest.n; i++) /* far from slipping */
        speed[i] = 1e-6 * rest.column[CALX_COL_COULOMB][i] / (2 * kt[i] * dt + ct[i] + 1e-9);
    if (!calx_trial_declared(c, CALX_COL_COULOMB))
        for (size_t i = 0; i < rest.n; i++)
            speed[i] = 1e-6;
    tangential_slope(&rest, c, speed, dt, one);
    tangential_slope(&rest, c, speed, 2 * dt, two);
    for (size_t i = 0; i < rest.n; i++) {
        double growth = two[i] - one[i], scale = kt[i] * dt + ct[i] + 1e-9;
        worst = fmax(worst, (fabs(growth - kt[i] * dt) + fabs(one[i] - growth - ct[i])) / scale);
    }
    calx_conform_note(report, "reported tangential stiffness and damping", worst, DERIVATIVE,
                      c->where);
}

/* ---- all ---- */

void calx_conform_contact(struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_contact_law *law = c->plugin->law;
    if (law->nonsmooth) {
        calx_conform_condition(c, report);
        return;
    }
    calx_trial_check_batches(c, report);
    calx_trial_check_finite(c, report);
    check_apart(c, report, -c->demand.gap - 1e-6);
    check_apart(c, report, -c->demand.gap);
    check_acts(c, report);
    check_velocities(c, report);
    check_objectivity(c, report);
    check_friction(c, report);
    if (law->provides & (CALX_NORMAL | CALX_COHESION))
        check_normal_derivatives(c, report);
    if (c->demand.needs & CALX_NEEDS_TANGENT)
        check_tangential_derivatives(c, report);
    calx_conform_cycles(c, report);
}

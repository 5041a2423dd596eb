/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The energy of a contact law over paths in time. The motion is prescribed, with the velocity of
 * each step equal to its displacement over dt as under velocity Verlet, so that the work put in,
 * the trapezoid of the forces, must equal what the law reports as stored and as dissipated. Paths:
 * an impact from apart to apart; sliding in a closed loop at constant overlap, and the release
 * after it.
 */
#include <math.h>
#include <string.h>

#include "core/conform_parts.h"

enum { SEED = 27182, STEPS = 2000 };

/* The trapezoid of a smooth force over n steps errs by about (pi/n)^2/2 of the energy, 1.2e-6; a
 * rule of first order by 1/n, 5e-4. */
static const double BOOKS = 2e-5;
/* Dissipation may be negative by round-off only: the sum of 2000 terms. */
static const double GAIN = 1e-10;

/* Running sums per contact. */
struct books {
    struct calx_trial t;
    double work_in[CALX_BATCH], lost[CALX_BATCH], stored[CALX_BATCH], scale[CALX_BATCH],
        residual[CALX_BATCH];
    double force[7][CALX_BATCH]; /* fn, ft, torque of the evaluation before */
};

/* A path: overlap, tangential displacement and rotation, as shares of their amplitudes, at phase s
 * in [0, 1]. */
struct path {
    double (*overlap)(double s);
    double (*slide)(double s, int k);
};

static double overlap_cycle(double s)
{
    return 0.5 - 0.5 * cos(2 * M_PI * s);
}

static double overlap_held(double s)
{
    (void)s;
    return 1;
}

static double overlap_release(double s)
{
    return 0.5 + 0.5 * cos(M_PI * s);
}

static double slide_loop(double s, int k)
{
    return k == 0 ? sin(4 * M_PI * s) : 0.5 * sin(8 * M_PI * s);
}

static double slide_on(double s, int k)
{
    return k == 0 ? 0.1 * s : 0;
}

static const struct path impact = {overlap_cycle, slide_loop}, loop = {overlap_held, slide_loop},
                         release = {overlap_release, slide_on};

/* What the path is scaled with, per contact. */
struct amplitudes {
    double low[CALX_BATCH], high[CALX_BATCH];   /* overlap, m */
    double slide[CALX_BATCH], turn[CALX_BATCH]; /* m, rad */
    double normal_force[CALX_BATCH];            /* N, at `high` */
};

static void remember(struct books *b, const struct calx_choice *c)
{
    for (size_t i = 0; i < b->t.n; i++) {
        b->force[0][i] =
            b->t.column[CALX_COL_FN][i] -
            (calx_trial_declared(c, CALX_COL_COULOMB) ? b->t.column[CALX_COL_COULOMB][i] : 0);
        for (size_t k = 0; k < 6; k++) {
            size_t col = k < 3 ? CALX_COL_FT + k : CALX_COL_TORQUE + k - 3;
            b->force[k + 1][i] = calx_trial_declared(c, col) ? b->t.column[col][i] : 0;
        }
    }
}

/* Sets the kinematics of the step from phase s0 to s1. Two directions across the normal, which is
 * x, are y and z. */
static void set_step(struct books *b, const struct calx_choice *c, const struct amplitudes *a,
                     const struct path *p, double s0, double s1)
{
    double(*col)[CALX_BATCH] = b->t.column;
    for (size_t i = 0; i < b->t.n; i++) {
        double d0 = a->low[i] + (a->high[i] - a->low[i]) * p->overlap(s0);
        double d1 = a->low[i] + (a->high[i] - a->low[i]) * p->overlap(s1);
        col[CALX_COL_OVERLAP][i] = d1;
        col[CALX_COL_VN][i] = -(d1 - d0) / b->t.dt;
        if (calx_trial_declared(c, CALX_COL_COULOMB))
            col[CALX_COL_COULOMB][i] = a->normal_force[i] * pow(fmax(d1 / a->high[i], 0), 1.5);
        for (int k = 0; k < 2; k++) {
            double step = (p->slide(s1, k) - p->slide(s0, k)) / b->t.dt;
            if (calx_trial_declared(c, CALX_COL_VT))
                col[CALX_COL_VT + 1 + k][i] = a->slide[i] * step;
            if (calx_trial_declared(c, CALX_COL_SPIN))
                col[CALX_COL_SPIN + 1 + k][i] = a->turn[i] * step;
        }
    }
}

/* One evaluation: adds what went in and what was lost since the one before. */
static void account(struct books *b, const struct calx_choice *c)
{
    static const size_t velocity[] = {CALX_COL_VN,      CALX_COL_VT,   CALX_COL_VT + 1,
                                      CALX_COL_VT + 2,  CALX_COL_SPIN, CALX_COL_SPIN + 1,
                                      CALX_COL_SPIN + 2};
    double old[7][CALX_BATCH];
    memcpy(old, b->force, sizeof old);
    calx_trial_clear(&b->t, c);
    calx_trial_evaluate(&b->t, c);
    calx_trial_respond(&b->t, c);
    remember(b, c);
    for (size_t i = 0; i < b->t.n; i++) {
        double power = 0;
        for (size_t k = 0; k < 7; k++)
            if (calx_trial_declared(c, velocity[k]))
                power += 0.5 * (old[k][i] + b->force[k][i]) * b->t.column[velocity[k]][i];
        b->work_in[i] -= power * b->t.dt;
        b->lost[i] += b->t.column[CALX_COL_WORK][i];
        b->stored[i] = b->t.column[CALX_COL_ENERGY][i];
        b->scale[i] =
            fmax(b->scale[i], fmax(fabs(b->work_in[i]), fmax(fabs(b->lost[i]), b->stored[i])));
        /* at every step: over a closed path errors of first order cancel */
        b->residual[i] = fmax(b->residual[i], fabs(b->work_in[i] - b->stored[i] - b->lost[i]));
    }
}

static void walk(struct books *b, const struct calx_choice *c, const struct amplitudes *a,
                 const struct path *p)
{
    for (int n = 0; n < STEPS; n++) {
        set_step(b, c, a, p, (double)n / STEPS, (n + 1.0) / STEPS);
        account(b, c);
    }
}

static double worst_residual(const struct books *b)
{
    double worst = 0;
    for (size_t i = 0; i < b->t.n; i++)
        worst = fmax(worst, b->residual[i] / (b->scale[i] + 1e-300));
    return worst;
}

static double worst_gain(const struct books *b)
{
    double worst = 0;
    for (size_t i = 0; i < b->t.n; i++)
        worst = fmax(worst, -b->lost[i] / (b->scale[i] + 1e-300));
    return worst;
}

/* New contacts with the normal along x, and amplitudes from what the law says of its stiffness. */
static void begin(struct books *b, struct amplitudes *a, const struct calx_choice *c)
{
    memset(b, 0, sizeof *b);
    calx_trial_fill(&b->t, c, CALX_BATCH, SEED);
    memset(b->t.column[CALX_COL_HISTORY], 0,
           sizeof b->t.column[0] * (CALX_COL_COUNT - CALX_COL_HISTORY));
    for (size_t k = CALX_COL_NORMAL; k < CALX_COL_SPIN + 3; k++)
        for (size_t i = 0; i < b->t.n && calx_trial_declared(c, k); i++)
            b->t.column[k][i] = k == CALX_COL_NORMAL;
    for (size_t i = 0; i < b->t.n; i++)
        b->t.column[CALX_COL_OVERLAP][i] = a->high[i] = fabs(b->t.column[CALX_COL_OVERLAP][i]);
    for (size_t k = CALX_COL_VN; k < CALX_COL_SPIN + 3; k++)
        for (size_t i = 0; i < b->t.n && calx_trial_declared(c, k); i++)
            b->t.column[k][i] = 0;
    calx_trial_respond(&b->t, c);
    double k0 = fmax(b->t.column[CALX_COL_STIFFNESS][0], b->t.column[CALX_COL_STIFFNESS + 1][0]);
    b->t.dt = (k0 > 0 ? 2 * M_PI / sqrt(k0 / b->t.column[CALX_COL_MASS][0]) : 1) / STEPS;
    for (size_t i = 0; i < b->t.n; i++) {
        double kt = b->t.column[CALX_COL_STIFFNESS + 1][i];
        a->normal_force[i] =
            calx_trial_declared(c, CALX_COL_COULOMB) ? b->t.column[CALX_COL_COULOMB][i] : 0;
        a->low[i] = -c->demand.gap - 0.01 * a->high[i];
        a->slide[i] = kt > 0 && a->normal_force[i] > 0 ? 2 * a->normal_force[i] / kt : a->high[i];
        a->turn[i] = a->slide[i] * b->t.column[CALX_COL_CURVATURE][i];
    }
}

/* After its end a contact holds no energy, gives no force, and books nothing more. */
static void check_end(struct books *b, const struct calx_choice *c, struct calx_conformance *report)
{
    double lost[CALX_BATCH], worst = 0;
    memcpy(lost, b->lost, sizeof lost);
    account(b, c);
    for (size_t i = 0; i < b->t.n; i++) {
        worst = fmax(worst, fabs(b->lost[i] - lost[i]) / (b->scale[i] + 1e-300));
        worst = fmax(worst, b->stored[i] / (b->scale[i] + 1e-300));
        for (size_t k = 0; k < 7; k++)
            worst = fmax(worst, fabs(b->force[k][i]) / 1e-300);
    }
    calx_conform_note(report, "nothing is left after a contact", worst, 0, c->where);
}

void calx_conform_cycles(struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_contact_law *law = c->plugin->law;
    struct books b;
    struct amplitudes a;
    begin(&b, &a, c);
    if (law->provides & (CALX_NORMAL | CALX_COHESION)) {
        walk(&b, c, &a, &impact);
        calx_conform_note(report, "dissipation >= 0 over a closed cycle", worst_gain(&b), GAIN,
                          c->where);
    } else {
        walk(&b, c, &a, &loop);
        calx_conform_note(report, "dissipation >= 0 over a closed cycle", worst_gain(&b), GAIN,
                          c->where);
        walk(&b, c, &a, &release);
    }
    check_end(&b, c, report);
    calx_conform_note(report, "work in = stored + dissipated", worst_residual(&b), BOOKS, c->where);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "arkode": an explicit Runge-Kutta pair of orders 6 and 5 by the ARKODE solver of SUNDIALS, which also finds the moments at
 * which contacts begin and end, so that no sub-step goes over one: forces are smooth within each. A reference for small scenes: all
 * bodies share one sub-step, and it takes tens of evaluations to pass a moment at which forces jump. (Fehlberg's pair of orders 8 and 7
 * does not see such a jump: its estimate leaves out what happens between the ends of the step.)
 * References: Verner, SIAM J. Numer. Anal. 15 (1978) 772; Reynolds et al., ACM Trans. Math. Softw. 49 (2023) 19 (ARKODE); Hindmarsh et al.,
 * ACM Trans. Math. Softw. 31 (2005) 363 (SUNDIALS).
 * Laws with history (friction) see it as it was at the start of a sub-step and take one increment from there: what they do is right to
 * second order in the sub-step, whatever the tolerance. Give those scenes a short time step, which is the longest sub-step.
 * Vector of ARKODE: per body displacement since the start of the step (it has more digits than a position), velocity, spin, in order of
 * rows at the start of the step. A body's place in it is kept in the body's extra state, because rows may be sorted anew at any
 * evaluation; positions in rows move by differences, because they may be wrapped around.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>

#include "core/plugin.h"

enum { X = 0, V = 3, W = 6, PER_BODY = 9 };
enum { FAILURES = 200, STEPS = 1000000 }; /* of error tests in one sub-step; sub-steps in one step */

struct solver {
    SUNContext context;
    void *arkode;
    N_Vector y, tolerances;
    double *placed; /* what rows show now */
    size_t bodies;  /* there is room for */
    /* the step under way */
    const struct calx_motion_host *host;
    double first;  /* address of the first row's velocities, as a number: exact below 2^53 */
    double kept;   /* s since its start: the last evaluation that was kept */
    int stopped;   /* the engine wants the run to stop */
};

/* No tolerance is below what numbers can tell apart. */
static const double ROUNDING = 4e-16;

struct arkode {
    double tolerance;
    struct solver *solver;
};

static const struct calx_parameter parameters[] = {
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Error of a sub-step, root mean square over all bodies: in positions and in velocities times the time step relative to the "
            "radius; for spins in the angle.",
     .initial = 1e-14,
     .min = 1e-17,
     .max = 1e-6,
     .scope = CALX_RUN,
     .offset = offsetof(struct arkode, tolerance)},
};

/* ---- rows and vector ---- */

struct task {
    struct solver *solver;
    const double *from; /* of the vector */
    double *to;
    double tolerance, dt;
};

static double end_of_rows(const void *params, const struct calx_rows *r)
{
    (void)params;
    return (double)(uintptr_t)(r->v + r->stride * r->n);
}

/* How many bytes before `end` rows begin. */
static double bytes_before(const void *params, const struct calx_rows *r)
{
    return *(const double *)params - (double)(uintptr_t)r->v;
}

static double stride_of(const void *params, const struct calx_rows *r)
{
    (void)params;
    return (double)r->stride;
}

static void number(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    size_t first = (size_t)((double)(uintptr_t)r->v - t->solver->first) / (r->stride * sizeof(double));
    for (size_t i = 0; i < r->n; i++)
        r->extra[0][4 * i] = (double)(first + i);
}

static double *numbers_of(double *vector, const struct calx_rows *r, size_t i)
{
    return vector + PER_BODY * (size_t)r->extra[0][4 * i];
}

/* The state to the vector, and how far it may be off. */
static void take_motion(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    double *tolerances = N_VGetArrayPointer(t->solver->tolerances);
    for (size_t i = 0; i < r->n; i++) {
        double *y = numbers_of(t->to, r, i), *w = numbers_of(tolerances, r, i), far = t->tolerance * r->x[4 * i + 3];
        const double *v = r->v + i * r->stride;
        double rounding = ROUNDING * (fabs(v[0]) + fabs(v[1]) + fabs(v[2]));
        for (size_t k = 0; k < 3; k++) {
            y[X + k] = 0;
            y[V + k] = v[k];
            w[X + k] = fmax(far, rounding * t->dt);
            w[V + k] = fmax(far / t->dt, rounding);
        }
    }
}

static void take_spin(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    for (size_t i = 0; i < r->n; i++)
        memcpy(numbers_of(t->to, r, i) + W, r->v + i * r->stride, 3 * sizeof(double));
}

static void put_motion(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    for (size_t i = 0; i < r->n; i++) {
        const double *y = t->from + PER_BODY * (size_t)r->extra[0][4 * i];
        double *placed = numbers_of(t->solver->placed, r, i);
        for (size_t k = 0; k < 3; k++) {
            r->x[4 * i + k] += y[X + k] - placed[X + k];
            r->v[i * r->stride + k] = y[V + k];
            placed[X + k] = y[X + k];
        }
    }
}

static void put_spin(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    for (size_t i = 0; i < r->n; i++)
        memcpy(r->v + i * r->stride, t->from + PER_BODY * (size_t)r->extra[0][4 * i] + W, 3 * sizeof(double));
}

/* Rates of change; lanes without a step stay. */
static void take_rates(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    for (size_t i = 0; i < r->n; i++) {
        double *rate = numbers_of(t->to, r, i);
        for (size_t k = 0; k < 3; k++) {
            double moves = r->dt[k] != 0 ? 1 : 0;
            rate[X + k] = moves * r->v[i * r->stride + k];
            rate[V + k] = moves * r->a[i * r->stride + k];
        }
    }
}

static void take_spin_rates(const void *params, const struct calx_rows *r)
{
    const struct task *t = params;
    for (size_t i = 0; i < r->n; i++) {
        double *rate = numbers_of(t->to, r, i);
        for (size_t k = 0; k < 3; k++)
            rate[W + k] = r->dt[k] != 0 ? r->a[i * r->stride + k] : 0;
    }
}

static void place(struct solver *s, const double *y)
{
    const struct task t = {.solver = s, .from = y};
    s->host->each(s->host->engine, s->host->dt, put_motion, put_spin, &t);
}

/* ---- what ARKODE asks for; times are those since the start of the step ---- */

static int rates(sunrealtype t, N_Vector y, N_Vector rate, void *user)
{
    struct solver *s = user;
    const struct calx_motion_host *host = s->host;
    const struct task task = {.solver = s, .to = N_VGetArrayPointer(rate)};
    const struct calx_evaluation ask = {.time = host->t + t, .elapsed = t - s->kept};
    N_VConst(0, rate); /* spins of bodies that have none */
    place(s, N_VGetArrayPointer(y));
    s->stopped = host->forces(host->engine, &ask);
    if (s->stopped)
        return -1;
    host->each(host->engine, host->dt, take_rates, take_spin_rates, &task);
    return 0;
}

/* Positive until a contact begins or ends. */
static int change(sunrealtype t, N_Vector y, sunrealtype *value, void *user)
{
    struct solver *s = user;
    place(s, N_VGetArrayPointer(y));
    *value = fmin(s->host->change(s->host->engine, s->host->t + t), 1e100);
    s->stopped = isnan(*value);
    return s->stopped ? -1 : 0;
}

/* ---- the solver ---- */

static void clear(struct solver *s)
{
    if (s->arkode)
        ERKStepFree(&s->arkode);
    N_VDestroy(s->y);
    N_VDestroy(s->tolerances);
    free(s->placed);
    s->y = s->tolerances = NULL;
    s->placed = NULL;
    s->bodies = 0;
}

/* A solver for so many bodies: 0, or 1. */
static int fit(struct solver *s, size_t bodies)
{
    if (s->bodies == bodies)
        return 0;
    clear(s);
    s->y = N_VNew_Serial((sunindextype)(PER_BODY * bodies), s->context);
    s->tolerances = N_VNew_Serial((sunindextype)(PER_BODY * bodies), s->context);
    s->placed = calloc(PER_BODY * bodies, sizeof *s->placed);
    if (!s->y || !s->tolerances || !s->placed)
        return 1;
    N_VConst(0, s->y);
    N_VConst(1, s->tolerances);
    s->arkode = ERKStepCreate(rates, 0, s->y, s->context);
    s->bodies = bodies;
    return !s->arkode || ERKStepSetErrFile(s->arkode, NULL) || ERKStepSetUserData(s->arkode, s) || ERKStepSetTableNum(s->arkode, ARKODE_VERNER_8_5_6) ||
           ERKStepRootInit(s->arkode, 1, change) ||
           ERKStepSetMaxErrTestFails(s->arkode, FAILURES) || ERKStepSetMaxNumSteps(s->arkode, STEPS) ||
           ERKStepSetNoInactiveRootWarn(s->arkode);
}

/* The state into the vector, and the solver at the start of a step. */
static int begin(struct solver *s, const struct arkode *p, const struct calx_motion_host *host)
{
    double end = host->largest(host->engine, host->dt, end_of_rows, end_of_rows, NULL);
    double bytes = host->largest(host->engine, host->dt, bytes_before, bytes_before, &end);
    double stride = host->largest(host->engine, host->dt, stride_of, stride_of, NULL);
    s->host = host;
    s->first = end - bytes;
    s->kept = 0;
    s->stopped = 0;
    if (fit(s, stride > 0 ? (size_t)(bytes / (stride * sizeof(double))) : 1))
        return 1;
    struct task t = {.solver = s, .to = N_VGetArrayPointer(s->y), .tolerance = p->tolerance, .dt = host->dt};
    host->each(host->engine, host->dt, number, number, &t);
    host->each(host->engine, host->dt, take_motion, take_spin, &t);
    memset(s->placed, 0, PER_BODY * s->bodies * sizeof *s->placed);
    double *tolerances = N_VGetArrayPointer(s->tolerances);
    for (size_t b = 0; b < s->bodies; b++)
        for (size_t k = W; k < PER_BODY; k++)
            tolerances[PER_BODY * b + k] = fmax(p->tolerance / host->dt, ROUNDING * fabs(t.to[PER_BODY * b + k]));
    double first = host->memory[0] > 0 ? fmin(host->memory[0], host->dt) : 0.1 * host->dt;
    return ERKStepReInit(s->arkode, rates, 0, s->y) || ERKStepSVtolerances(s->arkode, 0, s->tolerances) || ERKStepSetInitStep(s->arkode, first) ||
           ERKStepSetMaxStep(s->arkode, host->dt) || ERKStepSetStopTime(s->arkode, host->dt);
}

/* The evaluation at the end of a sub-step, which laws keep. */
static int keep(struct solver *s, double t)
{
    const struct calx_motion_host *host = s->host;
    struct calx_evaluation ask = {.time = t < host->dt ? host->t + t : host->t + host->dt, .elapsed = t - s->kept, .keep = 1};
    place(s, N_VGetArrayPointer(s->y));
    s->kept = t;
    s->stopped = host->forces(host->engine, &ask);
    return s->stopped;
}

/* On from a sub-step that ended at t, after a contact has changed with a short one. ARKODE 5.4 takes the slope of the last stage, which is at the
 * end of the sub-step too, for that of the result, and falls to third order with it: it is told to start anew. */
static int go_on(struct solver *s, double t, int changed, double *last)
{
    double left = s->host->dt - t, next = 0.1 * left;
    if (!changed && (ERKStepGetLastStep(s->arkode, last) || ERKStepGetCurrentStep(s->arkode, &next)))
        return 1;
    return ERKStepReset(s->arkode, t, s->y) || ERKStepSetInitStep(s->arkode, fmin(next, left)) || ERKStepSetStopTime(s->arkode, s->host->dt);
}

static int advance(const void *params, const struct calx_motion_host *host, char *why, size_t why_size)
{
    const struct arkode *p = params;
    struct solver *s = p->solver;
    double t = 0, rounding = 1e-12 * host->dt, last = 0;
    if (begin(s, p, host)) {
        snprintf(why, why_size, "no memory for the solver");
        return 1;
    }
    while (t < host->dt) {
        int flag = ERKStepEvolve(s->arkode, host->dt, s->y, &t, ARK_ONE_STEP);
        if (s->stopped)
            return 1;
        if (flag < 0) {
            char *name = ERKStepGetReturnFlagName(flag);
            snprintf(why, why_size, "%s after %g s of a step of %g s; tolerance %g: give a larger one, or a shorter step", name, t,
                     host->dt, p->tolerance);
            free(name);
            return 1;
        }
        t = host->dt - t < rounding ? host->dt : t;
        if (keep(s, t))
            return 1;
        if (t < host->dt && go_on(s, t, flag == ARK_ROOT_RETURN, &last))
            return 1;
    }
    host->memory[0] = last;
    return 0;
}

static void release(void *params)
{
    struct arkode *p = params;
    if (!p->solver)
        return;
    clear(p->solver);
    SUNContext_Free(&p->solver->context);
    free(p->solver);
    p->solver = NULL;
}

static int prepare(const struct calx_setup *setup, void *params, struct calx_motion_integrator *law, char *why, size_t why_size)
{
    struct arkode *p = params;
    (void)setup, (void)law;
    p->solver = calloc(1, sizeof *p->solver);
    if (p->solver && SUNContext_Create(NULL, &p->solver->context) == 0)
        return 0;
    free(p->solver);
    p->solver = NULL;
    snprintf(why, why_size, "no memory for the solver");
    return 1;
}

static const char *const extra[] = {"place"};

static const struct calx_motion_integrator law = {
    .order = 6,
    .stability = 3.14, /* half a contact: no sub-step passes over one unseen */
    .damping = 5,
    .extra_translation = 1,
    .extra_rotation = 1,
    .extra = extra,
    .prepare = prepare,
    .release = release,
    .advance = advance,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "arkode",
    .summary = "adaptive, finds where contacts begin and end: the reference for small scenes (SUNDIALS)",
    .reference = "Verner, SIAM J. Numer. Anal. 15 (1978) 772; Reynolds et al., ACM Trans. Math. Softw. 49 (2023) 19",
    .equation = "k_s = f(y + h sum_j a_sj k_j);  y += h sum b_s k_s;  |h sum (b_s - b*_s) k_s| < tol;\n"
                "a sub-step ends where a gap or an overlap reaches 0",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct arkode),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contacts that begin or end inside the step. A leapfrog is a sum of equal kicks, h sum F(t_k), where the impulse is
 * an integral. For F = t^p after an onset s steps before t_1 the sum exceeds it by zeta(-p, s), Hurwitz' function
 * (Navot, J. Math. and Phys. 40 (1961) 271): p = 0 makes the jump of a damper an error of first order, p = 1/4 and
 * 3/2 are Tsuji's and Hertz' forces. So in the step of the onset, and in that of the end, which is an onset in
 * reverse, the laws are tried at four moments after it, powers 0, 1/4, 1, 3/2 are laid through what they answer, and
 * the kick is what makes the sum right for them. The moment of the impulse before t_1 is made good too: a kick more
 * then and less one step later, which waits in history. Damping takes the velocity at t_k, where laws see that of
 * half a step before.
 */
#include "core/onset.h"

enum { NODES = CALX_ONSET_NODES, TERMS = 8 };

/* The fourth powers of quarters: their powers 0, 1/4, 1, 3/2 are rational, */
const double CALX_ISA(calx_onset_node)[NODES] = {1.0 / 256, 1.0 / 16, 81.0 / 256, 1.0};
/* and so is what turns forces at the nodes into factors of these powers. Row: node; column: power. */
static const double factor[NODES][NODES] = {
    {3516.0 / 1435, -244.0 / 41, 6176.0 / 615, -5632.0 / 861},
    {-2838.0 / 1435, 338.0 / 41, -4576.0 / 205, 4608.0 / 287},
    {124.0 / 205, -108.0 / 41, 2976.0 / 205, -512.0 / 41},
    {-111.0 / 1435, 14.0 / 41, -1376.0 / 615, 2560.0 / 861}};

/* ---- weights ---- */

/* -zeta(-1/4, s) and -zeta(-3/2, s): Euler and Maclaurin's formula from the eighth term on, the next term of which is
 * below 1e-7. */
static void tails(calx_v8 s, calx_v8 *quarter, calx_v8 *hertz)
{
    calx_v8 q = s + (double)TERMS, root = calx_v8_sqrt(q), y = calx_v8_sqrt(root), cube = q * q * q;
    *quarter = y * (q / 1.25 - 0.5 + 1.0 / (48.0 * q) - 0.25 * -0.75 * -1.75 / (720.0 * cube));
    *hertz = q * root * (q / 2.5 - 0.5 + 0.125 / q - 1.5 * 0.5 * -0.5 / (720.0 * cube));
    for (int j = 0; j < TERMS; j++) {
        calx_v8 t = s + (double)j, r = calx_v8_sqrt(t);
        *quarter -= calx_v8_sqrt(r);
        *hertz -= t * r;
    }
}

static void through_powers(const calx_v8 at[NODES], calx_v8 weight[NODES])
{
    for (int node = 0; node < NODES; node++) {
        weight[node] = (calx_v8){0};
        for (int p = 0; p < NODES; p++)
            weight[node] += factor[node][p] * at[p];
    }
}

void CALX_ISA(calx_onset_weigh)(calx_v8 s, struct calx_onset_weights *w)
{
    calx_v8 root = calx_v8_sqrt(s), y = calx_v8_sqrt(root), s2 = s * s;
    calx_v8 force[NODES] = {(calx_v8){0} + 1.0, y, s, s * root};
    calx_v8 tail[NODES] = {s - 0.5, {0}, 0.5 * (s2 - s + 1.0 / 6), {0}};
    calx_v8 later[NODES] = {s2 / 2.0, s2 * y / (1.25 * 2.25), s2 * s / 6.0, s2 * s * root / (2.5 * 3.5)};
    tails(s, &tail[1], &tail[3]);
    through_powers(force, w->force);
    through_powers(tail, w->tail);
    through_powers(later, w->later);
}

/* ---- which contacts ---- */

/* Those that began, or those that ended, in this step, and what is found of them. Columns have one lane per contact,
 * and come first, so that they are aligned. */
struct calx_changes {
    calx_column share;        /* of a step: from onset to now, or from the evaluation before to the end */
    calx_column speed, depth; /* m/s, m: of the approach, or of the parting in reverse, at the node under way */
    calx_column vn, vt[3], spin[3]; /* as the laws saw them */
    calx_column fn, ft[3], torque[3], work, owed; /* sums over nodes; work: of normal laws */
    bool begin;
    size_t n;
    uint8_t lane[CALX_BATCH]; /* in the batch */
} __attribute__((aligned(64)));

/* One that did not come, or go, by its own speed is left as it is: nothing is known of it. */
static void note_change(const struct calx_columns *c, size_t lane, double h, struct calx_changes *x)
{
    double sign = x->begin ? 1.0 : -1.0, gap = sign * c->overlap[lane], speed = -sign * c->vn[lane];
    if (!(speed > 0.0) || !(c->mass[lane] > 0.0) || !(gap > 0.0))
        return;
    double share = gap < speed * h ? gap / (speed * h) : 1.0;
    x->lane[x->n] = (uint8_t)lane;
    x->vn[x->n] = c->vn[lane];
    x->speed[x->n] = speed;
    x->share[x->n++] = x->begin ? share : 1.0 - share;
}

static void find_changes(const struct calx_columns *c, double h, bool begin, struct calx_changes *x)
{
    x->begin = begin;
    x->n = 0;
    for (size_t group = 0; group < calx_padded(c->n) / 8; group++) {
        unsigned bits = begin ? c->is[group] & ~c->was[group] : c->was[group] & ~c->is[group];
        for (; bits; bits &= bits - 1)
            note_change(c, 8 * group + (size_t)__builtin_ctz(bits), h, x);
    }
}

/* ---- the laws at the nodes ---- */

static void take_columns(calx_column *to, const calx_column *from, size_t count, const struct calx_changes *x)
{
    for (size_t q = 0; q < count; q++)
        for (size_t k = 0; k < x->n; k++)
            to[q][k] = from[q][x->lane[k]];
}

/* What laws see of the contacts but for overlap and normal velocity. Padding keeps what it has, which is finite;
 * without mass it would not be. */
static void take_contacts(const struct calx_plan *p, const struct calx_columns *c, struct calx_changes *x,
                          struct calx_columns *node)
{
    node->n = x->n;
    take_columns(node->normal, c->normal, 3, x);
    take_columns(&node->mass, &c->mass, 1, x);
    take_columns(node->curvature, c->curvature, 2, x);
    if (p->needs & CALX_NEEDS_TANGENT)
        take_columns(node->vt, c->vt, 3, x);
    if (p->needs & CALX_NEEDS_SPIN)
        take_columns(node->spin, c->spin, 3, x);
    if (p->needs & CALX_NEEDS_TEMPERATURE)
        take_columns(node->temperature, c->temperature, 2, x);
    memcpy(x->vt, node->vt, sizeof x->vt);
    memcpy(x->spin, node->spin, sizeof x->spin);
    for (size_t k = x->n; k < calx_padded(x->n); k++) {
        node->mass[k] = x->share[k] = 1.0;
        x->speed[k] = 0.0;
    }
    for (size_t k = 0; k < calx_padded(x->n); k++)
        x->depth[k] = x->fn[k] = x->work[k] = x->owed[k] = node->fn[k] = 0.0;
    memset(x->ft, 0, sizeof x->ft);
    memset(x->torque, 0, sizeof x->torque);
}

static void run_laws(const struct calx_plan *p, size_t type, double time, const struct calx_columns *c,
                     const struct calx_changes *x, struct calx_columns *node)
{
    for (size_t q = 0; q < p->history; q++) {
        node->history[q] = node->kept[q];
        for (size_t k = 0; k < x->n; k++)
            node->kept[q][k] = c->history[q][x->lane[k]];
    }
    for (size_t lane = 0; lane < x->n; lane += 8) {
        calx_v8 speed = calx_v8_load(x->speed + lane), depth = calx_v8_load(x->depth + lane);
        calx_v8_store(node->vn + lane, x->begin ? -speed : speed);
        calx_v8_store(node->overlap + lane, lane + 8 > x->n ? calx_v8_first(depth, x->n - lane) : depth);
    }
    CALX_ISA(calx_evaluate_stack)(p, type, time, false, node, NULL);
}

/* On to a node `time` (s) later, by the force at the last one. */
static void go_on(double time, const struct calx_columns *node, struct calx_changes *x)
{
    for (size_t lane = 0; lane < x->n; lane += 8) {
        calx_v8 u = calx_v8_load(x->speed + lane), none = {0};
        calx_v8 next = calx_v8_max(u - time * calx_v8_load(node->fn + lane) / calx_v8_load(node->mass + lane), none);
        calx_v8_store(x->depth + lane, calx_v8_load(x->depth + lane) + 0.5 * time * (u + next));
        calx_v8_store(x->speed + lane, next);
    }
}

static void add(double *to, calx_v8 v)
{
    calx_v8_store(to, calx_v8_load(to) + v);
}

/* Sums what the laws have answered at node q. The work that normal laws book is that of half the force before and
 * half the force there, for the time they are told: 2/time times it is the power. At an end the force before is not
 * none; apply() takes its part off. */
static void add_node(const struct calx_plan *p, const struct calx_columns *node, int q, double h, double time,
                     const struct calx_onset_weights *weights, struct calx_changes *x)
{
    for (size_t lane = 0; lane < x->n; lane += 8) {
        const struct calx_onset_weights *w = &weights[lane / 8];
        calx_v8 owed = x->begin ? w->later[q] : (calx_v8){0}, force = x->begin ? w->force[q] : (calx_v8){0};
        calx_v8 sum = w->tail[q] + force + owed, fn = calx_v8_load(node->fn + lane);
        calx_v8 work = 2.0 * h / time * (w->tail[q] + 0.5 * force) * calx_v8_load(node->damping + lane);
        add(x->fn + lane, sum * fn);
        add(x->owed + lane, -owed * fn);
        add(x->work + lane, work);
        for (int k = 0; k < 3 && p->needs & CALX_NEEDS_TANGENT; k++)
            add(x->ft[k] + lane, sum * calx_v8_load(node->ft[k] + lane));
        for (int k = 0; k < 3 && p->needs & CALX_NEEDS_SPIN; k++)
            add(x->torque[k] + lane, sum * calx_v8_load(node->torque[k] + lane));
    }
}

/* The velocity seen is that of the middle of the step; the force at the end takes it to the end. */
static void part_speed(double h, const struct calx_columns *node, struct calx_changes *x)
{
    for (size_t k = 0; k < x->n; k++) {
        double u = x->speed[k] + h * (x->share[k] - 0.5) * node->fn[k] / node->mass[k];
        x->speed[k] = u > 0.0 ? u : 0.0;
    }
}

static void try_nodes(const struct calx_plan *p, size_t type, double h, const struct calx_columns *c,
                      struct calx_columns *node, struct calx_changes *x)
{
    struct calx_onset_weights weights[CALX_BATCH / 8];
    const double *at = CALX_ISA(calx_onset_node);
    take_contacts(p, c, x, node);
    if (!x->begin) {
        for (size_t k = 0; k < x->n; k++)
            x->depth[k] = at[0] * h * x->speed[k];
        run_laws(p, type, h, c, x, node);
        part_speed(h, node, x);
        memset(x->depth, 0, sizeof x->depth);
        memset(node->fn, 0, sizeof node->fn);
    }
    for (size_t lane = 0; lane < x->n; lane += 8)
        CALX_ISA(calx_onset_weigh)(calx_v8_load(x->share + lane), &weights[lane / 8]);
    for (int q = 0; q < NODES; q++) {
        double time = x->begin ? at[q] * h : h;
        go_on((at[q] - (q ? at[q - 1] : 0.0)) * h, node, x);
        run_laws(p, type, time, c, x, node);
        add_node(p, node, q, h, time, weights, x);
    }
}

/* ---- into the batch ---- */

/* What has begun has slid, and turned, for a part of the step only: history begins with that. Tangential laws then see an approach that
 * was shortened as well (calx_onset_normal): to them the bodies have been in touch from the start of the step. */
static void shorten_paths(const struct calx_plan *p, const struct calx_changes *x, struct calx_columns *c)
{
    for (size_t k = 0; k < x->n; k++)
        for (int q = 0; q < 3; q++) {
            if (p->needs & CALX_NEEDS_TANGENT)
                c->vt[q][x->lane[k]] *= x->share[k];
            if (p->needs & CALX_NEEDS_SPIN)
                c->spin[q][x->lane[k]] *= x->share[k];
        }
}

/* Power of tangential forces and couples of one contact, W. */
static double power(const struct calx_plan *p, const struct calx_changes *x, size_t k, const calx_column *ft,
                    const calx_column *torque, size_t lane)
{
    double sum = 0.0;
    for (int q = 0; q < 3 && p->needs & CALX_NEEDS_TANGENT; q++)
        sum += ft[q][lane] * x->vt[q][k];
    for (int q = 0; q < 3 && p->needs & CALX_NEEDS_SPIN; q++)
        sum += torque[q][lane] * x->spin[q][k];
    return sum;
}

/* What is dissipated. Normal laws: as the nodes say. The others have booked, of an onset, the path since then with
 * half their force, of an end half a step of the force before and what was stored; what acts is the whole kick, half
 * a step of which they book in the next step. */
static double lost(const struct calx_plan *p, const struct calx_changes *x, size_t k, double h, struct calx_columns *c)
{
    size_t lane = x->lane[k];
    double share = x->share[k], others = c->work[lane] - c->damping[lane], acts = h * power(p, x, k, x->ft, x->torque, k);
    if (!x->begin)
        return x->work[k] + 2.0 * (1.0 - share) * c->damping[lane] + others - acts;
    return x->work[k] + others - acts + 0.5 * (1.0 + share) * h * power(p, x, k, c->ft, c->torque, lane);
}

static void apply(const struct calx_plan *p, const struct calx_changes *x, double h, struct calx_columns *c)
{
    for (size_t k = 0; k < x->n; k++) {
        size_t lane = x->lane[k];
        c->work[lane] = lost(p, x, k, h, c);
        c->fn[lane] = (x->begin ? 0.0 : c->fn[lane]) + x->fn[k]; /* of an end: what was owed */
        for (int q = 0; q < 3 && p->needs & CALX_NEEDS_TANGENT; q++)
            c->ft[q][lane] = x->ft[q][k];
        for (int q = 0; q < 3 && p->needs & CALX_NEEDS_SPIN; q++)
            c->torque[q][lane] = x->torque[q][k];
        if (!x->begin)
            continue;
        c->history[p->owed][lane] = x->owed[k];
        c->history[p->past][lane] = 0.5 * (x->vn[k] + h * (x->fn[k] + x->owed[k]) / c->mass[lane]);
    }
}

/* ---- every contact ---- */

/* Bit of each lane to which something is owed. */
static unsigned owing(const struct calx_plan *p, const struct calx_columns *c, size_t lane)
{
    calx_v8 owed = calx_v8_load(c->history[p->owed] + lane), none = {0};
    return calx_v8_less(owed, none) | calx_v8_less(none, owed);
}

/* The laws see the velocity without the loan. */
static void expect_owed(const struct calx_plan *p, double h, struct calx_columns *c)
{
    for (size_t group = 0; group < c->n; group += 8)
        for (unsigned bits = owing(p, c, group); bits; bits &= bits - 1) {
            size_t lane = group + (size_t)__builtin_ctz(bits);
            c->vn[lane] += h * c->history[p->owed][lane] / c->mass[lane];
        }
}

/* Damping as the law reports it, d fn/d vn. The velocity at the moment t_k of the positions: v = vn + h a/2, where
 * the acceleration a is that at the last evaluation, (vn(t_k) - vn(t_k-1))/h, whatever made it, and the change of
 * this contact's force since then: of that, vn/2 + h fn/(2 m*) is kept, 0 where nothing is known. Energy: what the
 * force now lacks, times v. */
static void damp_at_moment(const struct calx_plan *p, size_t l, size_t type, struct calx_columns *c)
{
    const struct calx_law *law = &p->laws[l];
    struct calx_response response = {.size = sizeof response, .damping = {c->damping, NULL}};
    double h = c->centre, *kept = c->history[p->past];
    memset(c->damping, 0, calx_padded(c->n) * sizeof(double));
    law->law->response(law->params + law->plugin->params_size * type, &c->views[l], &response);
    for (size_t lane = 0; lane < c->n; lane += 8) {
        calx_v8 fn = calx_v8_load(c->fn + lane), mass = calx_v8_load(c->mass + lane), vn = calx_v8_load(c->vn + lane);
        calx_v8 none = {0}, one = none + 1.0, half = 0.5 * vn, past = calx_v8_load(kept + lane);
        calx_v8 damping = calx_v8_load(c->damping + lane), ahead = half - calx_v8_positive(past * past, past, half);
        calx_v8 share = calx_v8_positive(mass, 0.5 * h / calx_v8_positive(mass, mass, one), none); /* m/s of the kick, per N */
        calx_v8 force = (fn - calx_v8_positive(fn * fn, damping * ahead, none)) / (one + damping * share);
        calx_v8 speed = vn + ahead + share * force;
        calx_v8_store(c->work + lane, calx_v8_load(c->work + lane) - h * (force - fn) * speed);
        calx_v8_store(c->fn + lane, force);
        calx_v8_store(kept + lane, calx_v8_positive(calx_v8_load(c->overlap + lane), half + share * force, none));
    }
}

void CALX_ISA(calx_onset_normal)(const struct calx_plan *p, size_t l, size_t type, struct calx_columns *c)
{
    if (c->centre > 0.0 && p->laws[l].own[type].needs & CALX_USES_VELOCITY)
        damp_at_moment(p, l, type, c);
    memcpy(c->damping, c->work, calx_padded(c->n) * sizeof(double));
    for (size_t k = 0; c->centre > 0.0 && k < c->begun->n; k++)
        c->vn[c->begun->lane[k]] = c->begun->share[k] * c->begun->vn[k];
    for (size_t group = 0; c->centre > 0.0 && group < c->n; group += 8)
        for (unsigned bits = owing(p, c, group); bits; bits &= bits - 1) {
            size_t lane = group + (size_t)__builtin_ctz(bits);
            c->fn[lane] += c->history[p->owed][lane];
            c->history[p->owed][lane] = 0.0;
        }
}

void CALX_ISA(calx_onset_laws)(const struct calx_plan *p, size_t type, double dt, bool conduct, struct calx_columns *c,
                               struct calx_clock *clock)
{
    struct calx_changes begun, ended;
    expect_owed(p, dt, c);
    find_changes(c, dt, true, &begun);
    find_changes(c, dt, false, &ended);
    if (begun.n) {
        try_nodes(p, type, dt, c, c + 1, &begun);
        shorten_paths(p, &begun, c);
    }
    if (ended.n)
        try_nodes(p, type, dt, c, c + 1, &ended);
    c->centre = dt;
    c->begun = &begun;
    CALX_ISA(calx_evaluate_stack)(p, type, dt, conduct, c, clock);
    c->centre = 0.0;
    apply(p, &begun, dt, c);
    apply(p, &ended, dt, c);
}

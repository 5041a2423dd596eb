/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Batches for the conformance suite: fills them, hands them to a plugin, and checks what every
 * kernel over a batch must do: the same bits however contacts are grouped, nothing from padding or
 * from inputs that were not declared, nothing into outputs that were not, and no number that is not
 * finite.
 */
#include <math.h>
#include <string.h>

#include "core/conform_parts.h"

enum { SEED = 20251 };

/* Columns that exist only with a need, and how many they are. */
static const struct {
    size_t first, count;
    uint32_t need;
} conditional[] = {
    {CALX_COL_VT, 3, CALX_NEEDS_TANGENT},
    {CALX_COL_FT, 3, CALX_NEEDS_TANGENT},
    {CALX_COL_SPIN, 3, CALX_NEEDS_SPIN},
    {CALX_COL_TORQUE, 3, CALX_NEEDS_SPIN},
    {CALX_COL_TEMPERATURE, 2, CALX_NEEDS_TEMPERATURE},
    {CALX_COL_COULOMB, 1, CALX_NEEDS_NORMAL_FORCE},
    {CALX_COL_CURVATURE, 2, CALX_NEEDS_CURVATURE},
};

static size_t history_columns(const struct calx_choice *c)
{
    return 3 * c->demand.history_vectors + c->demand.history_scalars;
}

static bool is_nonsmooth(const struct calx_choice *c)
{
    return c->plugin->kind == CALX_CONTACT && ((const struct calx_contact_law *)c->plugin->law)->nonsmooth;
}

bool calx_trial_declared(const struct calx_choice *c, size_t column)
{
    bool moving = column >= CALX_COL_VN && column < CALX_COL_MASS; /* nobody knows velocities and forces yet */
    if (is_nonsmooth(c) && (moving || (column >= CALX_COL_COULOMB && column < CALX_COL_ENERGY)))
        return false;
    for (size_t k = 0; k < sizeof conditional / sizeof *conditional; k++)
        if (column >= conditional[k].first && column < conditional[k].first + conditional[k].count)
            return c->demand.needs & conditional[k].need;
    if (column == CALX_COL_FN && c->plugin->kind == CALX_CONDUCTANCE)
        return c->demand.needs & CALX_NEEDS_NORMAL_FORCE;
    return column < CALX_COL_HISTORY || column < CALX_COL_HISTORY + history_columns(c);
}

/* ---- filling ---- */

static void fill_geometry(struct calx_trial *t, size_t c, uint64_t *seed)
{
    double *const r =
        (double[]){calx_conform_random(seed, 1e-3, 5e-3), calx_conform_random(seed, 1e-3, 5e-3)};
    bool wall = c % 4 == 3;
    double mass[2], (*col)[CALX_BATCH] = t->column;
    for (int k = 0; k < 2; k++) {
        mass[k] = 2500 * 4.0 / 3.0 * M_PI * r[k] * r[k] * r[k];
        col[CALX_COL_CURVATURE + k][c] = k && wall ? 0 : 1 / r[k];
        col[CALX_COL_TEMPERATURE + k][c] = calx_conform_random(seed, 300, 400);
    }
    col[CALX_COL_MASS][c] = 1 / (1 / mass[0] + (wall ? 0 : 1 / mass[1]));
    col[CALX_COL_OVERLAP][c] =
        (c % 4 == 2 ? -0.01 : 0.02) * calx_conform_random(seed, 0.01, 1) * r[0];
    col[CALX_COL_COULOMB][c] = calx_conform_random(seed, 0.1, 1);
}

static void fill_motion(struct calx_trial *t, size_t c, uint64_t *seed)
{
    double(*col)[CALX_BATCH] = t->column, n[3], size = 0, along = 0;
    for (int k = 0; k < 3; k++) {
        n[k] = calx_conform_random(seed, -1, 1);
        col[CALX_COL_VT + k][c] = calx_conform_random(seed, -1, 1);
        col[CALX_COL_SPIN + k][c] = calx_conform_random(seed, -100, 100);
        size += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        n[k] /= sqrt(size);
        col[CALX_COL_NORMAL + k][c] = n[k];
        along += n[k] * col[CALX_COL_VT + k][c];
    }
    for (int k = 0; k < 3; k++)
        col[CALX_COL_VT + k][c] -= along * n[k];
    col[CALX_COL_VN][c] = calx_conform_random(seed, -1, 1);
}

static void poison(struct calx_trial *t, const struct calx_choice *choice)
{
    for (size_t k = 0; k < CALX_COL_HISTORY; k++)
        if (!calx_trial_declared(choice, k))
            for (size_t c = 0; c < CALX_BATCH; c++)
                t->column[k][c] = NAN;
}

void calx_trial_fill(struct calx_trial *t, const struct calx_choice *choice, size_t n,
                     uint64_t seed)
{
    memset(t, 0, sizeof *t);
    t->n = n;
    t->dt = 1e-3;
    for (size_t c = 0; c < n; c++) {
        fill_geometry(t, c, &seed);
        fill_motion(t, c, &seed);
    }
    poison(t, choice);
    calx_trial_clear(t, choice);
    if (choice->plugin->kind == CALX_CONTACT && !is_nonsmooth(choice))
        for (int k = 0; k < 4; k++) {
            calx_trial_evaluate(t, choice); /* the history of a real contact, not any numbers */
            calx_trial_clear(t, choice);
            for (size_t c = 0; c < n && k < 3; c++)
                t->column[CALX_COL_VN][c] *= -0.9;
        }
}

void calx_trial_clear(struct calx_trial *t, const struct calx_choice *choice)
{
    bool before = choice->demand.needs & CALX_NEEDS_NORMAL_FORCE;
    memset(t->column[CALX_COL_FT], 0, sizeof t->column[0] * (CALX_COL_HISTORY - CALX_COL_FT));
    memset(t->column[CALX_COL_FN], 0, sizeof t->column[0]);
    if (before)
        memcpy(t->column[CALX_COL_FN], t->column[CALX_COL_COULOMB], sizeof t->column[0]);
    else if (choice->plugin->kind == CALX_CONDUCTANCE)
        for (size_t c = 0; c < CALX_BATCH; c++)
            t->column[CALX_COL_FN][c] = NAN;
}

void calx_trial_exchange(struct calx_trial *t)
{
    for (size_t c = 0; c < t->n; c++) {
        for (size_t k = CALX_COL_CURVATURE; k <= CALX_COL_TEMPERATURE; k += 2) {
            double keep = t->column[k][c];
            t->column[k][c] = t->column[k + 1][c];
            t->column[k + 1][c] = keep;
        }
        for (size_t k = 0; k < 3; k++)
            t->column[CALX_COL_NORMAL + k][c] *= -1;
    }
}

/* ---- calling ---- */

static struct calx_contacts view(struct calx_trial *t, double *history[])
{
    double(*col)[CALX_BATCH] = t->column;
    struct calx_contacts b = {.size = sizeof b,
                              .n = t->n,
                              .dt = t->dt,
                              .overlap = col[CALX_COL_OVERLAP],
                              .vn = col[CALX_COL_VN],
                              .mass = col[CALX_COL_MASS],
                              .coulomb = col[CALX_COL_COULOMB],
                              .fn = col[CALX_COL_FN],
                              .work = col[CALX_COL_WORK],
                              .history = history};
    for (int k = 0; k < 3; k++) {
        b.normal[k] = col[CALX_COL_NORMAL + k];
        b.vt[k] = col[CALX_COL_VT + k];
        b.spin[k] = col[CALX_COL_SPIN + k];
        b.ft[k] = col[CALX_COL_FT + k];
        b.torque[k] = col[CALX_COL_TORQUE + k];
    }
    for (int k = 0; k < 2; k++) {
        b.curvature[k] = col[CALX_COL_CURVATURE + k];
        b.temperature[k] = col[CALX_COL_TEMPERATURE + k];
    }
    for (int k = 0; k < CALX_COL_COUNT - CALX_COL_HISTORY; k++)
        history[k] = col[CALX_COL_HISTORY + k];
    return b;
}

static void condition(struct calx_trial *t, const struct calx_choice *c, const struct calx_contacts *b)
{
    double(*col)[CALX_BATCH] = t->column;
    struct calx_condition said = {.size = sizeof said,
                                  .friction = col[CALX_COL_ENERGY],
                                  .restitution = col[CALX_COL_STIFFNESS],
                                  .pull = col[CALX_COL_STIFFNESS + 1],
                                  .reach = col[CALX_COL_DAMPING]};
    memset(col[CALX_COL_ENERGY], 0, sizeof col[0] * (CALX_COL_CONDUCTANCE - CALX_COL_ENERGY));
    ((const struct calx_contact_law *)c->plugin->law)->condition(c->params, b, &said);
}

void calx_trial_evaluate(struct calx_trial *t, const struct calx_choice *c)
{
    double *history[CALX_COL_COUNT - CALX_COL_HISTORY];
    struct calx_contacts b = view(t, history);
    if (is_nonsmooth(c))
        condition(t, c, &b);
    else if (c->plugin->kind == CALX_CONTACT)
        ((const struct calx_contact_law *)c->plugin->law)->force(c->params, &b);
    else
        ((const struct calx_conductance_law *)c->plugin->law)
            ->conductance(c->params, &b, t->column[CALX_COL_CONDUCTANCE]);
}

void calx_trial_respond(struct calx_trial *t, const struct calx_choice *c)
{
    double *history[CALX_COL_COUNT - CALX_COL_HISTORY], (*col)[CALX_BATCH] = t->column;
    struct calx_contacts b = view(t, history);
    struct calx_response r = {.size = sizeof r,
                              .energy = col[CALX_COL_ENERGY],
                              .stiffness = {col[CALX_COL_STIFFNESS], col[CALX_COL_STIFFNESS + 1]},
                              .damping = {col[CALX_COL_DAMPING], col[CALX_COL_DAMPING + 1]}};
    memset(col[CALX_COL_ENERGY], 0, sizeof col[0] * (CALX_COL_CONDUCTANCE - CALX_COL_ENERGY));
    ((const struct calx_contact_law *)c->plugin->law)->response(c->params, &b, &r);
}

static void run(struct calx_trial *t, const struct calx_choice *c)
{
    calx_trial_evaluate(t, c);
    if (c->plugin->kind == CALX_CONTACT && !is_nonsmooth(c))
        calx_trial_respond(t, c);
}

/* ---- checks ---- */

/* Copies contact `from` of a to contact `to` of b. */
static void copy_contact(const struct calx_trial *a, size_t from, struct calx_trial *b, size_t to)
{
    for (size_t k = 0; k < CALX_COL_COUNT; k++)
        b->column[k][to] = a->column[k][from];
}

/* How many numbers of contact i of a and contact k of b differ in their bits, over the columns that
 * were declared. */
static size_t count_different(const struct calx_choice *c, const struct calx_trial *a, size_t i,
                              const struct calx_trial *b, size_t k)
{
    size_t count = 0;
    for (size_t col = 0; col < CALX_COL_COUNT; col++)
        count += calx_trial_declared(c, col) &&
                 memcmp(&a->column[col][i], &b->column[col][k], sizeof(double)) != 0;
    return count;
}

/* whole: evaluated; raw: the same before. Pieces of raw must give the same. */
static size_t count_pieces(const struct calx_choice *c, const struct calx_trial *raw,
                           const struct calx_trial *whole)
{
    static const size_t sizes[] = {1, 7, 8, 9, 16, 23};
    size_t count = 0, first = 0;
    for (size_t p = 0; first < raw->n; p++) {
        size_t n = sizes[p % 6] < raw->n - first ? sizes[p % 6] : raw->n - first;
        struct calx_trial piece = {.n = n, .dt = raw->dt};
        for (size_t i = 0; i < n; i++)
            copy_contact(raw, first + i, &piece, i);
        run(&piece, c);
        for (size_t i = 0; i < n; i++)
            count += count_different(c, &piece, i, whole, first + i);
        first += n;
    }
    return count;
}

static size_t count_permuted(const struct calx_choice *c, const struct calx_trial *raw,
                             const struct calx_trial *whole)
{
    struct calx_trial mixed = {.n = raw->n, .dt = raw->dt};
    size_t count = 0;
    for (size_t i = 0; i < raw->n; i++)
        copy_contact(raw, 29 * i % raw->n, &mixed,
                     i); /* raw->n is a power of two, so 29 reaches all */
    run(&mixed, c);
    for (size_t i = 0; i < raw->n; i++)
        count += count_different(c, &mixed, i, whole, 29 * i % raw->n);
    return count;
}

/* Other numbers in the padding must not change contacts. */
static size_t count_padding(const struct calx_choice *c, const struct calx_trial *raw)
{
    struct calx_trial a = *raw, b = *raw;
    size_t count = 0;
    a.n = b.n = 51;
    for (size_t i = a.n; i < raw->n; i++)
        copy_contact(raw, i - 32, &b, i);
    run(&a, c);
    run(&b, c);
    for (size_t i = 0; i < a.n; i++)
        count += count_different(c, &a, i, &b, i);
    return count;
}

/* Inputs that were not declared: NaN in one run, ordinary numbers in the other. */
static size_t count_undeclared(const struct calx_choice *c, const struct calx_trial *raw)
{
    struct calx_trial a = *raw, b = *raw;
    size_t count = 0;
    for (size_t k = 0; k < CALX_COL_HISTORY; k++)
        if (!calx_trial_declared(c, k))
            for (size_t i = 0; i < raw->n; i++) {
                a.column[k][i] = k >= CALX_COL_FT ? 0.25 : NAN;
                b.column[k][i] = 0.25;
            }
    run(&a, c);
    run(&b, c);
    for (size_t i = 0; i < raw->n; i++)
        count += count_different(c, &a, i, &b, i);
    for (size_t k = CALX_COL_FT; k < CALX_COL_COUNT; k++)
        if (!calx_trial_declared(c, k))
            for (size_t i = 0; i < raw->n; i++) /* outputs and history that are not there */
                count += b.column[k][i] != (k < CALX_COL_HISTORY ? 0.25 : 0);
    return count;
}

void calx_trial_check_batches(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial raw, whole;
    calx_trial_fill(&raw, c, CALX_BATCH, SEED);
    whole = raw;
    run(&whole, c);
    calx_conform_note(report, "same bits in pieces", (double)count_pieces(c, &raw, &whole), 0,
                      c->where);
    calx_conform_note(report, "same bits in another order", (double)count_permuted(c, &raw, &whole),
                      0, c->where);
    calx_conform_note(report, "padding is ignored", (double)count_padding(c, &raw), 0, c->where);
    calx_conform_note(report, "undeclared columns are unused", (double)count_undeclared(c, &raw), 0,
                      c->where);
}

void calx_trial_check_finite(struct calx_choice *c, struct calx_conformance *report)
{
    static const double overlaps[] = {0, 5e-324, 1e-300, 1e-20, 1e-9};
    struct calx_trial t;
    size_t count = 0;
    calx_trial_fill(&t, c, CALX_BATCH, SEED + 1);
    for (size_t i = 0; i < sizeof overlaps / sizeof *overlaps; i++)
        t.column[CALX_COL_OVERLAP][4 * i] = t.column[CALX_COL_OVERLAP][4 * i + 3] = overlaps[i];
    for (int still = 0; still < 2;
         still++) { /* the first evaluation of a run has no step before it: dt = 0 */
        t.dt *= 1 - still;
        run(&t, c);
        for (size_t k = CALX_COL_FN; k < CALX_COL_COUNT; k++)
            for (size_t i = 0; i < t.n; i++)
                count += calx_trial_declared(c, k) && !isfinite(t.column[k][i]);
    }
    calx_conform_note(report, "finite at every bound of the parameters", (double)count, 0,
                      c->where);
}

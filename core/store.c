/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact problem of a step, for integrators that solve for impulses: all contacts of non-smooth laws in block order, and the
 * bodies with their velocities at the start of the step and, if no contact acted, at its end. After the solution: the work that each contact
 * has dissipated, -r.(u- + u+)/2, which is what the bodies lose, to round-off. Contacts are met again in the same order when their
 * impulses are delivered (evaluate.c). Behind the rows of particles each wall has one: where it is free along an axis, what it carries and what
 * touches it finds that body.
 */
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"
#include "core/surface.h"

enum {
    NORMAL,
    LEVER = NORMAL + 3,
    GAP = LEVER + 2,
    WALL_BEFORE,
    WALL_AFTER = WALL_BEFORE + 3,
    FRICTION = WALL_AFTER + 3,
    RESTITUTION,
    PULL,
    IMPULSE, /* tangential, then normal */
    WORK = IMPULSE + 4,
    COLUMNS
};

struct calx_store {
    struct calx_problem view;
    struct calx_solution solution;
    size_t n, capacity, rows, blocks;
    size_t *first; /* per block: its first contact */
    int32_t *body[2];
    double *column[COLUMNS];
    double *before, *velocity; /* rows of eight */
    double (*speed)[3], (*spin)[3]; /* of walls at the start of the step */
    int8_t *axis;                   /* along which walls are free, or -1 */
    bool failed;
};

static int no_memory(struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the contact problem");
}

int calx_store_begin(struct calx_sim *s, struct calx_error *e)
{
    size_t walls = s->scene->wall_count;
    if (!s->store) {
        s->store = calloc(1, sizeof *s->store);
        if (!s->store)
            return no_memory(e);
        s->store->speed = calx_memory_zeroed(walls, sizeof *s->store->speed);
        s->store->spin = calx_memory_zeroed(walls, sizeof *s->store->spin);
        s->store->axis = calx_memory_zeroed(walls, sizeof *s->store->axis);
        if (!s->store->speed || !s->store->spin || !s->store->axis)
            return no_memory(e);
    }
    for (size_t w = 0; w < walls; w++) {
        memcpy(s->store->speed[w], s->poses[w].speed, sizeof s->poses[w].speed);
        memcpy(s->store->spin[w], s->poses[w].spin, sizeof s->poses[w].spin);
    }
    return 0;
}

/* ---- room ---- */

static int grow(struct calx_store *t)
{
    size_t capacity = t->capacity ? 2 * t->capacity : 256;
    for (int k = 0; k < 2; k++) {
        int32_t *p = realloc(t->body[k], capacity * sizeof *p);
        if (!p)
            return 1;
        t->body[k] = p;
    }
    for (size_t k = 0; k < COLUMNS; k++) {
        double *p = realloc(t->column[k], capacity * sizeof *p);
        if (!p)
            return 1;
        t->column[k] = p;
    }
    t->capacity = capacity;
    return 0;
}

/* Rows and blocks as they are now. */
static int fit(struct calx_sim *s, struct calx_store *t)
{
    if (t->rows != s->r.rows + s->scene->wall_count) {
        free(t->before);
        free(t->velocity);
        t->rows = s->r.rows + s->scene->wall_count;
        t->before = calx_memory_zeroed(t->rows, 8 * sizeof(double));
        t->velocity = calx_memory_zeroed(t->rows, 8 * sizeof(double));
    }
    if (t->blocks != s->block_count || !t->first) {
        free(t->first);
        t->blocks = s->block_count;
        t->first = calloc(t->blocks + 1, sizeof *t->first);
    }
    return !t->before || !t->velocity || !t->first || (!t->capacity && grow(t));
}

/* ---- bodies ---- */

static void fill_row(const struct calx_sim *s, struct calx_store *t, int32_t row, double dt)
{
    const double *v = calx_row_v(s, row), radius = calx_row_x(s, row)[3];
    double *before = t->before + 8 * (size_t)row, *after = t->velocity + 8 * (size_t)row;
    bool turns = s->plan->needs & CALX_NEEDS_ROTATION;
    memcpy(before, v, 4 * sizeof *v);
    for (int k = 0; k < 3; k++)
        before[4 + k] = turns ? v[4 + k] : 0.0;
    before[7] = turns ? v[3] / (calx_particle_inertia_factor(s->scene) * radius * radius) : 0.0;
    memcpy(after, before, 8 * sizeof *after);
    for (int k = 0; k < 3 && v[3] > 0.0; k++)
        after[k] += dt * s->gravity[k];
}

/* Bodies that walls carry: as the wall moved at the start of the step, and, in their rows now, as it does at the end. */
static void fill_carried(const struct calx_sim *s, struct calx_store *t)
{
    for (size_t k = 0; k < s->carried_count; k++) {
        const struct calx_carried *c = &s->carried[k];
        double *before = t->before + 8 * (size_t)c->row, whole[3];
        memcpy(whole, calx_row_x(s, c->row), sizeof whole);
        for (int q = 0; q < 3 && s->r.image; q++)
            whole[q] += s->scene->periodic[q] ? s->r.image[c->row][q] * (s->scene->high[q] - s->scene->low[q]) : 0.0;
        calx_surface_velocity(t->speed[c->wall], t->spin[c->wall], whole, before);
        for (int q = 0; q < 3 && s->features.rotation; q++)
            before[4 + q] = t->spin[c->wall][q];
    }
}

static void fill_plates(struct calx_sim *s, struct calx_store *t, double forces, double dt)
{
    for (size_t w = 0; w < s->scene->wall_count; w++) {
        const struct calx_motion *m = &s->scene->stages[s->stage].motion[w];
        double *before = t->before + 8 * (s->r.rows + w), *after = t->velocity + 8 * (s->r.rows + w);
        t->axis[w] = m->free ? (int8_t)m->free_axis : -1;
        memset(before, 0, 8 * sizeof *before);
        memset(after, 0, 8 * sizeof *after);
        if (!m->free)
            continue;
        memcpy(before, t->speed[w], sizeof t->speed[w]);
        memcpy(after, s->poses[w].past_speed, sizeof s->poses[w].past_speed);
        before[3] = after[3] = calx_plates_expect(s, w, forces, dt, &after[m->free_axis]);
    }
}

static void fill_bodies(struct calx_sim *s, struct calx_store *t, double forces, double dt)
{
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            fill_row(s, t, row, dt);
    fill_carried(s, t);
    fill_plates(s, t, forces, dt);
}

/* ---- contacts ---- */

struct collector {
    struct calx_sim *s;
    struct calx_store *t;
    const struct calx_row_block *block;
};

static void take_wall(const struct collector *k, const struct calx_columns *c, size_t lane, size_t at, int32_t row, int wall)
{
    struct calx_store *t = k->t;
    const double *x = calx_row_x(k->s, row);
    const struct calx_pose *pose = &k->s->poses[wall];
    double point[3], before[3], after[3], reach = x[3] - c->overlap[lane];
    for (int q = 0; q < 3; q++)
        point[q] = x[q] - reach * c->normal[q][lane];
    calx_surface_velocity(t->speed[wall], t->spin[wall], point, before);
    calx_surface_velocity(pose->past_speed, pose->past_spin, point, after);
    bool given = t->axis[wall] < 0;
    for (int q = 0; q < 3; q++) {
        t->column[WALL_BEFORE + q][at] = given ? before[q] : 0.0;
        t->column[WALL_AFTER + q][at] = given ? after[q] : 0.0;
    }
    t->column[LEVER][at] = c->levers[lane];
    t->column[LEVER + 1][at] = 0.0;
}

static void take_pair(const struct collector *k, const struct calx_columns *c, size_t lane, size_t at)
{
    struct calx_store *t = k->t;
    double excess = k->s->radius_min < k->s->radius_max ? c->excess[lane] : 0.0;
    for (int q = 0; q < 3; q++)
        t->column[WALL_BEFORE + q][at] = t->column[WALL_AFTER + q][at] = 0.0;
    t->column[LEVER][at] = 0.5 * (c->levers[lane] + excess);
    t->column[LEVER + 1][at] = 0.5 * (c->levers[lane] - excess);
}

static int32_t plate(const struct collector *k, int32_t wall, int32_t otherwise)
{
    return wall >= 0 && k->t->axis[wall] >= 0 ? (int32_t)k->s->r.rows + wall : otherwise;
}

/* The row of the body that impulses move. */
static int32_t body_of(const struct collector *k, int32_t row)
{
    const int32_t *carrier = k->s->scene->particles.carrier;
    int32_t own = row < k->block->first + k->block->own ? row : k->s->r.source[row];
    return carrier ? plate(k, carrier[k->s->r.id[own]], own) : own;
}

static void take(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct collector *k = context;
    struct calx_store *t = k->t;
    const struct calx_plan *p = k->s->plan;
    double gap = -c->overlap[lane];
    t->failed |= !t->failed && t->n == t->capacity && grow(t);
    if (t->failed || !(gap < p->gap))
        return;
    size_t at = t->n++;
    t->body[0][at] = body_of(k, row_i);
    t->body[1][at] = row_j < 0 ? plate(k, -1 - row_j, -1) : body_of(k, row_j);
    if (row_j < 0)
        take_wall(k, c, lane, at, row_i, -1 - row_j);
    else
        take_pair(k, c, lane, at);
    for (int q = 0; q < 3; q++) {
        t->column[NORMAL + q][at] = c->normal[q][lane];
        t->column[IMPULSE + q][at] = p->needs & CALX_NEEDS_TANGENT ? c->ft[q][lane] * p->dt : 0.0;
    }
    t->column[IMPULSE + 3][at] = c->fn[lane] * p->dt;
    t->column[GAP][at] = gap;
    t->column[FRICTION][at] = c->condition[0][lane];
    t->column[RESTITUTION][at] = c->condition[1][lane];
    t->column[PULL][at] = gap <= c->condition[3][lane] ? c->condition[2][lane] : 0.0;
}

static void take_contacts(struct calx_sim *s, struct calx_store *t)
{
    struct collector k = {.s = s, .t = t};
    struct calx_sink sink = {&k, take};
    t->n = 0;
    s->trial = true; /* history stays as it is */
    for (size_t b = 0; b < s->block_count; b++) {
        k.block = &s->blocks[b];
        t->first[b] = t->n;
        s->engine->block_collect(s, b, &sink);
    }
    s->trial = false;
}

/* What walls do in the mean of the step: their power is then that of the mean force. */
static void mean_speeds(struct calx_sim *s, const struct calx_store *t)
{
    for (size_t w = 0; w < s->scene->wall_count; w++)
        for (int k = 0; k < 3; k++) {
            s->poses[w].speed[k] = 0.5 * (t->speed[w][k] + s->poses[w].past_speed[k]);
            s->poses[w].spin[k] = 0.5 * (t->spin[w][k] + s->poses[w].past_spin[k]);
        }
}

static void point_view(const struct calx_sim *s, struct calx_store *t, double dt)
{
    double **c = t->column;
    t->view = (struct calx_problem){
        .size = sizeof t->view, .n = t->n, .bodies = t->rows, .walls = s->scene->wall_count, .axis = t->axis, .dt = dt, .position = s->r.x, .before = t->before,
        .velocity = t->velocity, .body = {t->body[0], t->body[1]}, .normal = {c[NORMAL], c[NORMAL + 1], c[NORMAL + 2]},
        .lever = {c[LEVER], c[LEVER + 1]}, .gap = c[GAP],
        .wall_before = {c[WALL_BEFORE], c[WALL_BEFORE + 1], c[WALL_BEFORE + 2]},
        .wall_after = {c[WALL_AFTER], c[WALL_AFTER + 1], c[WALL_AFTER + 2]}, .friction = c[FRICTION],
        .restitution = c[RESTITUTION], .pull = c[PULL], .normal_impulse = c[IMPULSE + 3],
        .impulse = {c[IMPULSE], c[IMPULSE + 1], c[IMPULSE + 2]}};
    for (int k = 0; k < 3; k++)
        t->view.gravity[k] = s->gravity[k];
    t->solution = (struct calx_solution){{c[IMPULSE], c[IMPULSE + 1], c[IMPULSE + 2], c[IMPULSE + 3]}, c[WORK]};
}

int calx_store_collect(struct calx_sim *s, double forces, double dt, struct calx_error *e)
{
    struct calx_store *t = s->store;
    if (fit(s, t))
        return no_memory(e);
    fill_bodies(s, t, forces, dt);
    take_contacts(s, t);
    if (t->failed)
        return no_memory(e);
    mean_speeds(s, t);
    point_view(s, t, dt);
    return 0;
}

/* ---- after the solution ---- */

/* Velocity of i relative to j, or to a wall, at contact c. */
static void relative(const struct calx_store *t, size_t c, const double *rows, const double *const *wall, double u[3])
{
    const double *vi = rows + 8 * (size_t)t->body[0][c], *vj = t->body[1][c] < 0 ? NULL : rows + 8 * (size_t)t->body[1][c];
    double n[3], w[3];
    for (int k = 0; k < 3; k++) {
        n[k] = t->column[NORMAL + k][c];
        w[k] = t->column[LEVER][c] * vi[4 + k] + (vj ? t->column[LEVER + 1][c] * vj[4 + k] : 0.0);
        u[k] = vi[k] - (vj ? vj[k] : wall[k][c]);
    }
    for (int k = 0; k < 3; k++)
        u[k] += n[(k + 1) % 3] * w[(k + 2) % 3] - n[(k + 2) % 3] * w[(k + 1) % 3];
}

void calx_store_work(struct calx_sim *s)
{
    struct calx_store *t = s->store;
    for (size_t c = 0; c < t->n; c++) {
        double u[2][3], work = 0.0;
        relative(t, c, t->before, t->view.wall_before, u[0]);
        relative(t, c, t->velocity, t->view.wall_after, u[1]);
        for (int k = 0; k < 3; k++) {
            double r = t->column[IMPULSE + 3][c] * t->column[NORMAL + k][c] + t->column[IMPULSE + k][c];
            work -= 0.5 * r * (u[0][k] + u[1][k]);
        }
        t->column[WORK][c] = work;
    }
    for (size_t w = 0; w < s->scene->wall_count; w++)
        if (t->axis[w] >= 0)
            calx_plates_settle(s, w, t->velocity[8 * (s->r.rows + w) + (size_t)t->axis[w]]);
    s->sweeps = t->view.sweeps;
    s->residual = t->view.residual;
}

double calx_sim_solver(const struct calx_sim *s, double *residual)
{
    *residual = s->residual;
    return s->sweeps;
}

struct calx_problem *calx_store_problem(struct calx_sim *s)
{
    return &s->store->view;
}

const struct calx_solution *calx_store_solution(const struct calx_sim *s, size_t block, size_t *first)
{
    *first = s->store->first[block];
    return &s->store->solution;
}

void calx_store_free(struct calx_sim *s)
{
    struct calx_store *t = s->store;
    if (!t)
        return;
    for (size_t k = 0; k < COLUMNS; k++)
        free(t->column[k]);
    void *all[] = {t->first, t->body[0], t->body[1], t->before, t->velocity, t->speed, t->spin, t->axis, t};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contacts of the particles of one block with walls: which of the near primitives count, their columns (a wall is a body of curvature 0,
 * inverse mass 0 and lever 0 that moves with the speed of its material), and where the results go. The laws, the
 * conductance and the kinematics are those of particle contacts (evaluate.c).
 *
 * History follows the surface, not the primitive, so friction survives joints.
 */
#include <math.h>
#include <string.h>

#include "core/columns.h"
#include "core/slab.h"
#include "core/surface.h"
#include "core/wall_candidates.h"

#define NOWHERE SIZE_MAX   /* slot of a contact that has ended */

struct wall_batch {
    struct calx_sim *s;
    const struct calx_row_block *block;
    struct calx_tally *tally;
    struct calx_columns *c;
    double *a;
    double dt;
    bool conduct;
    double *energy;
    const struct calx_sink *sink;
    bool look; /* nothing may change: energy or sink */
    size_t type; /* pair of materials of the lanes */
    size_t next; /* contacts of the block so far */
    struct lane *lane;
};

/* Of each lane: what the columns do not say. */
struct lane {
    int wall;
    int32_t row;
    size_t slot; /* where its history goes */
    double point_velocity[3], share;
    double point[3];
    struct calx_slab_spot spot; /* on the face of a slab */
};

static double wall_share(const struct calx_sim *s, int wall, size_t material)
{
    double share[2];
    CALX_ISA(calx_heat_shares)(s, material, (size_t)s->scene->walls[wall].material, share);
    return calx_wall_conducts(s, wall) ? share[0] : share[0] + share[1];
}

/* The temperature that the grain sees: its own where the wall is insulated. */
static double wall_temperature(struct wall_batch *w, size_t lane, int wall, const double point[3], double own)
{
    const struct calx_sim *s = w->s;
    if (!calx_wall_has_slab(s, wall))
        return s->scene->walls[wall].isothermal ? s->wall_temperature[wall] : own;
    struct calx_slab_spot *spot = &w->lane[lane].spot;
    const double *face = s->slab_temperature + s->slab_cell[wall];
    *spot = calx_slab_find(&s->scene->walls[wall].slab, &s->poses[wall], point);
    memcpy(w->lane[lane].point, point, sizeof w->lane[lane].point);
    return (1.0 - spot->share) * face[spot->cell[0]] + spot->share * face[spot->cell[1]];
}

/* One lane: the grain is body i. */
static void fill_lane(struct wall_batch *w, int32_t row, const struct candidate *k)
{
    const struct calx_sim *s = w->s;
    struct calx_columns *c = w->c;
    size_t lane = c->n++;
    const double *x = calx_row_x(s, row), *v = calx_row_v(s, row);
    int wall = s->posed[k->primitive].wall;
    const struct calx_pose *pose = &s->poses[wall];
    double past[3], *now = w->lane[lane].point_velocity;
    calx_surface_velocity(pose->speed, pose->spin, k->touch.point, now);
    calx_surface_past_velocity(pose, k->touch.point, v, past);
    const double *seen = w->dt != 0.0 ? past : now; /* as the grains' own velocities */
    double depth = x[3] - k->touch.distance;
    c->overlap[lane] = depth;
    c->levers[lane] = s->plan->models->lever_full ? x[3] : x[3] - 0.5 * depth;
    c->curvature[1][lane] = 0.0;
    c->mass[lane] = v[3] > 0.0 ? 1.0 / v[3] : 0.0;
    c->curvature[0][lane] = 1.0 / x[3];
    for (int q = 0; q < 3; q++) {
        c->normal[q][lane] = k->touch.normal[q];
        c->velocity[q][lane] = v[q] - seen[q];
        if (s->r.stride == 8)
            c->omega[q][lane] = v[4 + q];
    }
    if (s->features.temperature) {
        c->temperature[0][lane] = v[7];
        c->temperature[1][lane] = wall_temperature(w, lane, wall, k->touch.point, v[7]);
        w->lane[lane].share = wall_share(s, wall, (size_t)s->r.material[row]);
    }
    w->lane[lane].wall = wall;
    w->lane[lane].row = row;
}

static double *row_a(const struct wall_batch *w, size_t lane)
{
    return w->a + w->s->r.stride * (size_t)(w->lane[lane].row - w->block->first);
}

static void add_wall_force(struct wall_batch *w, size_t lane)
{
    struct calx_sim *s = w->s;
    struct calx_columns *c = w->c;
    size_t block = (size_t)(w->block - s->blocks);
    double *total = s->block_wall_force[block * s->scene->wall_count + (size_t)w->lane[lane].wall];
    for (int k = 0; k < 3; k++) {
        total[k] -= c->force[k][lane];
        w->tally->wall_power += c->force[k][lane] * w->lane[lane].point_velocity[k];
    }
}

/* The block's cells of the face that the contact is on, and their weights. */
static void add_to_face(struct wall_batch *w, size_t lane, double flow, double conductance, double lost)
{
    const struct calx_sim *s = w->s;
    size_t block = (size_t)(w->block - s->blocks);
    struct calx_face *face = s->block_faces + block * s->slab_faces + s->slab_face[w->lane[lane].wall];
    for (int q = 0; q < 2; q++) {
        double weight = q ? w->lane[lane].spot.share : 1.0 - w->lane[lane].spot.share;
        face[w->lane[lane].spot.cell[q]].flow += weight * flow;
        face[w->lane[lane].spot.cell[q]].conductance += weight * conductance;
        face[w->lane[lane].spot.cell[q]].lost += weight * lost;
    }
}

static void add_conduction(struct wall_batch *w, size_t lane)
{
    struct calx_sim *s = w->s;
    struct calx_columns *c = w->c;
    int wall = w->lane[lane].wall;
    double h = c->conductance[lane], q = h * (c->temperature[1][lane] - c->temperature[0][lane]);
    if (!calx_wall_conducts(s, wall))
        return;
    if (calx_wall_has_slab(s, wall))
        add_to_face(w, lane, -q, h, 0.0);
    if (s->plan->global_heat) {
        size_t e = w->block->near_first + w->tally->boundaries++;
        s->boundary_i[e] = w->lane[lane].row;
        s->boundary_h[e] = h;
        s->boundary_t[e] = c->temperature[1][lane];
        s->boundary_wall[e] = wall;
        if (calx_wall_has_slab(s, wall))
            memcpy(s->boundary_at[e], w->lane[lane].point, sizeof s->boundary_at[e]);
        return;
    }
    row_a(w, lane)[7] += q;
    if (!calx_wall_has_slab(s, wall))
        w->tally->wall_heat += q;
}

static void add_lane(struct wall_batch *w, size_t lane)
{
    struct calx_sim *s = w->s;
    struct calx_columns *c = w->c;
    const struct calx_plan *plan = s->plan;
    double *a = row_a(w, lane), depth = c->overlap[lane] * c->curvature[0][lane];
    for (int k = 0; k < 3; k++) {
        a[k] += c->force[k][lane];
        if (plan->needs & CALX_NEEDS_ROTATION)
            a[4 + k] -= c->levers[lane] * c->twist[k][lane];
        if (plan->needs & CALX_NEEDS_SPIN)
            a[4 + k] += c->torque[k][lane];
    }
    add_wall_force(w, lane);
    if (w->conduct)
        add_conduction(w, lane);
    if (s->features.temperature && s->scene->from_dissipation > 0.0 && w->dt > 0.0 && !s->trial) {
        a[7] += w->lane[lane].share * c->work[lane] / s->heat_interval;
        double lost = (s->scene->from_dissipation - w->lane[lane].share) * c->work[lane];
        if (calx_wall_has_slab(s, w->lane[lane].wall))
            add_to_face(w, lane, 0.0, 0.0, lost);
        else
            w->tally->wall_heat_lost += lost;
    }
    w->tally->work += c->work[lane];
    w->tally->wall_contacts += plan->nonsmooth ? c->fn[lane] != 0.0 : c->overlap[lane] > 0.0;
    if (depth > w->tally->overlap) {
        w->tally->overlap = depth;
        w->tally->overlap_rows[0] = w->lane[lane].row;
        w->tally->overlap_rows[1] = -1 - w->lane[lane].wall;
    }
}

/* Evaluates what is in the batch. */
static void flush(struct wall_batch *w)
{
    struct calx_columns *c = w->c;
    struct calx_sim *s = w->s;
    size_t columns = s->plan->history;
    for (size_t lane = c->n; lane % CALX_WIDTH; lane++)
        c->overlap[lane] = 0.0;
    CALX_ISA(calx_evaluate_motion)(s->plan, s->lag, c);
    if (w->energy) {
        CALX_ISA(calx_evaluate_energy)(s->plan, w->type, w->dt, c);
        for (size_t lane = 0; lane < c->n; lane++)
            *w->energy += c->overlap[lane] > -s->plan->gap ? c->energy[lane] : 0.0;
        c->n = 0;
        return;
    }
    CALX_ISA(calx_evaluate_laws)(s->plan, w->type, w->dt, w->conduct, c, NULL);
    CALX_ISA(calx_evaluate_force)(s->plan, c);
    for (size_t lane = 0; lane < c->n; lane++) {
        if (w->sink) {
            w->sink->take(w->sink->context, c, lane, w->lane[lane].row, -1 - w->lane[lane].wall);
            continue;
        }
        size_t slot = w->lane[lane].slot;
        add_lane(w, lane);
        for (size_t h = 0; h < columns && slot != NOWHERE; h++)
            s->wall_history_next[columns * slot + h] = c->history[h][lane];
    }
    c->n = 0;
}

/* The old contact of this row and surface that is not taken yet, or -1. `first` is where the row's old contacts start. */
static ptrdiff_t find_old(const struct calx_wall_contact *old, size_t count, size_t first, int32_t row,
                          int32_t surface, uint64_t taken)
{
    for (size_t k = first; k < count && old[k].row == row && k - first < 64; k++)
        if (old[k].surface == surface && !(taken >> (k - first) & 1))
            return (ptrdiff_t)k;
    return -1;
}

/* Of the lane to come: whether it touched at the last evaluation, and does now. */
static void note_touch(struct calx_columns *c, bool was, bool is)
{
    size_t byte = c->n / 8, bit = c->n % 8, others = (1u << bit) - 1u;
    c->was[byte] = (uint8_t)((c->was[byte] & others) | (size_t)was << bit);
    c->is[byte] = (uint8_t)((c->is[byte] & others) | (size_t)is << bit);
}

/* Adds a lane with the history of old contact `old` (-1: none), flushing first if the batch is full or of another pair of materials. */
static void push(struct wall_batch *w, int32_t row, const struct candidate *k, ptrdiff_t old, size_t slot)
{
    struct calx_sim *s = w->s;
    struct calx_columns *c = w->c;
    size_t columns = s->plan->history, materials = s->scene->material_count;
    size_t type = (size_t)s->r.material[row] * materials +
                  (size_t)s->scene->walls[s->posed[k->primitive].wall].material;
    if (c->n == CALX_BATCH || (c->n && type != w->type))
        flush(w);
    w->type = type;
    w->lane[c->n].slot = slot;
    for (size_t h = 0; h < columns; h++)
        c->history[h][c->n] = old >= 0 ? s->wall_history[columns * (size_t)old + h] : 0.0;
    note_touch(c, old >= 0, slot != NOWHERE);
    fill_lane(w, row, k);
    if (slot == NOWHERE) /* over: seen once more so that its last half step is booked */
        c->overlap[c->n - 1] = fmin(c->overlap[c->n - 1], -s->plan->gap);
}

/* An old contact that no candidate continues. */
static void push_ended(struct wall_batch *w, int32_t row, const struct candidate *list, size_t count,
                       size_t old)
{
    const struct candidate *nearest = NULL;
    for (size_t k = 0; k < count; k++)
        if (list[k].surface == w->s->wall_contacts[old].surface &&
            (!nearest || list[k].touch.distance < nearest->touch.distance))
            nearest = &list[k];
    if (nearest)
        push(w, row, nearest, (ptrdiff_t)old, NOWHERE);
}

/* All contacts of one particle; its old contacts are first..last. */
static void process_particle(struct wall_batch *w, int32_t row, struct candidate *list, size_t count,
                             size_t first, size_t last)
{
    struct calx_sim *s = w->s;
    double reach = calx_row_x(s, row)[3] + s->plan->gap;
    uint64_t taken = 0;
    if (count > 1)
        drop_duplicates(s, list, count);
    for (size_t k = 0; k < count; k++) {
        if (list[k].dropped || list[k].touch.distance >= reach)
            continue;
        size_t slot = w->block->near_first + w->next;
        ptrdiff_t old = find_old(s->wall_contacts, last, first, row, list[k].surface, taken);
        if (old >= 0)
            taken |= 1ull << ((size_t)old - first);
        if (!w->look)
            s->wall_contacts_next[slot] = (struct calx_wall_contact){row, list[k].surface};
        w->next++;
        push(w, row, &list[k], old, slot);
    }
    for (size_t k = first; k < last && k - first < 64 && !w->look; k++)
        if (!(taken >> (k - first) & 1))
            push_ended(w, row, list, count, k);
}

void CALX_ISA(calx_wall_contacts)(struct calx_sim *s, size_t block, double dt, bool conduct, double *a,
                                  struct calx_columns *c, double *energy, const struct calx_sink *sink)
{
    struct calx_row_block *b = &s->blocks[block];
    struct lane lanes[CALX_BATCH];
    struct wall_batch w = {.s = s, .lane = lanes, .block = b, .tally = &s->tallies[block], .c = c, .a = a, .dt = dt,
                           .conduct = conduct, .energy = energy, .sink = sink,
                           .look = energy || sink};
    struct candidate list[NEAR_MAX];
    size_t at = b->near_first, end = at + b->near_count, old = at, old_end = at + b->wall_count, count;
    if (!s->features.wall_contacts)
        return;
    if (!w.look)
        memset(s->block_wall_force + block * s->scene->wall_count, 0,
               s->scene->wall_count * sizeof *s->block_wall_force);
    if (!w.look && s->slab_faces)
        memset(s->block_faces + block * s->slab_faces, 0, s->slab_faces * sizeof *s->block_faces);
    for (size_t h = 0; h < s->plan->history; h++)
        c->history[h] = c->kept[h];
    c->n = 0;
    while (at < end) {
        int32_t row = s->near_row[at];
        at = collect(s, b, at, list, &count);
        while (old < old_end && s->wall_contacts[old].row < row)
            old++;
        size_t first = old;
        while (old < old_end && s->wall_contacts[old].row == row)
            old++;
        process_particle(&w, row, list, count, first, old);
    }
    if (c->n)
        flush(&w);
    if (!w.look)
        b->wall_next = w.next;
}

void CALX_ISA(calx_heat_shares)(const struct calx_sim *s, size_t material_i, size_t material_j, double share[2])
{
    double f = s->scene->from_dissipation, e[2] = {1.0, 1.0};
    const size_t m[2] = {material_i, material_j};
    for (int k = 0; k < 2 && s->scene->split_effusivity; k++) {
        const struct calx_material *material = &s->scene->materials[m[k]];
        e[k] = sqrt(material->density * material->specific_heat *
                    calx_scene_material_value(s->scene, m[k], "conductivity"));
    }
    share[0] = f * e[0] / (e[0] + e[1]);
    share[1] = f - share[0];
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Bodies that a wall carries: a rigid group of particles that is moved by prescription, never by
 * impacts. To contacts, lists and output they are particles of infinite mass; motion, force, work
 * and held temperature are those of their wall, which needs no surface of its own. Before each
 * evaluation of forces they are put where the wall's pose carries their first place, with the
 * velocity of the moment that the other bodies' velocities belong to; after it they get that of
 * their positions.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface.h"

int calx_carried_list(struct calx_sim *s, struct calx_error *e)
{
    const int32_t *carrier = s->scene->particles.carrier;
    size_t count = 0;
    for (size_t i = 0; carrier && i < s->n; i++)
        count += carrier[i] >= 0;
    free(s->carried);
    s->carried = calx_memory_zeroed(count, sizeof *s->carried);
    if (!s->carried)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu bodies of groups",
                              count);
    s->carried_count = 0;
    for (size_t b = 0; b < s->block_count; b++) {
        struct calx_row_block *block = &s->blocks[b];
        block->carried_first = s->carried_count;
        for (int32_t row = block->first; count && row < block->first + block->own; row++)
            if (carrier[s->r.id[row]] >= 0)
                s->carried[s->carried_count++] = (struct calx_carried){row, carrier[s->r.id[row]]};
        block->carried_count = s->carried_count - block->carried_first;
    }
    return 0;
}

/* Where the pose carries the body: in unbroken space, and in that of a periodic domain. */
struct spot {
    double whole[3], at[3];
};

static struct spot spot_of(const struct calx_sim *s, const struct calx_carried *c)
{
    const struct calx_scene *scene = s->scene;
    const struct calx_pose *pose = &s->poses[c->wall];
    const double *from = scene->particles.position[s->r.id[c->row]];
    struct spot p;
    for (int k = 0; k < 3; k++) {
        p.whole[k] = pose->turn[3 * k] * from[0] + pose->turn[3 * k + 1] * from[1] +
                     pose->turn[3 * k + 2] * from[2] + pose->shift[k];
        p.at[k] = p.whole[k];
        if (scene->periodic[k])
            p.at[k] -= s->r.image[c->row][k] * (scene->high[k] - scene->low[k]);
    }
    return p;
}

/* past: as the laws are to see it, else at the moment of the positions. */
static void set_velocity(struct calx_sim *s, const struct calx_carried *c, const double whole[3],
                         bool past)
{
    const struct calx_pose *pose = &s->poses[c->wall];
    double *v = calx_row_v(s, c->row), now[3];
    calx_walls_velocity(s, c->wall, whole, now);
    memcpy(v, now, sizeof now);
    if (past)
        calx_surface_past_velocity(pose, whole, now, v);
    if (s->features.rotation)
        memcpy(v + 4, past ? pose->past_spin : pose->spin, sizeof pose->spin);
}

/* Integrators move these bodies too, by what they know of them: that way counts already, the rest
 * of the way is counted here. */
void calx_carried_move(struct calx_sim *s)
{
    double most2 = 0.0, speed2 = 0.0;
    for (size_t k = 0; k < s->carried_count; k++) {
        const struct calx_carried *c = &s->carried[k];
        double *x = calx_row_x(s, c->row), *v = calx_row_v(s, c->row), way2 = 0.0;
        struct spot p = spot_of(s, c);
        for (int q = 0; q < 3; q++)
            way2 += (p.at[q] - x[q]) * (p.at[q] - x[q]);
        memcpy(x, p.at, sizeof p.at);
        set_velocity(s, c, p.whole, s->poses[c->wall].ago != 0.0);
        most2 = fmax(most2, way2);
        speed2 = fmax(speed2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (s->features.temperature && s->scene->walls[c->wall].isothermal)
            v[7] = s->wall_temperature[c->wall];
    }
    s->drift += sqrt(most2);
    s->moved += sqrt(most2);
    s->speed = fmax(s->speed, sqrt(speed2));
}

/* The force of grains on a wall, its power against the motion, and the heat that a wall of given
 * temperature takes. a: forces, couples and heat flows of the block. */
void calx_carried_take(struct calx_sim *s, size_t block, const struct calx_pass *pass,
                       const double *a)
{
    const struct calx_row_block *b = &s->blocks[block];
    struct calx_tally *t = &s->tallies[block];
    for (size_t k = b->carried_first; k < b->carried_first + b->carried_count; k++) {
        const struct calx_carried *c = &s->carried[k];
        const double *row = a + s->r.stride * (size_t)(c->row - b->first);
        double *total = s->block_wall_force[block * s->scene->wall_count + (size_t)c->wall], v[3];
        calx_walls_velocity(s, c->wall, spot_of(s, c).whole, v);
        for (int q = 0; q < 3; q++) {
            total[q] += row[q];
            t->wall_power -= row[q] * v[q];
            if (s->features.rotation)
                t->wall_power -= row[4 + q] * s->poses[c->wall].spin[q];
        }
        if (!s->features.temperature || !s->scene->walls[c->wall].isothermal)
            continue;
        if (pass->conduct && !s->plan->global_heat)
            t->wall_heat -= row[7];
        else
            t->wall_heat_lost += row[7] * s->heat_interval;
    }
}

void calx_carried_settle(struct calx_sim *s, const struct calx_row_block *b, size_t first, size_t n)
{
    for (size_t k = b->carried_first; k < b->carried_first + b->carried_count; k++) {
        const struct calx_carried *c = &s->carried[k];
        if ((size_t)c->row < first || (size_t)c->row >= first + n)
            continue;
        struct spot p = spot_of(s, c);
        memcpy(calx_row_x(s, c->row), p.at, sizeof p.at);
        set_velocity(s, c, p.whole, false);
    }
}

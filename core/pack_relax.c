/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Takes the overlaps out of a dense random arrangement: bodies a little larger than they are (so
 * that the end is reached in finite time) repel in proportion to their overlap, and the energy is
 * minimised with FIRE (Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006) until nothing overlaps.
 * Below the jamming density (0.84 in 2D, 0.64 in 3D; O'Hern et al., Phys. Rev. E 68, 011306, 2003)
 * the minimum is 0. Units: stiffness 1 N/m, mass 1 kg for the smallest body. Input and output: the
 * positions of a set.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/pack_parts.h"

static const double inflation = 1e-3; /* of the radius */
static const double safety = 1e-6;    /* of the least radius: a gap that rounding cannot close */
static const double skin_share = 0.5; /* of the least radius */
static const int most_steps = 20000;
static const int patience = 1000; /* steps in which the energy must fall by a tenth */

struct neighbour {
    int32_t i, j; /* j: a body, or an edge (then obstacles) of the region */
};

struct list {
    struct neighbour *list;
    size_t count, room;
};

struct relax {
    struct calx_pack_set *set;
    double skin;
    double (*velocity)[3], (*force)[3], (*built)[3]; /* built: positions when the lists were made */
    double *mass;
    struct list bodies, edges;
    double energy, deepest; /* J of the inflated bodies; m, largest true overlap */
    double shrink;          /* largest true overlap relative to the radii that cause it */
    int32_t searching;      /* the body whose neighbours are being listed */
    int level;
    bool failed;
    double dt, mixing; /* of FIRE */
    int downhill;      /* steps since the power was last negative */
};

static bool append(struct list *list, int32_t i, int32_t j)
{
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 1024;
        struct neighbour *more = realloc(list->list, room * sizeof *more);
        if (!more)
            return false;
        list->list = more;
        list->room = room;
    }
    list->list[list->count++] = (struct neighbour){i, j};
    return true;
}

/* ---- neighbour lists ---- */

/* A pair is found from its smaller body, among equals of a level from the later one. */
static bool add_neighbour(void *context, int32_t j)
{
    struct relax *relax = context;
    const struct calx_pack_set *set = relax->set;
    int32_t i = relax->searching;
    if ((size_t)i >= set->count && (size_t)j >= set->count)
        return true;
    if (j >= i && calx_pack_grid_level(&set->grid, set->radius[j]) == relax->level)
        return true;
    double d[3], reach = (set->radius[i] + set->radius[j]) * (1 + inflation) + relax->skin;
    if (calx_pack_grid_between(&set->grid, set->position[i], j, d) >= reach * reach)
        return true;
    relax->failed = !append(&relax->bodies, i, j);
    return !relax->failed;
}

static const double *edge_at(const struct calx_region *region, int32_t e)
{
    size_t k = (size_t)e;
    return k < region->edge_count ? region->edges[k] : region->obstacles[k - region->edge_count];
}

static void list_edges(struct relax *relax, int32_t i)
{
    const struct calx_region *region = relax->set->region;
    double away[2],
        reach = relax->set->radius[i] * (1 + inflation) + region->clearance + relax->skin;
    for (int32_t e = 0; (size_t)e < region->edge_count + region->obstacle_count; e++)
        if (calx_region_edge(edge_at(region, e), relax->set->position[i], away) < reach &&
            !append(&relax->edges, i, e))
            relax->failed = true;
}

static bool build_lists(struct relax *relax)
{
    struct calx_pack_set *set = relax->set;
    relax->bodies.count = relax->edges.count = 0;
    calx_pack_grid_reset(&set->grid);
    for (size_t i = 0; i < set->total; i++)
        calx_pack_grid_insert(&set->grid, (int32_t)i);
    for (size_t i = 0; i < set->total && !relax->failed; i++) {
        double r = set->radius[i];
        relax->searching = (int32_t)i;
        relax->level = calx_pack_grid_level(&set->grid, r);
        double margin = relax->skin + inflation * (r + set->largest);
        calx_pack_grid_visit(&set->grid, set->position[i], r, margin, relax->level, add_neighbour,
                             relax);
        if (i < set->count)
            list_edges(relax, (int32_t)i);
    }
    memcpy(relax->built, set->position, set->count * sizeof *relax->built);
    return !relax->failed;
}

static bool lists_are_stale(const struct relax *relax)
{
    double far = relax->skin * relax->skin / 4;
    for (size_t i = 0; i < relax->set->count; i++) {
        const double *x = relax->set->position[i], *b = relax->built[i];
        double dx = x[0] - b[0], dy = x[1] - b[1], dz = x[2] - b[2];
        if (dx * dx + dy * dy + dz * dz > far)
            return true;
    }
    return false;
}

/* ---- forces ---- */

/* Books a contact: its overlap, what of it is real, and the radii that it comes from. */
static void note(struct relax *relax, double overlap, double real, double radii)
{
    relax->energy += overlap * overlap / 2;
    relax->deepest = fmax(relax->deepest, real);
    relax->shrink = fmax(relax->shrink, real / radii);
}

static void push_bodies(struct relax *relax)
{
    struct calx_pack_set *set = relax->set;
    for (size_t k = 0; k < relax->bodies.count; k++) {
        int32_t i = relax->bodies.list[k].i, j = relax->bodies.list[k].j;
        double d[3] = {0}, sum = set->radius[i] + set->radius[j], reach = sum * (1 + inflation);
        double square = calx_pack_grid_between(&set->grid, set->position[i], j, d);
        if (square >= reach * reach)
            continue;
        double distance = sqrt(square), overlap = reach - distance;
        if (distance == 0)
            d[0] = distance = 1; /* any direction parts two bodies in one place */
        note(relax, overlap, sum - sqrt(square), sum);
        for (int c = 0; c < 3; c++) {
            double f = overlap * d[c] / distance;
            relax->force[i][c] += f;
            relax->force[j][c] -= f;
        }
    }
}

static void push_edges(struct relax *relax)
{
    struct calx_pack_set *set = relax->set;
    for (size_t k = 0; k < relax->edges.count; k++) {
        int32_t i = relax->edges.list[k].i;
        double away[2], reach = set->radius[i] * (1 + inflation) + set->region->clearance;
        double distance =
            calx_region_edge(edge_at(set->region, relax->edges.list[k].j), set->position[i], away);
        double overlap = reach - distance;
        if (overlap <= 0 || distance == 0)
            continue;
        note(relax, overlap, overlap - inflation * set->radius[i], set->radius[i]);
        for (int c = 0; c < 2; c++)
            relax->force[i][c] += overlap * away[c] / distance;
    }
}

static void push_bounds(struct relax *relax)
{
    struct calx_pack_set *set = relax->set;
    for (size_t i = 0; i < set->count; i++) {
        double extra = inflation * set->radius[i];
        double overlap = calx_region_push(set->region, set->position[i], set->radius[i] + extra,
                                          relax->force[i]);
        note(relax, fmax(0, overlap), overlap - extra, set->radius[i]);
    }
}

static void find_forces(struct relax *relax)
{
    relax->energy = relax->shrink = 0;
    relax->deepest = -INFINITY;
    memset(relax->force, 0, relax->set->total * sizeof *relax->force);
    push_bodies(relax);
    push_edges(relax);
    push_bounds(relax);
}

/* ---- motion ---- */

/* The mixing and the step of FIRE, with the constants of the paper. */
static void adapt(struct relax *relax)
{
    double power = 0, speed = 0, strength = 0;
    for (size_t i = 0; i < relax->set->count; i++) {
        for (int c = 0; c < 3; c++) {
            double v = relax->velocity[i][c], f = relax->force[i][c];
            power += f * v;
            speed += v * v;
            strength += f * f;
        }
    }
    bool down = power > 0;
    double keep = down ? 1 - relax->mixing : 0;
    double turn = down && strength > 0 ? relax->mixing * sqrt(speed / strength) : 0;
    for (size_t i = 0; i < relax->set->count; i++)
        for (int c = 0; c < 3; c++)
            relax->velocity[i][c] = keep * relax->velocity[i][c] + turn * relax->force[i][c];
    relax->downhill = down ? relax->downhill + 1 : 0;
    if (!down) {
        relax->dt = fmax(0.02, relax->dt * 0.5);
        relax->mixing = 0.1;
    } else if (relax->downhill > 5) {
        relax->dt = fmin(0.4, relax->dt * 1.1); /* 2/omega of a body with 12 contacts */
        relax->mixing *= 0.99;
    }
}

/* Steps are short against the least radius, so that no body jumps over a segment. */
static void move(struct relax *relax)
{
    struct calx_pack_set *set = relax->set;
    double longest = relax->skin / 4;
    for (size_t i = 0; i < set->count; i++) {
        double *v = relax->velocity[i], square = 0;
        for (int c = 0; c < 3; c++) {
            v[c] += relax->dt * relax->force[i][c] / relax->mass[i];
            square += v[c] * v[c];
        }
        double step = relax->dt * sqrt(square), scale = step > longest ? longest / step : 1;
        for (int c = 0; c < 3; c++) {
            v[c] *= scale;
            set->position[i][c] += relax->dt * v[c];
        }
    }
}

static bool minimise(struct relax *relax)
{
    double reference = INFINITY;
    for (int step = 0; step < most_steps; step++) {
        if ((step == 0 || lists_are_stale(relax)) && !build_lists(relax))
            return false;
        find_forces(relax);
        if (relax->deepest <= -safety * relax->set->least)
            return true;
        if (step % patience == 0) {
            if (relax->energy > 0.9 * reference)
                return true;
            reference = relax->energy;
        }
        adapt(relax);
        move(relax);
    }
    return true;
}

/* Back into the first image, inside low <= x < high. */
static void wrap(struct calx_pack_set *set)
{
    const struct calx_region *region = set->region;
    for (size_t i = 0; i < set->count; i++) {
        for (uint32_t k = 0; k < region->dimension; k++) {
            double period = region->high[k] - region->low[k], *x = &set->position[i][k];
            if (region->periodic[k])
                *x -= period * floor((*x - region->low[k]) / period);
            if (region->periodic[k] && *x >= region->high[k]) /* by rounding */
                *x = region->low[k];
        }
    }
}

int calx_pack_relax(struct calx_pack_set *set, double *shrink, struct calx_error *error)
{
    struct relax relax = {.set = set, .skin = skin_share * set->least, .dt = 0.1, .mixing = 0.1};
    relax.velocity = calloc(set->total, sizeof *relax.velocity);
    relax.force = calloc(set->total, sizeof *relax.force);
    relax.built = calloc(set->total, sizeof *relax.built);
    relax.mass = calloc(set->total, sizeof *relax.mass);
    bool done = relax.velocity && relax.force && relax.built && relax.mass;
    if (done) {
        for (size_t i = 0; i < set->count;
             i++) /* as many contacts as fit around it share the stiffness */
            relax.mass[i] = pow(set->radius[i] / set->least, set->region->dimension - 1);
        done = minimise(&relax);
        wrap(set);
        *shrink = relax.shrink;
    }
    free(relax.velocity);
    free(relax.force);
    free(relax.built);
    free(relax.mass);
    free(relax.bodies.list);
    free(relax.edges.list);
    return done ? CALX_OK
                : calx_error_set(error, CALX_ERROR_MEMORY, "no memory to pack %zu bodies",
                                 set->count);
}

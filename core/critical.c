/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The critical step of a plan: the integrator's limit on omega*dt over the fastest frequency of a pair of bodies, taken from
 * the tangent stiffness and damping that the laws report at the deepest overlap the scene can be expected to reach
 * (its elastic energy equals the kinetic energy of the fastest approach).
 * omega^2 = k/m*; tangential: k_t (1 + m R^2/I)/m*; damping of ratio z shortens the limit by sqrt(1 + y^2) - y, y = z times the integrator's
 * limit without damping over that of damping alone (1 for velocity Verlet, for which the formula is exact). Non-smooth laws have no stiffness
 * and set no step.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/tangent.h"

struct pair_case {
    size_t type;
    double radius[2], mass[2]; /* radius 0, mass infinite: a wall */
    const char *name[2];
};

double calx_critical_speed(const struct calx_scene *scene)
{
    static const double nowhere[3];
    double speed = 0.0, fall = 0.0, lo[3], hi[3], g2 = 0.0, extent2 = 0.0;
    const struct calx_particles *p = &scene->particles;
    for (size_t i = 0; i < p->count; i++) {
        double v2 = 0.0;
        for (int k = 0; k < 3; k++) {
            v2 += p->velocity ? p->velocity[i][k] * p->velocity[i][k] : 0.0;
            lo[k] = i ? fmin(lo[k], p->position[i][k]) : p->position[i][k];
            hi[k] = i ? fmax(hi[k], p->position[i][k]) : p->position[i][k];
        }
        speed = fmax(speed, sqrt(v2));
    }
    for (int k = 0; k < 3 && p->count; k++) {
        double g = calx_evaluate(&scene->stages[0].gravity[k], 0.0, nowhere);
        g2 += g * g;
        extent2 += (hi[k] - lo[k] + 4.0 * p->radius[0]) * (hi[k] - lo[k] + 4.0 * p->radius[0]);
    }
    fall = sqrt(2.0 * sqrt(g2) * sqrt(extent2));
    return fmax(2.0 * speed, fall);
}

static void respond(const struct calx_plan *p, const struct pair_case *c, double overlap, double *energy,
                    double stiffness[2], double damping[2])
{
    double e[CALX_WIDTH] = {0}, k[2][CALX_WIDTH] = {{0}}, d[2][CALX_WIDTH] = {{0}};
    struct calx_columns columns;
    memset(&columns, 0, sizeof columns);
    columns.n = 1;
    for (size_t h = 0; h < CALX_HISTORY_MAX; h++)
        columns.history[h] = columns.kept[h];
    for (size_t q = 0; q < CALX_WIDTH; q++) {
        columns.overlap[q] = q ? 0.0 : overlap;
        columns.normal[0][q] = 1.0;
        columns.mass[q] = 1.0 / (1.0 / c->mass[0] + 1.0 / c->mass[1]);
        for (int b = 0; b < 2; b++) {
            columns.curvature[b][q] = c->radius[b] > 0.0 ? 1.0 / c->radius[b] : 0.0;
            columns.temperature[b][q] = 293.15;
        }
    }
    struct calx_response out = {.size = sizeof out, .energy = e, .stiffness = {k[0], k[1]}, .damping = {d[0], d[1]}};
    calx_tangent_respond(p, c->type, &columns, &out);
    *energy = e[0];
    for (int q = 0; q < 2; q++) {
        stiffness[q] = k[q][0];
        damping[q] = d[q][0];
    }
}

/* The overlap whose elastic energy is that of an approach at `speed`, at most a quarter of the smaller radius. */
static double deepest_overlap(const struct calx_plan *p, const struct pair_case *c, double speed)
{
    double reduced = 1.0 / (1.0 / c->mass[0] + 1.0 / c->mass[1]), wanted = 0.5 * reduced * speed * speed;
    double radius = c->radius[1] > 0.0 ? fmin(c->radius[0], c->radius[1]) : c->radius[0];
    double lo = 1e-6 * radius, hi = 0.25 * radius, k[2], d[2], energy;
    for (int step = 0; step < 60; step++) {
        double mid = sqrt(lo * hi);
        respond(p, c, mid, &energy, k, d);
        if (energy < wanted)
            lo = mid;
        else
            hi = mid;
    }
    return hi;
}

/* The largest stable step of one pair, and half the period of its normal vibration. */
static double pair_limit(const struct calx_scene *scene, const struct calx_plan *p, const struct pair_case *c,
                         double speed, double *duration)
{
    double k[2], d[2], energy, reduced = 1.0 / (1.0 / c->mass[0] + 1.0 / c->mass[1]), limit = INFINITY;
    double lever = 1.0 + 1.0 / calx_particle_inertia_factor(scene);
    respond(p, c, deepest_overlap(p, c, speed), &energy, k, d);
    *duration = M_PI / sqrt(k[0] / reduced);
    for (int q = 0; q < 2; q++) {
        double effective = q && p->needs & CALX_NEEDS_ROTATION ? reduced / lever : reduced;
        double omega = sqrt(k[q] / effective), ratio = d[q] / (2.0 * effective * omega);
        ratio *= p->motion_law->stability / p->motion_law->damping;
        if (omega > 0.0)
            limit = fmin(limit, p->motion_law->stability / omega * (sqrt(1.0 + ratio * ratio) - ratio));
    }
    return limit;
}

static bool is_held(const struct calx_particles *p, size_t i)
{
    return (p->fixed && p->fixed[i]) || (p->carrier && p->carrier[i] >= 0);
}

/* In a scene of held bodies alone the step matters to nobody; one is found as if they were free. */
static bool anybody_free(const struct calx_particles *p)
{
    for (size_t i = 0; i < p->count; i++)
        if (!is_held(p, i))
            return true;
    return false;
}

/* Of the bodies of a material: the smallest radius of those that impacts move, the lightest, or the largest of those that are held or
 * carried, on which contacts are stiffest. any_free: some bodies of the scene are not held. 0 if it has none. */
static double extreme_radius(const struct calx_scene *scene, size_t material, bool held, bool any_free)
{
    const struct calx_particles *p = &scene->particles;
    double radius = 0.0;
    for (size_t i = 0; i < p->count; i++) {
        if ((size_t)p->material[i] != material || (any_free && is_held(p, i)) != held)
            continue;
        if (radius == 0.0 || (held ? p->radius[i] > radius : p->radius[i] < radius))
            radius = p->radius[i];
    }
    return radius;
}

static void consider(const struct calx_sim *s, struct calx_plan *p, const struct pair_case *c, double speed)
{
    double duration, limit = pair_limit(s->scene, p, c, speed, &duration);
    p->shortest = fmin(p->shortest, duration);
    if (limit >= p->critical_dt)
        return;
    p->critical_dt = limit;
    snprintf(p->critical_text, sizeof p->critical_text, "%s (R = %g m) against %s%s", c->name[0], c->radius[0],
             c->radius[1] > 0.0 ? "" : "a wall of ", c->name[1]);
}

int calx_critical_step(struct calx_sim *s, struct calx_plan *p, struct calx_error *e)
{
    const struct calx_scene *scene = s->scene;
    size_t n = scene->material_count;
    double speed = calx_critical_speed(scene);
    bool any_free = anybody_free(&scene->particles);
    (void)e;
    p->critical_dt = p->shortest = INFINITY;
    for (size_t type = 0; p->motion && p->law_count && !p->nonsmooth && type < n * n; type++) {
        size_t m[2] = {type / n, type % n};
        struct pair_case c = {.type = type};
        for (int q = 0; q < 2; q++)
            c.name[q] = scene->materials[m[q]].name;
        c.radius[0] = extreme_radius(scene, m[0], false, any_free);
        c.mass[0] = calx_particle_mass(scene, c.radius[0], scene->materials[m[0]].density);
        if (!(c.radius[0] > 0.0))
            continue;
        for (int held = 0; held < 2; held++) {
            c.radius[1] = extreme_radius(scene, m[1], held, any_free);
            c.mass[1] = held ? INFINITY : calx_particle_mass(scene, c.radius[1], scene->materials[m[1]].density);
            if (c.radius[1] > 0.0 && scene->particles.count > 1)
                consider(s, p, &c, speed);
        }
        if (s->material_used[m[1]] & 2) {
            c.radius[1] = 0.0;
            c.mass[1] = INFINITY;
            consider(s, p, &c, speed);
        }
    }
    return 0;
}

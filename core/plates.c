/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Loaded plates: walls, or rigid groups, that are free along one axis and have a mass there: m du/dt = F + L + m g - c u, with the force F of
 * the grains, a load L and a damping c. Method: between two evaluations that are kept, at t and t + dt, a plate is where its acceleration
 * at t takes it, q + u dt + a dt^2/2; after the second, u gains (a + a') dt/2: velocity Verlet, whatever integrates the bodies, c implicit.
 * Among rigid bodies a plate is one of those of the contact problem (store.c), and moves as they do: m (u' - u) = r + dt (L + m g - c (u + u')/2),
 * q' = q + u (1 - theta) dt + u' theta dt.
 * Ledger: a plate's energies are among those of the bodies; the load works from outside; damping of the plate is dissipated, not heat.
 */
#include <math.h>

#include "core/state.h"

static const struct calx_motion *motion_of(const struct calx_sim *s, size_t wall)
{
    return &s->scene->stages[s->stage].motion[wall];
}

bool calx_plates_ever(const struct calx_scene *scene, int wall)
{
    for (size_t k = 0; wall >= 0 && k < scene->stage_count; k++)
        if (scene->stages[k].motion[wall].free)
            return true;
    return false;
}

static double load_at(const struct calx_motion *m, double t)
{
    static const double nowhere[3];
    return calx_evaluate(&m->load, t, nowhere);
}

static double weight_at(const struct calx_sim *s, const struct calx_motion *m, double t)
{
    static const double nowhere[3];
    return m->mass * calx_evaluate(&s->scene->stages[s->stage].gravity[m->free_axis], t, nowhere);
}

/* Between impulses there is none. */
static double acceleration(const struct calx_sim *s, const struct calx_plate *p)
{
    return s->plan && s->plan->nonsmooth ? 0.0 : p->acceleration;
}

void calx_plates_place(const struct calx_sim *s, size_t wall, double t, double shift[3])
{
    const struct calx_motion *m = motion_of(s, wall);
    const struct calx_plate *p = &s->plates[wall];
    double dt = t - p->time;
    if (m->free)
        shift[m->free_axis] += p->shift + dt * (p->speed + 0.5 * dt * acceleration(s, p));
}

double calx_plates_speed(const struct calx_sim *s, size_t wall, double t)
{
    const struct calx_plate *p = &s->plates[wall];
    return p->speed + (t - p->time) * acceleration(s, p);
}

static void take(struct calx_sim *s, size_t wall, double t)
{
    const struct calx_motion *m = motion_of(s, wall);
    struct calx_plate *p = &s->plates[wall];
    double dt = t - p->time, before = p->speed, load = load_at(m, t);
    double way = dt * (before + 0.5 * dt * p->acceleration), half = before + 0.5 * dt * p->acceleration;
    p->power = s->wall_force[wall][m->free_axis] * (before + dt * p->acceleration);
    p->contact = s->wall_force[wall][m->free_axis];
    double force = p->contact + load + weight_at(s, m, t);
    p->speed = (half + 0.5 * dt * force / m->mass) / (1.0 + 0.5 * dt * m->damping / m->mass);
    p->acceleration = (force - m->damping * p->speed) / m->mass;
    p->shift += way;
    p->time = t;
    s->outside_work += 0.5 * (p->load + load) * way;
    s->dissipated += 0.5 * dt * m->damping * (before * before + p->speed * p->speed);
    p->load = load;
    s->poses[wall].speed[m->free_axis] = p->speed;
}

/* ---- among rigid bodies ---- */

double calx_plates_expect(struct calx_sim *s, size_t wall, double t, double dt, double *speed)
{
    const struct calx_motion *m = motion_of(s, wall);
    struct calx_plate *p = &s->plates[wall];
    double mass = m->mass + 0.5 * dt * m->damping;
    p->load = load_at(m, t);
    *speed = ((m->mass - 0.5 * dt * m->damping) * p->speed + dt * (p->load + weight_at(s, m, t))) / mass;
    return 1.0 / mass;
}

void calx_plates_settle(struct calx_sim *s, size_t wall, double speed)
{
    int axis = motion_of(s, wall)->free_axis;
    struct calx_pose *pose = &s->poses[wall];
    pose->past_speed[axis] = speed;
    pose->speed[axis] = 0.5 * (s->plates[wall].speed + speed);
}

/* Walls are where contacts were looked for, with the mean speeds of the step. */
static void take_settled(struct calx_sim *s, size_t wall)
{
    const struct calx_motion *m = motion_of(s, wall);
    struct calx_plate *p = &s->plates[wall];
    const struct calx_pose *pose = &s->poses[wall];
    double first = s->evaluated - p->time, mean = pose->speed[m->free_axis], after = pose->past_speed[m->free_axis];
    double way = first * p->speed + (s->dt - first) * after;
    p->contact = s->wall_force[wall][m->free_axis];
    p->power = p->contact * mean;
    p->shift += way;
    p->speed = after;
    p->time += s->dt;
    s->outside_work += p->load * way;
    s->dissipated += s->dt * m->damping * mean * mean;
}

void calx_plates_take(struct calx_sim *s, double t)
{
    for (size_t w = 0; w < s->scene->wall_count; w++) {
        if (!motion_of(s, w)->free)
            continue;
        if (!s->plan->nonsmooth)
            take(s, w, t);
        else if (s->delivering)
            take_settled(s, w);
    }
}

double calx_plates_power(const struct calx_sim *s)
{
    double power = 0.0;
    for (size_t w = 0; w < s->scene->wall_count; w++)
        power += motion_of(s, w)->free ? s->plates[w].power : 0.0;
    return power;
}

/* ---- energies ---- */

static double kinetic(const struct calx_motion *m, const struct calx_plate *p)
{
    return m->free ? 0.5 * m->mass * p->speed * p->speed : 0.0;
}

static double potential(const struct calx_motion *m, const struct calx_plate *p, const double gravity[3])
{
    return m->free ? -m->mass * gravity[m->free_axis] * (p->shift + p->risen) : 0.0;
}

double calx_plates_kinetic(const struct calx_sim *s)
{
    double sum = 0.0;
    for (size_t w = 0; w < s->scene->wall_count; w++)
        sum += kinetic(motion_of(s, w), &s->plates[w]);
    return sum;
}

double calx_plates_potential(const struct calx_sim *s)
{
    double sum = 0.0;
    for (size_t w = 0; w < s->scene->wall_count; w++)
        sum += potential(motion_of(s, w), &s->plates[w], s->gravity);
    return sum;
}

/* ---- stages ---- */

/* A plate that was free along the same axis goes on as it moves; a wall that becomes free starts with the speed it had. What that does to the
 * energies is work from outside. */
void calx_plates_begin_stage(struct calx_sim *s, const struct calx_stage_spec *before)
{
    static const struct calx_motion rest;
    for (size_t w = 0; w < s->scene->wall_count; w++) {
        const struct calx_motion *m = motion_of(s, w), *old = before ? &before->motion[w] : &rest;
        struct calx_plate *p = &s->plates[w];
        bool goes_on = m->free && old->free && m->free_axis == old->free_axis;
        double energy = kinetic(old, p) + potential(old, p, s->gravity);
        *p = (struct calx_plate){.time = s->time, .risen = goes_on ? p->risen + p->shift : 0.0};
        if (!m->free) {
            s->outside_work -= energy;
            continue;
        }
        p->speed = s->poses[w].speed[m->free_axis];
        p->contact = s->wall_force[w][m->free_axis];
        p->load = load_at(m, s->time);
        p->acceleration = (p->contact + p->load + weight_at(s, m, s->time) - m->damping * p->speed) / m->mass;
        s->outside_work += kinetic(m, p) + potential(m, p, s->gravity) - energy;
    }
}

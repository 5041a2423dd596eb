/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Rigid motion of walls: the pose of each wall is the motion of the present stage applied to its pose when the stage
 * began. Constant rates are exact products of time; functions of time are integrated by the midpoint rule.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface.h"

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Rotation by `angle` about the unit axis (Rodrigues). */
static void rotation(const double axis[3], double angle, double m[9])
{
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[3 * i + j] = (1.0 - c) * axis[i] * axis[j] + (i == j ? c : 0.0);
    m[1] -= s * axis[2];
    m[2] += s * axis[1];
    m[3] += s * axis[2];
    m[5] -= s * axis[0];
    m[6] -= s * axis[1];
    m[7] += s * axis[0];
}

static void turn(const double m[9], const double v[3], double out[3])
{
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
    memcpy(out, r, sizeof r);
}

/* Puts primitive p of a wall, the `at`-th of the scene, into the wall's pose. */
static void place_primitive(struct calx_sim *s, size_t wall, size_t p, size_t at)
{
    const struct calx_pose *pose = &s->poses[wall];
    struct calx_primitive *q = &s->posed[at].p;
    *q = s->scene->walls[wall].primitives[p];
    turn(pose->turn, q->a, q->a);
    turn(pose->turn, q->b, q->b);
    turn(pose->turn, q->n, q->n);
    for (int k = 0; k < 3; k++) {
        q->a[k] += pose->shift[k];
        q->b[k] += pose->shift[k];
    }
    s->posed[at].wall = (int32_t)wall;
}

/* The farthest that any grain or wall point is from the middle of the scene: bounds how far a turn can carry a surface. */
static double scene_reach(const struct calx_scene *scene)
{
    double reach = 0.0;
    for (size_t i = 0; i < scene->particles.count; i++) {
        const double *x = scene->particles.position[i];
        reach = fmax(reach, sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
    }
    return 2.0 * reach;
}

int calx_walls_create(struct calx_sim *s, struct calx_error *e)
{
    const struct calx_scene *scene = s->scene;
    size_t n = scene->wall_count;
    for (size_t w = 0; w < n; w++)
        s->primitive_count += scene->walls[w].primitive_count;
    s->posed = calx_memory_zeroed(s->primitive_count, sizeof *s->posed);
    s->poses = calx_memory_zeroed(n, sizeof *s->poses);
    s->stage_poses = calx_memory_zeroed(n, sizeof *s->stage_poses);
    s->wall_angle = calx_memory_zeroed(n, sizeof *s->wall_angle);
    s->wall_shift = calx_memory_zeroed(n, sizeof *s->wall_shift);
    s->plates = calx_memory_zeroed(n, sizeof *s->plates);
    s->wall_force = calx_memory_zeroed(n, sizeof *s->wall_force);
    s->wall_temperature = calx_memory_zeroed(n, sizeof *s->wall_temperature);
    if (!s->posed || !s->poses || !s->stage_poses || !s->wall_angle || !s->wall_shift || !s->plates ||
        !s->wall_force || !s->wall_temperature)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu walls", n);
    s->wall_reach = scene_reach(scene);
    for (size_t w = 0, at = 0; w < n; w++) {
        for (int k = 0; k < 9; k += 4)
            s->poses[w].turn[k] = 1.0;
        for (size_t p = 0; p < scene->walls[w].primitive_count; p++)
            place_primitive(s, w, p, at++);
    }
    s->walls_changed = true;
    return 0;
}

void calx_walls_begin_stage(struct calx_sim *s)
{
    for (size_t w = 0; w < s->scene->wall_count; w++) {
        s->stage_poses[w] = s->poses[w];
        s->wall_angle[w] = 0.0;
        memset(s->wall_shift[w], 0, sizeof s->wall_shift[w]);
    }
    calx_walls_move(s, s->time, 0.0);
}

/* Integrates a rate: a constant gives the exact product with the time since the stage began. */
static void advance(const struct calx_function *rate, double t, double dt, double tau, double *sum)
{
    static const double nowhere[3];
    if (rate->eval)
        *sum += dt * rate->eval(rate->context, t - 0.5 * dt, nowhere);
    else
        *sum = rate->value * tau;
}

/* Displacement of the oscillation and of the prescribed displacement, added to shift. */
static void add_prescribed(const struct calx_motion *m, double t, double tau, double stage_start, double shift[3])
{
    static const double nowhere[3];
    double w = 2.0 * M_PI * m->frequency;
    for (int k = 0; k < 3; k++) {
        const struct calx_function *f = &m->displacement[k];
        shift[k] += m->amplitude[k] * (sin(w * tau + m->phase) - sin(m->phase));
        if (m->has_displacement)
            shift[k] += calx_evaluate(f, t, nowhere) - calx_evaluate(f, stage_start, nowhere);
    }
}

/* Speed at the origin of space and spin, `ago` seconds before t; centre: what the wall turns about, at t. */
static void wall_speed(const struct calx_motion *m, double t, double tau, double ago, const double centre[3],
                       double speed[3], double spin[3])
{
    static const double nowhere[3];
    double w = 2.0 * M_PI * m->frequency, h = 1e-6 * fmax(fabs(t), 1e-3), then = t - ago, about[3], offset[3];
    for (int k = 0; k < 3; k++) {
        const struct calx_function *f = &m->displacement[k];
        speed[k] = calx_evaluate(&m->velocity[k], then, nowhere);
        speed[k] += m->amplitude[k] * w * cos(w * (tau - ago) + m->phase);
        if (m->has_displacement)
            speed[k] += (calx_evaluate(f, then + h, nowhere) - calx_evaluate(f, then - h, nowhere)) / (2.0 * h);
        spin[k] = m->axis[k] * calx_evaluate(&m->rate, then, nowhere);
        about[k] = centre[k] - ago * speed[k];
    }
    cross(spin, about, offset);
    for (int k = 0; k < 3; k++)
        speed[k] -= offset[k];
}

static void pose_wall(struct calx_sim *s, size_t w, const struct calx_motion *m, double t, double dt)
{
    double tau = t - s->stage_start, m9[9], shift[3], centre[3], offset[3];
    const struct calx_pose *base = &s->stage_poses[w];
    struct calx_pose *pose = &s->poses[w];
    advance(&m->rate, t, dt, tau, &s->wall_angle[w]);
    for (int k = 0; k < 3; k++) {
        advance(&m->velocity[k], t, dt, tau, &s->wall_shift[w][k]);
        shift[k] = s->wall_shift[w][k];
    }
    add_prescribed(m, t, tau, s->stage_start, shift);
    calx_plates_place(s, w, t, shift);
    rotation(m->axis, s->wall_angle[w], m9);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            pose->turn[3 * i + j] = m9[3 * i] * base->turn[j] + m9[3 * i + 1] * base->turn[3 + j] +
                                    m9[3 * i + 2] * base->turn[6 + j];
    for (int k = 0; k < 3; k++)
        offset[k] = base->shift[k] - m->about[k];
    turn(m9, offset, offset);
    for (int k = 0; k < 3; k++) {
        centre[k] = m->about[k] + shift[k];
        pose->shift[k] = centre[k] + offset[k];
    }
    pose->ago = s->lag;
    wall_speed(m, t, tau, 0.0, centre, pose->speed, pose->spin);
    wall_speed(m, t, tau, pose->ago, centre, pose->past_speed, pose->past_spin);
    if (m->free) {
        pose->speed[m->free_axis] = calx_plates_speed(s, w, t);
        pose->past_speed[m->free_axis] = calx_plates_speed(s, w, t - pose->ago);
    }
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* How far the surface may have moved towards a grain between two places of a primitive. */
static double displacement(const struct calx_primitive *a, const struct calx_primitive *b, double reach)
{
    double d = distance(a->a, b->a);
    if (a->shape == CALX_SEGMENT)
        return fmax(d, distance(a->b, b->b));
    return a->shape == CALX_SPHERE ? d : d + reach * distance(a->n, b->n);
}

static void stop(struct calx_pose *p)
{
    p->ago = 0.0;
    for (int k = 0; k < 3; k++)
        p->speed[k] = p->spin[k] = p->past_speed[k] = p->past_spin[k] = 0.0;
}

void calx_walls_move(struct calx_sim *s, double t, double dt)
{
    static const double nowhere[3];
    const struct calx_stage_spec *stage = &s->scene->stages[s->stage];
    double drift = 0.0;
    s->evaluated = t;
    for (size_t w = 0, at = 0; w < s->scene->wall_count; at += s->scene->walls[w++].primitive_count) {
        if (s->features.temperature && s->scene->walls[w].isothermal)
            s->wall_temperature[w] = calx_evaluate(&stage->wall_temperature[w], t, nowhere);
        if (!stage->motion[w].moves) {
            stop(&s->poses[w]);
            continue;
        }
        pose_wall(s, w, &stage->motion[w], t, dt);
        for (size_t p = 0; p < s->scene->walls[w].primitive_count; p++) {
            struct calx_primitive before = s->posed[at + p].p;
            place_primitive(s, w, p, at + p);
            double came = displacement(&before, &s->posed[at + p].p, s->wall_reach);
            s->wall_fastest = came > drift ? (int)w : s->wall_fastest;
            drift = fmax(drift, came);
        }
        s->walls_changed = true;
    }
    s->wall_drift += drift;
    s->wall_step += drift;
    calx_carried_move(s);
}

void calx_walls_velocity(const struct calx_sim *s, int wall, const double at[3], double out[3])
{
    calx_surface_velocity(s->poses[wall].speed, s->poses[wall].spin, at, out);
}

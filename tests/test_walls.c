/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Walls: the nearest point of every primitive against brute-force sampling; joints, corners,
 * T-junctions and flattened circles, where a contact must count once; friction across joints.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

/* ---- nearest points ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Two unit vectors across n. */
static void across(const double n[3], double u[3], double v[3])
{
    int k = fabs(n[0]) < 0.9 ? 0 : 1;
    double size;
    for (int q = 0; q < 3; q++)
        u[q] = (q == k) - n[k] * n[q];
    size = sqrt(dot(u, u));
    for (int q = 0; q < 3; q++)
        u[q] /= size;
    for (int q = 0; q < 3; q++)
        v[q] = n[(q + 1) % 3] * u[(q + 2) % 3] - n[(q + 2) % 3] * u[(q + 1) % 3];
}

/* The point with parameters a, b in [0, 1] on the part of the surface that can be near the unit
 * ball about the origin. */
static void surface_point(const struct calx_primitive *p, uint32_t dimension, double a, double b,
                          double out[3])
{
    double u[3], v[3], half = p->length > 0.0 ? 0.5 * p->length : 6.0, angle = 2.0 * M_PI * a,
                       polar = M_PI * b;
    if (p->shape != CALX_SEGMENT)
        across(p->shape == CALX_SPHERE ? (double[3]){0, 0, 1} : p->n, u, v);
    for (int k = 0; k < 3; k++) {
        if (p->shape == CALX_SEGMENT)
            out[k] = k < 2 ? p->a[k] + a * (p->b[k] - p->a[k]) : 12.0 * (b - 0.5);
        else if (p->shape == CALX_PLANE)
            out[k] = p->a[k] + 12.0 * (a - 0.5) * u[k] + 12.0 * (b - 0.5) * v[k];
        else if (p->shape == CALX_CYLINDER)
            out[k] = p->a[k] + p->radius * (cos(angle) * u[k] + sin(angle) * v[k]) +
                     (2.0 * b - 1.0) * half * p->n[k];
        else
            out[k] = p->a[k] + p->radius * (sin(polar) * (cos(angle) * u[k] + sin(angle) * v[k]) +
                                            cos(polar) * (k == 2));
    }
    if (dimension == 2)
        out[2] = 0.0;
}

/* The least distance of x from the surface: a coarse grid, then ever finer ones around the best
 * point so far. */
static double sampled_distance(const struct calx_primitive *p, uint32_t dimension,
                               const double x[3])
{
    enum { GRID = 48, FINER = 14 };
    double best = INFINITY, at[2] = {0.5, 0.5}, width = 1.0;
    for (int level = 0; level < FINER; level++) {
        double centre[2] = {at[0], at[1]};
        for (int i = 0; i <= GRID; i++)
            for (int j = 0; j <= GRID; j++) {
                double q[3], a = centre[0] + width * ((double)i / GRID - 0.5),
                             b = centre[1] + width * ((double)j / GRID - 0.5);
                if (p->shape == CALX_SEGMENT || p->shape == CALX_PLANE)
                    a = fmin(fmax(a, 0.0), 1.0);
                b = fmin(fmax(b, 0.0), 1.0);
                surface_point(p, dimension, a, b, q);
                double d[3] = {x[0] - q[0], x[1] - q[1], x[2] - q[2]}, size = sqrt(dot(d, d));
                if (size < best) {
                    best = size;
                    at[0] = a;
                    at[1] = b;
                }
            }
        width *= 0.2;
    }
    return best;
}

static const struct {
    const char *name;
    uint32_t dimension;
    struct calx_primitive p;
} primitives[] = {
    {"segment 2D", 2, {.shape = CALX_SEGMENT, .a = {-0.5, -0.2, 0}, .b = {0.7, 0.4, 0}}},
    {"strip 3D", 3, {.shape = CALX_SEGMENT, .a = {-0.5, 0.3, 0}, .b = {0.1, -0.4, 0}}},
    {"line 2D", 2, {.shape = CALX_PLANE, .a = {0.1, 0.2, 0}, .n = {0.6, -0.8, 0}}},
    {"plane 3D",
     3,
     {.shape = CALX_PLANE, .a = {0.1, 0.2, -0.3}, .n = {2.0 / 3, -1.0 / 3, 2.0 / 3}}},
    {"circle inside 2D",
     2,
     {.shape = CALX_CYLINDER, .inside = true, .a = {0.2, 0.1, 0}, .n = {0, 0, 1}, .radius = 0.9}},
    {"circle outside 2D",
     2,
     {.shape = CALX_CYLINDER, .a = {0.2, 0.1, 0}, .n = {0, 0, 1}, .radius = 0.4}},
    {"endless cylinder",
     3,
     {.shape = CALX_CYLINDER,
      .inside = true,
      .a = {0, 0.1, 0.2},
      .n = {0.6, 0.0, 0.8},
      .radius = 1.1}},
    {"cylinder with ends",
     3,
     {.shape = CALX_CYLINDER, .a = {0.1, 0.1, 0}, .n = {0, 1, 0}, .radius = 0.3, .length = 0.8}},
    {"drum with ends",
     3,
     {.shape = CALX_CYLINDER,
      .inside = true,
      .a = {0, 0, 0},
      .n = {0, 0, 1},
      .radius = 0.7,
      .length = 0.9}},
    {"sphere inside",
     3,
     {.shape = CALX_SPHERE, .inside = true, .a = {0.1, -0.1, 0.1}, .radius = 1.2}},
    {"sphere outside", 3, {.shape = CALX_SPHERE, .a = {0.1, -0.1, 0.1}, .radius = 0.5}},
};

/* Whether the sign of the distance is right: behind a plane, or out of an inside, it is negative.
 */
static bool behind(const struct calx_primitive *p, const double x[3])
{
    double d[3] = {x[0] - p->a[0], x[1] - p->a[1], x[2] - p->a[2]}, along = dot(d, p->n);
    if (p->shape == CALX_SEGMENT)
        return false;
    if (p->shape == CALX_PLANE)
        return along < 0.0;
    if (p->shape == CALX_CYLINDER && p->length > 0.0 && fabs(along) > 0.5 * p->length)
        return false; /* beyond the rim: the distance to a curve */
    double rho = sqrt(dot(d, d) - (p->shape == CALX_CYLINDER ? along * along : 0.0));
    return p->inside ? rho > p->radius : rho < p->radius;
}

START_TEST(nearest_points_are_the_nearest)
{
    enum { POINTS = 40 };
    /* the last grid is 0.2^13/48 of the surface wide: 1e-10 of 12 m, squared over a distance that
     * random points do not come below 1e-4 of */
    const double tolerance = 1e-9;
    struct calx_random random;
    calx_random_seed(&random, 1);
    for (size_t c = 0; c < sizeof primitives / sizeof *primitives; c++)
        for (int n = 0; n < POINTS; n++) {
            const struct calx_primitive *p = &primitives[c].p;
            struct calx_touch t;
            double x[3];
            for (uint32_t k = 0; k < 3; k++)
                x[k] = k < primitives[c].dimension ? 2.0 * calx_random_uniform(&random) - 1.0 : 0.0;
            calx_surface_nearest(p, primitives[c].dimension, x, &t);
            double d = sampled_distance(p, primitives[c].dimension, x),
                   sign = behind(p, x) ? -1.0 : 1.0, gap = 0.0;
            for (int k = 0; k < 3; k++)
                gap += fabs(x[k] - t.distance * t.normal[k] - t.point[k]);
            if (fabs(sign * d - t.distance) > tolerance ||
                fabs(dot(t.normal, t.normal) - 1.0) > 1e-14 || gap > 1e-14)
                ck_abort_msg("%s from (%g, %g, %g): %.12g, sampled %.12g", primitives[c].name, x[0],
                             x[1], x[2], t.distance, sign * d);
        }
}
END_TEST

/* ---- joints ---- */

static const double STIFFNESS = 1e5, RADIUS = 0.1, DEPTH = 1e-3;
static const double RATIO = 1e-10; /* of forces and directions */

/* What acts on one grain that is put into a scene of segments. */
struct felt {
    size_t contacts;
    double force[3], tangential;
};

enum { LINKS = 8 };

struct chain {
    size_t n;
    double ends[LINKS][4];
    int32_t surface[LINKS];
};

static struct calx_scene *chain_scene(const struct chain *chain, uint32_t dimension, double x,
                                      double y)
{
    struct calx_scene *s = scene_create(dimension, CALX_SPHERES, 1);
    scene_linear(s, STIFFNESS, NAN, 0.5, 1e-5);
    scene_put(s, 0, x, y, 0.0, RADIUS);
    int w = scene_wall(s, "chain", 0);
    for (size_t k = 0; k < chain->n; k++)
        scene_segment(s, w, chain->ends[k][0], chain->ends[k][1], chain->ends[k][2],
                      chain->ends[k][3], chain->surface[k]);
    return s;
}

/* Forces of the frame after one step at rest. */
static struct felt feel(struct calx_scene *s)
{
    struct felt out = {0};
    struct run r = run_start(s, 1);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    out.contacts = f->contact_count;
    for (int k = 0; k < 3; k++)
        out.force[k] = f->force[0][k];
    for (size_t c = 0; c < f->contact_count; c++)
        out.tangential += f->tangential_force[c];
    calx_frame_free(f);
    run_free(&r);
    return out;
}

START_TEST(a_joint_counts_once)
{
    const double height = RADIUS - DEPTH, c = RADIUS - DEPTH, h = sqrt(0.5), u = STIFFNESS * DEPTH;
    const struct chain flat = {2, {{-1, 0, 0, 0}, {0, 0, 1, 0}}, {0, 0}},
                       strangers = {2, {{-1, 0, 0, 0}, {1, 0, 0, 0}}, {0, 1}},
                       roof = {2, {{-1, -1, 0, 0}, {0, 0, 1, -1}}, {0, 1}},
                       corner = {2, {{0, 1, 0, 0}, {0, 0, 1, 0}}, {0, 1}},
                       tee = {2, {{-1, 0, 1, 0}, {0, 0, 0, -1}}, {0, 1}},
                       end = {1, {{-1, 0, 0, 0}}, {0}},
                       cross = {2, {{-1, 0, 1, 0}, {0, -1, 0, 1}}, {0, 1}},
                       fan = {4,
                              {{0, 0, -1, -1}, {0, 0, -0.3, -1}, {0, 0, 0.4, -1}, {0, 0, 1, -1}},
                              {0, 1, 2, 3}};
    const struct {
        const char *name;
        const struct chain *chain;
        double x, y;
        size_t contacts;
        double fx, fy; /* N */
    } rows[] = {
        {"on the joint of one plane", &flat, 0.0, height, 1, 0, u},
        {"before the joint", &flat, -1e-3, height, 1, 0, u},
        {"a rounding after the joint", &flat, 1e-16, height, 1, 0, u},
        {"under the joint", &flat, 0.0, -height, 1, 0, -u},
        {"joint of two surfaces", &strangers, 2e-4, height, 1, 0, u},
        {"on a convex corner", &roof, 0.0, height, 1, 0, u},
        {"beside a convex corner", &roof, c * 0.6, c * 0.8, 1, u * 0.6, u * 0.8},
        {"in a re-entrant corner", &corner, c, c, 2, u, u},
        {"outside of that corner", &corner, -c * h, -c * h, 1, -u * h, -u * h},
        {"over a T", &tee, 1e-3, height, 1, 0, u},
        {"in the armpit of a T", &tee, c, -c, 2, u, -u},
        {"at a free end", &end, c * 0.6, c * 0.8, 1, u * 0.6, u * 0.8},
        {"in the angle of a cross", &cross, c, c, 2, u, u},
        {"on a fan of four", &fan, 0.0, height, 1, 0, u},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        for (uint32_t dimension = 2; dimension <= 3; dimension++) {
            struct felt f = feel(chain_scene(rows[k].chain, dimension, rows[k].x, rows[k].y));
            ck_assert_msg(f.contacts == rows[k].contacts, "%s: %zu contacts", rows[k].name,
                          f.contacts);
            ck_assert_msg(hypot(f.force[0] - rows[k].fx, f.force[1] - rows[k].fy) < RATIO * u &&
                              f.force[2] == 0.0 && f.tangential == 0.0,
                          "%s: (%.15g, %.15g, %g) N and %g N along it", rows[k].name, f.force[0],
                          f.force[1], f.force[2], f.tangential);
        }
}
END_TEST

/* A circle of n chords of one smooth surface; inside, a grain anywhere on it has one contact with
 * the force of the nearest chord alone. More chords than fit any fixed list of candidates. */
static void check_circle(size_t n)
{
    const double drum = 0.5, turn = 2.0 * M_PI / (double)n;
    for (int q = 0; q < 37; q++) {
        /* over a joint, over the middle of a chord, and anywhere; so far out that the nearest chord
         * is DEPTH deep */
        double angle = q == 0   ? 0.0
                       : q == 1 ? 0.5 * turn
                                : 0.17 * q,
               reach = drum * cos(0.5 * turn);
        double from = (reach - RADIUS + DEPTH) / cos(fmod(angle, turn) - 0.5 * turn);
        struct calx_scene *s = scene_create(2, CALX_SPHERES, 1);
        scene_linear(s, STIFFNESS, NAN, 0.5, 1e-5);
        scene_put(s, 0, from * cos(angle), from * sin(angle), 0.0, RADIUS);
        int w = scene_wall(s, "circle", 0);
        for (size_t k = 0; k < n; k++) {
            double a = turn * (double)k, b = turn * (double)((k + 1) % n);
            scene_segment(s, w, drum * cos(a), drum * sin(a), drum * cos(b), drum * sin(b), 7);
        }
        struct felt f = feel(s);
        ck_assert_msg(f.contacts == 1, "%zu chords, %g rad: %zu contacts", n, angle, f.contacts);
        double force = hypot(f.force[0], f.force[1]);
        ck_assert_msg(fabs(force / (STIFFNESS * DEPTH) - 1.0) < RATIO && f.tangential == 0.0,
                      "%zu chords, %g rad: %.12g N of %.12g", n, angle, force, STIFFNESS * DEPTH);
    }
}

START_TEST(a_flattened_circle_is_smooth)
{
    check_circle(24);
    check_circle(400);
}
END_TEST

/* A grain rolls down a plane of 20 degrees, held by friction at (2/7) m g sin a; the plane is one
 * segment or several. Returns its speed at the end. */
static double rolled_speed(size_t pieces, bool smooth, double mu)
{
    const double g = 9.81, tilt = 20.0 * M_PI / 180.0, length = 1.0, dt = 2e-5;
    struct chain chain = {.n = pieces};
    for (size_t k = 0; k < pieces && k < LINKS; k++) {
        double a = length * (double)k / (double)pieces,
               b = length * (double)(k + 1) / (double)pieces;
        memcpy(chain.ends[k], (double[4]){a, 0.0, b, 0.0}, sizeof chain.ends[k]);
        chain.surface[k] = smooth ? 0 : (int32_t)k;
    }
    struct calx_scene *s = chain_scene(&chain, 2, 0.1, RADIUS - DEPTH);
    double mass = calx_particle_mass(s, RADIUS, 1000.0), depth = mass * g * cos(tilt) / STIFFNESS;
    s->models[0].count = 0;
    for (size_t k = 0; k < 3; k++)
        free(s->models[0].list[k].values);
    scene_linear(s, STIFFNESS, NAN, mu, dt);
    scene_put(s, 0, 0.1, RADIUS - depth, 0.0, RADIUS);
    scene_gravity(s, g * sin(tilt), -g * cos(tilt), 0.0);
    struct run r = run_start(s, 1);
    while (run_x(&r, 0)[0] < 0.85)
        run_steps(&r, 1);
    double v = run_v(&r, 0)[0];
    run_free(&r);
    return v;
}

START_TEST(friction_survives_joints)
{
    const double bound =
        1e-6; /* of the speed; a contact that forgets its friction at the joint loses more */
    double whole = rolled_speed(1, true, 0.5);
    for (size_t pieces = 2; pieces <= LINKS; pieces *= 2)
        ck_assert_msg(fabs(rolled_speed(pieces, true, 0.5) / whole - 1.0) < bound,
                      "%zu pieces: %.12g instead of %.12g", pieces, rolled_speed(pieces, true, 0.5),
                      whole);
    ck_assert_double_gt(fabs(rolled_speed(LINKS, false, 0.5) / whole - 1.0),
                        bound); /* the bound bites */
    /* and it rolls as it should, (5/7) g sin a: the spring swings at the start by 2/7 of what
     * friction holds */
    double expected = sqrt(2.0 * 5.0 / 7.0 * 9.81 * sin(20.0 * M_PI / 180.0) * 0.75);
    ck_assert_double_eq_tol(whole / expected, 1.0, 0.02);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {nearest_points_are_the_nearest, a_joint_counts_once,
                            a_flattened_circle_is_smooth, friction_survives_joints};
    return run_tests("walls", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The estimate of the longest stable step against the step at which the engine itself turns
 * unstable, found by bisection, over random networks of contacts: packings of grains of several
 * sizes, periodic or between walls, in space and in the plane, smooth and rough, elastic and
 * damped.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/collision_times.h"
#include "core/stability.h"
#include "tests/scenes.h"

enum { NETWORKS = 200, MOST = 40, RELAX = 3000, STEPS = 300, HALVINGS = 5 };
static const double STIFFNESS = 1e4, SPACING = 0.02, MOST_RATIO = 1.6;

struct packing {
    uint32_t dimension;
    size_t n;
    double x[MOST][3], radius[MOST], size[3], low, high; /* low, high: walls along y */
    bool fixed[MOST], walls;
    double friction, tangential,
        restitution; /* friction < 0: none; tangential over normal stiffness */
};

static struct calx_registry *registry;

static void open_registry(void)
{
    registry = calx_registry_create(NULL);
    ck_assert_ptr_nonnull(registry);
}

static void close_registry(void)
{
    calx_registry_free(registry);
}

/* ---- the networks ---- */

/* Cells of a cubic, body-centred or face-centred lattice (in the plane: of a square or centred
 * one), grains shifted and of sizes up to `spread` apart, large enough to press on each other. */
static void draw(struct packing *p, struct calx_random *random)
{
    static const double sites[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    static const double radius[5] = {0, 0.55, 0.385, 0,
                                     0.36}; /* over the cell, by sites: beyond jamming */
    memset(p, 0, sizeof *p);
    p->dimension = calx_random_uniform(random) < 0.3 ? 2 : 3;
    size_t per_cell = p->dimension == 2 ? 1 + (size_t)(2.0 * calx_random_uniform(random))
                      : calx_random_uniform(random) < 0.5 ? 1
                                                          : 4;
    size_t cells = per_cell == 4 ? 2 : p->dimension == 2 ? 4 : 3;
    double spread = 0.3 * calx_random_uniform(random);
    p->walls = calx_random_uniform(random) < 0.3;
    for (size_t c = 0; c < cells * cells * (p->dimension == 3 ? cells : 1); c++)
        for (size_t q = 0; q < per_cell; q++) {
            size_t at[3] = {c % cells, c / cells % cells, c / cells / cells}, i = p->n++;
            p->radius[i] =
                SPACING * radius[per_cell] * (1.0 + spread * (calx_random_uniform(random) - 0.4));
            p->fixed[i] = calx_random_uniform(random) < 0.05;
            for (size_t k = 0; k < p->dimension; k++)
                p->x[i][k] = SPACING * ((double)at[k] + sites[q][k] + 0.25 +
                                        0.05 * (calx_random_uniform(random) - 0.5));
        }
    for (int k = 0; k < 3; k++)
        p->size[k] = SPACING * (double)cells;
    p->low = INFINITY, p->high = -INFINITY;
    for (size_t i = 0; i < p->n; i++) { /* both walls press on the grains that reach farthest */
        p->low = fmin(p->low, p->x[i][1] - 0.9 * p->radius[i]);
        p->high = fmax(p->high, p->x[i][1] + 0.9 * p->radius[i]);
    }
    static const double tangential[] = {2.0 / 7.0, 0.8, 1.5}, restitution[] = {NAN, 0.5, 0.1};
    p->friction = calx_random_uniform(random) < 0.3 ? -1.0 : 1e3;
    p->tangential = tangential[(size_t)(3.0 * calx_random_uniform(random))];
    p->restitution = restitution[(size_t)(3.0 * calx_random_uniform(random))];
}

/* Frictionless and heavily damped to relax, or as the network says. */
static struct calx_scene *scene_of(const struct packing *p, bool relax, double dt)
{
    struct calx_scene *s = scene_create(p->dimension, CALX_SPHERES, p->n);
    double e = relax ? 0.0 : p->restitution;
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){
                    {"stiffness", STIFFNESS}, {isnan(e) ? NULL : "restitution", e}, {NULL, 0.0}});
    if (!relax && p->friction > 0.0)
        scene_model(s, CALX_CONTACT, "coulomb",
                    (struct given[]){{"stiffness", p->tangential * STIFFNESS},
                                     {"friction", p->friction},
                                     {NULL, 0.0}});
    scene_model(s, CALX_MOTION, "velocity-verlet", NULL);
    s->models[0].dt = dt;
    s->models[0].forced = true;
    for (size_t i = 0; i < p->n; i++) {
        scene_put(s, i, p->x[i][0], p->x[i][1], p->x[i][2], p->radius[i]);
        if (p->fixed[i])
            scene_fix(s, i);
    }
    for (size_t k = 0; k < p->dimension; k++)
        if (!p->walls || k != 1)
            scene_extent(s, (int)k, 0.0, p->size[k], 'p');
    int box = p->walls ? scene_wall(s, "box", 0) : -1;
    if (p->walls) {
        scene_plane(s, box, (double[3]){0, p->low, 0}, (double[3]){0, 1, 0});
        scene_plane(s, box, (double[3]){0, p->high, 0}, (double[3]){0, -1, 0});
    }
    return s;
}

static struct run start(struct calx_scene *scene)
{
    struct calx_error e = {0};
    struct run r = {.scene = scene};
    r.sim = calx_sim_create(scene, registry, 1, &e);
    ck_assert_msg(r.sim != NULL, "%s", e.text);
    return r;
}

static void stop(struct run *r)
{
    calx_sim_free(r->sim);
    calx_scene_free(r->scene);
}

static void relax(struct packing *p)
{
    double mass = 4.0 / 3.0 * M_PI * pow(0.3 * SPACING, 3.0) * 1000.0;
    struct run r = start(scene_of(p, true, 0.1 * sqrt(mass / STIFFNESS)));
    run_steps(&r, RELAX);
    for (size_t i = 0; i < p->n; i++)
        memcpy(p->x[i], run_x(&r, (int64_t)i), sizeof p->x[i]);
    stop(&r);
}

/* ---- the limit, by running ---- */

/* Kinetic energy of the difference of two runs. */
static double apart(const struct run r[2], size_t n)
{
    double v[2][MOST][6] = {{{0}}}, mass[MOST] = {0}, radius[MOST] = {0}, sum = 0.0;
    for (int side = 0; side < 2; side++) {
        const struct calx_sim *s = r[side].sim;
        for (int32_t row = s->blocks[0].first; row < s->blocks[0].first + s->blocks[0].own; row++) {
            const double *from = calx_row_v(s, row);
            int64_t i = s->r.id[row];
            mass[i] = from[3] > 0.0 ? 1.0 / from[3] : 0.0;
            radius[i] = calx_row_x(s, row)[3];
            for (int k = 0; k < 3; k++) {
                v[side][i][k] = from[k];
                v[side][i][3 + k] = s->r.stride == 8 ? from[4 + k] : 0.0;
            }
        }
    }
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 6; k++) {
            double d = v[1][i][k] - v[0][i][k];
            sum += 0.5 * mass[i] * d * d * (k < 3 ? 1.0 : 0.4 * radius[i] * radius[i]);
        }
    return sum;
}

static void stir(const struct run *r, uint32_t dimension, double speed)
{
    struct calx_sim *s = r->sim;
    struct calx_random random;
    calx_random_seed(&random, 3);
    for (int32_t row = s->blocks[0].first; row < s->blocks[0].first + s->blocks[0].own; row++) {
        double *v = calx_row_v(s, row);
        for (uint32_t k = 0; k < dimension && v[3] > 0.0; k++)
            v[k] = speed * (calx_random_uniform(&random) - 0.5);
    }
}

/* Two runs, one stirred by a millionth of the overlaps per step: in a stable network they stay as
 * near to each other, above the limit they part, until contacts open, at 1e12 times the energy of
 * the stir. Growth per step is 1 + sqrt(8 x) for a step a share x above the limit if undamped, so
 * that 300 steps show x = 1e-3; of the order of 1 + x if damped: x = 0.02. */
static bool explodes(const struct packing *p, double dt)
{
    const double grown = 1e4;
    struct run r[2] = {start(scene_of(p, false, dt)), start(scene_of(p, false, dt))};
    struct calx_error e = {0};
    stir(&r[1], p->dimension, 1e-6 * 0.02 * SPACING / dt);
    double first = apart(r, p->n), most = 0.0;
    int code = 0;
    for (int k = 0; k < STEPS && !code && most < grown * first; k++) {
        code = calx_sim_step(r[0].sim, &e) || calx_sim_step(r[1].sim, &e);
        most = fmax(most, apart(r, p->n));
    }
    stop(&r[0]);
    stop(&r[1]);
    return code || most >= grown * first;
}

struct outcome {
    double ratio, sharp, plain; /* the true limit over each estimate */
};

/* The least estimates while the network settles: contacts that barely touch come and go. */
static struct calx_stability estimate(const struct packing *p)
{
    struct run r = start(scene_of(p, false, 1e-7));
    struct calx_stability least, now;
    struct calx_error e = {0};
    ck_assert_int_eq(calx_stability_look(r.sim, CALX_SHARP, &least, &e), 0);
    ck_assert(isfinite(least.limit) && least.limit > 0.0 && least.id >= 0);
    stop(&r);
    r = start(scene_of(p, false, 0.5 * least.limit));
    for (int k = 0; k < 2 * STEPS; k += 30) {
        run_steps(&r, 30);
        ck_assert_int_eq(calx_stability_look(r.sim, CALX_SHARP, &now, &e), 0);
        least.limit = fmin(least.limit, now.limit);
        least.sharp = fmin(least.sharp, now.sharp);
        least.plain = fmin(least.plain, now.plain);
    }
    stop(&r);
    return least;
}

static struct outcome try(const struct packing *p)
{
    struct calx_stability look = estimate(p);
    double low = look.limit, high = MOST_RATIO * low;
    ck_assert_msg(!explodes(p, low), "unstable at the estimate %g s (by iteration: %g s)", low,
                  look.sharp);
    ck_assert_msg(explodes(p, high), "stable at %g times the estimate %g s (by iteration: %g s)",
                  MOST_RATIO, low, look.sharp);
    for (int k = 0; k < HALVINGS; k++) {
        double middle = 0.5 * (low + high);
        *(explodes(p, middle) ? &high : &low) = middle;
    }
    double truth = 0.5 * (low + high);
    return (struct outcome){truth / look.limit, truth / look.sharp, truth / look.plain};
}

START_TEST(the_estimate_is_safe_and_not_wasteful)
{
    struct calx_random random;
    struct outcome least = {INFINITY, INFINITY, INFINITY}, most = {0};
    double mean = 0.0;
    calx_random_seed(&random, 1);
    for (int k = 0; k < NETWORKS; k++) {
        struct packing p;
        draw(&p, &random);
        relax(&p);
        struct outcome o = try(&p);
        mean += o.ratio / NETWORKS;
        least.ratio = fmin(least.ratio, o.ratio), most.ratio = fmax(most.ratio, o.ratio);
        least.sharp = fmin(least.sharp, o.sharp), most.sharp = fmax(most.sharp, o.sharp);
        least.plain = fmin(least.plain, o.plain), most.plain = fmax(most.plain, o.plain);
        if (getenv("CALX_TEST_PRINT"))
            printf("%3d: %uD, %2zu grains%s, mu %g, kt/kn %.2f, e %4g: true limit over bound %.3f, "
                   "iteration %.3f, sums %.3f\n",
                   k, p.dimension, p.n, p.walls ? " between walls" : "", p.friction, p.tangential,
                   p.restitution, o.ratio, o.sharp, o.plain);
    }
    printf("true limit over estimate: bound %.3f to %.3f, mean %.3f; iteration %.3f to %.3f; plain "
           "sums %.3f to %.3f\n",
           least.ratio, most.ratio, mean, least.sharp, most.sharp, least.plain, most.plain);
}
END_TEST

/* Single contacts, exactly: omega^2 = k (1/m1 + 1/m2), and for friction kt (1/m + R^2/I) = 7/2 kt/m
 * per body, with levers to the middle of the overlap; a damped one is stable up to sqrt(1 + b^2) -
 * b of that. */
START_TEST(single_contacts)
{
    static const struct {
        double ratio, tangential, restitution; /* radius of the second over the first, 0: a plane */
    } rows[] = {{1, 0, NAN},   {0.01, 0, NAN}, {100, 0, NAN}, {0, 0, NAN},
                {0.5, 2, NAN}, {0, 2, NAN},    {1, 0, 0.1},   {0, 0, 0.5}};
    const double depth = 1e-9, radius = 0.01, mass = 4.0 / 3.0 * M_PI * 1e-6 * 1000.0;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double ratio = rows[k].ratio,
               inverse = 1.0 / mass + (ratio > 0.0 ? 1.0 / (mass * ratio * ratio * ratio) : 0.0);
        struct calx_scene *s = scene_create(3, CALX_SPHERES, ratio > 0.0 ? 2 : 1);
        scene_model(s, CALX_CONTACT, "linear",
                    (struct given[]){
                        {"stiffness", STIFFNESS},
                        {isnan(rows[k].restitution) ? NULL : "restitution", rows[k].restitution},
                        {NULL, 0.0}});
        if (rows[k].tangential > 0.0)
            scene_model(s, CALX_CONTACT, "coulomb",
                        (struct given[]){{"stiffness", rows[k].tangential * STIFFNESS},
                                         {"friction", 0.5},
                                         {NULL, 0.0}});
        scene_model(s, CALX_MOTION, "velocity-verlet", NULL);
        s->models[0].dt = 1e-9;
        scene_put(s, 0, 0.0, radius * (1.0 - depth), 0.0, radius);
        if (ratio > 0.0)
            scene_put(s, 1, 0.0, -ratio * radius, 0.0, ratio * radius);
        else
            scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
        struct run r = start(s);
        struct calx_stability look;
        struct calx_error e = {0};
        ck_assert_int_eq(calx_stability_look(r.sim, CALX_SHARP, &look, &e), 0);
        double stiffest = fmax(1.0, 3.5 * rows[k].tangential),
               l = isnan(rows[k].restitution) ? 0.0 : log(rows[k].restitution);
        double b = -l / sqrt(M_PI * M_PI + l * l),
               limit = 2.0 / sqrt(stiffest * STIFFNESS * inverse) * (sqrt(1.0 + b * b) - b);
        /* a friction block has two equal eigenvalues: their bound by the trace is 2^(1/64) too
         * high, half as much in the step */
        double slack = rows[k].tangential > 0.0 ? 0.0055 : 1e-6;
        ck_assert_msg(look.limit < limit * (1.0 + 1e-6) && look.limit > limit * (1.0 - slack),
                      "row %zu: %.9g, expected %.9g", k, look.limit, limit);
        ck_assert_double_eq_tol(look.sharp / limit, 1.0, 1e-6);
        ck_assert_double_eq_tol(look.shortest / (M_PI / sqrt(STIFFNESS * inverse)), 1.0, 1e-9);
        ck_assert_int_eq(look.contacts, 1);
        ck_assert_int_eq((int)(look.pair[0] + look.pair[1]), ratio > 0.0 ? 1 : -1);
        stop(&r);
    }
}
END_TEST

/* One heavy grain, thirty-two light ones around it that do not touch each other: a plain sum over
 * its contacts would be 32 times too high at mass ratio 1, but its mass hides them: the fastest
 * mode is that of a light grain, k/m, to the share of the masses. */
START_TEST(a_heavy_grain_among_light_ones)
{
    enum { LIGHT = 32 };
    const double big = 0.1, small = 0.01, k = STIFFNESS, mass = 4.0 / 3.0 * M_PI * 1e-6 * 1000.0;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, LIGHT + 1);
    scene_linear(s, k, NAN, -1.0, 1e-9);
    scene_put(s, 0, 0, 0, 0, big);
    for (size_t i = 0; i < LIGHT; i++) { /* Fibonacci's sphere */
        double z = 1.0 - (2.0 * (double)i + 1.0) / LIGHT,
               turn = M_PI * (3.0 - sqrt(5.0)) * (double)i, rho = sqrt(1.0 - z * z);
        double d = (big + small) * (1.0 - 1e-6);
        scene_put(s, i + 1, d * rho * cos(turn), d * rho * sin(turn), d * z, small);
    }
    struct run r = start(s);
    struct calx_stability look;
    struct calx_error e = {0};
    ck_assert_int_eq(calx_stability_look(r.sim, CALX_SHARP, &look, &e), 0);
    double limit = 2.0 / sqrt(k / mass),
           share = 0.5 * LIGHT *
                   1e-3; /* all light grains together against the heavy one, halved by the root */
    ck_assert_msg(look.limit > limit * (1.0 - 2.0 * share) && look.limit <= limit,
                  "%g, expected %g", look.limit, limit);
    stop(&r);
}
END_TEST

/* Glass on glass, 20 m/s: 40.3395 us (Chung and Ooi, Granul. Matter 13 (2011) 643, test 1, by
 * Hertz's closed form, to the digits of the constant 2.868266). Rayleigh by hand: G = 2e10 Pa, pi
 * 0.01 sqrt(2800/2e10)/(0.1631 0.2 + 0.8766) s. */
START_TEST(collision_times)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    s->materials[0].density = 2800.0;
    scene_put(s, 0, 0, 0, 0, 0.01);
    ck_assert(isinf(calx_collision_times_find(s, 20.0).hertz));
    scene_material_value(s, 0, "young", 4.8e10);
    scene_material_value(s, 0, "poisson", 0.2);
    struct calx_collision_times t = calx_collision_times_find(s, 20.0);
    ck_assert_double_eq_tol(t.hertz / 40.3395e-6, 1.0, 2e-6);
    ck_assert_double_eq_tol(t.rayleigh / 1.292841e-5, 1.0, 1e-5);
    ck_assert(isinf(calx_collision_times_find(s, 0.0).hertz));
    calx_scene_free(s);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stability");
    TCase *test = tcase_create("stability");
    tcase_add_checked_fixture(test, open_registry, close_registry);
    tcase_add_test(test, single_contacts);
    tcase_add_test(test, collision_times);
    tcase_add_test(test, a_heavy_grain_among_light_ones);
    tcase_add_test(test, the_estimate_is_safe_and_not_wasteful);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

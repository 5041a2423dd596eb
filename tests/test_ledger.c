/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The ledger closes. Mechanical: within (pi/n)^2/2 of the energy in contact at n steps per contact,
 * falling as n^-2. Heat: to rounding. What is dissipated is what the closed forms say, and becomes
 * heat where the scene says so.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

/* ---- the mechanical residual ---- */

static const double STIFFNESS = 1e4, RADIUS = 0.1, SPEED = 1.0;

/* What happens in one run. The grain has unit mass and hits at SPEED along y. */
struct story {
    const char *name;
    double restitution, friction, oblique; /* NaN: undamped; < 0: none; tangential speed, m/s */
    bool hertz, twins, wall_moves, shakes, falls, turns, round;
    double energy; /* J, that goes through the contact: the approach, and the motion along the wall
                      if there is friction */
};

static const struct story stories[] = {
    {.name = "linear elastic", .restitution = NAN, .friction = -1, .energy = 0.5},
    {.name = "linear damped", .restitution = 0.5, .friction = -1, .energy = 0.5},
    {.name = "hertz damped", .restitution = 0.5, .friction = -1, .hertz = true, .energy = 0.5},
    {.name = "sliding", .restitution = NAN, .friction = 0.1, .oblique = 1, .energy = 1},
    {.name = "sliding and sticking, damped",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .energy = 1},
    {.name = "mindlin",
     .restitution = 0.5,
     .friction = 0.3,
     .oblique = 1,
     .hertz = true,
     .energy = 1},
    {.name = "twins",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .twins = true,
     .energy = 2},
    {.name = "wall that comes",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .wall_moves = true,
     .energy = 1},
    {.name = "wall that shakes",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .shakes = true,
     .energy = 1},
    {.name = "wall that turns",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .turns = true,
     .energy = 1},
    {.name = "round wall",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .round = true,
     .energy = 1},
    {.name = "round wall that turns",
     .restitution = 0.5,
     .friction = 0.5,
     .oblique = 1,
     .round = true,
     .turns = true,
     .energy = 1},
    {.name = "falling",
     .restitution = 0.8,
     .friction = 0.3,
     .oblique = 1,
     .falls = true,
     .energy = 1},
};

/* E* such that the deepest overlap is that of the linear spring. */
static double modulus_of(double depth, double reduced, double radius)
{
    return 15.0 / 16.0 * reduced * SPEED * SPEED / (sqrt(radius) * pow(depth, 2.5));
}

static void add_laws(struct calx_scene *s, const struct story *story, double reduced,
                     double duration, double n)
{
    double depth = SPEED / sqrt(STIFFNESS / reduced),
           e = modulus_of(depth, reduced, story->twins ? 0.5 * RADIUS : RADIUS);
    bool damped = !isnan(story->restitution);
    if (!story->hertz) {
        scene_linear(s, STIFFNESS, story->restitution, story->friction, duration / n);
        return;
    }
    scene_material_value(s, 0, "young", e);
    scene_material_value(s, 0, "poisson", 0.0);
    scene_material_value(s, 1, "young", 1e20);
    scene_material_value(s, 1, "poisson", 0.0);
    scene_model1(s, CALX_CONTACT, "hertz", damped ? "restitution" : NULL, story->restitution);
    if (story->friction >= 0)
        scene_model1(s, CALX_CONTACT, "mindlin", "friction", story->friction);
    scene_model(s, CALX_MOTION, "velocity-verlet", NULL);
    s->models[0].dt = duration / n;
}

/* The contact begins `phase` of a step after an evaluation. */
static struct calx_scene *tell(const struct story *story, double n, double phase)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, story->twins ? 2 : 1);
    double reduced = story->twins ? 0.5 : 1.0, depth = SPEED * sqrt(reduced / STIFFNESS);
    double duration = story->hertz ? 2.943275 * depth / SPEED : M_PI * sqrt(reduced / STIFFNESS),
           dt = duration / n;
    double closing = story->twins ? 2 * SPEED : SPEED, gap = closing * dt * (1.0 + phase);
    s->materials[0].density = 1.0 / (4.0 / 3.0 * M_PI * pow(RADIUS, 3.0));
    scene_material(s, "wall", 1.0, 1.0);
    add_laws(s, story, reduced, duration, n);
    scene_put(s, 0, 0.0, RADIUS + gap, 0.0, RADIUS);
    scene_move(s, 0, story->oblique, story->wall_moves ? 0.0 : -SPEED, 0.3 * story->oblique);
    if (story->twins) {
        scene_put(s, 1, 0.0, -RADIUS, 0.0, RADIUS);
        scene_move(s, 1, -story->oblique, SPEED, 0.0);
    } else if (story->round) {
        scene_primitive(s, scene_wall(s, "drum", 1),
                        (struct calx_primitive){.shape = CALX_CYLINDER,
                                                .inside = true,
                                                .a = {0.0, 0.4, 0.0},
                                                .n = {0.0, 0.0, 1.0},
                                                .radius = 0.4});
    } else {
        scene_plane(s, scene_wall(s, "plane", 1), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    }
    if (story->turns) {
        struct calx_motion *m = scene_motion(s, 0, 0);
        m->rate.value = 3.0;
        m->about[1] = 0.4;
    }
    if (story->wall_moves)
        scene_motion(s, 0, 0)->velocity[1].value = SPEED;
    if (story->shakes) {
        struct calx_motion *m = scene_motion(s, 0, 0);
        m->amplitude[0] = m->amplitude[1] = 0.2 * depth;
        m->frequency = 1.0 / duration;
    }
    if (story->falls)
        scene_gravity(s, 1.0, -40.0, 0.0);
    return s;
}

/* The largest residual, J, during n + a few steps: before, in and after the contact. */
static double largest_residual(const struct story *story, double n, double phase)
{
    struct run r = run_start(tell(story, n, phase), 1);
    double worst = 0.0;
    for (size_t k = 0; k < (size_t)(1.6 * n) + 4; k++) {
        run_steps(&r, 1);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        worst = fmax(worst, fabs(l.residual));
    }
    run_free(&r);
    return worst;
}

enum { PHASES = 5, FRACTIONS = 5 };

/* The largest residual over phases of onset and fractions of a step; *rms: root of the mean square.
 */
static double residual_at(const struct story *story, double n, double *rms)
{
    double worst = 0.0, sum = 0.0;
    for (size_t p = 0; p < PHASES; p++)
        for (size_t f = 0; f < FRACTIONS; f++) {
            double x = largest_residual(story, n + ((double)f + 0.5) / FRACTIONS,
                                        ((double)p + 0.5) / PHASES);
            worst = fmax(worst, x);
            sum += x * x / (PHASES * FRACTIONS);
        }
    *rms = sqrt(sum);
    return worst;
}

static const double STEPS[] = {20, 50, 100};
/* Least squares over 25 samples at each of three n: the rms of the oscillating part scatters by a
 * few per cent, 0.1 in the order. Where the normal turns with a wall (it turns or is round) a term
 * of first order remains, smaller by the ratio of overlap and radius. */
static const double LEAST_ORDER = 1.9, MOST_ORDER = 2.1, LEAST_ORDER_TURNING = 1.7;

START_TEST(mechanical_energy_closes)
{
    for (size_t k = 0; k < sizeof stories / sizeof *stories; k++) {
        double rms[3],
            least = stories[k].turns || stories[k].round ? LEAST_ORDER_TURNING : LEAST_ORDER;
        for (size_t q = 0; q < 3; q++) {
            double worst = residual_at(&stories[k], STEPS[q], &rms[q]);
            double bound = 0.5 * pow(M_PI / STEPS[q], 2) * stories[k].energy;
            ck_assert_msg(worst < bound, "%s, %g steps: %.3g J of %.3g J allowed", stories[k].name,
                          STEPS[q], worst, bound);
        }
        double order = -slope(3, STEPS, rms);
        ck_assert_msg(order > least && order < MOST_ORDER, "%s: falls with order %.3f",
                      stories[k].name, order);
    }
}
END_TEST

/* ---- walls work ---- */

/* A wall of constant speed that hits a grain at rest gives it twice its speed; its work is force
 * times path, exactly its speed times the momentum. Of the kicks of velocity Verlet the sum is
 * exact: rounding of n steps. */
START_TEST(work_of_a_wall_is_force_times_path)
{
    const struct story story = {.restitution = NAN, .friction = -1, .wall_moves = true};
    struct run r = run_start(tell(&story, 200.3, 0.4), 1);
    const double rounding = 300 * 2.3e-16 * 2.0;
    for (size_t k = 0; k < 300; k++) {
        run_steps(&r, 1);
        double momentum = run_v(&r, 0)[1] * 1.0, work = calx_sim_ledger(r.sim).wall_work;
        if (fabs(work - SPEED * momentum) > rounding)
            ck_abort_msg("step %zu: work %.17g, speed times momentum %.17g", k, work,
                         SPEED * momentum);
    }
    ck_assert_double_eq_tol(run_v(&r, 0)[1], 2.0 * SPEED, 0.25 * pow(M_PI / 200.3, 2));
    run_free(&r);
}
END_TEST

/* A held grain that rubs on a turning drum: power of the drum = friction times its speed = what is
 * dissipated. The spring takes mu N/(k_t v) to load. */
START_TEST(power_of_a_drum_is_dissipated)
{
    const double drum = 0.5, rate = 4.0, mu = 0.3, depth = 1e-3, dt = 1e-4, steps = 2000;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_linear(s, STIFFNESS, NAN, mu, dt);
    scene_put(s, 0, 0.0, -(drum - RADIUS + depth), 0.0, RADIUS);
    scene_fix(s, 0);
    int w = scene_wall(s, "drum", 0);
    scene_primitive(s, w,
                    (struct calx_primitive){
                        .shape = CALX_CYLINDER, .inside = true, .n = {0, 0, 1}, .radius = drum});
    scene_motion(s, 0, w)->rate.value = rate;
    struct run r = run_start(s, 1);
    run_steps(&r, (size_t)steps);
    double fn = STIFFNESS * depth, v = rate * drum, load = mu * fn / (2.0 / 7.0 * STIFFNESS * v);
    double expected = mu * fn * v * (dt * steps - load);
    struct calx_ledger l = calx_sim_ledger(r.sim);
    /* half a step at either end, and 1e-12 of rounding */
    ck_assert_double_eq_tol(l.dissipated, expected, mu * fn * v * dt);
    ck_assert_double_eq_tol(l.wall_work, l.dissipated + l.elastic - 0.5 * STIFFNESS * depth * depth,
                            1e-12 * expected * steps);
    ck_assert_double_eq_tol(r.sim->wall_force[0][0], -mu * fn, 1e-12 * fn);
    run_free(&r);
}
END_TEST

/* ---- dissipation and heat ---- */

/* Head-on at +-v: m v^2 (1 - e^2) in all, v^2 (1 - e^2)/(2 c) in the temperature of each body. The
 * e of velocity Verlet is off by 1.5e-2 at 20 steps, order 1 (verified for the design), 7.5e-5 at
 * 4000, twice that at the worst phase; that changes 1 - e^2 by 2 e de. */
START_TEST(an_impact_heats_both_bodies)
{
    const double e = 0.5, v = 1.0, c = 385.0, n = 4000,
                 tolerance = 2.0 * 0.5 * 2.0 * 1.5e-2 * 20 / 4000 / 0.75;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    double mass = calx_particle_mass(s, RADIUS, 1000.0);
    s->materials[0].specific_heat = c;
    s->from_dissipation = 1.0;
    scene_linear(s, 1e6, e, -1.0, M_PI * sqrt(0.5 * mass / 1e6) / n);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 0.0);
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    for (size_t i = 0; i < 2; i++) {
        scene_put(s, i, i ? 2.0 * RADIUS : 0.0, 0.0, 0.0, RADIUS);
        scene_move(s, i, i ? -v : v, 0.0, 0.0);
        scene_warm(s, i, 300.0);
    }
    struct run r = run_start(s, 1);
    run_steps(&r, (size_t)(1.5 * n));
    struct calx_ledger l = calx_sim_ledger(r.sim);
    ck_assert_double_eq_tol(l.dissipated / (mass * v * v * (1 - e * e)), 1.0, tolerance);
    ck_assert_double_eq(l.heat_of_dissipation, l.dissipated);
    for (int64_t i = 0; i < 2; i++) /* the temperature rounds at 300 K: 6e-14 K a step */
        ck_assert_double_eq_tol(run_v(&r, i)[7] - 300.0, l.dissipated / (2.0 * mass * c),
                                6000 * 5.7e-14);
    ck_assert_double_eq_tol((run_v(&r, 0)[7] - 300.0) / 9.7403e-4, 1.0, tolerance);
    run_free(&r);
}
END_TEST

/* From sliding to rolling: m u0^2/7 of heat for a sphere, m u0^2/6 for a disc. The lever is R - d/2
 * and the spring keeps (mu N)^2/(2 k_t) or loses it: both relative to the heat are of the order of
 * the overlap mg/k over R, and u0^2/R g. */
START_TEST(sliding_to_rolling_heats)
{
    const double stiffness = 1e8, g = 9.81, mu = 0.5, dt = 1e-5;
    for (uint32_t bodies = CALX_SPHERES; bodies <= CALX_DISCS; bodies++) {
        struct calx_scene *s = scene_create(bodies == CALX_DISCS ? 2 : 3, bodies, 1);
        double mass = calx_particle_mass(s, RADIUS, 1000.0), depth = mass * g / stiffness;
        double share = bodies == CALX_DISCS ? 6.0 : 7.0,
               kept = 0.5 * pow(mu * mass * g, 2) / (2.0 / 7.0 * stiffness);
        s->from_dissipation = 1.0;
        scene_linear(s, stiffness, NAN, mu, dt);
        scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 0.0);
        scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
        scene_put(s, 0, 0.0, RADIUS - depth, 0.0, RADIUS);
        scene_move(s, 0, 1.0, 0.0, 0.0);
        scene_gravity(s, 0.0, -g, 0.0);
        scene_plane(s, scene_wall(s, "plane", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
        struct run r = run_start(s, 1);
        run_steps(&r, 10000);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        /* the heat is that of the slide; what the spring holds at its end swings on, at most twice
         * `kept` */
        ck_assert_double_eq_tol(l.dissipated * share / mass, 1.0,
                                (2.0 * kept + mass * depth / RADIUS) * share / mass);
        ck_assert_double_eq_tol(l.heat_residual / l.heat, 0.0, 1e-12);
        run_free(&r);
    }
}
END_TEST

/* Friction between two materials, an insulated and a hot wall, a heat step of 4 steps: what bodies
 * hold is what walls and dissipation gave. */
START_TEST(heat_closes)
{
    const char *integrators[] = {"heat-euler", "heat-theta"};
    for (size_t k = 0; k < 4; k++) {
        enum { GRAINS = 60 };
        struct calx_scene *s = scene_create(2, CALX_SPHERES, GRAINS);
        scene_material(s, "wall", 2000.0, 500.0);
        scene_material_value(s, 0, "conductivity", 20.0);
        scene_material_value(s, 1, "conductivity", 300.0);
        s->from_dissipation = 0.7;
        s->split_effusivity = k & 2;
        scene_linear(s, 1e5, 0.5, 0.4, 2e-5);
        scene_model(s, CALX_CONDUCTANCE, "overlap", NULL);
        scene_model(s, CALX_TEMPERATURE, integrators[k & 1], NULL);
        s->models[0].heat_dt = 8e-5;
        for (size_t i = 0; i < GRAINS; i++) {
            scene_put(s, i, 0.02 + 0.021 * (double)(i % 10), 0.02 + 0.021 * (double)(i / 10), 0.0,
                      0.01);
            scene_move(s, i, (double)(i % 3) - 1.0, -2.0, 0.0);
            scene_warm(s, i, 300.0 + 10.0 * (double)(i % 7));
        }
        scene_gravity(s, 0.0, -9.81, 0.0);
        int hot = scene_wall(s, "hot", 1), cold = scene_wall(s, "insulated", 1);
        scene_segment(s, hot, 0.0, 0.0, 0.25, 0.0, 0);
        scene_segment(s, cold, 0.0, 0.0, 0.0, 0.3, 0);
        scene_segment(s, cold, 0.25, 0.0, 0.25, 0.3, 0);
        scene_wall_temperature(s, hot, 900.0);
        scene_motion(s, 0, cold)->velocity[1].value = 1.0;
        struct run r = run_start(s, 1);
        run_steps(&r, 4000);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_gt(l.wall_heat, 0.0);
        ck_assert_double_gt(l.heat_of_dissipation, 0.0);
        ck_assert_msg(fabs(l.heat_residual) < 1e-12 * l.heat, "%s: %.3g of %g J",
                      integrators[k & 1], l.heat_residual, l.heat);
        ck_assert_double_eq_tol(l.heat_of_dissipation, 0.7 * l.dissipated, 1e-12 * l.dissipated);
        run_free(&r);
    }
}
END_TEST

int main(void)
{
    const TTest *tests[] = {mechanical_energy_closes,      work_of_a_wall_is_force_times_path,
                            power_of_a_drum_is_dissipated, an_impact_heats_both_bodies,
                            sliding_to_rolling_heats,      heat_closes};
    return run_tests("ledger", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Equal bits: with 1, 2, 3 and 4 threads; for a straight run and one that is saved, freed and
 * restored at random steps; with and without looking at each step; from the copies of the kernels
 * for each instruction set. The scene has what can break it: several blocks, two materials,
 * friction, heat, a moving and a hot wall, a moving and hot group of grains, a periodic axis,
 * rebuilds.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

extern const struct calx_engine calx_engine_base;
/* Only in a build for several instruction sets. */
extern const struct calx_engine calx_engine_avx2 __attribute__((weak));
extern const struct calx_engine calx_engine_avx512 __attribute__((weak));

enum { EDGE = 21, GRAINS = EDGE * EDGE * EDGE, STEPS = 200, LEAST_BLOCKS = 5, LEAST_REBUILDS = 5 };
static const double RADIUS = 1e-3, SPACING = 2.05e-3;

static void add_grains(struct calx_scene *s)
{
    struct calx_random random;
    calx_random_seed(&random, 5);
    for (size_t i = 0; i < GRAINS; i++) {
        size_t at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        double x[3], v[3], w[3];
        for (int k = 0; k < 3; k++) {
            x[k] = SPACING * ((double)at[k] + 0.5) + 2e-5 * (calx_random_uniform(&random) - 0.5);
            v[k] = 2.0 * calx_random_uniform(&random) - 1.0;
            w[k] = 200.0 * (calx_random_uniform(&random) - 0.5);
        }
        scene_put(s, i, x[0], x[1], x[2], RADIUS * (1.0 - 0.1 * calx_random_uniform(&random)));
        scene_move(s, i, v[0], v[1], v[2]);
        scene_spin(s, i, w[0], w[1], w[2]);
        scene_warm(s, i, 300.0 + 100.0 * calx_random_uniform(&random));
        s->particles.material[i] = (int32_t)(i % 2);
    }
}

/* Periodic along x, a moving hot floor and a fixed lid along y, walls along z. */
static void add_box(struct calx_scene *s)
{
    double size = SPACING * EDGE;
    const double origin[3] = {0}, end[3] = {size, size, size};
    scene_extent(s, 0, 0.0, size, 'p');
    int box = scene_wall(s, "box", 1), floor_ = scene_wall(s, "floor", 0);
    scene_plane(s, floor_, origin, (double[3]){0, 1, 0});
    scene_plane(s, box, end, (double[3]){0, -1, 0});
    scene_plane(s, box, origin, (double[3]){0, 0, 1});
    scene_plane(s, box, end, (double[3]){0, 0, -1});
    scene_wall_temperature(s, floor_, 500.0);
    struct calx_motion *m = scene_motion(s, 0, floor_);
    m->amplitude[1] = 1e-4;
    m->frequency = 500.0;
    m->velocity[0].value = 0.2;
}

/* A layer of grains across y is a hot rigid group that slides along the periodic axis and sways. */
static void add_group(struct calx_scene *s)
{
    int group = scene_group(s, "layer");
    for (size_t i = 0; i < GRAINS; i++)
        if (i / EDGE % EDGE == EDGE / 2)
            scene_carry(s, i, group);
    scene_wall_temperature(s, group, 450.0);
    struct calx_motion *m = scene_motion(s, 0, group);
    m->velocity[0].value = 1.2;
    m->amplitude[1] = 5e-5;
    m->frequency = 700.0;
}

/* Of the crowd; two of the tests change it. */
static const char *motion = "velocity-verlet";
static bool rigid;

static void set_motion(struct calx_scene *s)
{
    for (size_t k = 0; k < s->models[0].count; k++)
        if (s->models[0].list[k].kind == CALX_MOTION)
            snprintf(s->models[0].list[k].plugin, sizeof s->models[0].list[k].plugin, "%s", motion);
}

/* Non-smooth laws and what conducts under them; the solver is left coarse, which must not matter. */
static void set_rigid(struct calx_scene *s)
{
    for (int m = 0; m < 2; m++) {
        scene_material_value(s, m, "young", 1e9);
        scene_material_value(s, m, "poisson", 0.3);
        scene_material_value(s, m, "adhesion", 1e-7);
        scene_material_value(s, m, "adhesion-change", 5e-8);
        scene_material_value(s, m, "transition-temperature", 350.0);
    }
    scene_model(s, CALX_CONTACT, "signorini-coulomb", (struct given[]){{"friction", 0.4}, {"restitution", 0.3}, {NULL, 0.0}});
    scene_model1(s, CALX_CONTACT, "cohesion-thermal", "distance", 2e-5);
    scene_model(s, CALX_MOTION, "nscd", (struct given[]){{"tolerance", 1e-2}, {"accuracy", 1e9}, {"order", 2.0}, {NULL, 0.0}});
    s->models[0].dt = 5e-6;
    scene_model(s, CALX_CONDUCTANCE, "hertz", NULL);
}

static struct calx_scene *crowd(const char *heat)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, GRAINS);
    scene_material(s, "other", 2000.0, 500.0);
    scene_material_value(s, 0, "conductivity", 50.0);
    scene_material_value(s, 1, "conductivity", 5.0);
    if (rigid) {
        set_rigid(s);
    } else {
        scene_linear(s, 2e3, 0.7, 0.4, 5e-6);
        set_motion(s);
        scene_model(s, CALX_CONDUCTANCE, "overlap", NULL);
    }
    scene_model(s, CALX_TEMPERATURE, heat, NULL);
    s->models[0].heat_dt = 2e-5;
    s->from_dissipation = 1.0;
    s->skin = 5e-5;
    scene_gravity(s, 0.0, -9.81, 0.0);
    add_grains(s);
    add_box(s);
    add_group(s);
    return s;
}

/* All that a run says at its end: the hash, and sums that are not part of the state's hash. */
struct said {
    uint64_t hash;
    struct calx_ledger ledger;
};

static struct said say(const struct run *r)
{
    struct said s;
    memset(&s, 0, sizeof s);
    s.hash = calx_sim_hash(r->sim);
    s.ledger = calx_sim_ledger(r->sim);
    s.ledger.scale = s.ledger.heat_scale = 0.0; /* the largest among the times of asking */
    return s;
}

static void same(const struct said *a, const struct said *b, const char *what)
{
    ck_assert_msg(a->hash == b->hash, "%s: hash %llx instead of %llx", what,
                  (unsigned long long)b->hash, (unsigned long long)a->hash);
    ck_assert_msg(!memcmp(&a->ledger, &b->ledger, sizeof a->ledger), "%s: the ledgers differ",
                  what);
}

/* The scene is what it should be: blocks, rebuilds, contacts with history, warmth. */
static void has_everything(const struct run *r)
{
    struct calx_features f = calx_sim_features(r->sim);
    ck_assert_uint_ge(r->sim->block_count, LEAST_BLOCKS);
    ck_assert_int_ge(r->sim->rebuilds, LEAST_REBUILDS);
    ck_assert_uint_gt(calx_sim_contact_count(r->sim), GRAINS / 10);
    ck_assert(f.history && f.rotation && f.temperature && f.periodic && f.wall_contacts);
    if (!rigid) /* impacts last one step: not in each of them */
        ck_assert_double_gt(r->sim->wall_force[1][1] * r->sim->wall_force[1][1], 0.0);
}

static struct said run_with_threads(const char *heat, int threads)
{
    struct run r = run_start(crowd(heat), threads);
    run_steps(&r, STEPS);
    has_everything(&r);
    struct said out = say(&r);
    ck_assert_double_lt(fabs(out.ledger.heat_residual),
                        1e-12 * out.ledger.heat); /* through ghosts too */
    run_free(&r);
    return out;
}

static void same_with_threads(const char *heat)
{
    struct said one = run_with_threads(heat, 1);
    for (int threads = 2; threads <= 4; threads++) {
        char what[64];
        struct said other = run_with_threads(heat, threads);
        snprintf(what, sizeof what, "%s, %d threads", heat, threads);
        same(&one, &other, what);
    }
}

START_TEST(threads_change_nothing)
{
    same_with_threads("heat-euler");
}
END_TEST

START_TEST(threads_change_nothing_in_the_heat_network)
{
    same_with_threads("heat-theta");
    same_with_threads("heat-exponential");
}
END_TEST

/* ---- saving and restoring ---- */

static struct calx_block *copy_blocks(struct calx_sim *s, size_t *count)
{
    struct calx_error e = {0};
    struct calx_block *blocks;
    ck_assert_msg(calx_sim_save(s, &blocks, count, &e) == 0, "%s", e.text);
    for (size_t k = 0; k < *count; k++) {
        void *copy = malloc(blocks[k].bytes + 1);
        ck_assert_ptr_nonnull(copy);
        if (blocks[k].bytes)
            memcpy(copy, blocks[k].data, blocks[k].bytes);
        blocks[k].data = copy;
    }
    return blocks;
}

static void free_blocks(struct calx_block *blocks, size_t count)
{
    for (size_t k = 0; k < count; k++)
        free((void *)blocks[k].data);
    free(blocks);
}

/* Runs `before` steps, hands the state to a new simulation, and goes on to STEPS there. */
static void resumed(size_t before, const char *heat, const struct said *straight)
{
    char what[64];
    struct calx_error e = {0};
    size_t count;
    struct run first = run_start(crowd(heat), 2);
    run_steps(&first, before);
    uint64_t hash = calx_sim_hash(first.sim);
    struct calx_block *blocks = copy_blocks(first.sim, &count);
    run_free(&first);
    struct run second = run_start(crowd(heat), 1);
    run_steps(&second, before % 7); /* what it did before must not matter */
    ck_assert_msg(calx_sim_restore(second.sim, blocks, count, &e) == 0, "%s", e.text);
    free_blocks(blocks, count);
    ck_assert_uint_eq(calx_sim_hash(second.sim), hash);
    run_steps(&second, STEPS - before);
    struct said out = say(&second);
    snprintf(what, sizeof what, "%s, resumed at step %zu", heat, before);
    same(straight, &out, what);
    run_free(&second);
}

START_TEST(a_restart_changes_nothing)
{
    static const size_t at[] = {0, 1, 37, 101, 198};
    struct said straight = run_with_threads("heat-euler", 2);
    for (size_t k = 0; k < sizeof at / sizeof *at; k++)
        resumed(at[k], "heat-euler", &straight);
    straight = run_with_threads("heat-theta", 2);
    resumed(122, "heat-theta", &straight);
}
END_TEST

START_TEST(a_restart_that_does_not_fit_is_refused)
{
    struct calx_error e = {0};
    size_t count;
    struct run first = run_start(crowd("heat-euler"), 1);
    struct calx_block *blocks = copy_blocks(first.sim, &count);
    run_free(&first);
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, 1e3, NAN, -1.0, 1e-5);
    scene_put(s, 1, 3.0, 0.0, 0.0, 1.0);
    struct run second = run_start(s, 1);
    ck_assert_int_eq(calx_sim_restore(second.sim, blocks, count, &e), CALX_ERROR_INPUT);
    ck_assert_ptr_nonnull(strstr(e.text, "does not fit"));
    run_free(&second);
    free_blocks(blocks, count);
}
END_TEST

/* ---- looking ---- */

START_TEST(looking_changes_nothing)
{
    enum { LOOKS = 60 };
    struct calx_probe probe = {
        .quantity = "kinetic-energy", .particle = -1, .material = -1, .wall = -1};
    ck_assert_ptr_nonnull(calx_measure_find(probe.quantity));
    FILE *nowhere = fopen("/dev/null", "w");
    struct run blind = run_start(crowd("heat-euler"), 1), watched = run_again(&blind, 1);
    for (size_t k = 0; k < LOOKS; k++) {
        struct calx_block *blocks;
        size_t count;
        run_steps(&blind, 1);
        run_steps(&watched, 1);
        calx_frame_free(calx_frame_create(watched.sim, k % 2));
        calx_sim_ledger(watched.sim);
        calx_sim_measure(watched.sim, &probe);
        calx_sim_describe(watched.sim, nowhere);
        calx_sim_save(watched.sim, &blocks, &count, NULL);
        free(blocks);
    }
    fclose(nowhere);
    struct said a = say(&blind), b = say(&watched);
    same(&a, &b, "looking at each step");
    run_free(&watched);
    run_free(&blind);
}
END_TEST

/* ---- many steps at once ---- */

/* The crowd in two stages, the second with another gravity. */
static struct calx_scene *staged(const char *heat)
{
    struct calx_scene *s = crowd(heat);
    s->stages[0].duration = 77.0 * s->models[0].dt;
    size_t second = scene_stage(s);
    s->stages[second].duration = INFINITY;
    s->stages[second].gravity[2].value = 3.0;
    return s;
}

/* Advances STEPS steps in bites of changing size, looking in between; single steps where the engine
 * asks for them. */
static struct said advanced(const char *heat, int threads, size_t *alone)
{
    static const int64_t bites[] = {1, 2, 64, 5, 3, 40, 17};
    struct calx_error e = {0};
    struct run r = run_start(staged(heat), threads);
    for (size_t k = 0; calx_sim_step_count(r.sim) < STEPS; k++) {
        int64_t left = STEPS - calx_sim_step_count(r.sim), made = 0,
                bite = bites[k % 7] < left ? bites[k % 7] : left;
        ck_assert_msg(calx_sim_advance(r.sim, bite, &made, &e) == 0, "%s", e.text);
        ck_assert(made >= 0 && made <= bite);
        if (made == 0)
            run_steps(&r, 1);
        *alone += made == 0;
        calx_frame_free(calx_frame_create(r.sim, true));
    }
    struct said out = say(&r);
    run_free(&r);
    return out;
}

START_TEST(many_steps_at_once_change_nothing)
{
    static const char *const heat[] = {"heat-euler", "heat-theta"};
    for (size_t k = 0; k < 2; k++) {
        struct run r = run_start(staged(heat[k]), 1);
        run_steps(&r, STEPS);
        ck_assert_int_eq(calx_sim_stage(r.sim), 1);
        struct said single = say(&r);
        run_free(&r);
        for (int threads = 1; threads <= 3; threads += 2) {
            char what[64];
            size_t alone = 0;
            struct said many = advanced(heat[k], threads, &alone);
            snprintf(what, sizeof what, "%s, many steps at once, %d threads", heat[k], threads);
            same(&single, &many, what);
            ck_assert_uint_lt(alone, STEPS / 10);
        }
    }
}
END_TEST

/* ---- instruction sets ---- */

static void same_with_instruction_sets(void)
{
    const struct {
        const char *name;
        const struct calx_engine *engine;
        bool there;
    } copies[] = {
        {"AVX2", &calx_engine_avx2, __builtin_cpu_supports("avx2")},
        {"AVX-512", &calx_engine_avx512, calx_engine_pick(NULL) == &calx_engine_avx512},
    };
    struct run base = run_start(crowd("heat-euler"), 1);
    base.sim->engine = &calx_engine_base;
    run_steps(&base, STEPS);
    struct said a = say(&base);
    for (size_t k = 0; k < sizeof copies / sizeof *copies; k++) {
        if (!copies[k].engine || !copies[k].there)
            continue; /* not built, or this processor lacks it */
        struct run r = run_again(&base, 1);
        r.sim->engine = copies[k].engine;
        run_steps(&r, STEPS);
        struct said b = say(&r);
        same(&a, &b, copies[k].name);
        run_free(&r);
    }
    run_free(&base);
}

START_TEST(instruction_sets_agree)
{
    same_with_instruction_sets();
}
END_TEST

/* It keeps a number per contact from step to step, and tries the laws on parts of batches. */
START_TEST(resolved_contacts_change_nothing)
{
    motion = "contact-exact";
    struct said straight = run_with_threads("heat-euler", 2);
    same_with_threads("heat-euler");
    resumed(37, "heat-euler", &straight);
    same_with_instruction_sets();
    motion = "velocity-verlet";
}
END_TEST

/* Impulses go through a problem that all blocks share, and are kept with their contacts for the next step. */
START_TEST(impulses_change_nothing)
{
    rigid = true;
    struct said straight = run_with_threads("heat-theta", 2);
    same_with_threads("heat-theta");
    resumed(0, "heat-theta", &straight);
    resumed(37, "heat-theta", &straight);
    resumed(198, "heat-theta", &straight);
    same_with_instruction_sets();
    rigid = false;
}
END_TEST

int main(void)
{
    const TTest *tests[] = {a_restart_that_does_not_fit_is_refused,
                            threads_change_nothing,
                            threads_change_nothing_in_the_heat_network,
                            a_restart_changes_nothing,
                            looking_changes_nothing,
                            many_steps_at_once_change_nothing,
                            instruction_sets_agree,
                            resolved_contacts_change_nothing,
                            impulses_change_nothing};
    return run_tests("determinism", sizeof tests / sizeof *tests, tests);
}

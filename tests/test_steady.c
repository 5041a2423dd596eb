/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Signals that are watched until they are stationary: Student's t against tables, the confidence interval against its definition on random
 * numbers, a transient that decays by a known factor per step, a velocity that grows in one of three layers; equal bits when a run stops within a
 * window, and whoever looks at the state in between.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/steady.h"
#include "tests/scenes.h"

/* ---- statistics ---- */

START_TEST(student_s_t_is_that_of_the_tables)
{
    static const struct {
        size_t freedom;
        double t;
    } table[] = {{2, 4.302653}, {4, 2.776445}, {8, 2.306004}, {18, 2.100922}, {30, 2.042272}, {120, 1.979930}};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++)
        ck_assert_double_eq_tol(calx_steady_student(table[k].freedom), table[k].t, 5e-7);
}
END_TEST

static double normal(struct calx_random *random)
{
    double u = 1.0 - calx_random_uniform(random), v = calx_random_uniform(random);
    return sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
}

/* Of stationary noise the true change is 0 and the true mean is known: both lie within their intervals in 95 % of all windows, whatever the
 * number of blocks; 4 standard deviations of so many windows. With a step of CHANGE in the middle the interval holds that. */
START_TEST(intervals_hold_the_truth_in_95_of_100_windows)
{
    enum { WINDOWS = 20000 };
    static const double MEAN = 7.0, NOISE = 0.3, CHANGE = 0.2;
    double allowed = 4.0 * sqrt(0.95 * 0.05 / WINDOWS);
    struct calx_random random;
    calx_random_seed(&random, 5);
    for (size_t n = 4; n <= 20; n += 8) {
        int change = 0, mean = 0, step = 0;
        for (int w = 0; w < WINDOWS; w++) {
            double blocks[20];
            for (size_t k = 0; k < n; k++)
                blocks[k] = MEAN + NOISE * normal(&random);
            struct calx_steady_verdict v = calx_steady_judge(blocks, n, 1.0);
            change += fabs(v.change) <= v.doubt;
            mean += fabs(v.mean - MEAN) <= v.error;
            for (size_t k = n / 2; k < n; k++)
                blocks[k] += CHANGE;
            v = calx_steady_judge(blocks, n, 1.0);
            step += fabs(v.change - CHANGE) <= v.doubt;
        }
        ck_assert_double_eq_tol(change / (double)WINDOWS, 0.95, allowed);
        ck_assert_double_eq_tol(mean / (double)WINDOWS, 0.95, allowed);
        ck_assert_double_eq_tol(step / (double)WINDOWS, 0.95, allowed);
    }
}
END_TEST

/* A signal whose change is just the allowed one is called steady in 2.5 % of all windows at most; one that is too noisy to say, never. */
START_TEST(what_changes_or_is_too_noisy_is_not_called_steady)
{
    enum { WINDOWS = 20000, BLOCKS = 10 };
    struct calx_random random;
    int border = 0, noisy = 0, quiet = 0;
    calx_random_seed(&random, 6);
    for (int w = 0; w < WINDOWS; w++) {
        double blocks[BLOCKS], noise[BLOCKS], still[BLOCKS];
        for (int k = 0; k < BLOCKS; k++) {
            double x = normal(&random);
            blocks[k] = 0.02 * x + (k >= BLOCKS / 2 ? 0.1 : 0.0);
            noise[k] = x;
            still[k] = 0.02 * x;
        }
        border += calx_steady_judge(blocks, BLOCKS, 0.1).drift <= 1.0;
        noisy += calx_steady_judge(noise, BLOCKS, 0.1).drift <= 1.0;
        quiet += calx_steady_judge(still, BLOCKS, 0.1).drift <= 1.0;
    }
    ck_assert_double_lt(border / (double)WINDOWS, 0.025 + 4.0 * sqrt(0.025 * 0.975 / WINDOWS));
    ck_assert_int_eq(noisy, 0);
    ck_assert_double_gt(quiet / (double)WINDOWS, 0.99);
    ck_assert(isnan(calx_steady_judge((double[]){1.0, NAN, 1.0, 1.0}, 4, 1.0).drift));
}
END_TEST

/* ---- a known transient ---- */

static struct calx_steady *watch(struct calx_scene *s, const char *quantity, double every, double over, size_t blocks, double within)
{
    s->steady = realloc(s->steady, (s->steady_count + 1) * sizeof *s->steady);
    ck_assert_ptr_nonnull(s->steady);
    struct calx_steady *w = &s->steady[s->steady_count++];
    *w = (struct calx_steady){.name = "watched", .signal = {.particle = -1, .material = -1, .wall = -1, .profile = -1}, .every = every,
                              .over = over, .blocks = blocks, .within = within};
    snprintf(w->signal.quantity, sizeof w->signal.quantity, "%s", quantity);
    return w;
}

enum { PER_BLOCK = 3, STEPS_EACH = 2, BLOCKS = 6, BLOCK = PER_BLOCK * STEPS_EACH, WINDOW = BLOCKS * BLOCK };
static const double DT = 0.01, HOT = 400.0, COLD = 300.0, WITHIN = 0.5;

/* Two equal grains share their heat by explicit steps: the hot one is at 350 K + 50 K q^n after n steps, q = 1 - 2 H dt/C. */
static struct calx_scene *pair(double *q)
{
    static const double H = 1e6;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    s->models[0].frozen = true;
    s->models[0].dt = DT;
    scene_put(s, 0, 0.0, 0.0, 0.0, 1.0);
    scene_put(s, 1, 0.0, 0.0, 1.99, 1.0);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    scene_warm(s, 0, HOT);
    scene_warm(s, 1, COLD);
    watch(s, "temperature", STEPS_EACH * DT, BLOCK * DT, BLOCKS, WITHIN)->signal.particle = 0;
    *q = 1.0 - 2.0 * H * DT / (4.0 / 3.0 * M_PI * 1000.0 * 1000.0);
    return s;
}

/* The verdict on the window that ends after n steps, from its definition. */
static double expected_drift(double q, int n)
{
    double means[BLOCKS], half[2] = {0, 0}, spread = 0.0, change;
    for (int b = 0; b < BLOCKS; b++) {
        means[b] = 0.0;
        for (int k = 1; k <= PER_BLOCK; k++)
            means[b] += (350.0 + 50.0 * pow(q, n - WINDOW + b * BLOCK + k * STEPS_EACH)) / PER_BLOCK;
        half[b >= BLOCKS / 2] += means[b] / (BLOCKS / 2);
    }
    for (int b = 0; b < BLOCKS; b++)
        spread += pow(means[b] - half[b >= BLOCKS / 2], 2) / (BLOCKS - 2);
    change = half[1] - half[0];
    return (fabs(change) + 2.7764451 * sqrt(spread * 2.0 / (BLOCKS / 2))) / WITHIN; /* t of 4 degrees */
}

START_TEST(a_transient_that_decays)
{
    double q, first = NAN;
    struct calx_scene *s = pair(&q);
    struct run r = run_start(s, 1);
    ck_assert(isnan(calx_sim_steady(r.sim, 0)->drift));
    for (int n = BLOCK; n < 100 * BLOCK; n += BLOCK) {
        run_steps(&r, BLOCK);
        const struct calx_steady_view *v = calx_sim_steady(r.sim, 0);
        if (n < WINDOW) {
            ck_assert(isnan(v->drift) && isnan(v->since));
            continue;
        }
        double drift = expected_drift(q, n);
        ck_assert_double_eq_tol(v->drift, drift, 1e-6 * drift + 1e-10);
        if (isnan(first) && drift <= 1.0)
            first = (n - WINDOW) * DT;
        ck_assert(isnan(first) ? isnan(v->since) : fabs(v->since - first) < 1e-9);
    }
    ck_assert(first > 2 * WINDOW * DT); /* there was a transient, and its end */
    run_free(&r);
}
END_TEST

/* What disturbs it makes it not steady, and then it is steady since a later time. */
START_TEST(a_disturbance_starts_anew)
{
    double q;
    struct calx_scene *s = pair(&q);
    struct run r = run_start(s, 1);
    run_steps(&r, 100 * BLOCK);
    double since = calx_sim_steady(r.sim, 0)->since;
    ((double *)run_v(&r, 0))[7] += 20.0;
    run_steps(&r, WINDOW);
    ck_assert(!isnan(since) && isnan(calx_sim_steady(r.sim, 0)->since));
    run_steps(&r, 100 * BLOCK);
    ck_assert_double_gt(calx_sim_steady(r.sim, 0)->since, 100 * BLOCK * DT);
    run_free(&r);
}
END_TEST

/* ---- layers ---- */

/* Three layers across x: one grain held, one that falls, none. The fall, g t, has block means g over apart: a change of half the blocks times that,
 * with a spread of the halves of (h (h^2 - 1)/12) of its square each. */
START_TEST(the_worst_layer_counts)
{
    static const double G = 10.0, STEP = 1e-3, OVER = 5e-3, LIMIT = 2.0;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_linear(s, 1e3, NAN, -1.0, STEP);
    scene_gravity(s, 0.0, 0.0, -G);
    scene_put(s, 0, 5.0, 0.0, 0.0, 1.0);
    scene_put(s, 1, 15.0, 0.0, 0.0, 1.0);
    scene_fix(s, 0);
    s->profiles = calloc(1, sizeof *s->profiles);
    s->profile_count = 1;
    s->profiles[0] = (struct calx_profile){.name = "across", .axis = 0, .layers = 3, .every = STEP, .over = STEP,
                                           .low = {0, -100, -100}, .high = {30, 100, 100}};
    struct calx_steady *w = watch(s, "layer-velocity", STEP, OVER, 10, LIMIT);
    w->signal.profile = 0;
    w->signal.component = 'z';
    struct run r = run_start(s, 1);
    run_steps(&r, 70);
    const struct calx_steady_view *v = calx_sim_steady(r.sim, 0);
    double d = G * OVER, spread = 2.0 * 5.0 * 24.0 / 12.0 * d * d / 8.0, change = -5.0 * d;
    ck_assert_uint_eq(v->layer, 1);
    ck_assert_double_eq_tol(v->change, change, 1e-9);
    ck_assert_double_eq_tol(v->drift, (5.0 * d + 2.3060041 * sqrt(2.0 * spread / 5.0)) / LIMIT, 1e-7);
    ck_assert_double_lt(v->drift, 1.0);
    run_free(&r);
}
END_TEST

/* ---- bits ---- */

/* Velocities of a grain that falls are half a step ahead in steps that nobody looks at. */
static struct calx_scene *falling(void)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 1);
    scene_linear(s, 1e3, NAN, -1.0, DT);
    scene_gravity(s, 0.0, 0.0, -10.0);
    watch(s, "kinetic-energy", STEPS_EACH * DT, BLOCK * DT, BLOCKS, WITHIN);
    return s;
}

static void check_equal(const struct run *a, const struct run *b)
{
    const struct calx_steady_view *v = calx_sim_steady(a->sim, 0);
    ck_assert(!isnan(v->drift));
    ck_assert_mem_eq(v, calx_sim_steady(b->sim, 0), offsetof(struct calx_steady_view, since));
}

START_TEST(the_same_bits)
{
    enum { LONG = 3 * WINDOW + 2, BREAK = LONG - WINDOW + BLOCK + STEPS_EACH + 1 }; /* within a block, between samples; the window counts what was before */
    for (int moving = 0; moving < 2; moving++) {
        double q;
        struct calx_error e = {0};
        struct calx_block *blocks;
        size_t count;
        struct run first = run_start(moving ? falling() : pair(&q), 1), broken = run_again(&first, 1), resumed = run_again(&first, 2),
                   quiet = run_again(&first, 1);
        run_steps(&first, LONG);
        run_steps(&broken, BREAK);
        ck_assert_int_eq(calx_sim_save(broken.sim, &blocks, &count, &e), 0);
        ck_assert_msg(calx_sim_restore(resumed.sim, blocks, count, &e) == 0, "%s", e.text);
        free(blocks);
        run_steps(&resumed, LONG - BREAK);
        for (int64_t made, left = LONG; left > 0; left -= made) {
            ck_assert_int_eq(calx_sim_advance(quiet.sim, left, &made, &e), 0);
            if (made < left) {
                ck_assert_int_eq(calx_sim_step(quiet.sim, &e), 0);
                made++;
            }
        }
        check_equal(&first, &resumed);
        check_equal(&first, &quiet);
        run_free(&quiet);
        run_free(&resumed);
        run_free(&broken);
        run_free(&first);
    }
}
END_TEST

int main(void)
{
    const TTest *tests[] = {student_s_t_is_that_of_the_tables,
                            intervals_hold_the_truth_in_95_of_100_windows,
                            what_changes_or_is_too_noisy_is_not_called_steady,
                            a_transient_that_decays,
                            a_disturbance_starts_anew,
                            the_worst_layer_counts,
                            the_same_bits};
    return run_tests("steady", sizeof tests / sizeof *tests, tests);
}

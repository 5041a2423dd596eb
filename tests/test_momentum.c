/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What is conserved: momentum in a periodic crowd that rubs, angular momentum in a free one, the
 * energy of an elastic gas.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double RADIUS = 0.1;

/* ---- momentum ---- */

enum { CLUSTER = 64 };

/* A cubic cluster that flies apart, rubs and spins; periodic or free. */
static struct calx_scene *cluster(bool periodic)
{
    struct calx_scene *s = scene_create(3, CALX_SPHERES, CLUSTER);
    struct calx_random random;
    calx_random_seed(&random, 3);
    scene_linear(s, 1e5, 0.6, 0.5, 5e-5);
    for (size_t i = 0; i < CLUSTER; i++) {
        double u[6];
        for (int k = 0; k < 6; k++)
            u[k] = 2.0 * calx_random_uniform(&random) - 1.0;
        scene_put(s, i, 0.21 * (double)(i % 4) + 0.1, 0.21 * (double)(i / 4 % 4) + 0.1,
                  0.21 * (double)(i / 16) + 0.1, RADIUS);
        scene_move(s, i, u[0], u[1], u[2]);
        scene_spin(s, i, 20.0 * u[3], 20.0 * u[4], 20.0 * u[5]);
    }
    for (int k = 0; k < 3 && periodic; k++)
        scene_extent(s, k, 0.0, 0.84, 'p');
    return s;
}

static double size_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Angular momentum about the origin, and the sum of its parts' sizes. */
static double angular_momentum(const struct run *r, double out[3])
{
    double sum = 0.0;
    memset(out, 0, sizeof(double[3]));
    for (int64_t i = 0; i < CLUSTER; i++) {
        const double *x = run_x(r, i), *v = run_v(r, i);
        double m = run_mass(r, i), part[3];
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            part[k] = m * (x[a] * v[b] - x[b] * v[a]) + 0.4 * m * x[3] * x[3] * v[4 + k];
            out[k] += part[k];
        }
        sum += size_of(part);
    }
    return sum;
}

START_TEST(momentum_is_conserved)
{
    const double bound = 1e-12;
    struct run r = run_start(cluster(true), 1);
    double parts = 0.0, change[3];
    struct calx_ledger before = calx_sim_ledger(r.sim);
    for (int64_t i = 0; i < CLUSTER; i++)
        parts += run_mass(&r, i) * size_of(run_v(&r, i));
    run_steps(&r, 10000);
    struct calx_ledger after = calx_sim_ledger(r.sim);
    for (int k = 0; k < 3; k++)
        change[k] = after.momentum[k] - before.momentum[k];
    ck_assert_double_gt(after.dissipated, 0.1 * before.kinetic);
    ck_assert_msg(size_of(change) < bound * parts, "momentum changed by %.3g of %.3g",
                  size_of(change), parts);
    run_free(&r);
}
END_TEST

START_TEST(angular_momentum_is_conserved)
{
    const double bound = 1e-10;
    struct run r = run_start(cluster(false), 1);
    double before[3], after[3], change[3], parts = angular_momentum(&r, before);
    run_steps(&r, 10000);
    angular_momentum(&r, after);
    for (int k = 0; k < 3; k++)
        change[k] = after[k] - before[k];
    ck_assert_double_gt(calx_sim_ledger(r.sim).dissipated, 0.0);
    ck_assert_msg(size_of(change) < bound * parts, "angular momentum changed by %.3g of %.3g",
                  size_of(change), parts);
    run_free(&r);
}
END_TEST

/* ---- an elastic gas ---- */

static const double GRAIN = 0.01, GAS_STIFFNESS = 1e4;

/* A step with n of them in an impact of two equal grains. */
static double step_for(double n)
{
    return M_PI * sqrt(0.5 * 4.0 / 3.0 * M_PI * pow(GRAIN, 3.0) * 1000.0 / GAS_STIFFNESS) / n;
}

START_TEST(an_elastic_gas_keeps_its_energy)
{
    enum { EDGE = 5, GAS = EDGE * EDGE * EDGE, STEPS = 40000 };
    const double bound = 1e-3, rounding = 1e-12; /* of the design, at tc/50 */
    struct calx_scene *s = scene_create(3, CALX_SPHERES, GAS);
    struct calx_random random;
    calx_random_seed(&random, 9);
    scene_linear(s, GAS_STIFFNESS, NAN, -1.0, step_for(50));
    for (size_t i = 0; i < GAS; i++) {
        scene_put(s, i, 0.03 * (double)(i % EDGE), 0.03 * (double)(i / EDGE % EDGE),
                  0.03 * (double)(i / EDGE / EDGE), GRAIN);
        scene_move(s, i, calx_random_uniform(&random) - 0.5, calx_random_uniform(&random) - 0.5,
                   calx_random_uniform(&random) - 0.5);
    }
    for (int k = 0; k < 3; k++)
        scene_extent(s, k, 0.0, 0.03 * EDGE, 'p');
    struct run r = run_start(s, 1);
    struct calx_ledger first = calx_sim_ledger(r.sim);
    double parts = 0.0, worst = 0.0, change = 0.0;
    for (int64_t i = 0; i < GAS; i++)
        parts += run_mass(&r, i) *
                 sqrt(pow(run_v(&r, i)[0], 2) + pow(run_v(&r, i)[1], 2) + pow(run_v(&r, i)[2], 2));
    for (int k = 0; k < STEPS; k += 400) {
        run_steps(&r, 400);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        worst = fmax(worst, fabs((l.kinetic + l.elastic) / first.kinetic - 1.0));
        for (int q = 0; q < 3; q++)
            change = fmax(change, fabs(l.momentum[q] - first.momentum[q]));
    }
    ck_assert_msg(worst < bound, "energy is off by %g", worst);
    ck_assert_msg(change < rounding * parts, "momentum is off by %g of %g", change, parts);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {momentum_is_conserved, angular_momentum_is_conserved,
                            an_elastic_gas_keeps_its_energy};
    return run_tests("momentum", sizeof tests / sizeof *tests, tests);
}

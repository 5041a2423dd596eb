/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Slabs against closed forms: modes of the scheme, a half-space suddenly heated, a line source that moves over its face, the linear profile of
 * a steady flow; heat is conserved, between grains and slab too; friction heats the slab; a wall carries it along; equal bits.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/slab.h"
#include "tests/scenes.h"

/* rho c = 2, k = 3 in the tests of the scheme. */
static struct calx_slab slab_of(size_t along, size_t deep, double length, double depth)
{
    return (struct calx_slab){.along = along, .deep = deep, .axis = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, .length = length,
                              .depth = depth, .width = 0.5, .conductivity = 3.0, .capacity = 2.0, .theta = 0.5,
                              .start = 300.0, .far = 300.0};
}

static const double DIFFUSIVITY = 1.5;

/* A slab with its arrays. */
struct block {
    struct calx_slab b;
    struct calx_slab_step step;
    double *heat;
};

static struct block block_of(struct calx_slab b, double dt)
{
    struct block k = {.b = b, .step = {.dt = dt}};
    k.step.temperature = calloc(b.along * b.deep, sizeof(double));
    k.step.scratch = calloc(calx_slab_scratch(&b), sizeof(double));
    k.step.heat = k.heat = calloc(b.along, sizeof(double));
    ck_assert(k.step.temperature && k.step.scratch && k.heat);
    return k;
}

static void block_free(struct block *k)
{
    free(k->step.temperature);
    free(k->step.scratch);
    free(k->heat);
}

static double content(const struct block *k)
{
    long double sum = 0.0;
    for (size_t c = 0; c < k->b.along * k->b.deep; c++)
        sum += k->step.temperature[c];
    return (double)sum * calx_slab_capacity(&k->b);
}

/* ---- the scheme ---- */

/* cos(2 pi m x/L) or cos(pi m x/L) by cos(pi n z/D), with a far face held at 0 cos(pi (n + 1/2) z/D), are modes of the differences, of eigenvalue
 * 4 sin^2(.)/h^2 each; a step multiplies them by the factor of the split scheme, for steps far beyond any explicit limit too. */
START_TEST(modes_are_multiplied_by_the_factor_of_the_scheme)
{
    for (int kind = 0; kind < 8; kind++) {
        bool periodic = kind & 1, far = kind & 2;
        size_t along = kind & 4 ? 1 : 12, deep = 9;
        double dt = 0.3, m = 2.0, n = far ? 1.5 : 1.0, wave = periodic ? 2.0 * m : m;
        struct block k = block_of(slab_of(along, deep, 2.0, 0.7), dt);
        k.b.periodic = periodic;
        k.b.far_isothermal = far;
        k.b.far = 0.0;
        k.b.theta = kind > 3 ? 1.0 : 0.5;
        double ds = 2.0 / (double)along, dz = 0.7 / (double)deep;
        double x = along > 1 ? sin(M_PI * wave / (2.0 * (double)along)) : 0.0, z = sin(M_PI * n / (2.0 * (double)deep));
        double a = dt * DIFFUSIVITY * 4.0 * x * x / (ds * ds), b = dt * DIFFUSIVITY * 4.0 * z * z / (dz * dz), theta = k.b.theta;
        double factor = ((1.0 - (1.0 - theta) * a - b) / (1.0 + theta * a) + theta * b) / (1.0 + theta * b);
        for (size_t c = 0; c < along * deep; c++)
            k.step.temperature[c] = (along > 1 ? cos(M_PI * wave * ((double)(c % along) + 0.5) / (double)along) : 1.0) *
                                    cos(M_PI * n * ((double)(c / along) + 0.5) / (double)deep);
        double *start = malloc(along * deep * sizeof *start);
        memcpy(start, k.step.temperature, along * deep * sizeof *start);
        calx_slab_advance(&k.b, &k.step);
        for (size_t c = 0; c < along * deep; c++)
            ck_assert_double_eq_tol(k.step.temperature[c], factor * start[c], 1e-12);
        free(start);
        block_free(&k);
    }
}
END_TEST

START_TEST(heat_is_conserved)
{
    struct calx_random random;
    calx_random_seed(&random, 1);
    for (int kind = 0; kind < 4; kind++) {
        struct block k = block_of(slab_of(17, 11, 2.0, 0.7), 0.01);
        k.b.periodic = kind & 1;
        k.b.far_isothermal = kind & 2;
        for (size_t c = 0; c < 17 * 11; c++)
            k.step.temperature[c] = 300.0 + 100.0 * calx_random_uniform(&random);
        for (int turn = 0; turn < 50; turn++) {
            double before = content(&k), given = 0.0;
            for (size_t i = 0; i < 17; i++)
                given += k.heat[i] = 5.0 * calx_random_uniform(&random);
            calx_slab_advance(&k.b, &k.step);
            ck_assert_double_eq_tol(content(&k), before + given + k.step.far_heat, 1e-12 * before);
            ck_assert((k.step.far_heat != 0.0) == (bool)(kind & 2));
        }
        block_free(&k);
    }
}
END_TEST

/* A half-space of 300 K whose face is at 400 K from t = 0: 300 + 100 erfc(y/(2 sqrt(a t))), y from the far face, which is that face here. From
 * the solution at t0 to 4 t0, with steps in proportion to the cells; the other end is at erfc(9). */
static double half_space_error(size_t deep)
{
    double t0 = 0.002, depth = 2.0 * 9.0 * sqrt(DIFFUSIVITY * 4.0 * t0) / 2.0, dt = 3.0 * t0 / (double)deep, worst = 0.0;
    struct block k = block_of(slab_of(1, deep, 1.0, depth), dt);
    k.b.far_isothermal = true;
    k.b.far = 400.0;
    double dz = depth / (double)deep;
    for (size_t i = 0; i < deep; i++)
        k.step.temperature[i] = 300.0 + 100.0 * erfc((depth - dz * ((double)i + 0.5)) / (2.0 * sqrt(DIFFUSIVITY * t0)));
    for (size_t n = 0; n < deep; n++)
        calx_slab_advance(&k.b, &k.step);
    for (size_t i = 0; i < deep; i++) {
        double exact = 300.0 + 100.0 * erfc((depth - dz * ((double)i + 0.5)) / (2.0 * sqrt(DIFFUSIVITY * 4.0 * t0)));
        worst = fmax(worst, fabs(k.step.temperature[i] - exact));
    }
    block_free(&k);
    return worst;
}

START_TEST(a_half_space_suddenly_heated)
{
    double error[3], cells[3] = {80, 160, 320};
    for (int k = 0; k < 3; k++)
        error[k] = half_space_error((size_t)cells[k]);
    ck_assert_double_eq_tol(slope(3, cells, error), -2.0, 0.1);
    ck_assert_double_lt(error[2], 0.02);
}
END_TEST

/* The same from the first moment on, and with a given flow q through the near face: 2 q/k sqrt(a t) ierfc(y/(2 sqrt(a t))). Below 1 % of the
 * rise at the face, once a few cells have warmed. */
START_TEST(a_half_space_with_a_given_flow)
{
    enum { DEEP = 200, STEPS = 400 };
    double depth = 1.0, dt = 1e-5, q = 1e4, t = STEPS * dt, root = sqrt(DIFFUSIVITY * t);
    struct block k = block_of(slab_of(1, DEEP, 1.0, depth), dt);
    k.heat[0] = q * dt * k.b.length * k.b.width;
    for (int n = 0; n < STEPS; n++)
        calx_slab_advance(&k.b, &k.step);
    double face = 2.0 * q / k.b.conductivity * root / sqrt(M_PI);
    for (size_t i = 0; i < DEEP; i++) {
        double u = depth / DEEP * ((double)i + 0.5) / (2.0 * root);
        double exact = 2.0 * q / k.b.conductivity * root * (exp(-u * u) / sqrt(M_PI) - u * erfc(u));
        ck_assert_double_eq_tol(k.step.temperature[i], exact, 0.002 * face);
    }
    block_free(&k);
}
END_TEST

/* What enters at the face leaves at the far face, held at 350 K: T = 350 + q (D - z)/k, exact at the middles of cells. */
START_TEST(a_steady_flow_has_a_linear_profile)
{
    struct block k = block_of(slab_of(5, 13, 2.0, 0.7), 1e4);
    k.b.far_isothermal = true;
    k.b.far = 350.0;
    k.b.theta = 1.0;
    double q = 700.0;
    for (size_t i = 0; i < 5; i++)
        k.heat[i] = q * k.step.dt * 2.0 / 5.0 * k.b.width;
    for (int n = 0; n < 40; n++)
        calx_slab_advance(&k.b, &k.step);
    for (size_t c = 0; c < 5 * 13; c++)
        ck_assert_double_eq_tol(k.step.temperature[c], 350.0 + q / 3.0 * 0.7 * (1.0 - ((double)(c / 5) + 0.5) / 13.0), 1e-6);
    ck_assert_double_eq_tol(k.step.far_heat, -q * k.step.dt * 2.0 * k.b.width, 1e-6 * q * k.step.dt);
    block_free(&k);
}
END_TEST

/* K_0(x) = integral of exp(-x cosh t) over t > 0; the trapezoidal rule converges exponentially. */
static double bessel_k0(double x)
{
    double sum = 0.5 * exp(-x), h = 0.03;
    for (int n = 1; n < 300; n++)
        sum += exp(-x * cosh(h * n));
    return h * sum;
}

/* A line source that moves along the insulated face of a half-space with speed V: q/(pi k) exp(-V x/(2a)) K_0(V r/(2a)), x ahead of it (Carslaw
 * and Jaeger, Conduction of heat in solids, 10.7; twice that of the whole space). After it has gone 60 times the length 2a/V; the largest error
 * at least that far from it, over q/(pi k). */
static double source_error(size_t along, size_t deep)
{
    double speed = 30.0, length = 8.0, depth = 1.5, dt = 0.2 / (1.5 * (double)along), power = 100.0, end = 0.2;
    struct block k = block_of(slab_of(along, deep, length, depth), dt);
    struct calx_pose pose = {.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    k.b.periodic = true;
    double ds = length / (double)along, dz = depth / (double)deep, scale = 2.0 * DIFFUSIVITY / speed, unit = power / (M_PI * 3.0);
    for (int n = 0; n < (int)lround(end / dt); n++) {
        struct calx_slab_spot spot = calx_slab_find(&k.b, &pose, (double[3]){1.0 + speed * dt * (n + 0.5), 0.0, 0.0});
        memset(k.heat, 0, along * sizeof *k.heat);
        k.heat[spot.cell[0]] += (1.0 - spot.share) * power * k.b.width * dt;
        k.heat[spot.cell[1]] += spot.share * power * k.b.width * dt;
        calx_slab_advance(&k.b, &k.step);
    }
    double source = 1.0 + speed * end, worst = 0.0, largest = 0.0;
    for (size_t c = 0; c < along * deep; c++) {
        double x = ds * ((double)(c % along) + 0.5) - source, z = dz * ((double)(c / along) + 0.5), r = hypot(x, z);
        if (r < scale || x > 3.0 * scale || x < -15.0 * scale || z > 5.0 * scale)
            continue;
        double exact = exp(-x / scale) * bessel_k0(r / scale);
        worst = fmax(worst, fabs(k.step.temperature[c] / unit - exact));
        largest = fmax(largest, exact);
    }
    ck_assert_double_gt(largest, 0.9);
    block_free(&k);
    return worst;
}

START_TEST(a_line_source_that_moves)
{
    double coarse = source_error(300, 75), fine = source_error(600, 150);
    ck_assert_double_lt(fine, 0.01);
    ck_assert_double_gt(coarse / fine, 1.8);
}
END_TEST

/* ---- where a contact is ---- */

START_TEST(a_wall_carries_its_slab)
{
    struct calx_slab b = slab_of(8, 2, 4.0, 1.0);
    struct calx_pose pose = {.turn = {0, -1, 0, 1, 0, 0, 0, 0, 1}, .shift = {10.0, 20.0, 0.0}}; /* a quarter turn */
    b.corner[0] = 1.0;
    /* x = 2.3 on the wall, s = 1.3, cell 2.6: between the middles of cells 2 and 3 */
    struct calx_slab_spot spot = calx_slab_find(&b, &pose, (double[3]){10.0, 22.3, 0.0});
    ck_assert(spot.cell[0] == 2 && spot.cell[1] == 3);
    ck_assert_double_eq_tol(spot.share, 0.1, 1e-12);
    spot = calx_slab_find(&b, &pose, (double[3]){10.0, 20.9, 0.0}); /* beyond the end */
    ck_assert(spot.cell[0] == 0 && spot.share == 0.0);
    b.periodic = true; /* cell -0.7: between the last and the first */
    spot = calx_slab_find(&b, &pose, (double[3]){10.0, 20.9, 0.0});
    ck_assert(spot.cell[0] == 7 && spot.cell[1] == 0);
    ck_assert_double_eq_tol(spot.share, 1.0 - 0.7, 1e-12);
}
END_TEST

/* ---- with grains ---- */

static const double H = 5.0;

/* Grains of radius 0.1 on a floor y = 0 with a slab below, along x from 0 to 2, periodic. */
static struct calx_scene *grains_on_slab(size_t n, const char *heat, size_t along, double dt, bool frozen)
{
    struct calx_scene *s = scene_create(2, CALX_DISCS, n);
    if (!frozen)
        scene_linear(s, 1e6, 0.5, 0.5, dt);
    s->models[0].frozen = frozen;
    s->models[0].dt = dt;
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
    scene_model(s, CALX_TEMPERATURE, heat, NULL);
    scene_extent(s, 0, 0.0, 2.0, 'p');
    scene_material_value(s, 0, "conductivity", 40.0);
    int floor_ = scene_wall(s, "floor", 0);
    scene_plane(s, floor_, (double[3]){0}, (double[3]){0, 1, 0});
    struct calx_slab b = slab_of(along, 6, 2.0, 0.3);
    b.periodic = true;
    b.width = 1.0;
    b.conductivity = 40.0;
    b.capacity = 1e6;
    s->walls[floor_].slab = b;
    for (size_t i = 0; i < n; i++) {
        scene_put(s, i, 2.0 * ((double)i + 0.37) / (double)n, 0.099, 0.0, 0.1);
        scene_warm(s, i, 500.0);
    }
    return s;
}

/* One hot grain, held on the slab: both come to the temperature of their heat, which stays. */
START_TEST(a_hot_grain_on_a_slab)
{
    static const char *const heat[] = {"heat-euler", "heat-exponential", "heat-theta"};
    for (int k = 0; k < 3; k++) {
        struct calx_scene *s = grains_on_slab(1, heat[k], 5, 1.0, true);
        struct run r = run_start(s, 1);
        double grain = run_mass(&r, 0) * 1000.0, slab = 2.0 * 0.3 * 1e6, start = grain * 500.0 + slab * 300.0;
        double first = calx_sim_ledger(r.sim).heat;
        ck_assert_double_eq_tol(first, start, 1e-12 * start);
        run_steps(&r, 10);
        double fallen = run_v(&r, 0)[7]; /* the first steps: C dT/dt = -H (T - T_face), T_face from 300 K on */
        ck_assert_double_eq_tol(fallen, 300.0 + 200.0 * exp(-H * 10.0 / grain), 0.1);
        for (int n = 0; n < 120; n++) {
            run_steps(&r, 1000);
            struct calx_ledger l = calx_sim_ledger(r.sim);
            ck_assert_double_lt(fabs(l.heat_residual), 120000 * 0x1p-52 * start); /* a unit in the last place in each step */
        }
        double mean = start / (grain + slab);
        ck_assert_double_eq_tol(run_v(&r, 0)[7], mean, 1e-3);
        ck_assert_double_eq_tol(calx_sim_slab_temperature(r.sim, 0, true), mean, 1e-3);
        ck_assert_double_eq_tol(calx_measure_frame(r.sim)->temperature_of_wall[0], mean, 1e-3);
        run_free(&r);
    }
}
END_TEST

/* Discs that slide and bounce on a floor that moves: all dissipated work is in grains and slab, with and without conduction, with a heat step
 * of one step and of five. */
START_TEST(friction_heats_the_slab)
{
    static const char *const heat[] = {"heat-euler", "heat-theta"};
    for (int k = 0; k < 8; k++) {
        struct calx_scene *s = grains_on_slab(4, heat[k % 2], 16, 1e-4, false);
        s->from_dissipation = 1.0;
        s->models[0].heat_dt = k & 2 ? 5e-4 : 0.0;
        if (k & 4) { /* the plugin that conducts gives its place to the one after it */
            free(s->models[0].list[3].values);
            s->models[0].list[3] = s->models[0].list[--s->models[0].count];
        }
        scene_gravity(s, 0.0, -10.0, 0.0);
        for (size_t i = 0; i < 4; i++) {
            scene_warm(s, i, 300.0);
            scene_move(s, i, 3.0, -1.0, 0.0);
        }
        scene_motion(s, 0, 0)->velocity[0].value = -2.0;
        struct run r = run_start(s, 1);
        double slab = calx_slabs_content(r.sim);
        run_steps(&r, 20000);
        struct calx_ledger l = calx_sim_ledger(r.sim);
        ck_assert_double_gt(l.heat_of_dissipation, 100.0);
        ck_assert_double_gt(calx_slabs_content(r.sim) - slab, 0.4 * l.heat_of_dissipation);
        ck_assert_double_lt(fabs(l.heat_residual), 1e-12 * l.heat);
        run_free(&r);
    }
}
END_TEST

/* Cells of a 3D slab are hexahedra of positive volume that fill it, whichever way it lies; in 2D quadrilaterals behind the face. */
START_TEST(cells_fill_the_slab)
{
    for (int kind = 0; kind < 7; kind++) {
        int normal = kind / 2 % 3, along = (normal + 1 + kind % 2) % 3, across = 3 - normal - along;
        bool flat = kind == 6;
        struct calx_scene *s = scene_create(flat ? 2 : 3, flat ? CALX_DISCS : CALX_SPHERES, 1);
        scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
        scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
        s->models[0].frozen = true;
        s->models[0].dt = 1.0;
        int wall = scene_wall(s, "wall", 0);
        struct calx_slab b = slab_of(4, 3, 2.0, 0.9);
        if (!flat) {
            memset(b.axis, 0, sizeof b.axis);
            b.axis[0][along] = b.axis[2][across] = 1.0;
            b.axis[1][normal] = kind % 2 ? -1.0 : 1.0;
        }
        s->walls[wall].slab = b;
        scene_put(s, 0, 9.0, 9.0, flat ? 0.0 : 9.0, 0.5);
        struct run r = run_start(s, 1);
        struct calx_mesh *m = calx_sim_slab_mesh(r.sim, wall);
        ck_assert(m && m->cells == 12 && m->corners == (flat ? 4 : 8) && m->points == (flat ? 20 : 40));
        double sum = 0.0;
        for (size_t c = 0; c < m->cells; c++) {
            const int64_t *q = m->corner + m->corners * c;
            double e[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0.5}}, volume = 0.0;
            for (int k = 0; k < 3; k++) {
                e[0][k] = m->position[q[1]][k] - m->position[q[0]][k];
                e[1][k] = m->position[q[3]][k] - m->position[q[0]][k];
                if (!flat)
                    e[2][k] = m->position[q[4]][k] - m->position[q[0]][k];
                ck_assert_double_eq_tol(m->position[q[2]][k] - m->position[q[1]][k], e[1][k], 1e-12);
            }
            for (int k = 0; k < 3; k++)
                volume += e[2][k] * (e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3]);
            ck_assert_double_gt(volume, 0.0);
            sum += volume;
        }
        ck_assert_double_eq_tol(sum, 2.0 * 0.9 * 0.5, 1e-12);
        calx_mesh_free(m);
        run_free(&r);
    }
}
END_TEST

START_TEST(a_face_that_would_overshoot_is_refused)
{
    struct calx_error e = {0};
    struct calx_scene *s = grains_on_slab(2, "heat-theta", 2000, 1.0, true);
    s->walls[0].slab.capacity = 1e3;
    struct run r = run_start(s, 1);
    ck_assert_int_ne(calx_sim_step(r.sim, &e), 0);
    ck_assert_msg(strstr(e.text, "slab of walls 'floor'") && strstr(e.text, "larger cells"), "%s", e.text);
    run_free(&r);
}
END_TEST

START_TEST(the_same_bits)
{
    enum { CROWD = 5000, STEPS = 300 };
    for (int k = 0; k < 2; k++) {
        struct calx_scene *s = grains_on_slab(CROWD, k ? "heat-theta" : "heat-euler", 64, 1e-5, false);
        struct calx_error e = {0};
        s->from_dissipation = 1.0;
        s->high[0] = 0.1 * CROWD;
        s->walls[0].slab.length = 0.1 * CROWD;
        for (size_t i = 0; i < CROWD; i++) {
            scene_put(s, i, 0.21 * ((double)(i / 2) + 0.5) * 0.1 * CROWD / (0.21 * CROWD / 2.0), i % 2 ? 0.295 : 0.099, 0.0, 0.1);
            scene_warm(s, i, 300.0 + (double)(i % 7));
            scene_move(s, i, (double)(i % 5) - 2.0, 0.0, 0.0);
        }
        scene_motion(s, 0, 0)->velocity[0].value = 1.0;
        struct run first = run_start(s, 1), two = run_again(&first, 2), broken = run_again(&first, 2), resumed = run_again(&first, 1);
        struct calx_block *blocks;
        size_t count;
        run_steps(&first, STEPS);
        run_steps(&two, STEPS);
        run_steps(&broken, STEPS / 3);
        ck_assert_int_eq(calx_sim_save(broken.sim, &blocks, &count, &e), 0);
        ck_assert_msg(calx_sim_restore(resumed.sim, blocks, count, &e) == 0, "%s", e.text);
        free(blocks);
        run_steps(&resumed, STEPS - STEPS / 3);
        uint64_t hash = calx_sim_hash(first.sim);
        ck_assert_double_ne(first.sim->slab_temperature[0], 300.0);
        ck_assert_uint_eq(calx_sim_hash(two.sim), hash);
        ck_assert_uint_eq(calx_sim_hash(resumed.sim), hash);
        run_free(&two);
        run_free(&broken);
        run_free(&resumed);
        run_free(&first);
    }
}
END_TEST

int main(void)
{
    const TTest *tests[] = {modes_are_multiplied_by_the_factor_of_the_scheme,
                            heat_is_conserved,
                            a_half_space_suddenly_heated,
                            a_half_space_with_a_given_flow,
                            a_steady_flow_has_a_linear_profile,
                            a_line_source_that_moves,
                            a_wall_carries_its_slab,
                            a_hot_grain_on_a_slab,
                            friction_heats_the_slab,
                            cells_fill_the_slab,
                            a_face_that_would_overshoot_is_refused,
                            the_same_bits};
    return run_tests("slab", sizeof tests / sizeof *tests, tests);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductances of contacts, and the effective conductivity of the cubic lattices that follows from
 * them: frozen bodies between two walls, steady state. k_eff = (1/V) sum over contacts of H
 * (l.e)^2.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

static const double H = 2.0;       /* W/K, of every contact where it is constant */
static const double RADIUS = 0.05; /* m */
static const double LAP = 1e-3;    /* m, overlap of neighbours */

/* A frozen scene of n grains with a constant conductance. */
static struct calx_scene *frozen(uint32_t dimension, size_t n, const char *integrator, double theta,
                                 double dt)
{
    struct calx_scene *s = scene_create(dimension, CALX_SPHERES, n);
    scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", H);
    scene_model1(s, CALX_TEMPERATURE, integrator, theta >= 0.0 ? "theta" : NULL, theta);
    s->models[0].frozen = true;
    s->models[0].heat_dt = dt;
    return s;
}

static double capacity(const struct calx_scene *s)
{
    return calx_particle_mass(s, RADIUS, 1000.0) * 1000.0;
}

/* ---- lattices ---- */

struct lattice {
    const char *name;
    size_t sites;
    double site[4][3]; /* in units of the cubic cell */
    double nearest;    /* distance of neighbours in the same unit */
    double factor;     /* k_eff L/H, with L the distance of neighbours: k_eff = H/L, sqrt(3) H/L, 2
                          sqrt(2) H/L */
};

static const struct lattice lattices[] = {
    {"simple cubic", 1, {{0, 0, 0}}, 1.0, 1.0},
    {"body-centred", 2, {{0, 0, 0}, {.5, .5, .5}}, 0.86602540378443865, 1.7320508075688773},
    {"face-centred",
     4,
     {{0, 0, 0}, {.5, .5, 0}, {.5, 0, .5}, {0, .5, .5}},
     0.70710678118654752,
     2.8284271247461903},
};

/* Periodic along y and z, between two walls along x; the conductivity is the flux per area over the
 * gradient inside. */
static double lattice_conductivity(const struct lattice *l)
{
    enum { CELLS = 4 };
    const double side = (2.0 * RADIUS - LAP) / l->nearest;
    struct calx_scene *s = frozen(3, CELLS * CELLS * CELLS * l->sites, "heat-theta", 1.0, 1.0);
    double last = 0.0, flux = 0.0, t[2] = {0}, count[2] = {0};
    s->models[0].heat_dt = 1e4 * capacity(s) / H;
    for (size_t i = 0; i < s->particles.count; i++) {
        size_t cell = i / l->sites,
               at[3] = {cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS};
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = side * ((double)at[k] + l->site[i % l->sites][k]);
        scene_put(s, i, x[0], x[1], x[2], RADIUS);
        last = fmax(last, x[0]);
    }
    for (int side_of = 0; side_of < 2; side_of++) {
        int w = scene_wall(s, side_of ? "right" : "left", 0);
        scene_plane(s, w, (double[3]){side_of ? last + RADIUS - LAP : LAP - RADIUS, 0, 0},
                    (double[3]){side_of ? -1 : 1, 0, 0});
        scene_wall_temperature(s, w, side_of ? 300.0 : 400.0);
    }
    for (int k = 1; k < 3; k++)
        scene_extent(s, k, -0.25 * side, (CELLS - 0.25) * side, 'p');
    struct run r = run_start(s, 1);
    run_steps(&r, 12);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    for (size_t c = 0; c < f->contact_count; c++)
        flux += f->pair[c][1] == -1 ? f->heat_flow[c] : 0.0;
    for (size_t i = 0; i < f->n; i++)
        for (int q = 0; q < 2; q++)
            if (fabs(f->position[i][0] - side * (q ? 2.0 : 1.0)) < 0.1 * side) {
                t[q] += f->temperature[i];
                count[q]++;
            }
    calx_frame_free(f);
    run_free(&r);
    double area = pow(CELLS * side, 2), gradient = (t[0] / count[0] - t[1] / count[1]) / side;
    return flux / area / gradient;
}

START_TEST(conductivity_of_lattices)
{
    const double bound = 1e-10; /* linear algebra */
    for (size_t k = 0; k < sizeof lattices / sizeof *lattices; k++) {
        double expected = lattices[k].factor * H / (2.0 * RADIUS - LAP),
               got = lattice_conductivity(&lattices[k]);
        ck_assert_msg(fabs(got / expected - 1.0) < bound, "%s: %.12g instead of %.12g W/(m K)",
                      lattices[k].name, got, expected);
    }
}
END_TEST

/* ---- conductances ---- */

/* H = 2 k r_c with r_c of the circle of intersection, k the harmonic mean; a wall is a sphere of
 * infinite radius. */
START_TEST(conductance_of_the_overlap)
{
    const double k[2] = {385.0, 36.0}, mean = 2.0 * 385.0 * 36.0 / (385.0 + 36.0), r1 = RADIUS,
                 r2 = 0.6 * RADIUS, l = r1 + r2 - LAP;
    double cut = (r1 * r1 - r2 * r2 + l * l) / (2.0 * l), wall_cut = r1 - LAP;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, 2);
    scene_material(s, "other", 1000.0, 1000.0);
    scene_material_value(s, 0, "conductivity", k[0]);
    scene_material_value(s, 1, "conductivity", k[1]);
    scene_model(s, CALX_CONDUCTANCE, "overlap", NULL);
    scene_model(s, CALX_TEMPERATURE, "heat-euler", NULL);
    s->models[0].frozen = true;
    s->models[0].heat_dt = 1e-3;
    s->particles.material[1] = 1;
    scene_put(s, 0, 0, 0, 0, r1);
    scene_put(s, 1, l, 0, 0, r2);
    scene_warm(s, 0, 300.0);
    scene_warm(s, 1, 301.0);
    int w = scene_wall(s, "wall", 0);
    scene_plane(s, w, (double[3]){0, -wall_cut, 0}, (double[3]){0, 1, 0});
    scene_wall_temperature(s, w, 302.0);
    struct run r = run_start(s, 1);
    struct calx_frame *f = calx_frame_create(r.sim, true);
    ck_assert_uint_eq(f->contact_count, 2);
    for (size_t c = 0; c < 2; c++) {
        bool wall = f->pair[c][1] < 0;
        double expected = wall ? 2.0 * 2.0 * k[0] * sqrt(r1 * r1 - wall_cut * wall_cut)
                               : 2.0 * mean * sqrt(r1 * r1 - cut * cut);
        double sign = !wall && f->pair[c][0] == 1 ? -1.0 : 1.0;
        /* r_c^2 is a difference: rounding grows by R/LAP */
        ck_assert_double_eq_tol(sign * f->heat_flow[c] / expected, 1.0, 1e-12);
    }
    calx_frame_free(f);
    run_free(&r);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {conductivity_of_lattices, conductance_of_the_overlap};
    return run_tests("lattices", sizeof tests / sizeof *tests, tests);
}

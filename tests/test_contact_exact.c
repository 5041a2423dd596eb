/* SPDX-License-Identifier: BSD-3-Clause
 *
 * contact-exact through the whole engine, where velocity Verlet is of first order: oblique impacts
 * with friction, of a grain on a wall and of two free grains, against themselves at many more
 * steps; the energy that a collision loses against what is booked as dissipated; momentum.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/impacts.h"

enum { PHASES = 8, FRACTIONS = 3, ANGLES = 6, LADDER = 4, FINE = 3000 };
static const double STEPS[LADDER] = {20, 50, 100, 200}, RADIUS = 0.01, STIFFNESS = 1e6;

/* What a grain has after the impact, m/s: normal, tangential, spin times radius; and J per kg that
 * are missing in the ledger. */
struct after { double v[3], residual, dissipated; };

struct kind {
    const char *name;
    bool hertz, twins;
    double e, mu, damping, clip;
};

static void add_laws(struct calx_scene *s, const struct kind *k)
{
    set_material(s, 0, &(struct material){1e8, 0.3, 1000.0});
    set_material(s, scene_material(s, "wall", 1.0, 1.0), &RIGID);
    if (k->hertz) {
        scene_model1(s, CALX_CONTACT, "hertz", k->e < 1.0 ? "restitution" : NULL, k->e);
        scene_model1(s, CALX_CONTACT, "mindlin", "friction", k->mu);
        return;
    }
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", STIFFNESS}, {"clip", k->clip}, {k->e < 1.0 ? "restitution" : NULL, k->e}, {NULL, 0.0}});
    if (k->mu >= 0.0)
    scene_model(s, CALX_CONTACT, "coulomb",
                (struct given[]){{"stiffness", 2.0 / 7.0 * STIFFNESS}, {"friction", k->mu},
                                 {k->damping > 0.0 ? "damping-rate" : NULL, k->damping}, {NULL, 0.0}});
}

static double duration_of(const struct kind *k, double mass)
{
    double half = k->twins ? 0.5 : 1.0, young[2] = {1e8, k->twins ? 1e8 : 1e20}, poisson[2] = {0.3, 0.3};
    return k->hertz ? hertz_duration(calx_effective_modulus(young, poisson), half * mass, half * RADIUS, k->twins ? 2.0 : 1.0)
                    : hypot(M_PI, log(k->e)) * sqrt(half * mass / STIFFNESS);
}

static double vt_of(size_t angle) { return tan((10.0 + 14.0 * (double)angle) * DEGREE); }

static void impacts(const char *integrator, const struct kind *k, double steps, size_t phases, struct after *out)
{
    size_t n = ANGLES * phases;
    struct calx_scene *s = scene_create(3, CALX_SPHERES, k->twins ? 2 * n : n);
    double mass = 4.0 / 3.0 * M_PI * pow(RADIUS, 3.0) * 1000.0, dt = duration_of(k, mass) / steps;
    add_laws(s, k);
    scene_model(s, CALX_MOTION, integrator, NULL);
    s->models[0].dt = dt;
    for (size_t q = 0; q < n; q++) {
        double gap = dt * (2.0 + ((double)(q % phases) + 0.5) / (double)phases), z = 10.0 * RADIUS * (double)(q%phases), x=1.0*(double)(q/phases);
        scene_put(s, q, x - gap * vt_of(q / phases), RADIUS + gap, z, RADIUS);
        scene_move(s, q, vt_of(q / phases), -1.0, 0.0);
        scene_spin(s, q, 0.0, 0.0, 20.0);
        if (!k->twins)
            continue;
        scene_put(s, n + q, x + gap * vt_of(q / phases), -RADIUS - gap, z, RADIUS);
        scene_move(s, n + q, -vt_of(q / phases), 1.0, 0.0);
    }
    if (!k->twins)
        scene_plane(s, scene_wall(s, "plane", 1), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    struct run r = run_start(s, 1);
    run_steps(&r, (size_t)(2.5 * steps) + 10);
    ck_assert_uint_eq(calx_sim_contact_count(r.sim), 0);
    for (size_t q = 0; q < n; q++) {
        const double *v = run_v(&r, (int64_t)q);
        out[q] = (struct after){{v[1], v[0], RADIUS * v[6]}, 0.0, 0.0};
    }
    struct calx_ledger l = calx_sim_ledger(r.sim);
    out[0].residual = l.residual / ((double)n * mass);
    out[0].dissipated = (double)r.sim->dissipated / ((double)n * mass);
    run_free(&r);
}

static const struct kind kinds[] = {
    {"linear wall", false, false, 0.5, 0.4, 0, 1}, {"linear twins", false, true, 0.5, 0.4, 0, 1},
    {"linear frictionless twins", false, true, 0.5, -1, 0, 1},
    {"linear elastic wall", false, false, 1, 0.4, 0, 0}, {"linear sticking wall", false, false, 0.5, 50, 0, 1},
    {"linear wall not clipped", false, false, 0.5, .4, 0, 0},
    {"linear wall tangential damping", false, false, 0.5, 0.4, 500, 1},
    {"hertz wall", true, false, 0.5, 0.4, 0, 0}, {"hertz twins", true, true, 0.5, 0.4, 0, 0},{"hertz elastic", true, false, 1, 0.4, 0, 0},{"hertz frictionless", true, true, .5, 0, 0, 0}};

START_TEST(show)
{
    static const char *const in[] = {"velocity-verlet", "contact-exact"};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        struct after fine[ANGLES], got[ANGLES * PHASES];
        impacts("contact-exact", &kinds[k], FINE, 1, fine);
        for (int i = 0; i < 2; i++) {
            double err[ANGLES][LADDER], all[LADDER], res[LADDER];
            for (size_t q = 0; q < LADDER; q++) {
                memset(&err, 0, 0);
                double sum[ANGLES] = {0}; res[q] = 0;
                for (size_t f = 0; f < FRACTIONS; f++) {
                    impacts(in[i], &kinds[k], STEPS[q] + (double)f / FRACTIONS, PHASES, got);
                    res[q] += fabs(got[0].residual) / FRACTIONS;
                    for (size_t p = 0; p < ANGLES * PHASES; p++)
                        for (int c = 0; c < 3; c++)
                            sum[p / PHASES] += pow(got[p].v[c] - fine[p / PHASES].v[c], 2) / (PHASES * FRACTIONS);
                }
                all[q] = 0;
                for (size_t a = 0; a < ANGLES; a++) { err[a][q] = sqrt(sum[a]); all[q] = fmax(all[q], err[a][q]); }
            }
            printf("%-28s %-16s worst %.2e %.2e %.2e %.2e order %.2f | orders", kinds[k].name, in[i], all[0], all[1], all[2], all[3], -slope(LADDER, STEPS, all));
            for (size_t a = 0; a < ANGLES; a++) printf(" %.2f", -slope(LADDER, STEPS, err[a]));
            printf(" | residual %.1e %.1e %.1e order %.2f, diss %.3f\n", res[0], res[1], res[3], -slope(LADDER, STEPS, res), got[0].dissipated);
        }
    }
}
END_TEST
int main(void){ const TTest *t[]={show}; return run_tests("x",1,t);}

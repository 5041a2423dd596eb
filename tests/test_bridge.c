/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Soft and rigid bodies on one scene (cases/21-soft-to-rigid): a packing whose forces are determined by balance alone. The geometry of the
 * soft one differs by overlaps of F/k, and so do its forces: the error of each falls as 1/k.
 */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/calx.h"
#include "io/case.h"
#include "tests/scenes.h"

enum { DISCS = 30, FORCES = 2 * DISCS };

struct network {
    int64_t pair[FORCES][2]; /* ids; a wall w is -1 - w */
    double force[FORCES];    /* N */
};

/* Runs a file of the case, springs of that stiffness if there are any, to its end. */
static void end_of(const char *name, double stiffness, struct network *out)
{
    char path[512], text[64];
    struct calx_problems problems = {0};
    struct calx_error e = {0};
    struct calx_setting setting = {"contact/stiffness", text};
    snprintf(path, sizeof path, "%s/cases/21-soft-to-rigid/%s.xml", getenv("CALX_SOURCE_ROOT"), name);
    snprintf(text, sizeof text, "%g N/m", stiffness);
    struct calx_registry *registry = calx_registry_create(NULL);
    struct calx_scene *scene = calx_case_read(path, registry, &setting, stiffness > 0.0, &problems);
    calx_problems_print(&problems, stderr);
    struct calx_sim *sim = scene ? calx_sim_create(scene, registry, 1, &e) : NULL;
    ck_assert_msg(sim != NULL, "%s: %s", path, e.text);
    while (!calx_sim_done(sim))
        ck_assert_msg(calx_sim_step(sim, &e) == 0, "%s", e.text);
    struct calx_frame *f = calx_frame_create(sim, true);
    ck_assert_uint_eq(f->contact_count, FORCES);
    for (size_t k = 0; k < FORCES; k++) {
        out->force[k] = f->normal_force[k];
        for (int b = 0; b < 2; b++)
            out->pair[k][b] = f->pair[k][b];
    }
    calx_frame_free(f);
    calx_sim_free(sim);
    calx_scene_free(scene);
    calx_registry_free(registry);
    calx_problems_clear(&problems);
}

static double force_between(const struct network *n, const int64_t pair[2])
{
    for (size_t k = 0; k < FORCES; k++)
        if ((n->pair[k][0] == pair[0] && n->pair[k][1] == pair[1]) || (n->pair[k][0] == pair[1] && n->pair[k][1] == pair[0]))
            return n->force[k];
    ck_abort_msg("no contact of %lld and %lld", (long long)pair[0], (long long)pair[1]);
    return NAN;
}

/* The largest difference of a force, over the largest force. */
static double difference(const struct network *a, const struct network *b)
{
    double most = 0.0, size = 0.0;
    for (size_t k = 0; k < FORCES; k++) {
        most = fmax(most, fabs(a->force[k] - force_between(b, a->pair[k])));
        size = fmax(size, a->force[k]);
    }
    return most / size;
}

/* Over two decades, each by ten: the second order in F/(k R), which is 2e-3 at most, may bend the line by some hundredths. */
START_TEST(forces_of_soft_bodies_approach_those_of_rigid_ones)
{
    struct network rigid, soft;
    double before = NAN;
    end_of("case", 0.0, &rigid);
    for (double stiffness = 1e5; stiffness < 2e7; stiffness *= 10.0) {
        end_of("soft", stiffness, &soft);
        double now = difference(&rigid, &soft);
        if (!isnan(before))
            ck_assert_msg(fabs(log10(before / now) - 1.0) < 0.05, "k = %g N/m: %g of the largest force, after %g", stiffness, now, before);
        before = now;
    }
    ck_assert_double_lt(before, 1e-3);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {forces_of_soft_bodies_approach_those_of_rigid_ones};
    return run_tests("bridge", sizeof tests / sizeof *tests, tests);
}

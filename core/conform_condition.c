/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance of a non-smooth contact law: what it says of a contact is a condition that has a solution (friction and
 * pull not negative, restitution from 0 to 1, no pull beyond the gap that contacts are looked for from), the same from both bodies and in
 * every direction. That batches may be cut, and undeclared columns are unused, is checked as for other laws (conform_trial.c), with
 * the four columns of the condition in the place of energy, stiffness and damping.
 */
#include <math.h>

#include "core/conform_parts.h"

enum { SEED = 2718 };

/* Round-off of a dozen operations. */
static const double ROUND_OFF = 1e-13;

static const size_t friction = CALX_COL_ENERGY, restitution = CALX_COL_STIFFNESS, pull = CALX_COL_STIFFNESS + 1,
                    reach = CALX_COL_DAMPING;

static void check_range(const struct calx_choice *c, const struct calx_trial *t, struct calx_conformance *report)
{
    size_t outside = 0, unseen = 0, idle = 0;
    const struct calx_contact_law *law = c->plugin->law;
    for (size_t i = 0; i < t->n; i++) {
        double e = t->column[restitution][i], far = t->column[reach][i];
        outside += !(t->column[friction][i] >= 0) + !(e >= 0 && e <= 1) + !(t->column[pull][i] >= 0) + !(far >= 0);
        unseen += far > c->demand.gap;
        idle += !(t->column[pull][i] > 0);
    }
    calx_conform_note(report, "conditions have a solution", (double)outside, 0, c->where);
    calx_conform_note(report, "pulls end within the declared gap", (double)unseen, 0, c->where);
    if (law->provides & CALX_COHESION && c->where[0] == 0) /* a wall may have no pull */
        calx_conform_note(report, "contacts are pulled", (double)idle / (double)t->n, 0.5, c->where);
}

static double worst_difference(const struct calx_trial *a, const struct calx_trial *b)
{
    double worst = 0;
    for (size_t k = friction; k <= reach; k++)
        for (size_t i = 0; i < a->n; i++)
            worst = fmax(worst, fabs(a->column[k][i] - b->column[k][i]) / (fabs(a->column[k][i]) + 1e-300));
    return worst;
}

/* Bodies exchanged, and another direction. */
static void check_symmetry(struct calx_choice *c, const struct calx_trial *raw, const struct calx_trial *seen,
                           struct calx_conformance *report)
{
    struct calx_trial other = *raw;
    calx_trial_exchange(&other);
    double worst = INFINITY;
    if (calx_choice_exchange(c) == 0) {
        calx_trial_evaluate(&other, c);
        worst = worst_difference(seen, &other);
    }
    if (calx_choice_exchange(c))
        worst = INFINITY;
    calx_conform_note(report, "the same from both bodies", worst, ROUND_OFF, c->where);
}

void calx_conform_condition(struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_trial raw, seen;
    calx_trial_check_batches(c, report);
    calx_trial_check_finite(c, report);
    calx_trial_fill(&raw, c, CALX_BATCH, SEED);
    seen = raw;
    calx_trial_evaluate(&seen, c);
    check_range(c, &seen, report);
    check_symmetry(c, &raw, &seen, report);
}

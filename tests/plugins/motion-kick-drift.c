/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "kick-drift", as a user might write one: v += a dt, x += v dt. First order in position. For
 * tests/test_report.py, which builds it with the command of plugins/README.md.
 */
#include "core/plugin.h"

static void kick(const struct calx_rows *r)
{
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            r->v[i * r->stride + k] += r->dt[k] * r->a[i * r->stride + k];
}

static void move(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 3; k++)
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    kick(r);
}

static const struct calx_stage translation[] = {{.before = move}};
static const struct calx_stage rotation[] = {{.before = turn}};

static const struct calx_motion_integrator law = {
    .order = 1,
    .stages = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .translation = translation,
    .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "kick-drift",
    .summary = "kick, then drift",
    .reference = "Cromer, Am. J. Phys. 49 (1981) 455",
    .equation = "v += a dt; x += v dt",
    .law = &law,
};

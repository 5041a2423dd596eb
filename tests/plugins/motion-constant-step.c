/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "constant-step", for tests: symplectic Euler, which declares that its step may not change, and remembers the
 * step it was started with in its extra state: a change makes the positions infinite.
 */
#include <math.h>

#include "core/plugin.h"

static void move(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++) {
        double *first = &r->extra[0][4 * i];
        *first = *first > 0 ? *first : r->dt[0];
        for (size_t k = 0; k < 4; k++) {
            r->v[i * r->stride + k] += r->dt[k] * r->a[i * r->stride + k];
            r->x[4 * i + k] += r->dt[k] * r->v[i * r->stride + k];
        }
        if (*first != r->dt[0])
            r->x[4 * i] = INFINITY;
    }
}

static void turn(const void *params, const struct calx_rows *r)
{
    (void)params;
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < 4; k++)
            r->v[i * r->stride + k] += r->dt[k] * r->a[i * r->stride + k];
}

static const struct calx_stage translation[] = {{.before = move}}, rotation[] = {{.before = turn}};
static const char *const extra[] = {"step"};

static const struct calx_motion_integrator law = {
    .order = 1, .stages = 1, .stability = 2, .constant_step = 1, .extra_translation = 1, .extra = extra,
    .translation = translation, .rotation = rotation,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "constant-step",
    .summary = "symplectic Euler whose step may not change",
    .reference = "none, for tests",
    .equation = "v += a dt;  x += v dt",
    .law = &law,
};

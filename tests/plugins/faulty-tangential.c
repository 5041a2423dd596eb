/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A tangential law that is right for FAULT NONE and breaks one rule of the contract for each other:
 * the conformance suite must find it. GAIN is damping on the whole sliding velocity, as in other
 * codes: it gives energy when sliding slows down. For tests only.
 */
#include <math.h>

#include "core/plugin.h"

enum { NONE, LIMIT, SLOPE, GAIN, DIRECTION, KEEPS };

struct faulty {
    double stiffness, friction;
};

static const struct calx_parameter parameters[] = {
    {.name = "stiffness",
     .symbol = "k",
     .unit = "N/m",
     .doc = "Stiffness.",
     .min = 1e-3,
     .max = 1e9,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct faulty, stiffness)},
    {.name = "friction",
     .symbol = "mu",
     .unit = "1",
     .doc = "Friction.",
     .min = 0,
     .max = 10,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct faulty, friction)},
};

static const double damping = FAULT == GAIN ? 0.3 : 0;

static void force(const void *params, const struct calx_contacts *b)
{
    const struct faulty *p = params;
    double *const *s = b->history, *const *h = b->history + 3;
    for (size_t c = 0; c < b->n; c++) {
        double f[3], size = 0, done = 0, stored = 0,
                     touch = b->overlap[c] > 0 || FAULT == KEEPS ? 1 : 0;
        for (int k = 0; k < 3; k++) {
            f[k] = s[k][c] - p->stiffness * b->vt[k][c] * b->dt - touch * damping * b->vt[k][c];
            f[k] += FAULT == DIRECTION && k == 1 ? 1e-6 * touch : 0;
            size += f[k] * f[k];
        }
        double limit = touch * (FAULT == LIMIT ? 1.01 : 1) * p->friction * fabs(b->coulomb[c]);
        double share = size > limit * limit ? limit / sqrt(size) : 1;
        for (int k = 0; k < 3; k++) {
            f[k] *= share;
            b->ft[k][c] += f[k];
            done += (h[k][c] + f[k]) * b->vt[k][c] * b->dt;
            h[k][c] = f[k];
            f[k] += touch * damping * b->vt[k][c];
            stored += (f[k] + s[k][c]) * (f[k] - s[k][c]) / p->stiffness;
            s[k][c] = f[k];
        }
        b->work[c] -= 0.5 * (done + stored);
    }
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct faulty *p = params;
    for (size_t c = 0; c < b->n; c++) {
        if (b->overlap[c] <= 0)
            continue;
        for (int k = 0; k < 3; k++)
            r->energy[c] += 0.5 * b->history[k][c] * b->history[k][c] / p->stiffness;
        r->stiffness[1][c] += (FAULT == SLOPE ? 0.99 : 1) * p->stiffness;
        r->damping[1][c] += damping;
    }
}

static const char *const history[] = {"spring", "force"};

static const struct calx_contact_law law = {
    .provides = CALX_TANGENTIAL,
    .depends = CALX_NORMAL,
    .demand = {.needs = CALX_NEEDS_TANGENT | CALX_NEEDS_NORMAL_FORCE | CALX_USES_VELOCITY, .history_vectors = 2},
    .history = history,
    .force = force,
    .response = response};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_CONTACT,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "ft = s",
                                                    .parameter_count = 2,
                                                    .parameters = parameters,
                                                    .params_size = sizeof(struct faulty),
                                                    .law = &law};

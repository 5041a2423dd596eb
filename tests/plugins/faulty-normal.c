/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A normal law, fn = k d - c vn, that is right for FAULT NONE and breaks one rule of the contract
 * for each other: the conformance suite must find it. For tests only.
 */
#include <stdio.h>

#include "core/plugin.h"

enum {
    NONE,
    PIECES,
    ORDER,
    PADDING,
    UNDECLARED,
    INFINITE,
    APART,
    IDLE_WORK,
    DIRECTION,
    ENERGY,
    STIFFNESS,
    DAMPING,
    GAIN,
    LEFT,
    BOOKS,
    REFUSES,
    VELOCITY
};

struct faulty {
    double stiffness, damping;
};

static const struct calx_parameter parameters[] = {
    {.name = "stiffness",
     .symbol = "k",
     .unit = "N/m",
     .doc = "Stiffness.",
     .min = 1e-9,
     .max = 1e15,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct faulty, stiffness)},
    {.name = "damping",
     .symbol = "c",
     .unit = "N s/m",
     .doc = "Damping.",
     .initial = 0.1,
     .min = 0,
     .max = 1e6,
     .scope = CALX_PAIR,
     .offset = offsetof(struct faulty, damping)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    (void)setup, (void)params, (void)demand;
    if (FAULT == REFUSES)
        snprintf(why, why_size, "never content");
    return FAULT == REFUSES;
}

static double push(const struct faulty *p, const struct calx_contacts *b, size_t c)
{
    double f = p->stiffness * b->overlap[c];
    if (FAULT == PIECES)
        f *= 1 + 1e-15 * (double)b->n;
    if (FAULT == ORDER)
        f *= 1 + 1e-15 * (double)c;
    if (FAULT == PADDING)
        f *= 1 + b->overlap[calx_padded(b->n) - 1];
    if (FAULT == UNDECLARED)
        f *= b->temperature[0][c] / 300;
    if (FAULT == INFINITE)
        f /= 1 - p->stiffness / 1e15;
    if (FAULT == DIRECTION)
        f *= 1 + 0.1 * b->normal[0][c];
    return f;
}

static void force(const void *params, const struct calx_contacts *b)
{
    const struct faulty *p = params;
    double *old = b->history[0];
    for (size_t c = 0; c < b->n; c++) {
        int touch = b->overlap[c] > (FAULT == APART ? -1e-5 : 0);
        double lost = touch ? (FAULT == GAIN ? 1 : -1) * p->damping * b->vn[c] : 0;
        b->fn[c] += (touch ? push(p, b, c) : 0) + lost;
        b->work[c] -= (FAULT == BOOKS ? lost : 0.5 * (old[c] + lost)) * b->vn[c] * b->dt;
        b->work[c] += FAULT == IDLE_WORK ? 1e-9 : 0;
        old[c] = FAULT == LEFT && !touch ? old[c] : lost;
    }
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct faulty *p = params;
    for (size_t c = 0; c < b->n; c++) {
        if (b->overlap[c] <= 0)
            continue;
        r->energy[c] +=
            (FAULT == ENERGY ? 0.4 : 0.5) * p->stiffness * b->overlap[c] * b->overlap[c];
        r->stiffness[0][c] += (FAULT == STIFFNESS ? 1.1 : 1) * p->stiffness;
        r->damping[0][c] += (FAULT == DAMPING ? 0.9 : 1) * p->damping;
    }
}

static const char *const history[] = {"force"};

static const struct calx_contact_law law = {.provides = CALX_NORMAL,
                                            .demand = {.needs = FAULT == VELOCITY ? 0 : CALX_USES_VELOCITY,
                                                       .history_scalars = 1},
                                            .history = history,
                                            .prepare = prepare,
                                            .force = force,
                                            .response = response};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_CONTACT,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "fn = k d - c vn",
                                                    .parameter_count = 2,
                                                    .parameters = parameters,
                                                    .params_size = sizeof(struct faulty),
                                                    .law = &law};

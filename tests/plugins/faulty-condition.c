/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A non-smooth law that is right for FAULT NONE and breaks one rule of the contract for each other.
 * For tests only.
 */
#include "core/plugin.h"

enum { NONE, RANGE, ONE_SIDED, BEYOND, NOTHING, VELOCITY, PIECES, INFINITE };

struct faulty {
    double pull[2], reach;
};

static const struct calx_parameter parameters[] = {
    {.name = "pull",
     .symbol = "f",
     .unit = "N",
     .doc = "Pull.",
     .initial = 1,
     .min = 0,
     .max = 1e6,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct faulty, pull)},
    {.name = "reach",
     .symbol = "d",
     .unit = "m",
     .doc = "Its reach.",
     .initial = 1e-3,
     .min = 0,
     .max = 1,
     .scope = CALX_PAIR,
     .offset = offsetof(struct faulty, reach)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand, char *why, size_t why_size)
{
    const struct faulty *p = params;
    (void)setup, (void)why, (void)why_size;
    demand->gap = FAULT == BEYOND ? 0.5 * p->reach : p->reach;
    return 0;
}

static void condition(const void *params, const struct calx_contacts *b, const struct calx_condition *c)
{
    const struct faulty *p = params;
    for (size_t k = 0; k < b->n; k++) {
        double pull = p->pull[0] * (FAULT == ONE_SIDED ? 1 : p->pull[1]);
        c->pull[k] += FAULT == NOTHING ? 0 : pull;
        c->reach[k] = p->reach;
        c->restitution[k] = FAULT == RANGE ? 1.5 : 0.5;
        c->friction[k] = FAULT == VELOCITY ? b->vn[k] : FAULT == PIECES ? 1 + 1e-15 * (double)b->n : 1;
        if (FAULT == INFINITE)
            c->friction[k] /= p->reach;
    }
}

static const struct calx_contact_law law = {.provides = CALX_NORMAL | CALX_COHESION,
                                            .nonsmooth = 1,
                                            .prepare = prepare,
                                            .condition = condition};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_CONTACT,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "r_n >= -f_i f_j",
                                                    .parameter_count = 2,
                                                    .parameters = parameters,
                                                    .params_size = sizeof(struct faulty),
                                                    .law = &law};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "cohesive": bodies attract each other with a constant pull gamma as long as the gap between them is at most d_w. With
 * Signorini's law that makes three states: apart (gap > d_w), pulled (-gamma <= r_n < 0), pressed (r_n >= 0, no gap); friction is limited by
 * mu (r_n + gamma). Reference: Renouf et al.
 */
#include "core/plugin.h"

struct cohesive {
    double pull, reach; /* from the table */
};

static const struct calx_parameter parameters[] = {
    {.name = "pull",
     .symbol = "gamma",
     .unit = "N",
     .doc = "Force with which bodies attract each other.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct cohesive, pull)},
    {.name = "distance",
     .symbol = "d_w",
     .unit = "m",
     .doc = "Largest gap at which they do.",
     .min = 0,
     .max = 1e3,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct cohesive, reach)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand, char *why, size_t why_size)
{
    const struct cohesive *p = params;
    (void)setup, (void)why, (void)why_size;
    demand->gap = p->reach;
    return 0;
}

static void condition(const void *params, const struct calx_contacts *b, const struct calx_condition *c)
{
    const struct cohesive *p = params;
    for (size_t k = 0; k < calx_padded(b->n); k++) {
        c->pull[k] += p->pull;
        c->reach[k] = p->reach;
    }
}

static const struct calx_contact_law law = {
    .provides = CALX_COHESION,
    .depends = CALX_NORMAL,
    .nonsmooth = 1,
    .prepare = prepare,
    .condition = condition,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "cohesive",
    .summary = "constant pull up to a gap (non-smooth)",
    .reference = "Renouf et al.: a Signorini law, and the same shifted by gamma",
    .equation = "r_n >= -gamma h while gap <= d_w;  |r_t| <= mu (r_n + gamma h)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct cohesive),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "signorini-coulomb": rigid bodies do not pass through each other and do not attract; friction holds up to mu times the normal
 * impulse; an impact sends them back with the share e of their speed. Reference: Moreau, in Nonsmooth Mechanics and Applications (1988).
 */
#include "core/plugin.h"

struct signorini {
    double restitution, friction, turning; /* from the table */
};

static const struct calx_parameter parameters[] = {
    {.name = "friction",
     .symbol = "mu",
     .unit = "1",
     .doc = "Friction coefficient.",
     .min = 0,
     .max = 1e3,
     .scope = CALX_PAIR,
     .offset = offsetof(struct signorini, friction)},
    {.name = "restitution",
     .symbol = "e",
     .unit = "1",
     .doc = "Newton's coefficient of restitution: the speed after an impact over that before.",
     .min = 0,
     .max = 1,
     .scope = CALX_PAIR,
     .offset = offsetof(struct signorini, restitution)},
    {.name = "turning",
     .symbol = "turning",
     .unit = "1",
     .doc = "Whether friction turns the bodies; if not they slide like blocks.",
     .initial = 1,
     .max = 1,
     .flags = CALX_SWITCH,
     .offset = offsetof(struct signorini, turning)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand, char *why, size_t why_size)
{
    const struct signorini *p = params;
    (void)setup, (void)why, (void)why_size;
    demand->needs = p->friction > 0 ? CALX_NEEDS_TANGENT | (p->turning > 0 ? CALX_NEEDS_ROTATION : 0) : 0;
    return 0;
}

static void condition(const void *params, const struct calx_contacts *b, const struct calx_condition *c)
{
    const struct signorini *p = params;
    for (size_t k = 0; k < calx_padded(b->n); k++) {
        c->friction[k] = p->friction;
        c->restitution[k] = p->restitution;
    }
}

static const struct calx_contact_law law = {
    .provides = CALX_NORMAL | CALX_TANGENTIAL,
    .nonsmooth = 1,
    .demand = {.needs = CALX_NEEDS_TANGENT | CALX_NEEDS_ROTATION},
    .prepare = prepare,
    .condition = condition,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "signorini-coulomb",
    .summary = "rigid contact with friction and restitution (non-smooth)",
    .reference = "Moreau, in Nonsmooth Mechanics and Applications, CISM 302 (1988)",
    .equation = "0 <= r_n, u_n+ + e u_n- >= 0, r_n (u_n+ + e u_n-) = 0;\n"
                "|r_t| <= mu r_n, and r_t = -mu r_n u_t+/|u_t+| where u_t+ is not 0",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct signorini),
    .law = &law,
};

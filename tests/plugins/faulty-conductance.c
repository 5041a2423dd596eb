/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A conductance that is right for FAULT NONE and breaks one rule of the contract for each other.
 * For tests only.
 */
#include <math.h>

#include "core/plugin.h"

enum { NONE, APART, NEGATIVE, NOTHING, ONE_SIDED, UNDECLARED, INFINITE };

struct faulty {
    double conductivity[2];
};

static const struct calx_parameter parameters[] = {
    {.name = "conductivity",
     .symbol = "k",
     .unit = "W/(m K)",
     .doc = "Conductivity.",
     .min = 0,
     .max = 1e6,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct faulty, conductivity)},
};

static void conductance(const void *params, const struct calx_contacts *b, double *h)
{
    const struct faulty *p = params;
    for (size_t c = 0; c < b->n; c++) {
        double k =
            FAULT == ONE_SIDED ? p->conductivity[0] : calx_pair_conductivity(p->conductivity);
        double d = b->overlap[c] > 0 ? b->overlap[c] : 0;
        h[c] = 2 * k * sqrt(FAULT == APART ? fabs(b->overlap[c]) : d);
        h[c] *= FAULT == NEGATIVE ? -1 : FAULT == NOTHING ? 0 : 1;
        if (FAULT == UNDECLARED)
            h[c] *= b->fn[c];
        if (FAULT == INFINITE)
            h[c] /= p->conductivity[0];
    }
}

static const struct calx_conductance_law law = {.conductance = conductance};

CALX_EXPORT const struct calx_plugin calx_plugin = {CALX_DESCRIPTOR_PREFIX,
                                                    .kind = CALX_CONDUCTANCE,
                                                    .name = "faulty",
                                                    .summary = "for tests",
                                                    .reference = "none",
                                                    .equation = "H = 2 k sqrt(d)",
                                                    .parameter_count = 1,
                                                    .parameters = parameters,
                                                    .params_size = sizeof(struct faulty),
                                                    .law = &law};

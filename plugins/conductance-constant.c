/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Conductance "constant": the same H for every contact of two materials, while they touch.
 * For tests against closed forms (a chain of equal conductances) and for contacts whose H was
 * measured. Reference: definition; Carslaw and Jaeger, Conduction of Heat in Solids (1959).
 */
#include "core/plugin.h"

struct constant {
    double conductance;
};

static const struct calx_parameter parameters[] = {
    {.name = "conductance",
     .symbol = "H",
     .unit = "W/K",
     .doc = "Conductance of a contact.",
     .min = 0,
     .max = 1e12,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct constant, conductance)},
};

CALX_KERNEL static void conduct(size_t n, double value, const double *restrict overlap,
                                double *restrict conductance)
{
    for (size_t c = 0; c < n; c++)
        conductance[c] = overlap[c] > 0 ? value : 0;
}

static void conductance(const void *params, const struct calx_contacts *b, double *h)
{
    const struct constant *p = params;
    conduct(calx_padded(b->n), p->conductance, b->overlap, h);
}

static const struct calx_conductance_law law = {.conductance = conductance};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONDUCTANCE,
    .name = "constant",
    .summary = "a given conductance while in touch",
    .reference = "Carslaw and Jaeger, Conduction of Heat in Solids (1959)",
    .equation = "H = H",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct constant),
    .law = &law,
};

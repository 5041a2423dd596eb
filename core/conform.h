/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The conformance suite: runs a plugin of any kind on its own, without an engine, and measures
 * whether it keeps the contract of core/plugin.h. `calx plugins --check FILE.so` prints it; the
 * tests run it on every plugin.
 */
#ifndef CALX_CONFORM_H
#define CALX_CONFORM_H

#include <stdbool.h>
#include <stddef.h>

#include "core/error.h"
#include "core/plugin.h"

/* One check: the worst figure that any choice of parameters gave, and the bound it must not exceed.
 */
struct calx_check {
    const char *name; /* what must hold */
    double figure, bound;
    bool passed;
    char where[256]; /* the choice of parameters of the worst figure, or why a check could not be
                        made */
};

enum { CALX_CHECKS_MAX = 32 };

struct calx_conformance {
    size_t count, failed;
    struct calx_check checks[CALX_CHECKS_MAX];
};

/* Runs every check that applies to the plugin, which must have passed the loader. Fills *report.
 * Returns 0, also when checks fail (report->failed), or CALX_ERROR_INPUT for a kind without a
 * suite. */
int calx_conform_run(const struct calx_plugin *, struct calx_conformance *report,
                     struct calx_error *);

#endif

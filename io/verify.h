/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Expectations: what a case says must come out, followed during the run and judged at its end.
 */
#ifndef CALX_IO_VERIFY_H
#define CALX_IO_VERIFY_H

#include <stdio.h>

#include "core/measure.h"

struct calx_verify;

/* The expectations of a scene, which must outlive the result. NULL with an error: memory, or an
 * unknown quantity (its place). */
struct calx_verify *calx_verify_create(const struct calx_scene *, struct calx_error *);
void calx_verify_free(struct calx_verify *);

/* Whether an expectation asks for the state at a time within (before, now], s. */
bool calx_verify_is_due(const struct calx_verify *, double before, double now);

/* Takes the present state into account; `before`: the time before the step that led here, s (now at
 * the start); `stage`: the stage which that step belonged to. */
void calx_verify_record(struct calx_verify *, struct calx_sim *, double before, int stage);

/* What one expectation came to. */
struct calx_verdict {
    const struct calx_expect *expect;
    double expected, got, error, tolerance; /* expected: NaN for a bound; tolerance: NaN likewise */
    double time; /* s, of the state judged; for `always` the worst; NaN if none was reached */
    bool passed;
};
size_t calx_verify_count(const struct calx_verify *);
struct calx_verdict calx_verify_verdict(const struct calx_verify *, size_t);
size_t calx_verify_failures(const struct calx_verify *);

/* A table with a header line, and one row per expectation; `name` is that of the case. */
void calx_verify_print_header(FILE *);
void calx_verify_print(const struct calx_verify *, const char *name, FILE *);

/* What has been followed so far, for the restart file: plain bytes, owned by the struct. restore:
 * CALX_ERROR_INPUT if the number of expectations differs. */
struct calx_block calx_verify_save(const struct calx_verify *);
int calx_verify_restore(struct calx_verify *, const struct calx_block *, struct calx_error *);

#endif

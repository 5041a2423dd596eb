/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx report`: error against run time of a case, over integrators and time steps, and the verdict
 * which of them to use.
 */
#ifndef CALX_IO_REPORT_H
#define CALX_IO_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "core/error.h"
#include "io/case.h"

/* What is asked. Strings may be NULL: not given. */
struct calx_report_options {
    const char *case_path;   /* a case file, or a folder that holds case.xml */
    const char *out;         /* folder; NULL: results/NAME-report */
    const char *integrators; /* names with commas between; NULL: all there are */
    const char *steps;       /* "1e-6..1e-4", s: of motion, or of heat where nothing moves */
    const char *heat_steps;  /* "1e-4..1e-2", s: the heat step beside the step of motion */
    const char *soften;      /* "10,100": contacts softer by these factors as well */
    const char *tolerances;  /* "1e-10..1e-4": of the solvers, as well */
    const char *points;      /* CSV file with points of other codes; NULL */
    const char *quantities;  /* names with commas between */
    double target;           /* the relative error to live with */
    double budget;           /* s of the clock */
    int seeds;               /* replicas where statistics decide; 0: as many as fit */
    int again;               /* seeds with which verdicts are measured again; 0: none */
    int threads;             /* 0: all cores */
    bool stability, json;
    FILE *progress; /* NULL: silent */
    const struct calx_setting *settings;
    size_t setting_count;
};

/* Makes the report and writes its files; with `json` the report as one object to stdout, else its
 * verdict. CALX_ERROR_INPUT (options, case), CALX_ERROR_IO, CALX_ERROR_MEMORY, CALX_ERROR_PHYSICS if
 * not even the reference came to its end. Mistakes of the case go to stderr. */
int calx_report_make(const struct calx_report_options *, struct calx_error *);

#endif

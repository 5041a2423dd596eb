/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One run of one case: joins the engine with its output. The subcommands of the program are built
 * from it.
 */
#ifndef CALX_IO_RUN_H
#define CALX_IO_RUN_H

#include <signal.h>

#include "core/calx.h"
#include "io/case.h"
#include "io/profiles.h"
#include "io/series.h"
#include "io/slabs.h"
#include "io/table.h"
#include "io/terminal.h"
#include "io/verify.h"

struct calx_run_options {
    const char *case_path; /* a case file, or a folder that holds case.xml */
    const char *out;       /* folder; NULL: results/NAME */
    bool files;            /* write output */
    bool resume;
    bool force;     /* steps that are too long are taken all the same */
    int threads;    /* 0: all cores */
    FILE *progress; /* NULL: silent */
    const struct calx_setting *settings;
    size_t setting_count;
    const volatile sig_atomic_t *stop; /* becomes not 0 when the run shall stop; may be NULL */
};

/* A case opened; the fields are for reading. */
struct calx_run {
    struct calx_run_options options;
    char *file, *name, *folder, *restart_path; /* case file; its short name; output */
    struct calx_registry *registry;
    struct calx_problems problems;
    struct calx_scene *scene;
    struct calx_sim *sim;
    struct calx_verify *verify;
    struct calx_terminal terminal;
    struct calx_series *series;
    struct calx_table *table;
    struct calx_profiles *profiles;
    struct calx_slab_files *slabs;
    size_t column_count; /* of the CSV: standard columns, then the probes of the scene */
    const struct calx_probe **columns;
    struct calx_probe *standard;
    double *row;
    uint64_t case_hash;
    double last_sync; /* s, of the monotonic clock; 0 before the first frame */
    double scheduled_frame,
        scheduled_row; /* s: last frame and row that were due, not forced by an interruption */
    double began;      /* s of the clock */
    int64_t first_step;
    size_t rows, frames; /* written in this run */
    bool interrupted;
};

/* Reads the case and makes the simulation; all mistakes of the case go to `messages`. The run is to
 * be closed in any case. CALX_ERROR_INPUT, or what the engine says. */
int calx_run_open(struct calx_run *, const struct calx_run_options *, FILE *messages,
                  struct calx_error *);

/* Runs to the end or until stopped, writing frames, records and restart points. CALX_ERROR_PHYSICS:
 * the frames and the restart point from before are kept and the broken state is in NAME_failed.vtu;
 * CALX_ERROR_IO, CALX_ERROR_MEMORY. */
int calx_run_go(struct calx_run *, struct calx_error *);

/* Wall time, speed, balance, files, state hash. */
void calx_run_print_summary(const struct calx_run *, FILE *);

void calx_run_close(struct calx_run *);

#endif

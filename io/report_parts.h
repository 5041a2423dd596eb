/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files of the report (io/report*.c) share; nobody else includes it. Data flows one way:
 * options -> study (case, candidates, quantities) -> plan (list of runs) -> runs (kept in a store) ->
 * analysis (errors, orders, verdict) -> csv, page, picture, JSON.
 */
#ifndef CALX_IO_REPORT_PARTS_H
#define CALX_IO_REPORT_PARTS_H

#include "core/measure.h"
#include "io/report.h"
#include "io/run.h"

enum {
    CALX_REPORT_QUANTITIES = 16, /* most in one report */
    CALX_REPORT_BODIES = 48,     /* most whose paths are compared */
    CALX_REPORT_SAMPLES = 64,    /* most instants at which runs are compared */
    CALX_REPORT_RANGE = 4,       /* most entries of --soften */
    CALX_REPORT_VALUES = 8       /* most parameters of one choice of --integrators */
};

/* ---- what is compared (report_quantity.c) ---- */

enum calx_report_form { CALX_REPORT_NUMBER, CALX_REPORT_PATHS, CALX_REPORT_TEMPERATURES };

struct calx_report_quantity {
    char name[64], unit[32];
    enum calx_report_form form;
    struct calx_probe probe;         /* of a number */
    const struct calx_exact *exact;  /* NULL: none known */
    size_t first, width;             /* its numbers in a sample */
};

/* ---- an integrator with its parameters (report_study.c) ---- */

struct calx_report_candidate {
    const struct calx_plugin *plugin;
    char name[128];       /* as it is shown: the plugin's, with the parameters that were asked for */
    size_t value_count;
    struct calx_value values[CALX_REPORT_VALUES]; /* other than the case's */
    bool own;             /* the case's */
    double critical;      /* s, the limit that calx estimates for it; infinite if there is none */
    bool unsafe;          /* calx runs it at no step, unless forced */
    double evaluations;   /* of forces per step, measured */
    double cost, spread;  /* s per evaluation: median over runs; half the interquartile range over it */
    char refused[256];    /* why it does not fit this case; "" if it does */
};

/* ---- one run (report_run.c) ---- */

enum calx_report_status {
    CALX_REPORT_GOOD,     /* came to its end */
    CALX_REPORT_UNSTABLE, /* a guard stopped it, or numbers that are none */
    CALX_REPORT_REFUSED   /* calx would not start it */
};

/* What to run. Equal recipes give equal numbers, bit for bit. */
struct calx_report_recipe {
    int candidate;
    double dt, heat_dt;        /* s; heat_dt 0: as the case says */
    double tolerance;          /* of the solvers that have one; 0: as the case says */
    double stiffness, damping; /* factors on the case's */
    double perturb;            /* starts are moved by this share of the radius, at random */
    int draw;                  /* of random numbers */
    bool forced;               /* even above the stability limit */
    double window;             /* s of the run that count */
    int samples;               /* instants */
};

struct calx_report_run {
    struct calx_report_recipe recipe;
    enum calx_report_status status;
    char why[256];
    int64_t steps, evaluations;
    double seconds; /* of the step loop without samples: the clock's, or processor time per thread if others had the machine */
    double wall, setup; /* s of the clock: of the step loop; to build the simulation */
    double reached;        /* s of the run */
    double residual;       /* worst relative imbalance of mechanical energy seen */
    double gain;           /* worst relative energy from nothing seen (>= 0) */
    double coldest, hottest; /* K, extremes seen; NaN without temperature */
    size_t count, width;   /* samples taken, numbers in each */
    double *times, *values;
};

/* ---- the study ---- */

enum calx_report_reference {
    CALX_REPORT_EXACT,     /* all quantities have solutions */
    CALX_REPORT_CONVERGED, /* the tightest steps, extrapolated */
    CALX_REPORT_STATISTICS /* chaotic: means over seeds */
};

struct calx_report_study {
    const struct calx_report_options *options;
    struct calx_run run;      /* the case as it stands; its scene is that of draw 0 */
    char *folder;
    size_t scene_count;       /* scenes of draws, read when needed */
    struct calx_scene **scenes;
    bool random;             /* draws differ; if not, starts are perturbed instead */
    enum calx_kind axis;     /* CALX_MOTION, or CALX_TEMPERATURE where nothing moves */
    bool temperature;
    size_t particles;
    double radius;           /* m, mean */
    double drawing;          /* s of the clock that another draw takes */
    double duration;         /* s of the whole case; infinite if a condition alone ends it */
    double common;           /* s: a step that divides this ends all stages on time; 0: there is none */
    double own_dt, own_heat_dt; /* s, of the case; NaN if it has none that works */
    int own;                 /* candidate of the case, or -1 */
    char adaptive[128];      /* names, with commas between, of integrators that are taken only if asked for; "" */
    size_t candidate_count;
    struct calx_report_candidate *candidates;
    size_t quantity_count, width;
    struct calx_report_quantity quantities[CALX_REPORT_QUANTITIES];
    size_t body_count;       /* whose paths are kept */
    size_t bodies[CALX_REPORT_BODIES];
    double low, high;        /* s, of --steps; NaN */
    double heat_low, heat_high;
    double tight, loose;     /* of --tolerances; NaN */
    size_t soften_count;
    double soften[CALX_REPORT_RANGE];
    uint64_t fingerprint;    /* of case, options and plugins */
};

/* report_study.c. The study is to be cleared in any case. */
int calx_report_study_open(struct calx_report_study *, const struct calx_report_options *,
                           struct calx_error *);
void calx_report_study_clear(struct calx_report_study *);
/* The scene of a draw, read once; NULL with an error. */
const struct calx_scene *calx_report_study_scene(struct calx_report_study *, int draw,
                                                 struct calx_error *);

/* The largest step that calx would take for the recipe; infinite if nothing limits it; *why: the integrator does not fit. */
int calx_report_limit(struct calx_report_study *, const struct calx_report_recipe *, double *limit, char *why,
                      size_t size, struct calx_error *);

/* report_options.c */
int calx_report_options_read(struct calx_report_study *, struct calx_error *);
/* The next word of a list with commas; false at its end. */
bool calx_report_options_word(const char **list, char *word, size_t size);

/* report_choice.c: one choice of --integrators. CALX_ERROR_INPUT says what was expected. */
int calx_report_choice_read(const struct calx_report_study *, const char *text, struct calx_report_candidate *, struct calx_error *);
/* Whether it is what the model (or NULL) says. */
bool calx_report_choice_is(const struct calx_report_candidate *, const struct calx_model *);

/* report_quantity.c: chooses what is compared. statistics: only what has a meaning when paths are lost. */
int calx_report_quantities_choose(struct calx_report_study *, bool statistics, struct calx_error *);
/* Writes the numbers of one sample: study->width of them. */
void calx_report_quantities_paths(struct calx_report_study *); /* paths alone */
void calx_report_quantities_sample(const struct calx_report_study *, struct calx_sim *, double *);

/* report_variant.c: a copy of the scene with the recipe's changes; shares what it does not change with the
 * original, which must outlive it. NULL without memory. */
struct calx_scene *calx_report_variant_create(const struct calx_report_study *,
                                              const struct calx_scene *,
                                              const struct calx_report_recipe *);
void calx_report_variant_free(struct calx_scene *);

/* Whether a solver that the recipe's candidate runs with, of motion or temperature, has a tolerance. */
bool calx_report_variant_has_tolerance(const struct calx_report_study *, int candidate);

/* report_fingerprint.c */
int calx_report_fingerprint(struct calx_report_study *, struct calx_error *);
uint64_t calx_report_hash(uint64_t hash, const void *, size_t bytes); /* FNV-1a; starts with any number */

/* report_run.c: CALX_OK also for runs that were refused or became unstable. CALX_ERROR_MEMORY;
 * CALX_ERROR_INPUT if `deadline` (s of the clock) passed before the end. */
int calx_report_run_go(struct calx_report_study *, const struct calx_report_recipe *,
                       double deadline, struct calx_report_run *, struct calx_error *);
void calx_report_run_clear(struct calx_report_run *);

/* ---- the store (report_store.c): runs on disk, one after the other ---- */

struct calx_report_store {
    int file;
    size_t count;
    struct calx_report_run *runs;
    size_t found; /* of an earlier, interrupted report */
    size_t note_count;
    struct calx_report_note { char key[32]; double values[8]; } *notes; /* what was decided, and must not be decided again */
};

/* Opens FOLDER/report.runs; what another case, other options or another calx left there is dropped. */
int calx_report_store_open(struct calx_report_store *, const struct calx_report_study *,
                           struct calx_error *);
void calx_report_store_close(struct calx_report_store *);
/* The run of that recipe with so many numbers in a sample, or NULL; valid until the next run is added. */
const struct calx_report_run *calx_report_store_find(const struct calx_report_store *,
                                                     const struct calx_report_recipe *, size_t width);
/* Takes the run, arrays and all. */
int calx_report_store_add(struct calx_report_store *, struct calx_report_run *,
                          struct calx_error *);
/* A decision: NULL if it was not taken yet. */
const double *calx_report_store_noted(const struct calx_report_store *, const char *key);
int calx_report_store_note(struct calx_report_store *, const char *key, const double values[8],
                           struct calx_error *);

/* ---- progress (report_progress.c) ---- */

struct calx_report_progress {
    FILE *file;
    bool live, drawn;
    double begin, last; /* s of the clock */
    double spent, all;  /* s of work: measured so far, estimated in all; 0: not known yet */
    size_t runs;        /* made */
};
void calx_report_progress_begin(struct calx_report_progress *, FILE *);
void calx_report_progress_update(struct calx_report_progress *, const char *what, double dt);
void calx_report_progress_say(struct calx_report_progress *, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void calx_report_progress_end(struct calx_report_progress *);

/* ---- the plan (report_plan.c, report_fit.c) ---- */

/* A point of the diagram: one integrator with one step, run `count` times with slightly different steps or other seeds. */
struct calx_report_point {
    int candidate;
    double dt, heat_dt, tolerance, stiffness;
    size_t first, count; /* in plan->recipes */
};

struct calx_report_plan {
    enum calx_report_reference reference;
    double window, decorrelation; /* s; decorrelation: infinite if it was not seen, NaN if not looked for */
    double growth;                /* of a perturbation, up to the window's end or to decorrelation */
    double grain;                 /* s that steps must divide; 0: any step */
    int samples, replicas;
    double ratio;                 /* of neighbouring steps */
    double evaluations, seconds;  /* that it takes, estimated */
    size_t point_count, recipe_count, reference_count;
    struct calx_report_point *points;
    struct calx_report_recipe *recipes;    /* of the points */
    struct calx_report_recipe *references; /* coarse to fine; with statistics one per seed */
};

/* A point that another code has measured (report_points.c). */
struct calx_report_peer {
    char name[64];
    size_t quantity;
    double dt, error, seconds, evaluations; /* the last two NaN if not given */
};

/* The whole at work. */
struct calx_report_job {
    struct calx_report_study study;
    struct calx_report_store store;
    struct calx_report_plan plan;
    struct calx_report_progress progress;
    double cost, setup; /* s per evaluation and per simulation, of the trial */
    double begin;       /* s of the clock */
    double before;      /* s that an interrupted report has spent already */
    size_t skipped;     /* runs that the budget did not allow */
    bool beyond;        /* the budget: runs are made whatever it says */
    size_t peer_count;
    struct calx_report_peer *peers;
};

/* report_points.c: reads --points, once the quantities are chosen. CALX_ERROR_INPUT names file, line and what was expected. */
int calx_report_points_read(struct calx_report_job *, struct calx_error *);
/* The peers of one name and quantity, one after the other: the index of the next peer that begins a curve, from `from` on; peer_count: none. */
size_t calx_report_points_curve(const struct calx_report_job *, size_t quantity, size_t from);

/* report_fit.c: the recipe of one seed of a point, or of one of its runs with steps that differ slightly. */
struct calx_report_recipe calx_report_replica(const struct calx_report_job *, const struct calx_report_point *, int replica);

/* report_job.c: runs the recipe unless the store has it. *run is NULL if there was no time left for it. */
int calx_report_job_run(struct calx_report_job *, const struct calx_report_recipe *,
                        const struct calx_report_run **run, struct calx_error *);
double calx_report_job_left(const struct calx_report_job *); /* s of the budget */
double calx_report_job_seconds(const struct calx_report_job *, const struct calx_report_recipe *); /* estimate */

/* report_plan.c: trial, window, reference; then points that fit. */
int calx_report_plan_make(struct calx_report_job *, struct calx_error *);
void calx_report_plan_clear(struct calx_report_plan *);
/* report_fit.c: chooses ladder, replicas and window for what is left of the budget. */
int calx_report_fit(struct calx_report_job *, struct calx_error *);
/* report_chaos.c: whether two starts that hardly differ stay together. */
int calx_report_chaos(struct calx_report_job *, struct calx_error *);

/* ---- stability (report_stability.c, report_stability_out.c) ---- */

enum { CALX_REPORT_LADDER = 11 }; /* steps, from 1/16 of the limit to twice, by the square root of 2 */

/* What holds at one step; bits. */
enum calx_report_holds { CALX_REPORT_BOUNDS = 1, CALX_REPORT_ENERGY = 2, CALX_REPORT_ORDER = 4, CALX_REPORT_SEEN = 8 };

/* One integrator with one stiffness and one damping. */
struct calx_report_sweep {
    int candidate;
    double stiffness, damping, limit; /* factors; s */
    double share[CALX_REPORT_LADDER]; /* of the limit: the steps that were made */
    unsigned holds[CALX_REPORT_LADDER];
    double error[CALX_REPORT_LADDER], residual[CALX_REPORT_LADDER], order[CALX_REPORT_LADDER];
    char why[256]; /* why not even the finest step came to its end */
};

/* Sweeps, then writes stability.md, .csv, .svg, .png. */
int calx_report_stability(struct calx_report_job *, struct calx_error *);
int calx_report_write_stability(const struct calx_report_job *, const struct calx_report_sweep *, size_t count,
                                struct calx_error *);
/* The largest share of the limit up to which it holds without a gap; 0 if nowhere. */
double calx_report_holds_to(const struct calx_report_sweep *, unsigned what);
int calx_report_cost(struct calx_report_job *, struct calx_error *); /* report_plan.c: the trial alone */

/* ---- analysis ---- */

/* What one quantity came to at one point. */
struct calx_report_error {
    double error;      /* relative: of the quantity's scale; NaN if there is none */
    double confidence; /* half width of the 95 % interval of `error` (statistics) or the scatter over replicas */
};

/* What a point came to. */
struct calx_report_result {
    const struct calx_report_point *point;
    enum calx_report_status status; /* the worst of its runs */
    char why[256];
    size_t runs;                    /* that came to their end */
    double steps, evaluations;      /* means over its runs, of the window */
    double measured, spread;        /* s of the step loop: median over its runs; half the interquartile range */
    double seconds;                 /* evaluations times the integrator's cost */
    double residual;
    struct calx_report_error errors[CALX_REPORT_QUANTITIES];
    bool front[CALX_REPORT_QUANTITIES]; /* on the Pareto front */
};

/* What holds for one integrator and quantity. */
struct calx_report_curve {
    double order, order_error; /* of the fit; NaN if there are too few points */
    size_t fitted;
};

struct calx_report_scale {
    double scale;      /* that errors are relative to, in the unit of the quantity */
    bool absolute;     /* nothing to be relative to: errors are in the unit */
    bool still;        /* it does not change at all, and no solution says that it should not: no error means anything */
    double floor;      /* relative uncertainty of the reference */
    double order;      /* of the reference's extrapolation; NaN */
};

/* The verdict on one quantity. */
struct calx_report_verdict {
    const struct calx_report_result *best, *own; /* cheapest within the target; cheapest with the case's integrator */
    double target;     /* that asked for, or the least that can be promised if that is more */
    double whole;      /* s of the clock for the whole case with the best; NaN if it has no end */
    double own_factor; /* how much finer the case's step is than `own`'s; below 1: too coarse; NaN */
    double reached;    /* the smallest error of all points */
    size_t equals;     /* others that cost the same within the scatter */
};

/* A verdict measured again with other seeds. */
struct calx_report_again {
    size_t seeds;     /* 0: not done */
    double mean, confidence; /* of the difference to the reference: its size, and half the width of its 95 % interval */
    bool holds;       /* the mean is within what the verdict promised */
};

struct calx_report_analysis {
    size_t count;
    struct calx_report_result *results;
    struct calx_report_scale scales[CALX_REPORT_QUANTITIES];
    struct calx_report_curve *curves; /* candidate-major: [candidate][quantity] */
    struct calx_report_verdict verdicts[CALX_REPORT_QUANTITIES];
    size_t seeds;
    struct calx_report_again again[CALX_REPORT_QUANTITIES];
    double pooled[CALX_REPORT_QUANTITIES]; /* see calx_report_pool() */
};

/* report_analysis.c */
int calx_report_analyse(struct calx_report_job *, struct calx_report_analysis *, struct calx_error *);
void calx_report_analysis_clear(struct calx_report_analysis *);
/* report_reference.c: what errors are measured against: at sample k of a run, number by number. */
struct calx_report_truth {
    size_t samples, width;
    double *times, *values; /* of the converged reference; NULL if there is none */
    double *means; /* of the statistics: [seed][quantity]; NULL */
    size_t seeds;
};
int calx_report_truth_find(struct calx_report_job *, struct calx_report_truth *,
                           struct calx_report_analysis *, struct calx_error *);
void calx_report_truth_clear(struct calx_report_truth *);
/* report_error.c: errors of one point in all quantities. */
void calx_report_errors(const struct calx_report_job *, const struct calx_report_truth *,
                        const struct calx_report_analysis *, struct calx_report_result *);
/* The standard deviation of differences over seeds that most points have, per quantity; room for as many numbers as points. */
void calx_report_pool(const struct calx_report_job *, const struct calx_report_truth *, struct calx_report_analysis *, double *room);
double calx_report_mean_of(const struct calx_report_study *, const struct calx_report_run *, size_t quantity);
/* report_verdict.c */
void calx_report_judge(const struct calx_report_job *, struct calx_report_analysis *);
/* One of the ladder of steps: the case's stiffness, heat step and tolerance. */
bool calx_report_is_plain(const struct calx_report_point *);
/* The point of the plain ladder nearest to that step; NULL if it has none. */
const struct calx_report_result *calx_report_nearest(const struct calx_report_analysis *, int candidate, double dt);
double calx_report_upper(const struct calx_report_plan *, const struct calx_report_error *); /* what the verdict trusts */
/* report_statistics.c: median, half the interquartile range, Student's t for 95 %. Reorders its input. */
double calx_report_median(double *, size_t n);
double calx_report_scatter(double *, size_t n);
double calx_report_student(size_t degrees);
struct calx_report_weighted { double value, weight; };
double calx_report_weighted_quantile(struct calx_report_weighted *, size_t n, double share); /* reorders its input */
/* Slope of a straight line through n points with its standard error. */
double calx_report_slope(const double *x, const double *y, size_t n, double *error);

/* report_again.c: measures each verdict again with --again other seeds; beyond the budget. Does nothing where errors are not of chance. */
int calx_report_measure_again(struct calx_report_job *, const struct calx_report_analysis *, struct calx_report_again *,
                              struct calx_error *);

/* ---- output ---- */

int calx_report_write_csv(const struct calx_report_job *, const struct calx_report_analysis *, struct calx_error *);
int calx_report_write_page(const struct calx_report_job *, const struct calx_report_analysis *, bool picture,
                           struct calx_error *);
/* *drawn: false if there is no gnuplot. */
int calx_report_write_plot(const struct calx_report_job *, const struct calx_report_analysis *, bool *drawn,
                           struct calx_error *);
void calx_report_print_json(const struct calx_report_job *, const struct calx_report_analysis *, FILE *);
void calx_report_print_verdict(const struct calx_report_job *, const struct calx_report_analysis *, size_t quantity,
                               FILE *);
/* Runs gnuplot on a script in the folder, for svg and png; *drawn false if there is no gnuplot. */
int calx_report_draw(const char *folder, const char *script, bool *drawn, struct calx_error *);
/* The quantity whose verdict comes at that place: those that do not change come last. */
size_t calx_report_ranked(const struct calx_report_job *, const struct calx_report_analysis *, size_t rank);
const char *calx_report_machine(char *text, size_t size);
const char *calx_report_step(double seconds, char *text, size_t size);   /* 2.5 us */
const char *calx_report_time(double seconds, char *text, size_t size);   /* 2.5 us, 12 s, 3:07 */
const char *calx_report_percent(double error, bool absolute, const char *unit, char *text, size_t size); /* 0.12 % */
/* What a point beside the ladder of steps has other than the case, each behind `before`; "" for one of the ladder. */
const char *calx_report_beside(const struct calx_report_point *, const char *before, char *text, size_t size);
/* Copies a text; one that is too long ends with a whole word and three points. */
void calx_report_shorten(char *text, size_t size, const char *from);
/* Creates a file in the folder. */
struct calx_file;
int calx_report_create(const struct calx_report_job *, const char *name, struct calx_file *, struct calx_error *);

#endif

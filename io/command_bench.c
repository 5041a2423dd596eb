/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx bench`: how fast a case runs, and where the time goes.
 * Input: a case, or none for a bed made here; thread counts. Output: a report per thread count, or
 * JSON, one line each. Method: for each thread count the case is opened anew and warmed up; then
 * the step loop alone is timed, without output and without laps; then a shorter stretch with laps
 * tells the share of each phase. Triads tell what the memory could do.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/bandwidth.h"
#include "io/bench.h"
#include "io/commands.h"
#include "io/run.h"

static const double speed_span = 2, laps_span = 0.5; /* s, where no number of steps is given */
static const double laps_share = 0.2;                /* steps with laps per step without */
static const int64_t default_warm = 100;
/* Bytes of each of a triad's three arrays. */
static const size_t memory_array = 64 << 20, cache_array = 4 << 20;

/* ---- the made scene ---- */

/* A bed that has nearly come to rest after made_warm steps: grains packed at random, dense enough
 * that they need not fall far. */
static const int64_t made_warm = 6000;
/* clang-format off */
static const char made_case[] =
    "<case title=\"A bed of 20000 spheres\">\n"
    "  <material name=\"glass\" density=\"2500 kg/m3\"/>\n"
    "  <contact plugin=\"linear\" stiffness=\"1000 N/m\" restitution=\"0.5\"/>\n"
    "  <contact plugin=\"coulomb\" stiffness=\"285.7 N/m\" friction=\"0.5\"\n"
    "    damping-rate=\"979 1/s\"/>\n"
    "  <integrator plugin=\"velocity-verlet\" dt=\"10 us\"/>\n"
    "  <gravity>0 0 -9.81 m/s2</gravity>\n"
    "  <domain low=\"0 0 -0.01\" high=\"0.044 0.044 0.2\" periodic=\"x y\"/>\n"
    "  <walls name=\"floor\" material=\"glass\"><plane normal=\"0 0 1\"/></walls>\n"
    "  <particles material=\"glass\" seed=\"1\">\n"
    "    <pack box=\"0 0 0 0.044 0.044 0.078\" count=\"20000\" radius=\"1 mm\"/>\n"
    "  </particles>\n"
    "  <stage for=\"100 s\"/>\n"
    "</case>\n";
/* clang-format on */

/* Writes the made scene to a new temporary file; the caller removes and frees its path. NULL with
 * an error. */
static char *write_made_case(struct calx_error *error)
{
    const char *folder = getenv("TMPDIR");
    char *path = NULL;
    if (asprintf(&path, "%s/calx-bench-XXXXXX.xml", folder && *folder ? folder : "/tmp") < 0) {
        calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
        return NULL;
    }
    int file = mkstemps(path, 4);
    bool written =
        file >= 0 && write(file, made_case, sizeof made_case - 1) == (ssize_t)sizeof made_case - 1;
    if (file >= 0)
        close(file);
    if (written)
        return path;
    calx_error_set(error, CALX_ERROR_IO, "cannot write '%s'", path);
    if (file >= 0)
        unlink(path);
    free(path);
    return NULL;
}

/* ---- measuring ---- */

/* Makes `most` steps, or as many as fit into `span` seconds if most < 0. CALX_ERROR_INPUT if the
 * case ends before. */
enum { AT_ONCE = 64 }; /* steps between looks at the clock, as calx run makes them */

static int make_steps(struct calx_sim *sim, int64_t most, double span, int64_t *made,
                      double *seconds, struct calx_error *error)
{
    double begin = calx_terminal_clock(), now = begin;
    for (*made = 0; most < 0 ? now - begin < span : *made < most; ++*made) {
        if (calx_sim_done(sim))
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "the case ends after %lld steps, before all were measured: ask "
                                  "for fewer with --steps "
                                  "and --warm, or set a longer stage",
                                  (long long)calx_sim_step_count(sim));
        int64_t quiet = 0, left = most < 0 ? AT_ONCE : most - *made - 1;
        CALX_TRY(calx_sim_advance(sim, left < AT_ONCE ? left : AT_ONCE, &quiet, error));
        *made += quiet;
        CALX_TRY(calx_sim_step(sim, error));
        if (most < 0)
            now = calx_terminal_clock();
    }
    *seconds = calx_terminal_clock() - begin;
    return CALX_OK;
}

/* Bytes of this process in memory: the second number of statm, in pages. 0 where there is no such
 * file. */
static double resident_bytes(void)
{
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file) {
        if (fscanf(file, "%*u %llu", &pages) != 1)
            pages = 0;
        fclose(file);
    }
    return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

static int measure_laps(struct calx_sim *sim, const struct calx_arguments *a, struct calx_bench *b,
                        struct calx_error *error)
{
    int64_t most = a->steps > 0 ? (int64_t)ceil(laps_share * (double)a->steps) : -1, made;
    double seconds;
    if (calx_sim_timing_start(sim))
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    CALX_TRY(make_steps(sim, most, laps_span, &made, &seconds, error));
    b->timing = calx_sim_timing(sim);
    return CALX_OK;
}

static int measure_run(struct calx_run *run, const struct calx_arguments *a, int64_t warm,
                       struct calx_bench *b, struct calx_error *error)
{
    struct calx_sim *sim = run->sim;
    double seconds;
    CALX_TRY(make_steps(sim, warm, 0, &b->warm, &seconds, error));
    int64_t rebuilds = calx_sim_timing(sim).rebuilds;
    CALX_TRY(
        make_steps(sim, a->steps > 0 ? a->steps : -1, speed_span, &b->steps, &b->seconds, error));
    b->rebuilds = calx_sim_timing(sim).rebuilds - rebuilds;
    b->particles = calx_sim_particle_count(sim);
    b->hash = calx_sim_hash(sim);
    b->features = calx_sim_features(sim);
    b->resident = resident_bytes();
    CALX_TRY(measure_laps(sim, a, b, error));
    b->threads = b->timing.threads;
    return CALX_OK;
}

/* ---- the command ---- */

static void tell(struct calx_bench *b, bool json)
{
    b->memory_rate = calx_bandwidth_triad(memory_array, b->threads);
    b->cache_rate = calx_bandwidth_triad(cache_array, b->threads);
    (json ? calx_bench_print_json : calx_bench_print)(b, stdout);
    fflush(stdout);
}

static int bench_threads(const struct calx_arguments *a, const char *path, int threads)
{
    const bool made = a->operand_count == 0;
    const struct calx_run_options options = {.case_path = path,
                                             .threads = threads,
                                             .settings = a->settings,
                                             .setting_count = a->setting_count};
    struct calx_bench bench = {.name = made ? "made bed" : path};
    struct calx_run run;
    struct calx_error error;
    int code = calx_run_open(&run, &options, stderr, &error);
    if (code == CALX_OK)
        code = measure_run(&run, a,
                           a->warm >= 0 ? a->warm
                           : made       ? made_warm
                                        : default_warm,
                           &bench, &error);
    if (code == CALX_OK)
        tell(&bench, a->json); /* names of laws live as long as the run */
    int status = code == CALX_OK ? 0 : calx_options_report(&error);
    calx_run_close(&run);
    return status;
}

static int bench_case(const struct calx_arguments *a)
{
    struct calx_error error;
    char *made = a->operand_count ? NULL : write_made_case(&error);
    if (!made && !a->operand_count)
        return calx_options_report(&error);
    int status = 0;
    if (a->thread_count == 0)
        status = bench_threads(a, made ? made : a->operands[0], 0);
    for (size_t i = 0; i < a->thread_count && status == 0; i++)
        status = bench_threads(a, made ? made : a->operands[0], a->thread_list[i]);
    if (made)
        unlink(made);
    free(made);
    return status;
}

#define OPTIONS 5
static const struct calx_option *const used[OPTIONS] = {
    &calx_option_thread_list, &calx_option_steps, &calx_option_warm,
    &calx_option_json,        &calx_option_set,
};

const struct calx_command calx_command_bench = {
    "bench",
    "[CASE] [options]",
    "measure the speed, and where the time goes",
    "Times the step loop alone, then the phases over a fifth as many steps, and compares with what "
    "the memory delivers. "
    "Without CASE: a bed of 20000 spheres. The machine should be idle; `taskset -c 0` keeps one "
    "thread in place.\n\n"
    "examples:\n"
    "  calx bench --threads 1,2\n"
    "  calx bench cases/08-calciner --steps 2000 --threads 1\n"
    "  calx bench cases/08-calciner --json --set particles/pack/count=1000\n",
    OPTIONS,
    used,
    0,
    1,
    bench_case,
};

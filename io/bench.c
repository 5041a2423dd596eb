/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Tells a benchmark: for people, or as JSON.
 * Input: struct calx_bench. Output: text. Times of phases are shares of the steps with laps, which
 * cost a few per cent; they are scaled to the speed without.
 */
#include "io/bench.h"

#include <inttypes.h>
#include <math.h>

double calx_bench_speed(const struct calx_bench *b)
{
    return b->seconds > 0 ? (double)b->particles * (double)b->steps / b->seconds : 0;
}

double calx_bench_traffic(const struct calx_bench *b)
{
    const struct calx_features *f = &b->features;
    const double number = sizeof(double),
                 vector = (f->dimension + 1) * number; /* with the radius, the mass */
    double n = b->particles ? (double)b->particles : 1;
    double rows = f->motion ? 2 * 3 * vector : 0;
    if (f->rotation)
        rows += 2 * 2 * (f->dimension == 3 ? 3 : 1) * number;
    if (f->temperature)
        rows += 2 * 2 * number;
    double pairs = (double)b->timing.pairs * 2 * sizeof(int32_t);
    return rows +
           (pairs + (double)b->timing.contacts * 2 * number * (double)f->history_columns) / n;
}

static double bytes_per_particle(const struct calx_bench *b)
{
    return (double)b->timing.bytes / (b->particles ? (double)b->particles : 1);
}

static double per_particle(const struct calx_bench *b, size_t count)
{
    return (double)count / (b->particles ? (double)b->particles : 1);
}

/* Seconds of all laps, over threads. */
static double laps(const struct calx_bench *b)
{
    double sum = 0;
    for (enum calx_phase p = 0; p < CALX_PHASE_COUNT; p++)
        sum += b->timing.seconds[p];
    return sum;
}

/* ---- for people ---- */

static void print_phase(const struct calx_bench *b, const char *name, double seconds, FILE *file)
{
    double share = laps(b) > 0 ? seconds / laps(b) : 0, speed = calx_bench_speed(b);
    if (seconds > 0)
        fprintf(file, "    %-14s %5.1f %%  %7.2f ns\n", name, 100 * share,
                speed > 0 ? 1e9 * share * b->threads / speed : 0);
}

static void print_phases(const struct calx_bench *b, FILE *file)
{
    char name[64];
    fprintf(file, "  time per particle-step and thread, over %" PRId64 " steps with laps:\n",
            b->timing.steps);
    for (enum calx_phase p = 0; p < CALX_PHASE_COUNT; p++) {
        print_phase(b, calx_phase_name(p), b->timing.seconds[p], file);
        for (size_t l = 0; p == CALX_PHASE_LAWS && l < 8; l++)
            if (b->timing.law[l]) {
                snprintf(name, sizeof name, "- %.40s", b->timing.law[l]);
                print_phase(b, name, b->timing.law_seconds[l], file);
            }
    }
}

static void print_limit(const struct calx_bench *b, FILE *file)
{
    double rate = calx_bench_traffic(b) * calx_bench_speed(b);
    fprintf(file, "  moves at least %.0f bytes per particle-step, %.2f GB/s", calx_bench_traffic(b),
            1e-9 * rate);
    if (b->memory_rate > 0 && b->cache_rate > 0)
        fprintf(file, ": %.0f %% of the %.1f GB/s from memory, %.0f %% of the %.1f GB/s from cache",
                100 * rate / b->memory_rate, 1e-9 * b->memory_rate, 100 * rate / b->cache_rate,
                1e-9 * b->cache_rate);
    fputc('\n', file);
}

void calx_bench_print(const struct calx_bench *b, FILE *file)
{
    const struct calx_timing *t = &b->timing;
    fprintf(file, "%s: %zu particles, %d thread%s, %s\n", b->name, b->particles, b->threads,
            b->threads == 1 ? "" : "s", t->kernels ? t->kernels : "no kernels");
    fprintf(file,
            "  %.3f million particle-steps/s: %" PRId64 " steps in %.3f s, after %" PRId64 "\n",
            1e-6 * calx_bench_speed(b), b->steps, b->seconds, b->warm);
    print_phases(b, file);
    fprintf(file, "  %zu contacts, %.2f per particle; %.2f pairs in reach per particle\n",
            t->contacts, per_particle(b, t->contacts), per_particle(b, t->pairs));
    fprintf(file, "  %" PRId64 " rebuilds of the list, skin %.4g m\n", b->rebuilds, t->skin);
    fprintf(file, "  %.1f MB of state, %.0f bytes per particle", 1e-6 * (double)t->bytes,
            bytes_per_particle(b));
    if (b->resident > 0)
        fprintf(file, "; %.1f MB resident", 1e-6 * b->resident);
    fputc('\n', file);
    print_limit(b, file);
    fprintf(file, "  state hash: %016" PRIx64 "\n", b->hash);
}

/* ---- JSON ---- */

static void print_string(const char *text, FILE *file)
{
    fputc('"', file);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < 0x20 || *c == '"' || *c == '\\')
            fprintf(file, "\\u%04x", *c);
        else
            fputc(*c, file);
    fputc('"', file);
}

/* JSON has no infinity: the skin of a scene without a search. */
static void print_number(const char *key, double value, FILE *file)
{
    if (isfinite(value))
        fprintf(file, ", \"%s\": %.9g", key, value);
    else
        fprintf(file, ", \"%s\": null", key);
}

static void print_json_phases(const struct calx_bench *b, FILE *file)
{
    double all = laps(b) > 0 ? laps(b) : 1;
    for (enum calx_phase p = 0; p < CALX_PHASE_COUNT; p++)
        fprintf(file, "%s\"%s\": %.6g", p ? ", " : ", \"shares\": {", calx_phase_name(p),
                b->timing.seconds[p] / all);
    fputs("}, \"laws\": {", file);
    for (size_t l = 0; l < 8 && b->timing.law[l]; l++) {
        fputs(l ? ", " : "", file);
        print_string(b->timing.law[l], file);
        fprintf(file, ": %.6g", b->timing.law_seconds[l] / all);
    }
    fputc('}', file);
}

void calx_bench_print_json(const struct calx_bench *b, FILE *file)
{
    const struct calx_timing *t = &b->timing;
    fputs("{\"case\": ", file);
    print_string(b->name, file);
    fputs(", \"kernels\": ", file);
    print_string(t->kernels ? t->kernels : "", file);
    fprintf(file, ", \"hash\": \"%016" PRIx64 "\"", b->hash);
    const struct {
        const char *key;
        double value;
    } numbers[] = {
        {"threads", b->threads},
        {"particles", (double)b->particles},
        {"warm", (double)b->warm},
        {"steps", (double)b->steps},
        {"seconds", b->seconds},
        {"particle_steps_per_second", calx_bench_speed(b)},
        {"rebuilds", (double)b->rebuilds},
        {"skin", t->skin},
        {"contacts", (double)t->contacts},
        {"pairs_per_particle", per_particle(b, t->pairs)},
        {"bytes", (double)t->bytes},
        {"bytes_per_particle", bytes_per_particle(b)},
        {"resident_bytes", b->resident},
        {"bytes_moved_per_particle_step", calx_bench_traffic(b)},
        {"memory_bytes_per_second", b->memory_rate},
        {"cache_bytes_per_second", b->cache_rate},
    };
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        print_number(numbers[k].key, numbers[k].value, file);
    print_json_phases(b, file);
    fputs("}\n", file);
}

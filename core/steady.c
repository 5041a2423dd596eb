/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Watches whether signals have become stationary. Input: a quantity, or one of all layers of a profile, sampled at the multiples of an interval;
 * the length of a block of time, how many blocks make the window that is looked at, and the change that counts as none. Output: struct
 * calx_steady_view. Method: the window's block means in two halves of equal spread; their difference with its 95 % interval by Student's t has
 * to lie within that change (an equivalence test: what is too noisy to say is not called steady). All layers must pass, so that many layers
 * make no false alarm more likely; the worst is reported.
 */
#include "core/steady.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/state.h"

/* ---- statistics ---- */

/* The share of the distribution between -t and t (Abramowitz and Stegun, 26.7.4). */
static double student_share(double t, size_t freedom)
{
    double angle = atan(t / sqrt((double)freedom)), c2 = cos(angle) * cos(angle), term = 1.0, sum = 1.0;
    for (size_t k = 2; k < freedom; k += 2) {
        term *= c2 * (double)(k - 1) / (double)k;
        sum += term;
    }
    return sin(angle) * sum;
}

double calx_steady_student(size_t freedom)
{
    double low = 1.9, high = 4.4; /* of infinitely many degrees, and of two */
    while (high - low > 1e-12) {
        double middle = 0.5 * (low + high);
        *(student_share(middle, freedom) < 0.95 ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static double mean_of(const double *v, size_t n)
{
    double sum = 0.0;
    for (size_t k = 0; k < n; k++)
        sum += v[k];
    return sum / (double)n;
}

static double squares_about(const double *v, size_t n, double mean)
{
    double sum = 0.0;
    for (size_t k = 0; k < n; k++)
        sum += (v[k] - mean) * (v[k] - mean);
    return sum;
}

struct calx_steady_verdict calx_steady_judge(const double *blocks, size_t n, double within)
{
    size_t half = n / 2;
    double first = mean_of(blocks, half), second = mean_of(blocks + half, half);
    double spread = (squares_about(blocks, half, first) + squares_about(blocks + half, half, second)) / (double)(n - 2);
    double t = calx_steady_student(n - 2);
    struct calx_steady_verdict v = {.mean = 0.5 * (first + second), .error = t * sqrt(spread / (double)n), .change = second - first,
                                    .doubt = t * sqrt(2.0 * spread / (double)half)};
    v.drift = (fabs(v.change) + v.doubt) / within;
    return v;
}

/* ---- arrays: sums, then a ring of block means, of each signal of each watch ---- */

size_t calx_steady_signals(const struct calx_scene *scene, const struct calx_steady *w)
{
    return w->signal.profile >= 0 ? scene->profiles[w->signal.profile].layers : 1;
}

size_t calx_steady_numbers(const struct calx_scene *scene, size_t watches)
{
    size_t sum = 0;
    for (size_t k = 0; k < watches; k++)
        sum += calx_steady_signals(scene, &scene->steady[k]) * (1 + scene->steady[k].blocks);
    return sum;
}

int calx_steady_create(struct calx_sim *s, struct calx_error *e)
{
    size_t count = s->scene->steady_count, numbers = calx_steady_numbers(s->scene, count);
    s->steady_clocks = calx_memory_zeroed(count, sizeof *s->steady_clocks);
    s->steady_numbers = calx_memory_zeroed(numbers, sizeof *s->steady_numbers);
    if (!s->steady_clocks || !s->steady_numbers)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu block means", numbers);
    for (size_t k = 0; k < count; k++)
        s->steady_clocks[k].view = (struct calx_steady_view){.mean = NAN, .error = NAN, .change = NAN, .doubt = NAN, .drift = NAN,
                                                            .since = NAN};
    return 0;
}

/* ---- samples, blocks, windows ---- */

static void take_sample(struct calx_sim *s, const struct calx_steady *w, double *numbers)
{
    struct calx_probe probe = w->signal;
    for (size_t k = 0; k < calx_steady_signals(s->scene, w); k++) {
        if (w->signal.profile >= 0)
            probe.layer = (int64_t)k + 1;
        numbers[k * (1 + w->blocks)] += calx_sim_measure(s, &probe);
    }
}

/* Of one signal, whose ring's oldest mean is at `oldest`. A layer that nothing has been in says nothing: false. */
static bool judge(const struct calx_steady *w, const double *ring, size_t oldest, struct calx_steady_verdict *v)
{
    double blocks[CALX_STEADY_MOST];
    size_t empty = 0;
    for (size_t k = 0; k < w->blocks; k++) {
        blocks[k] = ring[(oldest + k) % w->blocks];
        empty += isnan(blocks[k]);
    }
    *v = calx_steady_judge(blocks, w->blocks, w->within);
    return w->signal.profile < 0 || empty < w->blocks;
}

/* A signal of which a part is missing is worse than any other. */
static bool worse(double drift, double than)
{
    return isnan(drift) || drift > than;
}

static void judge_window(struct calx_sim *s, const struct calx_steady *w, struct calx_steady_clock *clock, const double *numbers)
{
    double since = clock->view.since;
    bool found = false;
    for (size_t k = 0; k < calx_steady_signals(s->scene, w) && !(found && isnan(clock->view.drift)); k++) {
        struct calx_steady_verdict v;
        if (!judge(w, numbers + k * (1 + w->blocks) + 1, (size_t)clock->blocks % w->blocks, &v))
            continue;
        if (!found || worse(v.drift, clock->view.drift))
            clock->view = (struct calx_steady_view){v.mean, v.error, v.change, v.doubt, v.drift, NAN, k};
        found = true;
    }
    if (found && clock->view.drift <= 1.0)
        clock->view.since = isnan(since) ? s->time - (double)w->blocks * w->over : since;
    else
        clock->view.since = NAN;
}

static void end_block(struct calx_sim *s, const struct calx_steady *w, struct calx_steady_clock *clock, double *numbers)
{
    double samples = (double)llround(w->over / w->every);
    for (size_t k = 0; k < calx_steady_signals(s->scene, w); k++) {
        double *sum = numbers + k * (1 + w->blocks);
        sum[1 + (size_t)clock->blocks % w->blocks] = *sum / samples;
        *sum = 0.0;
    }
    clock->blocks++;
    if (clock->blocks >= (int64_t)w->blocks)
        judge_window(s, w, clock, numbers);
}

static int64_t samples_until(const struct calx_sim *s, const struct calx_steady *w, double t)
{
    return calx_profile_multiples(s, w->after, w->every, t);
}

bool calx_steady_due(const struct calx_sim *s, double t)
{
    for (size_t k = 0; k < s->scene->steady_count; k++)
        if (samples_until(s, &s->scene->steady[k], t) > s->steady_clocks[k].taken)
            return true;
    return false;
}

void calx_steady_step(struct calx_sim *s)
{
    for (size_t k = 0; k < s->scene->steady_count; k++) {
        const struct calx_steady *w = &s->scene->steady[k];
        struct calx_steady_clock *clock = &s->steady_clocks[k];
        double *numbers = s->steady_numbers + calx_steady_numbers(s->scene, k);
        for (int64_t end = samples_until(s, w, s->time); clock->taken < end;) {
            take_sample(s, w, numbers);
            if (++clock->taken % llround(w->over / w->every) == 0)
                end_block(s, w, clock, numbers);
        }
    }
}

/* As profiles do. */
void calx_steady_resume(struct calx_sim *s)
{
    for (size_t k = 0; k < s->scene->steady_count; k++)
        s->steady_clocks[k].taken = samples_until(s, &s->scene->steady[k], s->time);
}

const struct calx_steady_view *calx_sim_steady(const struct calx_sim *s, size_t watch)
{
    return &s->steady_clocks[watch].view;
}

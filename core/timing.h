/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: laps of the phases, one clock per thread; nothing but a test of a pointer while timing is off.
 */
#ifndef CALX_TIMING_H
#define CALX_TIMING_H

#include <omp.h>
#include <time.h>

#include "core/state.h"

struct calx_clock {
    uint64_t last, ticks[CALX_PHASE_COUNT], law_ticks[CALX_LAWS_MAX];
} __attribute__((aligned(128)));

static inline uint64_t calx_timing_now(void)
{
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
#endif
}

/* The clock of this thread, or NULL if timing is off. */
static inline struct calx_clock *calx_timing_clock(const struct calx_sim *s)
{
    return s->clocks ? &s->clocks[omp_get_thread_num()] : NULL;
}

/* What comes now is not the rest of what was timed before (another thread's turn, a wait). */
static inline void calx_timing_restart(struct calx_clock *c)
{
    if (c)
        c->last = calx_timing_now();
}

/* The time since the last lap was spent in `phase`. */
static inline void calx_timing_lap(struct calx_clock *c, enum calx_phase phase)
{
    if (!c)
        return;
    uint64_t now = calx_timing_now();
    c->ticks[phase] += now - c->last;
    c->last = now;
}

static inline void calx_timing_law(struct calx_clock *c, size_t law)
{
    if (!c)
        return;
    uint64_t now = calx_timing_now();
    c->law_ticks[law] += now - c->last;
    calx_timing_lap(c, CALX_PHASE_LAWS);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Where the time goes: laps of the phases, summed over threads, in seconds. Ticks are the processor's; their length comes from
 * the monotonic clock over the same span.
 */
#include "core/timing.h"

#include <stdlib.h>
#include <string.h>

const char *calx_phase_name(enum calx_phase p)
{
    static const char *const names[CALX_PHASE_COUNT] = {
        [CALX_PHASE_SORT] = "sort", [CALX_PHASE_NEIGHBOURS] = "neighbours", [CALX_PHASE_GHOSTS] = "ghosts",
        [CALX_PHASE_SELECT] = "select", [CALX_PHASE_GATHER] = "gather",
        [CALX_PHASE_LAWS] = "laws", [CALX_PHASE_CONDUCTANCE] = "conductance", [CALX_PHASE_SCATTER] = "scatter",
        [CALX_PHASE_WALLS] = "walls", [CALX_PHASE_INTEGRATE] = "integrate", [CALX_PHASE_HEAT] = "heat",
        [CALX_PHASE_OTHER] = "other"};
    return names[p];
}

static double monotonic(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int calx_sim_timing_start(struct calx_sim *s)
{
    free(s->clocks);
    s->clocks = calx_memory_zeroed((size_t)s->threads, sizeof *s->clocks);
    s->timing_from = (struct calx_timing_from){monotonic(), calx_timing_now(), s->step, s->rebuilds};
    return s->clocks == NULL;
}

struct calx_timing calx_sim_timing(const struct calx_sim *s)
{
    const struct calx_timing_from *from = &s->timing_from;
    struct calx_timing t = {.steps = s->step - from->step, .rebuilds = s->rebuilds - from->rebuilds,
                            .pairs = s->pairs.reach, .contacts = calx_sim_contact_count(s),
                            .bytes = calx_sim_features(s).bytes, .skin = s->skin, .threads = s->threads};
    double ticks = (double)(calx_timing_now() - from->tick);
    double length = ticks > 0.0 ? (monotonic() - from->seconds) / ticks : 0.0;
    calx_engine_pick(&t.kernels);
    for (size_t l = 0; l < s->plan->law_count; l++)
        t.law[l] = s->plan->laws[l].plugin->name;
    for (int k = 0; s->clocks && k < s->threads; k++) {
        for (size_t p = 0; p < CALX_PHASE_COUNT; p++)
            t.seconds[p] += length * (double)s->clocks[k].ticks[p];
        for (size_t l = 0; l < CALX_LAWS_MAX; l++)
            t.law_seconds[l] += length * (double)s->clocks[k].law_ticks[l];
    }
    return t;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * An engine without physics, for tests of what looks at a simulation: its state is what the test
 * writes into it. Included by one test file each, in place of the engine.
 */
#ifndef CALX_TESTS_FAKE_ENGINE_H
#define CALX_TESTS_FAKE_ENGINE_H

#include <stdlib.h>

#include "core/measure.h"

struct calx_sim {
    struct calx_scene *scene;
    struct calx_measure_cache cache;
    struct calx_frame frame; /* what the next frame shows; arrays belong to the test */
    struct calx_ledger ledger;
    struct calx_peak peak;
    double time;
    int64_t step;
    int stage;
    size_t contacts;
    uint8_t *classes;
    int frames_made;
};

const struct calx_scene *calx_sim_scene(const struct calx_sim *sim)
{
    return sim->scene;
}

struct calx_measure_cache *calx_sim_measure_cache(struct calx_sim *sim)
{
    return &sim->cache;
}

uint8_t *calx_sim_probe_classes(struct calx_sim *sim, size_t probe)
{
    return probe < sim->scene->probe_count ? sim->classes : NULL;
}

double calx_sim_time(const struct calx_sim *sim)
{
    return sim->time;
}

int64_t calx_sim_step_count(const struct calx_sim *sim)
{
    return sim->step;
}

int calx_sim_stage(const struct calx_sim *sim)
{
    return sim->stage;
}

size_t calx_sim_particle_count(const struct calx_sim *sim)
{
    return sim->frame.n;
}

size_t calx_sim_contact_count(const struct calx_sim *sim)
{
    return sim->contacts;
}

struct calx_ledger calx_sim_ledger(struct calx_sim *sim)
{
    return sim->ledger;
}

double calx_sim_step_share(struct calx_sim *sim, int64_t *id)
{
    *id = 7;
    return 0.25 * (double)sim->step;
}

const struct calx_peak *calx_sim_peak(const struct calx_sim *sim)
{
    return &sim->peak;
}

struct calx_frame *calx_frame_create(struct calx_sim *sim, bool with_contacts)
{
    (void)with_contacts;
    struct calx_frame *frame = malloc(sizeof *frame);
    if (frame)
        *frame = sim->frame;
    sim->frames_made += 1;
    return frame;
}

void calx_frame_free(struct calx_frame *frame)
{
    free(frame);
}

#endif

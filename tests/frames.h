/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Frames made by hand for the tests of output.
 */
#ifndef CALX_TESTS_FRAMES_H
#define CALX_TESTS_FRAMES_H

#include <math.h>

#include "core/calx.h"

enum { MOST = 20000, CONTACTS = 3 };
static double position[MOST][3], radius[MOST], velocity[MOST][3], temperature[MOST];
static int64_t id[MOST], pair[CONTACTS][2] = {{0, 1}, {1, 2}, {2, -1}};
static int32_t material[MOST];
static double pair_position[CONTACTS][2][3] = {
    {{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {2, 0, 0}}, {{2, 0, 0}, {2, -1, 0}}};
static double normal_force[CONTACTS] = {1, 2, 3}, tangential_force[CONTACTS],
              heat_flow[CONTACTS] = {-1, 0, 1}, overlap[CONTACTS] = {1e-6, 2e-6, 3e-6};
static int32_t status[CONTACTS] = {0, 1, 0};
static double wall_position[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                     {0, 1, 0}, {2, 0, 0}, {3, 0, 0}},
              wall_velocity[6][3], wall_temperature[3] = {400, NAN, 300},
              wall_force[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
static int32_t wall_cell[3][4] = {{0, 1, 2, 3}, {4, 5, -1, -1}, {1, 4, 2, -1}},
               wall_of_cell[3] = {0, 1, 1};

static inline struct calx_frame frame_of(size_t n, double time)
{
    for (size_t i = 0; i < n; i++) {
        id[i] = (int64_t)i;
        material[i] = (int32_t)(i % 3);
        radius[i] = 0.5 + (double)i / MOST;
        temperature[i] = 293.15 + sqrt((double)i);
        for (size_t k = 0; k < 3; k++) {
            position[i][k] = sin((double)(3 * i + k));
            velocity[i][k] = cos((double)(3 * i + k));
        }
    }
    return (struct calx_frame){.time = time,
                               .dimension = 3,
                               .n = n,
                               .id = id,
                               .position = position,
                               .radius = radius,
                               .velocity = velocity,
                               .temperature = temperature,
                               .material = material,
                               .contact_count = CONTACTS,
                               .pair = pair,
                               .pair_position = pair_position,
                               .normal_force = normal_force,
                               .tangential_force = tangential_force,
                               .heat_flow = heat_flow,
                               .overlap = overlap,
                               .status = status,
                               .wall_points = 6,
                               .wall_cells = 3,
                               .wall_position = wall_position,
                               .wall_cell = wall_cell,
                               .wall_of_cell = wall_of_cell,
                               .wall_velocity = wall_velocity,
                               .wall_temperature = wall_temperature,
                               .wall_force = wall_force,
                               .walls_changed = true};
}

static const struct calx_output plain = {
    .fields = CALX_FIELD_ALL, .network = true, .compression = 6};

#endif

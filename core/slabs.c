/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Slabs of a simulation: the solids behind walls, joined to the contacts on their faces. A contact sees the temperature between the two nearest
 * cells of the face, linearly, and what flows through it, and the wall's share of what it dissipates, goes into the same cells with the same
 * weights: nothing is lost. Flows are those at the temperatures when the heat step begins; the blocks' parts are summed in their order.
 */
#include "core/slab.h"

#include <stdlib.h>
#include <string.h>

static const struct calx_slab *slab_of(const struct calx_sim *s, size_t wall)
{
    return &s->scene->walls[wall].slab;
}

int calx_slabs_create(struct calx_sim *s, struct calx_error *e)
{
    size_t walls = s->scene->wall_count;
    s->slab_cell = calx_memory_zeroed(walls, sizeof *s->slab_cell);
    s->slab_face = calx_memory_zeroed(walls, sizeof *s->slab_face);
    for (size_t w = 0; s->slab_cell && s->slab_face && w < walls; w++) {
        s->slab_cell[w] = s->slab_cells;
        s->slab_face[w] = s->slab_faces;
        s->slab_cells += slab_of(s, w)->along * slab_of(s, w)->deep;
        s->slab_faces += slab_of(s, w)->along;
    }
    s->slab_temperature = calx_memory_zeroed(s->slab_cells, sizeof *s->slab_temperature);
    s->slab_heat = calx_memory_zeroed(s->slab_faces, sizeof *s->slab_heat);
    if (!s->slab_cell || !s->slab_face || !s->slab_temperature || !s->slab_heat || calx_slabs_room(s))
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu cells of slabs", s->slab_cells);
    for (size_t w = 0; w < walls; w++)
        for (size_t c = 0; c < slab_of(s, w)->along * slab_of(s, w)->deep; c++)
            s->slab_temperature[s->slab_cell[w] + c] = slab_of(s, w)->start;
    return 0;
}

int calx_slabs_room(struct calx_sim *s)
{
    free(s->block_faces);
    s->block_faces = calx_memory_zeroed(s->block_count * s->slab_faces, sizeof *s->block_faces);
    return !s->block_faces;
}

void calx_slabs_take_dissipation(struct calx_sim *s)
{
    for (size_t b = 0; b < s->block_count; b++)
        for (size_t f = 0; f < s->slab_faces; f++)
            s->slab_heat[f] += s->block_faces[b * s->slab_faces + f].lost;
}

void calx_slabs_add(struct calx_sim *s, int wall, const double point[3], double heat)
{
    struct calx_slab_spot spot = calx_slab_find(slab_of(s, (size_t)wall), &s->poses[wall], point);
    double *face = s->slab_heat + s->slab_face[wall];
    face[spot.cell[0]] += (1.0 - spot.share) * heat;
    face[spot.cell[1]] += spot.share * heat;
}

/* A face cell must not give or take more than it has: beyond dt sum H = C its temperature would overshoot that of the grains. */
static int too_fast(const struct calx_sim *s, size_t wall, double conductance, struct calx_error *e)
{
    double capacity = calx_slab_capacity(slab_of(s, wall));
    return calx_error_set(e, CALX_ERROR_PHYSICS,
        "at t = %g s the grains on a cell of the slab of walls '%s' conduct %g W/K, so much that it would overshoot their temperature in a heat "
        "step of %g s: its heat capacity is %g J/K. Take a heat step below %g s, or larger cells", s->time, s->scene->walls[wall].name,
        conductance, s->heat_dt, capacity, 0.5 * capacity / conductance);
}

static int add_flows(struct calx_sim *s, size_t wall, bool flows, struct calx_error *e)
{
    const struct calx_slab *b = slab_of(s, wall);
    for (size_t i = 0; i < b->along; i++) {
        double flow = 0.0, conductance = 0.0;
        for (size_t block = 0; block < s->block_count; block++) {
            const struct calx_face *face = &s->block_faces[block * s->slab_faces + s->slab_face[wall] + i];
            flow += face->flow;
            conductance += face->conductance;
        }
        if (conductance * s->heat_dt > calx_slab_capacity(b))
            return too_fast(s, wall, conductance, e);
        s->slab_heat[s->slab_face[wall] + i] += flows ? flow * s->heat_dt : 0.0;
    }
    return 0;
}

static int step(struct calx_sim *s, size_t wall, bool flows, struct calx_error *e)
{
    const struct calx_slab *b = slab_of(s, wall);
    struct calx_slab_step step = {.dt = s->heat_dt, .temperature = s->slab_temperature + s->slab_cell[wall],
                                  .heat = s->slab_heat + s->slab_face[wall]};
    CALX_TRY(add_flows(s, wall, flows, e));
    step.scratch = malloc(calx_slab_scratch(b) * sizeof(double));
    if (!step.scratch)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the slab of walls '%s'", s->scene->walls[wall].name);
    calx_slab_advance(b, &step);
    free(step.scratch);
    memset(s->slab_heat + s->slab_face[wall], 0, b->along * sizeof *s->slab_heat);
    s->wall_heat += step.far_heat;
    return 0;
}

int calx_slabs_step(struct calx_sim *s, bool flows, struct calx_error *e)
{
    for (size_t w = 0; w < s->scene->wall_count; w++)
        if (calx_wall_has_slab(s, (int)w))
            CALX_TRY(step(s, w, flows, e));
    return 0;
}

double calx_slabs_content(const struct calx_sim *s)
{
    long double sum = 0.0;
    for (size_t w = 0; w < s->scene->wall_count; w++)
        for (size_t c = 0; c < slab_of(s, w)->along * slab_of(s, w)->deep; c++)
            sum += (long double)calx_slab_capacity(slab_of(s, w)) * (long double)s->slab_temperature[s->slab_cell[w] + c];
    for (size_t f = 0; f < s->slab_faces; f++)
        sum += s->slab_heat[f];
    return (double)sum;
}

double calx_slabs_mean(const struct calx_sim *s, int wall, bool face)
{
    const struct calx_slab *b = slab_of(s, (size_t)wall);
    size_t cells = b->along * (face ? 1 : b->deep);
    double sum = 0.0;
    for (size_t c = 0; c < cells; c++)
        sum += s->slab_temperature[s->slab_cell[wall] + c];
    return sum / (double)cells;
}

double calx_sim_slab_temperature(const struct calx_sim *s, int wall, bool largest)
{
    double most = -INFINITY;
    if (wall < 0 || !calx_wall_has_slab(s, wall))
        return NAN;
    for (size_t c = 0; c < slab_of(s, (size_t)wall)->along * slab_of(s, (size_t)wall)->deep; c++)
        most = fmax(most, s->slab_temperature[s->slab_cell[wall] + c]);
    return largest ? most : calx_slabs_mean(s, wall, false);
}

/* ---- output ---- */

/* The point i cells along, k cells deep, on the near (0) or other (1) side of the width, in the present pose. */
static void place(const struct calx_sim *s, size_t wall, size_t i, size_t k, int side, double out[3])
{
    const struct calx_slab *b = slab_of(s, wall);
    const struct calx_pose *pose = &s->poses[wall];
    double at[3];
    for (int q = 0; q < 3; q++)
        at[q] = b->corner[q] + b->axis[0][q] * b->length * (double)i / (double)b->along +
                b->axis[1][q] * b->depth * (double)k / (double)b->deep + side * b->axis[2][q] * b->width;
    for (int q = 0; q < 3; q++)
        out[q] = pose->turn[3 * q] * at[0] + pose->turn[3 * q + 1] * at[1] + pose->turn[3 * q + 2] * at[2] + pose->shift[q];
    if (s->scene->dimension == 2)
        out[2] = 0.0;
}

/* Whether the three axes are a right-handed frame: then cells are named the one way round, else the other. */
static bool is_right_handed(const double a[3][3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        sum += a[2][k] * (a[0][(k + 1) % 3] * a[1][(k + 2) % 3] - a[0][(k + 2) % 3] * a[1][(k + 1) % 3]);
    return sum > 0.0;
}

struct calx_mesh *calx_sim_slab_mesh(const struct calx_sim *s, int wall)
{
    const struct calx_slab *b = slab_of(s, (size_t)wall);
    size_t row = b->along + 1, layer = row * (b->deep + 1), sides = s->scene->dimension == 2 ? 1 : 2;
    struct calx_mesh *m = calx_mesh_create(sides * layer, b->along * b->deep, 4 * sides);
    double *t = m ? calx_mesh_add(m, "temperature", "K", 1) : NULL;
    if (!t) {
        calx_mesh_free(m);
        return NULL;
    }
    m->time = s->time;
    for (size_t side = 0; side < sides; side++)
        for (size_t p = 0; p < layer; p++)
            place(s, (size_t)wall, p % row, p / row, (int)side, m->position[side * layer + p]);
    for (size_t c = 0; c < b->along * b->deep; c++) {
        size_t first = c % b->along + row * (c / b->along);
        const size_t one = is_right_handed(b->axis) ? 1 : row, around[4] = {first, first + one, first + row + 1, first + row + 1 - one};
        for (size_t q = 0; q < 4 * sides; q++)
            m->corner[4 * sides * c + q] = (int64_t)(around[q % 4] + q / 4 * layer);
        t[c] = s->slab_temperature[s->slab_cell[wall] + c];
    }
    return m;
}

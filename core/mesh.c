/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Meshes for output: points, cells of equal shape, and arrays of numbers on the cells.
 */
#include <stdlib.h>

#include "core/state.h"

struct calx_mesh *calx_mesh_create(size_t points, size_t cells, size_t corners)
{
    struct calx_mesh *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    *m = (struct calx_mesh){.points = points, .cells = cells, .corners = corners};
    m->position = calx_memory_zeroed(points, sizeof *m->position);
    m->corner = calx_memory_zeroed(cells * corners, sizeof *m->corner);
    if (m->position && m->corner)
        return m;
    calx_mesh_free(m);
    return NULL;
}

double *calx_mesh_add(struct calx_mesh *m, const char *name, const char *unit, size_t components)
{
    double *value = calx_memory_zeroed(m->cells * components, sizeof *value);
    if (value)
        m->arrays[m->array_count++] = (struct calx_mesh_array){name, unit, components, value};
    return value;
}

void calx_mesh_free(struct calx_mesh *m)
{
    if (!m)
        return;
    for (size_t k = 0; k < m->array_count; k++)
        free(m->arrays[k].value);
    free(m->position);
    free(m->corner);
    free(m);
}

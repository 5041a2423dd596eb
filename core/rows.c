/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The arrays of a row layout: which exist follows from the features of the plan; what a scene does not need is not
 * allocated.
 */
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

/* Every array of the layout: where its pointer stands, bytes per row, whether this scene has it. */
struct row_array {
    size_t offset, bytes;
    bool present;
};

enum { ROW_ARRAYS = 10 };

static size_t list_arrays(const struct calx_sim *s, size_t stride,
                          struct row_array list[ROW_ARRAYS + 2 * CALX_EXTRA_MAX])
{
#define FIELD(name, size, when) {offsetof(struct calx_rows_arrays, name), size, when}
    const struct calx_features *f = &s->features;
    bool store = false;
    uint32_t translation = 0, rotation = 0;
    for (size_t p = 0; p < s->plan_count; p++) {
        const struct calx_plan *plan = &s->plans[p];
        const struct calx_motion_integrator *m = plan->motion_law;
        bool waits = plan->heat_every > 1 || (m && !m->stages) || (plan->adapts && plan->models->heat_dt > 0.0);
        store |= f->temperature && waits && s->scene->from_dissipation > 0.0;
        translation = m && m->extra_translation > translation ? m->extra_translation : translation;
        rotation = m && f->rotation && m->extra_rotation > rotation ? m->extra_rotation : rotation;
    }
    const struct row_array fixed[ROW_ARRAYS] = {
        FIELD(x, 4 * sizeof(double), true),
        FIELD(v, stride * sizeof(double), true),
        FIELD(a, stride * sizeof(double), true),
        FIELD(id, sizeof(int64_t), true),
        FIELD(material, sizeof(int32_t), true),
        FIELD(inverse_capacity, sizeof(double), f->temperature),
        FIELD(heat_store, sizeof(double), store),
        FIELD(image, 3 * sizeof(int32_t), f->periodic),
        FIELD(source, sizeof(int32_t), f->search),
        FIELD(shift, sizeof(uint8_t), f->search && f->periodic),
    };
#undef FIELD
    memcpy(list, fixed, sizeof fixed);
    size_t count = ROW_ARRAYS;
    for (size_t k = 0; k < 2 * CALX_EXTRA_MAX; k++)
        list[count++] = (struct row_array){
            offsetof(struct calx_rows_arrays, extra) + k * sizeof(double *), 4 * sizeof(double),
            k < CALX_EXTRA_MAX ? k < translation : k - CALX_EXTRA_MAX < rotation};
    return count;
}

static void **array_at(struct calx_rows_arrays *r, size_t offset)
{
    return (void **)((char *)r + offset);
}

int calx_rows_allocate(const struct calx_sim *s, struct calx_rows_arrays *r, size_t rows)
{
    struct row_array list[ROW_ARRAYS + 2 * CALX_EXTRA_MAX];
    size_t stride = s->features.rotation || s->features.temperature ? 8 : 4;
    size_t count = list_arrays(s, stride, list);
    memset(r, 0, sizeof *r);
    r->rows = rows;
    r->stride = stride;
    for (size_t k = 0; k < count; k++)
        if (list[k].present &&
            !(*array_at(r, list[k].offset) = calx_memory_to_fill(rows, list[k].bytes)))
            return 1;
    return 0;
}

size_t calx_rows_arrays_list(const struct calx_sim *s, struct calx_rows_arrays *r,
                             struct calx_row_view *views)
{
    struct row_array list[ROW_ARRAYS + 2 * CALX_EXTRA_MAX];
    size_t count = list_arrays(s, r->stride, list), present = 0;
    for (size_t k = 0; k < count; k++)
        if (list[k].present)
            views[present++] = (struct calx_row_view){*array_at(r, list[k].offset), list[k].bytes};
    return present;
}

void calx_rows_free(struct calx_rows_arrays *r)
{
    void *all[] = {r->x, r->v, r->a, r->id, r->material, r->inverse_capacity, r->heat_store,
                   r->image, r->source, r->shift};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
    for (size_t k = 0; k < 2 * CALX_EXTRA_MAX; k++)
        free(r->extra[k]);
    memset(r, 0, sizeof *r);
}

/* Rows of one length, which the compiler knows. */
static inline __attribute__((always_inline)) void gather(char *to, const char *from, const int32_t *row, size_t n, size_t bytes)
{
    for (size_t k = 0; k < n; k++)
        memcpy(to + bytes * k, from + bytes * (size_t)row[k], bytes);
}

static void gather_any(char *to, const char *from, const int32_t *row, size_t n, size_t bytes)
{
    switch (bytes) {
    case 4: gather(to, from, row, n, 4); break;
    case 8: gather(to, from, row, n, 8); break;
    case 32: gather(to, from, row, n, 32); break;
    case 64: gather(to, from, row, n, 64); break;
    default: gather(to, from, row, n, bytes);
    }
}

void calx_rows_fill(const struct calx_sim *s, struct calx_rows_arrays *to, size_t first, struct calx_rows_arrays *from,
                    const int32_t *row, size_t n, size_t ghosts)
{
    struct row_array list[ROW_ARRAYS + 2 * CALX_EXTRA_MAX];
    size_t count = list_arrays(s, to->stride, list);
    for (size_t k = 0; k < count; k++) {
        if (!list[k].present)
            continue;
        char *start = (char *)*array_at(to, list[k].offset) + list[k].bytes * first;
        gather_any(start, *array_at(from, list[k].offset), row, n, list[k].bytes);
        memset(start + list[k].bytes * n, 0, list[k].bytes * ghosts);
    }
}

void calx_rows_clear(const struct calx_sim *s, struct calx_rows_arrays *r)
{
    calx_rows_fill(s, r, 0, r, NULL, 0, r->rows);
}

int64_t calx_row_id(const struct calx_sim *s, int32_t row)
{
    /* a ghost has the radius of its source and no id of its own */
    for (size_t lo = 0, hi = s->block_count; lo < hi;) {
        size_t mid = (lo + hi) / 2;
        const struct calx_row_block *b = &s->blocks[mid];
        if (row < b->first)
            hi = mid;
        else if (row >= b->first + b->own + b->ghosts)
            lo = mid + 1;
        else
            return s->r.id[row >= b->first + b->own ? s->r.source[row] : row];
    }
    return -1;
}

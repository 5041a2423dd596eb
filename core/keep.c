/* SPDX-License-Identifier: BSD-3-Clause
 *
 * History moves with the pair: before the lists are replaced, the pairs that touch are listed under the new place of their
 * earlier particle (counting sort); each new pair looks through that short list. Vectors change sign with the pair's orientation.
 */
#include <stdlib.h>
#include <string.h>

#include "core/neighbours.h"

/* The new place of a block-local row of the old layout. */
static int32_t place_of(const struct calx_rebuild *r, const struct calx_row_block *b, int32_t local)
{
    int32_t row = b->first + local;
    return r->new_place[local >= b->own ? r->sim->r.source[row] : row];
}

/* Counts, or fills in, each old pair that touches under its earlier particle. */
static void each_kept(const struct calx_rebuild *r, bool fill)
{
    const struct calx_sim *s = r->sim;
    for (size_t b = 0; b < s->block_count; b++)
        for (size_t g = 0; g < s->blocks[b].group_count; g++) {
            size_t number = s->blocks[b].group_first + g;
            const struct calx_group *group = &s->groups[number];
            for (size_t k = 0; k < group->count; k++) {
                if (!calx_pair_touches(s, group->first + k))
                    continue;
                int32_t i = place_of(r, &s->blocks[b], calx_row_of_place(s->pairs.i[group->first + k]));
                int32_t j = place_of(r, &s->blocks[b], calx_row_of_place(s->pairs.j[group->first + k]));
                int32_t earlier = i < j ? i : j, later = i < j ? j : i;
                if (fill)
                    r->kept[r->kept_first[earlier + 1]++] = (struct calx_kept){later, i, number, k};
                else
                    r->kept_first[earlier + 2]++;
            }
        }
}

int calx_keep_collect(struct calx_rebuild *r)
{
    r->kept_first = calloc(r->n + 3, sizeof *r->kept_first);
    if (!r->kept_first)
        return 1;
    each_kept(r, false);
    for (size_t k = 0; k <= r->n; k++)
        r->kept_first[k + 2] += r->kept_first[k + 1];
    size_t total = r->kept_first[r->n + 1];
    r->kept = malloc((total + 1) * sizeof *r->kept);
    if (!r->kept)
        return 1;
    each_kept(r, true);
    return 0;
}

int64_t calx_keep_find(const struct calx_rebuild *r, int32_t earlier, int32_t later)
{
    for (size_t k = r->kept_first[earlier]; k < r->kept_first[earlier + 1]; k++)
        if (r->kept[k].later == later)
            return (int64_t)k;
    return -1;
}

/* Copies the columns of one pair; a vector, three columns, changes sign with the orientation. */
static void copy_history(const struct calx_rebuild *r, const struct calx_kept *kept, const struct calx_group *group,
                         size_t place, double sign)
{
    const struct calx_sim *s = r->sim;
    size_t columns = s->plan->history, vector = 0; /* columns left of the vector under way */
    double *to = r->pairs.history + columns * group->first + place;
    for (size_t h = 0; h < columns; h++) {
        vector = s->plan->history_is_vector[h] ? 3 : vector;
        to[h * group->room] = (vector ? sign : 1.0) * calx_group_history(s, &s->groups[kept->group], h)[kept->place];
        vector -= vector > 0;
    }
}

void calx_keep_apply(const struct calx_rebuild *r, const struct calx_local *l, size_t from, const struct calx_group *group)
{
    for (size_t k = 0; k < group->count; k++) {
        int64_t found = l->kept[from + k];
        if (found < 0)
            continue;
        size_t place = group->first + k;
        r->pairs.touching[place / 8] |= (uint8_t)(1u << place % 8);
        copy_history(r, &r->kept[found], group, k, l->same_way[from + k] ? 1.0 : -1.0);
    }
}

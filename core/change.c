/* SPDX-License-Identifier: BSD-3-Clause
 *
 * How far contacts are from a change: for integrators that look for the moment at which one begins or ends.
 * Input: present rows, lists, and which contacts there were at the last evaluation that was kept. Output: the smallest, over all pairs in
 * reach and all wall contacts that count, of the gap of what was apart and the overlap of what touched, m. A law that acts at a distance
 * touches from there on.
 */
#include <math.h>

#include "core/pairs.h"
#include "core/wall_candidates.h"

/* Ghosts are copies of the last evaluation: the place is that of the body itself. */
static void place_of(const struct calx_sim *s, const struct calx_row_block *b, int32_t row, double x[3])
{
    bool ghost = row >= b->first + b->own;
    const double *from = calx_row_x(s, ghost ? s->r.source[row] : row);
    int shift = ghost && s->r.shift ? s->r.shift[row] : CALX_NO_SHIFT;
    for (int k = 0; k < 3; k++) {
        int turns = calx_shift_turns(shift, k);
        x[k] = from[k] + (turns ? turns * (s->scene->high[k] - s->scene->low[k]) : 0.0);
    }
}

static double gap_of(const struct calx_sim *s, const struct calx_row_block *b, uint32_t i, uint32_t j)
{
    int32_t rows[2] = {b->first + calx_row_of_place(i), b->first + calx_row_of_place(j)};
    double x[2][3], square = 0.0;
    for (int k = 0; k < 2; k++)
        place_of(s, b, rows[k], x[k]);
    for (int k = 0; k < 3; k++)
        square += (x[0][k] - x[1][k]) * (x[0][k] - x[1][k]);
    return sqrt(square) - calx_row_x(s, rows[0])[3] - calx_row_x(s, rows[1])[3] - s->plan->gap;
}

static double change_of_group(const struct calx_sim *s, const struct calx_row_block *b, const struct calx_group *g)
{
    double least = INFINITY;
    for (size_t p = g->first; p < g->first + g->count; p++) {
        double gap = gap_of(s, b, s->pairs.i[p], s->pairs.j[p]);
        least = fmin(least, calx_pair_touches(s, p) ? -gap : gap);
    }
    for (size_t p = g->apart_first; p < g->apart_first + g->apart_count; p++)
        least = fmin(least, gap_of(s, b, s->pairs.apart_i[p], s->pairs.apart_j[p]));
    return least;
}

static bool touched(const struct calx_sim *s, const struct calx_row_block *b, int32_t row, int32_t surface)
{
    for (size_t k = b->near_first; k < b->near_first + b->wall_count; k++)
        if (s->wall_contacts[k].row == row && s->wall_contacts[k].surface == surface)
            return true;
    return false;
}

static double change_at_walls(const struct calx_sim *s, const struct calx_row_block *b)
{
    struct candidate list[NEAR_MAX];
    double least = INFINITY;
    for (size_t at = b->near_first, count; at < b->near_first + b->near_count;) {
        int32_t row = s->near_row[at];
        at = collect(s, b, at, list, &count);
        drop_duplicates(s, list, count);
        for (size_t k = 0; k < count; k++) {
            double gap = list[k].touch.distance - calx_row_x(s, row)[3] - s->plan->gap;
            if (!list[k].dropped)
                least = fmin(least, touched(s, b, row, list[k].surface) ? -gap : gap);
        }
    }
    return least;
}

double calx_change_distance(const struct calx_sim *s)
{
    double least = INFINITY;
    for (size_t b = 0; b < s->block_count && s->features.contacts; b++) {
        const struct calx_row_block *block = &s->blocks[b];
        for (size_t g = 0; g < block->group_count; g++)
            least = fmin(least, change_of_group(s, block, &s->groups[block->group_first + g]));
        if (s->features.wall_contacts)
            least = fmin(least, change_at_walls(s, block));
    }
    return least;
}

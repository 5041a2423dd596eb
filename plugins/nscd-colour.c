/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Colours of contacts: two of the same colour share no body that an impulse moves, so that those of one colour may be brought to their
 * conditions by several threads at once, in any order, with the same bits. Each contact in turn gets the first colour that is free at both its
 * bodies. A body with more contacts than there are colours leaves some without: these come last, one after the other.
 */
#include <stdlib.h>
#include <string.h>

#include "plugins/nscd.h"

/* The bodies' colours so far; held bodies and walls have none. */
static uint64_t taken(const struct nscd_solver *s, const uint64_t *used, int32_t row)
{
    return row >= 0 && s->v[8 * (size_t)row + 3] > 0 ? used[row] : 0;
}

static size_t colour_of(const struct nscd_solver *s, uint64_t *used, const struct nscd_contact *c)
{
    uint64_t free = ~(taken(s, used, c->i) | taken(s, used, c->j));
    if (!free)
        return NSCD_COLOURS;
    size_t colour = (size_t)__builtin_ctzll(free);
    used[c->i] |= 1ull << colour;
    if (c->j >= 0)
        used[c->j] |= 1ull << colour;
    return colour;
}

int nscd_colour(struct nscd_solver *s)
{
    uint64_t *used = calloc(s->problem->bodies + 1, sizeof *used);
    uint8_t *colour = malloc(s->n + 1);
    struct nscd_contact *sorted = malloc((s->n + 1) * sizeof *sorted);
    size_t at[NSCD_COLOURS + 2] = {0};
    int failed = !used || !colour || !sorted;
    for (size_t k = 0; !failed && k < s->n; k++) {
        colour[k] = (uint8_t)colour_of(s, used, &s->list[k]);
        at[colour[k] + 1]++;
    }
    for (size_t k = 0; k <= NSCD_COLOURS; k++)
        at[k + 1] += at[k];
    memcpy(s->first, at, sizeof s->first);
    for (size_t k = 0; !failed && k < s->n; k++)
        sorted[at[colour[k]]++] = s->list[k];
    if (!failed && s->n)
        memcpy(s->list, sorted, s->n * sizeof *sorted);
    free(used);
    free(colour);
    free(sorted);
    return failed;
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The hash of the physical state: equal bits, equal hash, whatever the order of rows and lists in memory. Each particle and each
 * contact is hashed on its own, with its ids, and the hashes are summed.
 * Method: FNV-1a over bytes, then a finalising mix (Steele et al., splitmix64).
 */
#include <string.h>

#include "core/state.h"

static uint64_t feed(uint64_t h, const void *data, size_t bytes)
{
    const unsigned char *p = data;
    for (size_t k = 0; k < bytes; k++)
        h = (h ^ p[k]) * 0x100000001b3ull;
    return h;
}

static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

static const uint64_t BASIS = 0xcbf29ce484222325ull;

static uint64_t hash_particle(const struct calx_sim *s, int32_t row)
{
    uint64_t h = feed(BASIS, &s->r.id[row], sizeof s->r.id[row]);
    h = feed(h, calx_row_x(s, row), 4 * sizeof(double));
    return mix(feed(h, calx_row_v(s, row), s->r.stride * sizeof(double)));
}

/* Vectors are stored as acting on i; the hash takes them as acting on the body of lower id. */
static uint64_t hash_pair(const struct calx_sim *s, const struct calx_row_block *b, const struct calx_group *g, size_t k)
{
    int32_t row[2] = {b->first + calx_row_of_place(s->pairs.i[g->first + k]),
                      b->first + calx_row_of_place(s->pairs.j[g->first + k])};
    int64_t id[2];
    for (int q = 0; q < 2; q++)
        id[q] = s->r.id[row[q] - b->first >= b->own ? s->r.source[row[q]] : row[q]];
    double sign = id[0] < id[1] ? 1.0 : -1.0;
    int64_t low = id[0] < id[1] ? id[0] : id[1], high = id[0] < id[1] ? id[1] : id[0];
    uint64_t h = feed(feed(BASIS, &low, sizeof low), &high, sizeof high);
    for (size_t c = 0; c < s->plan->history; c++) {
        bool vector = s->plan->history_is_vector[c] || (c > 0 && s->plan->history_is_vector[c - 1]) ||
                      (c > 1 && s->plan->history_is_vector[c - 2]);
        double v = calx_group_history(s, g, c)[k] * (vector ? sign : 1.0) + 0.0;
        h = feed(h, &v, sizeof v);
    }
    return mix(h);
}

static uint64_t hash_wall_contact(const struct calx_sim *s, size_t k)
{
    const struct calx_wall_contact *c = &s->wall_contacts[k];
    uint64_t h = feed(BASIS, &s->r.id[c->row], sizeof s->r.id[c->row]);
    h = feed(h, &c->surface, sizeof c->surface);
    return mix(feed(h, s->wall_history + s->plan->history * k, s->plan->history * sizeof(double)));
}

uint64_t calx_sim_hash(const struct calx_sim *s)
{
    uint64_t h = feed(feed(BASIS, &s->time, sizeof s->time), &s->step, sizeof s->step);
    for (size_t b = 0; b < s->block_count; b++) {
        const struct calx_row_block *block = &s->blocks[b];
        for (int32_t row = block->first; row < block->first + block->own; row++)
            h += hash_particle(s, row);
        for (size_t g = block->group_first; g < block->group_first + block->group_count; g++)
            for (size_t k = 0; k < s->groups[g].count; k++)
                if (calx_pair_touches(s, s->groups[g].first + k))
                    h += hash_pair(s, block, &s->groups[g], k);
        for (size_t k = 0; k < block->wall_count; k++)
            h += hash_wall_contact(s, block->near_first + k);
    }
    h = feed(h, s->slab_temperature, s->slab_cells * sizeof(double));
    for (size_t w = 0; w < s->scene->wall_count; w++)
        if (s->scene->stages[s->stage].motion[w].free)
            h = feed(feed(h, &s->plates[w].shift, sizeof(double)), &s->plates[w].speed, sizeof(double));
    return mix(h);
}

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: what one rebuild of rows, blocks and lists works on.
 */
#ifndef CALX_NEIGHBOURS_H
#define CALX_NEIGHBOURS_H

#include "core/pairs.h"
#include "core/state.h"

/* A block's pairs with rows local to the block, and the ghosts they need. */
struct calx_local {
    size_t pairs, ghosts, ghost_capacity;
    int32_t *i, *j;
    size_t (*type_count)[CALX_NEARNESSES]; /* per pair type and nearness, the order of the pairs */
    int64_t *kept;       /* per pair: what it was when it touched, see calx_keep_find() */
    bool *same_way;      /* per pair: its i was i then */
    int32_t *ghost;      /* place in the order, of each ghost */
    uint8_t *ghost_shift;
};

struct calx_rebuild {
    struct calx_sim *sim;
    size_t n, blocks, types;
    int32_t *old_row;    /* by new place */
    int32_t *new_place;  /* by old row */
    double *x;           /* sorted positions and radii */
    struct calx_found_list *found;
    struct calx_local *local;
    /* history to keep, by the new place of the earlier particle */
    size_t *kept_first;
    struct calx_kept { int32_t later, i; size_t group, place; } *kept; /* i: new place of the old i; place in the group */
    /* what comes out */
    struct calx_rows_arrays rows;
    struct calx_pairs pairs;
    struct calx_row_block *new_blocks;
    struct calx_group *groups;
    size_t group_count;
};

/* localise.c: turns found pairs into block-local ones. 0, or 1 without memory. */
int calx_localise(struct calx_rebuild *);

/* rows.c: allocates the arrays of a row layout, to be filled; 0, or 1 without memory. */
int calx_rows_allocate(const struct calx_sim *, struct calx_rows_arrays *, size_t rows);
/* Rows first..first+n become copies of from's row[0..n]; the `ghosts` rows after them are zero. */
void calx_rows_fill(const struct calx_sim *, struct calx_rows_arrays *to, size_t first, struct calx_rows_arrays *from, const int32_t *row,
                    size_t n, size_t ghosts);
void calx_rows_clear(const struct calx_sim *, struct calx_rows_arrays *);
void calx_rows_free(struct calx_rows_arrays *);

/* Every array that exists in this layout, with its bytes per row, for restart and memory figures. views: room for 32. */
struct calx_row_view {
    void *data;
    size_t bytes;
};
size_t calx_rows_arrays_list(const struct calx_sim *, struct calx_rows_arrays *, struct calx_row_view *views);

/* keep.c: friction and other history that moves with the pair. 0, or 1 without memory. */
int calx_keep_collect(struct calx_rebuild *);
/* The pair of new places earlier < later among r->kept, or -1 if it did not touch. */
int64_t calx_keep_find(const struct calx_rebuild *, int32_t earlier, int32_t later);
/* To the evaluated pairs of a group, which are those of l from `from` on. */
void calx_keep_apply(const struct calx_rebuild *, const struct calx_local *l, size_t from, const struct calx_group *);

/* near.c: particle-wall candidates. 0, or 1 without memory. */
int calx_near_build(struct calx_sim *, const struct calx_rebuild *);

#endif

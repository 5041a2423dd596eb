/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the parts of a frame.
 */
#ifndef CALX_FRAME_H
#define CALX_FRAME_H

#include "core/state.h"

/* frame_walls.c: points and cells of the walls at their present pose. 0, or 1 without memory. */
int calx_frame_walls(struct calx_sim *, struct calx_frame *);

/* network.c: coordination numbers, heat flows where the network of conductances holds them, and, if asked for, the contacts. */
int calx_frame_network(struct calx_sim *, struct calx_frame *, bool with_contacts);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core: the parts of the guards.
 */
#ifndef CALX_GUARD_H
#define CALX_GUARD_H

#include "core/state.h"

enum { CALX_GUARD_TEXT = 240 };

/* "particle 7" or "wall 'drum'": row, or -1 - wall. */
void calx_guard_name(const struct calx_sim *, int32_t row, char text[CALX_GUARD_TEXT]);

/* The contact laws of the plan by name: "linear, coulomb". */
void calx_guard_laws(const struct calx_plan *, char text[CALX_GUARD_TEXT]);

/* What a body touches deepest, with the laws that act there: "its deepest contact is with particle 7, overlap 3 % of the smaller radius,
 * laws linear, coulomb", or "it touches nothing". */
void calx_guard_contact(struct calx_sim *, int32_t row, char text[CALX_GUARD_TEXT]);

/* guard_contacts.c: in each step; and whether the contacts there are now are resolved and stable. */
int calx_guard_contacts_step(struct calx_sim *, struct calx_error *);
int calx_guard_contacts(struct calx_sim *, struct calx_error *);

/* guard_temperature.c: what walls may bring; and whether temperatures stay within what can be. */
void calx_guard_walls(struct calx_sim *);
int calx_guard_temperature(struct calx_sim *, struct calx_error *);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "velocity-verlet": half a kick, a drift, the forces, half a kick; for spins the kicks
 * alone. Reference: Swope, Andersen, Berens and Wilson, J. Chem. Phys. 76 (1982) 637. Second order,
 * symplectic and reversible, one force evaluation per step, stable for omega dt < 2. Laws see the
 * velocity of the middle of the step together with the positions of its end.
 */
#include "plugins/kick-drift.h"

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .reversible = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .translation = translation,
    .rotation = rotation,
    .whole = whole,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "velocity-verlet",
    .summary = "second order, symplectic, one force evaluation per step",
    .reference = "Swope, Andersen, Berens and Wilson, J. Chem. Phys. 76 (1982) 637",
    .equation = "v += a dt/2;  x += v dt;  a = a(x, v);  v += a dt/2",
    .law = &law,
};

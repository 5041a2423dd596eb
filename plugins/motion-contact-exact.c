/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator "contact-exact": the kicks and drifts of velocity-verlet (Swope et al., J. Chem. Phys. 76 (1982) 637),
 * with contacts that begin or end inside a step resolved by the engine (core/onset.c): there the sum of kicks is
 * corrected to the integral of a force that sets in as a power of time, by Navot, J. Math. and Phys. 40 (1961) 271.
 * Damping takes the velocity at the moment of the positions. Second order through collisions, damped or not, where
 * the jump of the force leaves other schemes at first; one force evaluation per step.
 */
#include "plugins/kick-drift.h"

static const struct calx_motion_integrator law = {
    .order = 2,
    .stages = 1,
    .symplectic = 1,
    .drifts = 1,
    .stability = 2,
    .damping = 2,
    .velocity_lag = 0.5,
    .resolves_contacts = 1,
    .translation = translation,
    .rotation = rotation,
    .whole = whole,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_MOTION,
    .name = "contact-exact",
    .summary = "velocity Verlet with onset and end of contacts resolved inside the step",
    .reference = "Swope, Andersen, Berens and Wilson, J. Chem. Phys. 76 (1982) 637; Navot, J. Math. and Phys. 40 (1961) 271",
    .equation = "v += a dt/2;  x += v dt;  a = a(x, v);  v += a dt/2;\n"
                "at onset and end of a contact dt sum F(t_k) is corrected to the integral of F for F ~ t^p, p = 0, 1/4, 1, 3/2",
    .law = &law,
};

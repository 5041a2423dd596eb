/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Scenes of rigid bodies, for the tests of non-smooth contact dynamics: their models, floor and box, columns, inclines and piles, and what
 * is asked of them.
 */
#ifndef CALX_TESTS_RIGID_H
#define CALX_TESTS_RIGID_H

#include "tests/scenes.h"

static const double G = 9.81, RADIUS = 0.01; /* m/s2; m */
static const double DENSITY = 1000.0;        /* kg/m3 */
/* A few hundred operations on numbers of one size. */
static const double ROUND_OFF = 1e-12;

/* The non-smooth models; `solver` are the integrator's numbers. */
void rigid_models(struct calx_scene *, double friction, double restitution, double turning, double dt, const struct given *solver);
/* Adds a floor through the origin; returns its index. */
int rigid_floor(struct calx_scene *);
/* Adds four sides from 0 to size. */
void rigid_box(struct calx_scene *, double size);
/* Of the first n bodies. */
double rigid_weight(const struct run *, size_t n);

/* Bodies on top of each other on a floor; the topmost of density `top`. */
struct calx_scene *rigid_column(size_t n, double top, double dt, const struct given *solver);
/* The largest error of a contact force of a column, relative to the largest force. */
double rigid_worst_force(const struct run *, size_t n);
/* One body on a floor; gravity is turned instead of the floor. */
struct calx_scene *rigid_incline(uint32_t bodies, double slope, double friction, double turning, double dt);
/* A loose pile of grains of three sizes that falls; without a floor. */
struct calx_scene *rigid_pile(double friction, double restitution, double gravity, const struct given *solver);

#endif

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The mechanics of a contact, eight at a time: approach, sliding, the turning of history with the normal, force and couple. The formulas
 * stand here once, for pairs (gather.c, scatter.c) and walls (evaluate.c).
 *
 * n: unit normal from j to i; u: velocity of i less that of j. Velocities are those of `lag` steps before the positions, so the normal
 * that belongs to them is m = n - tilt u, tilt = lag dt/d with d the distance of centres; what slides is worked out there and then laid
 * into the plane of n. Without this, friction at large size ratios sticks where it should slip (Vyas et al., Comput. Phys. Commun.
 * 310 (2025) 109524), and the ledger closes to first order only. For a wall tilt = 0.
 *
 * planar: bodies move in the plane of x and y and spin about z; the z of other vectors and the x and y of spins, couples and twists are 0, and
 * not read. Known when this is compiled, it saves a third of the work.
 */
#ifndef CALX_LANES_H
#define CALX_LANES_H

#include <stdbool.h>

#include "core/vector.h"

static inline calx_v8 calx_lanes_dot(const bool planar, const calx_v8 a[3], const calx_v8 b[3])
{
    calx_v8 sum = a[0] * b[0] + a[1] * b[1];
    return planar ? sum : sum + a[2] * b[2];
}

/* a + f b */
static inline void calx_lanes_add(const bool planar, calx_v8 a[3], calx_v8 f, const calx_v8 b[3])
{
    for (int k = 0; k < (planar ? 2 : 3); k++)
        a[k] += f * b[k];
}

static inline void calx_lanes_cross(const calx_v8 a[3], const calx_v8 b[3], calx_v8 out[3])
{
    for (int k = 0; k < 3; k++) {
        int p = (k + 1) % 3, q = (k + 2) % 3;
        out[k] = a[p] * b[q] - a[q] * b[p];
    }
}

/* u.m to first order in the turn since: what is lost and stored then balances to second order. un: u.n, u2: u.u. */
static inline calx_v8 calx_lanes_approach(calx_v8 un, calx_v8 u2, calx_v8 tilt)
{
    return un - tilt * (u2 - un * un);
}

/* The unit vector along m. |m|^2 - 1 = e = tilt (tilt u2 - 2 un) is small: 1/|m| = 1 - e/2 + 3 e^2/8, wrong by 5 e^3/16; a tilt of 0.01, a
 * step of a hundredth of the diameter, makes that 3e-6 of the lever's part, and 3e-12 at a usual step. */
static inline void calx_lanes_past_normal(const bool planar, const calx_v8 n[3], const calx_v8 u[3], calx_v8 un,
                                          calx_v8 u2, calx_v8 tilt, calx_v8 m[3])
{
    calx_v8 e = tilt * (tilt * u2 - 2.0 * un), s = 1.0 - e * (0.5 - 0.375 * e), st = s * tilt;
    for (int k = 0; k < (planar ? 2 : 3); k++)
        m[k] = s * n[k] - st * u[k];
}

/* Into the plane of n. */
static inline void calx_lanes_lay(const bool planar, const calx_v8 n[3], calx_v8 v[3])
{
    calx_lanes_add(planar, v, -calx_lanes_dot(planar, v, n), n);
}

/* Tangential velocity of i relative to j at the contact point. w: sum of lever times spin; a point at -l n from i moves with v_i - l w_i x n. */
static inline void calx_lanes_slide(const bool planar, const calx_v8 m[3], const calx_v8 u[3], const calx_v8 w[3],
                                    calx_v8 vt[3])
{
    if (planar) {
        vt[0] = u[0] + m[1] * w[2];
        vt[1] = u[1] - m[0] * w[2];
    } else {
        calx_lanes_cross(m, w, vt);
        for (int k = 0; k < 3; k++)
            vt[k] += u[k];
    }
    calx_lanes_lay(planar, m, vt);
}

/* Turns a vector of the plane of the last normal by the least rotation: h - (h.n)/(b.n) b with b = n - turn u half way between the
 * normals, turn = dt/(2 d). Where b is half way to rounding, as for velocity Verlet and bodies that keep their distance, the length is kept
 * exactly; else it changes by the turn squared times half the relative change of distance, of either sign. 1/(b.n) = 1/(1 - q), q = turn un, as
 * a series: what it is wrong by, q^4, is a tilt out of the plane of n of q^4 times the turn, taken out again in the next step. */
static inline void calx_lanes_turn(const bool planar, const calx_v8 n[3], const calx_v8 b[3], calx_v8 q, calx_v8 h[3])
{
    calx_v8 inverse = 1.0 + q * (1.0 + q * (1.0 + q));
    calx_lanes_add(planar, h, -calx_lanes_dot(planar, h, n) * inverse, b);
}

/* The same where the last normal is not known: laid into the plane of n, with its length kept. */
static inline void calx_lanes_turn_flat(const calx_v8 n[3], calx_v8 h[3])
{
    calx_v8 before = calx_lanes_dot(false, h, h);
    calx_lanes_lay(false, n, h);
    calx_v8 after = calx_lanes_dot(false, h, h), one = {1, 1, 1, 1, 1, 1, 1, 1};
    calx_v8 safe = calx_v8_positive(after, after, one), s = calx_v8_sqrt(before / safe);
    for (int k = 0; k < 3; k++)
        h[k] *= s;
}

/* force on i = fn n + ft. */
static inline void calx_lanes_force(const bool planar, const calx_v8 n[3], calx_v8 fn, const calx_v8 ft[3], calx_v8 force[3])
{
    for (int k = 0; k < (planar ? 2 : 3); k++)
        force[k] = fn * n[k] + ft[k];
}

/* twist = n x ft: the couple on i is -lever_i twist, on j -lever_j twist. */
static inline void calx_lanes_twist(const bool planar, const calx_v8 n[3], const calx_v8 ft[3], calx_v8 twist[3])
{
    if (planar)
        twist[2] = n[0] * ft[1] - n[1] * ft[0];
    else
        calx_lanes_cross(n, ft, twist);
}

#endif

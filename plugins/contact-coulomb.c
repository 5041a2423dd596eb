/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "coulomb": a tangential spring with friction, and optional damping.
 * The spring force s is history and grows by increments, ds = -kt w dt; the force is s - ct w, at
 * most mu times the normal force. While it sticks, w is the tangential velocity vt. When it slips,
 * w is what brings spring and damper together to the limit, and vt - w is the slip, against which
 * the force works: so the law never gives energy, as it would with a damper on all of vt.
 * Reference: Cundall and Strack, Geotechnique 29 (1979) 47; the shortened spring: Luding, Granular
 * Matter 10 (2008) 235. Booked as dissipated: the work of the force less what the spring stores,
 * |s|^2/(2 kt).
 */
#include <math.h>

#include "core/plugin.h"

enum { SERIAL, SPRING, PEERS }; /* cap */

struct coulomb {
    double stiffness, friction, damping_rate, damping, cap; /* from the table */
};

static const struct calx_parameter parameters[] = {
    {.name = "stiffness",
     .symbol = "k_t",
     .unit = "N/m",
     .doc = "Stiffness of the tangential spring.",
     .min = 1e-9,
     .max = 1e15,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct coulomb, stiffness)},
    {.name = "friction",
     .symbol = "mu",
     .unit = "1",
     .doc = "Friction coefficient.",
     .min = 0,
     .max = 1e3,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct coulomb, friction)},
    {.name = "damping-rate",
     .symbol = "gamma_t",
     .unit = "1/s",
     .doc = "Tangential damping per effective mass: c_t = gamma_t m*.",
     .min = 0,
     .max = 1e12,
     .scope = CALX_PAIR,
     .offset = offsetof(struct coulomb, damping_rate)},
    {.name = "damping",
     .symbol = "c_t",
     .unit = "N s/m",
     .doc = "Tangential damping coefficient, added to the rate's.",
     .min = 0,
     .max = 1e12,
     .scope = CALX_PAIR,
     .offset = offsetof(struct coulomb, damping)},
    {.name = "cap",
     .symbol = "cap",
     .unit = "1",
     .doc =
         "What friction limits: spring and damper together, in series when it slips; the spring alone (as in "
         "LIGGGHTS); or both, with the damper on all of the sliding velocity (as in LAMMPS: it can give energy, and is "
         "there to reproduce such runs).",
     .min = 0,
     .max = 2,
     .flags = CALX_CHOICE,
     .scope = CALX_RUN,
     .offset = offsetof(struct coulomb, cap),
     .choices = "spring-and-damper|spring|peers"},
};

static int damped(const struct coulomb *p)
{
    return p->damping_rate > 0 || p->damping > 0;
}

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    (void)setup, (void)why, (void)why_size;
    demand->history_vectors = damped(params) ? 2 : 1; /* undamped, the force is the spring */
    return 0;
}

static inline double damping(const struct coulomb *p, double mass)
{
    return p->damping + p->damping_rate * mass;
}

/* The factor that brings a force of size sqrt(f2) to the limit. */
static inline double shorten(double f2, double limit)
{
    return f2 > limit * limit ? limit / sqrt(f2) : 1;
}

CALX_KERNEL static void rub(size_t n, double k, double mu, double dt,
                            const double *restrict overlap, const double *restrict vx,
                            const double *restrict vy, const double *restrict vz,
                            const double *restrict normal_force, double *restrict fx,
                            double *restrict fy, double *restrict fz, double *restrict work,
                            double *restrict sx, double *restrict sy, double *restrict sz)
{
    for (size_t c = 0; c < n; c++) {
        double ux = vx[c] * dt, uy = vy[c] * dt, uz = vz[c] * dt;
        double x = sx[c] - k * ux, y = sy[c] - k * uy, z = sz[c] - k * uz;
        double limit = overlap[c] > 0 ? mu * fabs(normal_force[c]) : 0;
        double share = shorten(x * x + y * y + z * z, limit);
        x *= share, y *= share, z *= share;
        fx[c] += x, fy[c] += y, fz[c] += z;
        /* |s|^2 - |s_old|^2 = (s + s_old).(s - s_old), so that work of force and spring cancel
         * without loss */
        double wx = (sx[c] + x) * (ux + (x - sx[c]) / k);
        double wy = (sy[c] + y) * (uy + (y - sy[c]) / k);
        double wz = (sz[c] + z) * (uz + (z - sz[c]) / k);
        work[c] -= 0.5 * (wx + wy + wz);
        sx[c] = x, sy[c] = y, sz[c] = z;
    }
}

/* h: force of the evaluation before. The damper is before the slider, or beside both if friction
 * limits the spring alone. `cap` is known when this is compiled. */
static inline __attribute__((always_inline)) void slide(
    const int cap, size_t n, const struct coulomb *p, double dt, const double *restrict overlap,
    const double *restrict vx, const double *restrict vy, const double *restrict vz,
    const double *restrict mass, const double *restrict normal_force, double *restrict fx,
    double *restrict fy, double *restrict fz, double *restrict work, double *restrict sx,
    double *restrict sy, double *restrict sz, double *restrict hx, double *restrict hy,
    double *restrict hz)
{
    const double k = p->stiffness, compliance = 1 / k, friction = p->friction;
    const double constant = p->damping, rate = p->damping_rate;
    for (size_t c = 0; c < n; c++) {
        double touch = overlap[c] > 0 ? 1 : 0, ct = (constant + rate * mass[c]) * touch;
        double limited = cap == SPRING ? 0 : ct, pace = k * dt + limited;
        double x = sx[c] - pace * vx[c], y = sy[c] - pace * vy[c], z = sz[c] - pace * vz[c];
        double share = shorten(x * x + y * y + z * z, touch * friction * fabs(normal_force[c]));
        x *= share, y *= share, z *= share;
        double nx = x, ny = y, nz = z; /* the spring */
        if (cap == SERIAL) {
            double part = ct > 0 ? k * dt / pace : 1;
            nx = sx[c] - part * (sx[c] - x), ny = sy[c] - part * (sy[c] - y), nz = sz[c] - part * (sz[c] - z);
        } else if (cap == PEERS) {
            nx += ct * vx[c], ny += ct * vy[c], nz += ct * vz[c];
        } else {
            x -= ct * vx[c], y -= ct * vy[c], z -= ct * vz[c];
        }
        nx *= touch, ny *= touch, nz *= touch;
        fx[c] += x, fy[c] += y, fz[c] += z;
        double done = ((hx[c] + x) * vx[c] + (hy[c] + y) * vy[c] + (hz[c] + z) * vz[c]) * dt;
        double stored =
            (nx + sx[c]) * (nx - sx[c]) + (ny + sy[c]) * (ny - sy[c]) + (nz + sz[c]) * (nz - sz[c]);
        work[c] -= 0.5 * (done + stored * compliance);
        sx[c] = nx, sy[c] = ny, sz[c] = nz;
        hx[c] = x, hy[c] = y, hz[c] = z;
    }
}

CALX_KERNEL static void rub_damped(
    size_t n, const struct coulomb *p, double dt, const double *restrict overlap,
    const double *restrict vx, const double *restrict vy, const double *restrict vz,
    const double *restrict mass, const double *restrict normal_force, double *restrict fx,
    double *restrict fy, double *restrict fz, double *restrict work, double *restrict sx,
    double *restrict sy, double *restrict sz, double *restrict hx, double *restrict hy,
    double *restrict hz)
{
    if (p->cap == SERIAL)
        slide(SERIAL, n, p, dt, overlap, vx, vy, vz, mass, normal_force, fx, fy, fz, work, sx, sy,
              sz, hx, hy, hz);
    else if (p->cap == SPRING)
        slide(SPRING, n, p, dt, overlap, vx, vy, vz, mass, normal_force, fx, fy, fz, work, sx, sy,
              sz, hx, hy, hz);
    else
        slide(PEERS, n, p, dt, overlap, vx, vy, vz, mass, normal_force, fx, fy, fz, work, sx, sy, sz,
              hx, hy, hz);
}

static void force(const void *params, const struct calx_contacts *b)
{
    const struct coulomb *p = params;
    double *const *h = b->history;
    size_t n = calx_padded(b->n);
    if (damped(p))
        rub_damped(n, p, b->dt, b->overlap, b->vt[0], b->vt[1], b->vt[2], b->mass, b->coulomb, b->ft[0],
                   b->ft[1], b->ft[2], b->work, h[0], h[1], h[2], h[3], h[4], h[5]);
    else
        rub(n, p->stiffness, p->friction, b->dt, b->overlap, b->vt[0], b->vt[1], b->vt[2],
            b->coulomb, b->ft[0], b->ft[1], b->ft[2], b->work, h[0], h[1], h[2]);
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct coulomb *p = params;
    double *const *s = b->history;
    for (size_t c = 0; c < b->n; c++) {
        if (b->overlap[c] <= 0)
            continue;
        if (r->energy)
            r->energy[c] +=
                0.5 * (s[0][c] * s[0][c] + s[1][c] * s[1][c] + s[2][c] * s[2][c]) / p->stiffness;
        if (r->stiffness[1])
            r->stiffness[1][c] += p->stiffness;
        if (r->damping[1])
            r->damping[1][c] += damping(p, b->mass[c]);
    }
}

static const char *const history[] = {"spring", "force"};

static const struct calx_contact_law law = {
    .provides = CALX_TANGENTIAL,
    .depends = CALX_NORMAL,
    .demand = {.needs = CALX_NEEDS_TANGENT | CALX_NEEDS_ROTATION | CALX_NEEDS_NORMAL_FORCE |
                        CALX_USES_VELOCITY,
               .history_vectors = 2},
    .history = history,
    .prepare = prepare,
    .force = force,
    .response = response,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "coulomb",
    .summary = "tangential spring with friction",
    .reference =
        "Cundall and Strack, Geotechnique 29 (1979) 47; Luding, Granular Matter 10 (2008) 235",
    .equation = "ds = -k_t w dt;  ft = s - c_t w, |ft| <= mu |fn|;  w = vt while it sticks;  c_t = "
                "gamma_t m* + c_t",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct coulomb),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Contact law "mindlin": tangential force of elastic spheres without partial slip, with friction.
 * The spring force s is history and grows by increments, ds = -kt w dt with kt = 8 G* sqrt(R* d), its
 * mean over the increment: with that of the end, law and integrator together would be of first order;
 * it is not rescaled when the overlap changes. The force is s - ct w, at most mu times the normal
 * force. While it sticks, w is the tangential velocity vt; when it slips, w is what brings spring
 * and damper together to the limit, and vt - w is the slip. Reference: Mindlin, J. Appl. Mech. 16
 * (1949) 259; damping: Tsuji, Tanaka and Ishida, Powder Technology 71 (1992) 239. The spring stores
 * |s|^2/(2 kt) with the kt of the moment, and what the work of the force does not explain of it is
 * booked as dissipated.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/plugin.h"

struct mindlin {
    double young[2], poisson[2], friction, restitution; /* from the table */
    double modulus;                                     /* Pa, 8 G* */
    double root;                                        /* ct = root sqrt(kt m*) */
};

static const struct calx_parameter parameters[] = {
    {.name = "young",
     .symbol = "E",
     .unit = "Pa",
     .doc = "Young's modulus of the material.",
     .min = 1,
     .max = 1e20,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct mindlin, young)},
    {.name = "poisson",
     .symbol = "nu",
     .unit = "1",
     .doc = "Poisson's ratio of the material.",
     .min = -0.99,
     .max = 0.5,
     .flags = CALX_REQUIRED,
     .scope = CALX_MATERIAL,
     .offset = offsetof(struct mindlin, poisson)},
    {.name = "friction",
     .symbol = "mu",
     .unit = "1",
     .doc = "Friction coefficient.",
     .min = 0,
     .max = 1e3,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct mindlin, friction)},
    {.name = "restitution",
     .symbol = "e",
     .unit = "1",
     .doc = "Restitution coefficient that sets the tangential damping; none if it is not given.",
     .min = 0,
     .max = 1,
     .flags = CALX_OPTIONAL,
     .scope = CALX_PAIR,
     .offset = offsetof(struct mindlin, restitution)},
};

static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    struct mindlin *p = params;
    if (setup->bodies == CALX_DISCS) {
        snprintf(why, why_size,
                 "discs touch along a line, where this law does not hold: use coulomb");
        return 1;
    }
    double compliance = 0; /* 1/G* = sum (2 - nu)/G, G = E/(2 (1 + nu)) */
    for (int i = 0; i < 2; i++)
        compliance += (2 - p->poisson[i]) * 2 * (1 + p->poisson[i]) / p->young[i];
    p->modulus = 8 / compliance;
    p->root =
        isnan(p->restitution) ? 0 : 2 * sqrt(5.0 / 6.0) * calx_damping_ratio(p->restitution, 0);
    demand->history_vectors = p->root > 0 ? 2 : 1; /* undamped, the force is the spring */
    return 0;
}

static inline double stiffness(const struct mindlin *p, double d, double k1, double k2)
{
    return d > 0 ? p->modulus * sqrt(d / (k1 + k2)) : 0;
}

static inline double damping(const struct mindlin *p, double kt, double mass)
{
    return p->root * sqrt(kt * mass);
}

/* s: spring, h: force, e: energy stored, all of the evaluation before. Over the increment the overlap goes from `began` to d at a steady
 * pace: the mean of its root is (2/3) (d^(3/2) - began^(3/2))/(d - began), in which nothing cancels as it is written here; of a contact
 * that is new, only the share of the time in which the bodies touch counts. */
CALX_KERNEL static void rub(size_t n, struct mindlin p, double dt, const double *restrict overlap,
                            const double *restrict vn, const double *restrict vx, const double *restrict vy,
                            const double *restrict vz, const double *restrict mass,
                            const double *restrict k1, const double *restrict k2,
                            const double *restrict normal_force, double *restrict fx,
                            double *restrict fy, double *restrict fz, double *restrict work,
                            double *restrict sx, double *restrict sy, double *restrict sz,
                            double *restrict hx, double *restrict hy, double *restrict hz,
                            double *restrict e)
{
    for (size_t c = 0; c < n; c++) {
        double d = overlap[c] > 0 ? overlap[c] : 0, before = d + dt * vn[c], began = before > 0 ? before : 0;
        double shape = p.modulus / sqrt(k1[c] + k2[c]), now = sqrt(d), then = sqrt(began);
        double kt = shape * now, ct = damping(&p, kt, mass[c]);
        double touched = before < 0 ? d / (d - before) : 1;
        double mean = d > 0 ? shape * touched * (d + now * then + began) / (1.5 * (now + then)) : 0;
        double pace = mean * dt + ct, part = ct > 0 ? mean * dt / pace : 1;
        double x = sx[c] - pace * vx[c], y = sy[c] - pace * vy[c], z = sz[c] - pace * vz[c];
        double limit = kt > 0 ? p.friction * fabs(normal_force[c]) : 0, f2 = x * x + y * y + z * z;
        double share = f2 > limit * limit ? limit / sqrt(f2) : 1;
        x *= share, y *= share, z *= share;
        fx[c] += x, fy[c] += y, fz[c] += z;
        double done = ((hx[c] + x) * vx[c] + (hy[c] + y) * vy[c] + (hz[c] + z) * vz[c]) * dt;
        sx[c] -= part * (sx[c] - x), sy[c] -= part * (sy[c] - y), sz[c] -= part * (sz[c] - z);
        double s2 = sx[c] * sx[c] + sy[c] * sy[c] + sz[c] * sz[c],
               stored = kt > 0 ? 0.5 * s2 / kt : 0;
        work[c] -= 0.5 * done + (stored - e[c]);
        hx[c] = x, hy[c] = y, hz[c] = z;
        e[c] = stored;
    }
}

static void force(const void *params, const struct calx_contacts *b)
{
    const struct mindlin *p = params;
    double *const *s = b->history;
    double copy[3][CALX_BATCH]; /* stands for the force if there is no damping */
    size_t n = calx_padded(b->n);
    for (int k = 0; k < 3 && p->root == 0; k++)
        memcpy(copy[k], s[k], n * sizeof(double));
    double *h[] = {p->root > 0 ? s[3] : copy[0], p->root > 0 ? s[4] : copy[1],
                   p->root > 0 ? s[5] : copy[2]};
    rub(n, *p, b->dt, b->overlap, b->vn, b->vt[0], b->vt[1], b->vt[2], b->mass, b->curvature[0],
        b->curvature[1], b->coulomb, b->ft[0], b->ft[1], b->ft[2], b->work, s[0], s[1], s[2], h[0],
        h[1], h[2], s[p->root > 0 ? 6 : 3]);
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct mindlin *p = params;
    const double *stored = b->history[p->root > 0 ? 6 : 3];
    for (size_t c = 0; c < b->n; c++) {
        double kt = stiffness(p, b->overlap[c], b->curvature[0][c], b->curvature[1][c]);
        if (b->overlap[c] <= 0)
            continue;
        if (r->energy)
            r->energy[c] += stored[c];
        if (r->stiffness[1])
            r->stiffness[1][c] += kt;
        if (r->damping[1])
            r->damping[1][c] += damping(p, kt, b->mass[c]);
    }
}

static const char *const history[] = {"spring", "force", "energy"};

static const struct calx_contact_law law = {
    .provides = CALX_TANGENTIAL,
    .depends = CALX_NORMAL,
    .demand = {.needs = CALX_NEEDS_TANGENT | CALX_NEEDS_ROTATION | CALX_NEEDS_NORMAL_FORCE |
                        CALX_NEEDS_CURVATURE | CALX_USES_VELOCITY,
               .history_vectors = 2,
               .history_scalars = 1},
    .history = history,
    .prepare = prepare,
    .force = force,
    .response = response,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "mindlin",
    .summary = "tangential force of elastic spheres, with friction",
    .reference = "Mindlin, J. Appl. Mech. 16 (1949) 259; Tsuji, Tanaka and Ishida, Powder "
                 "Technology 71 (1992) 239",
    .equation =
        "ds = -kt w dt, kt = 8 G* sqrt(R* d);  ft = s - ct w, |ft| <= mu |fn|;  w = vt while it "
        "sticks;\n"
        "1/G* = (2 - nu1)/G1 + (2 - nu2)/G2, G = E/(2 (1 + nu));  ct = 2 sqrt(5/6) b sqrt(kt m*)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct mindlin),
    .law = &law,
};

/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A safe bound of the longest stable step, from the contacts there are now.
 * Small motions about the present state: M u'' + C u' + K u = 0, u the places and angles of all bodies. Contact c of bodies i, j with
 * normal n adds k (d.n)^2 + kt |d - n d.n|^2 to u'Ku, d = x_i - x_j + n x (l_i phi_i + l_j phi_j); and the same with damping to u'Cu.
 * With velocities that lag half a step, velocity Verlet is stable as long as dt^2 K + 2 dt C <= 4 M (at equality the amplification reaches -1, for
 * any number of bodies); for a limit s of omega*dt: dt^2 K + s dt C <= s^2 M. Since (a - b)^2 <= (1 + q) a^2 + (1 + 1/q) b^2
 * for any q > 0, K is at most a matrix of blocks of 6 by 6, one per body, in which contact c counts 1 + q_c times for i and 1 + 1/q_c
 * times for j; the largest eigenvalue of M^-1/2 (.) M^-1/2 is then the largest of the blocks'. q_c = m_i/m_j makes it exact for a
 * pair; shifting q_c from the body with the higher block to the other lowers the bound, which holds at each turn. What this leaves
 * out is the stress in the contacts (fn/R beside kn), which softens a network under pressure.
 */
#include "core/stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/tangent.h"

enum { LANES = 6, SWEEPS = 3, MANY_SWEEPS = 20, POWER_STEPS = 300 };

/* 1/m and l^2/I of one end of a contact. */
struct end {
    double inverse_mass, inverse_inertia, lever;
    double turn; /* 1/m + l^2/I: the inverse mass that a tangential force at the contact moves */
};

struct network {
    struct calx_sim *s;
    struct calx_tangents contacts;
    double (*share)[2]; /* per contact: q of the normal and of the tangential part */
    size_t *first, *list; /* contacts of each row: 2*contact + end */
    double *step;     /* s, per row: the step that its block allows */
    double *plate;    /* 1/s2, per wall: sum of stiffness along its free axis over its mass; 0 for the others */
    double limit;     /* of omega*dt */
};

static struct end end_of(const struct calx_sim *s, const struct calx_tangent *t, int body)
{
    struct end e = {.lever = t->lever[body]};
    int32_t row = t->row[body];
    if (row < 0)
        return e;
    double radius = calx_row_x(s, row)[3];
    e.inverse_mass = calx_row_v(s, row)[3];
    if (s->features.rotation)
        e.inverse_inertia = e.inverse_mass / (calx_particle_inertia_factor(s->scene) * radius * radius);
    e.turn = e.inverse_mass + e.lever * e.lever * e.inverse_inertia;
    return e;
}

/* Adds to a symmetric 6 by 6 block what the contact adds at one end; sign: +1 for body 0, -1 for body 1. */
static void add_block(const struct calx_tangent *t, const struct end *e, double sign, const double k[2],
                      double block[LANES][LANES])
{
    double cross = sign * sqrt(e->inverse_mass * e->inverse_inertia) * e->lever * k[1];
    const double *n = t->normal, spin[3][3] = {{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double along = n[a] * n[b], across = (a == b) - along;
            block[a][b] += e->inverse_mass * (k[0] * along + k[1] * across);
            block[3 + a][3 + b] += e->inverse_inertia * e->lever * e->lever * k[1] * across;
            block[a][3 + b] += cross * spin[a][b];
            block[3 + b][a] += cross * spin[a][b];
        }
}

/* A plane scene moves along x, y and about z only. */
static void confine(double block[LANES][LANES])
{
    static const int absent[] = {2, 3, 4};
    for (int q = 0; q < 3; q++)
        for (int k = 0; k < LANES; k++)
            block[absent[q]][k] = block[k][absent[q]] = 0.0;
}

/* From above, by at most 6^(1/64) - 1 = 3 %: the largest eigenvalue of a positive matrix is at most trace(A^64)^(1/64). */
static double norm_of(double block[LANES][LANES])
{
    double trace = 0.0, scale = 0.0;
    for (int k = 0; k < LANES; k++)
        trace += block[k][k];
    if (!(trace > 0.0))
        return 0.0;
    double a[LANES][LANES], square[LANES][LANES];
    for (int i = 0; i < LANES; i++)
        for (int j = 0; j < LANES; j++)
            a[i][j] = block[i][j] / trace;
    for (int turn = 0; turn < 5; turn++) { /* A^32 */
        for (int i = 0; i < LANES; i++)
            for (int j = 0; j < LANES; j++) {
                square[i][j] = 0.0;
                for (int k = 0; k < LANES; k++)
                    square[i][j] += a[i][k] * a[k][j];
            }
        memcpy(a, square, sizeof a);
    }
    for (int i = 0; i < LANES; i++)
        for (int j = 0; j < LANES; j++)
            scale += a[i][j] * a[i][j];
    return trace * pow(scale, 1.0 / 64.0);
}

static int list_ends(struct network *n)
{
    size_t rows = n->s->r.rows, total = 0;
    n->first = calloc(rows + 2, sizeof *n->first);
    n->list = malloc((2 * n->contacts.count + 1) * sizeof *n->list);
    if (!n->first || !n->list)
        return 1;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t c = 0; c < n->contacts.count; c++)
            for (size_t b = 0; b < 2; b++) {
                int32_t row = n->contacts.list[c].row[b];
                if (row >= 0 && pass == 0)
                    n->first[row + 2]++;
                else if (row >= 0)
                    n->list[n->first[row + 1]++] = 2 * c + b;
            }
        for (size_t r = 0; r < rows && pass == 0; r++)
            n->first[r + 2] = total += n->first[r + 2];
    }
    return 0;
}

static double quotient(double a, double b)
{
    return a > 0.0 && b > 0.0 ? a / b : 1.0;
}

static void first_shares(const struct network *n)
{
    for (size_t c = 0; c < n->contacts.count; c++) {
        struct end e[2] = {end_of(n->s, &n->contacts.list[c], 0), end_of(n->s, &n->contacts.list[c], 1)};
        n->share[c][0] = quotient(e[1].inverse_mass, e[0].inverse_mass);
        n->share[c][1] = quotient(e[1].turn, e[0].turn);
    }
}

static bool moves(const struct network *n, int32_t row)
{
    return row >= 0 && calx_row_v(n->s, row)[3] > 0.0;
}

/* dt^2 k + s c dt = s^2 */
static double step_of(double limit, double k, double c)
{
    double root = c + sqrt(c * c + 4.0 * k);
    return root > 0.0 ? 2.0 * limit / root : INFINITY;
}

/* ---- plates: walls and groups of finite mass along one axis ---- */

/* The plate that this end of a contact is part of, or -1. */
static int plate_of(const struct network *n, int32_t row)
{
    const struct calx_scene *scene = n->s->scene;
    int wall = row < 0 ? -1 - row : scene->particles.carrier ? scene->particles.carrier[n->s->r.id[row]] : -1;
    return wall >= 0 && scene->stages[n->s->stage].motion[wall].free ? wall : -1;
}

/* The part of a contact's normal (0) or tangential (1) stiffness that acts along the plate's axis, over its mass. */
static double plate_part(const struct network *n, const struct calx_tangent *t, int plate, int q)
{
    const struct calx_motion *m = &n->s->scene->stages[n->s->stage].motion[plate];
    double square = t->normal[m->free_axis] * t->normal[m->free_axis];
    return (q ? 1.0 - square : square) / m->mass;
}

static void sum_plates(const struct network *n)
{
    for (size_t c = 0; c < n->contacts.count; c++)
        for (int b = 0; b < 2; b++) {
            const struct calx_tangent *t = &n->contacts.list[c];
            int plate = plate_of(n, t->row[b]);
            for (int q = 0; plate >= 0 && q < 2; q++)
                n->plate[plate] += plate_part(n, t, plate, q) * t->stiffness[q];
        }
}

/* q of a contact with a plate, for end b that is a body: what its contacts with the plate make of its block then grows by no more than the
 * plate's own sum. */
static double plate_share(const struct network *n, const struct calx_tangent *t, int b, int q)
{
    int plate = plate_of(n, t->row[1 - b]);
    struct end e = end_of(n->s, t, b);
    double own = t->stiffness[q] * (q ? e.turn : e.inverse_mass);
    return plate >= 0 && own > 0.0 ? n->plate[plate] / own : 0.0;
}

static double plates_step(const struct network *n)
{
    double least = INFINITY;
    for (int w = 0; w < (int)n->s->scene->wall_count; w++) {
        double sum[2] = {0.0}; /* its own damping is implicit */
        for (size_t c = 0; c < n->contacts.count && n->plate[w] > 0.0; c++)
            for (int k = 0; k < 4; k++) {
                const struct calx_tangent *t = &n->contacts.list[c];
                int b = k / 2, q = k % 2;
                if (plate_of(n, t->row[b]) != w)
                    continue;
                double share = plate_share(n, t, 1 - b, q), times = share > 0.0 ? 1.0 + 1.0 / share : 1.0;
                sum[0] += times * plate_part(n, t, w, q) * t->stiffness[q];
                sum[1] += times * plate_part(n, t, w, q) * t->damping[q];
            }
        least = fmin(least, step_of(n->limit, sum[0], sum[1]));
    }
    return least;
}

/* From above: a plate between bodies that stay where they are. */
static double plates_alone(const struct network *n)
{
    double least = INFINITY;
    for (size_t w = 0; w < n->s->scene->wall_count; w++)
        least = fmin(least, step_of(n->limit, n->plate[w], 0.0));
    return least;
}

static void take_plates(const struct network *n, struct calx_stability *out)
{
    double step = plates_step(n);
    if (!(step < out->limit))
        return;
    out->limit = step;
    out->id = -1;
    out->contacts = 0;
}

static double row_step(const struct network *n, size_t row)
{
    double block[2][LANES][LANES] = {{{0}}};
    for (size_t k = n->first[row]; k < n->first[row + 1]; k++) {
        const struct calx_tangent *t = &n->contacts.list[n->list[k] / 2];
        int b = (int)(n->list[k] % 2);
        struct end e = end_of(n->s, t, b);
        double stiffness[2], damping[2], sign = b ? -1.0 : 1.0;
        for (int q = 0; q < 2; q++) {
            double share = n->share[n->list[k] / 2][q];
            double times = !moves(n, t->row[1 - b]) ? 1.0 + plate_share(n, t, b, q) : 1.0 + (b ? 1.0 / share : share);
            stiffness[q] = times * t->stiffness[q];
            damping[q] = times * t->damping[q];
        }
        add_block(t, &e, sign, stiffness, block[0]);
        add_block(t, &e, sign, damping, block[1]);
    }
    for (int q = 0; q < 2 && n->s->scene->dimension == 2; q++)
        confine(block[q]);
    return step_of(n->limit, norm_of(block[0]), norm_of(block[1]));
}

/* From the body that allows the shorter step to the other. */
static void shift_shares(const struct network *n)
{
    for (size_t c = 0; c < n->contacts.count; c++) {
        const int32_t *row = n->contacts.list[c].row;
        if (!moves(n, row[0]) || !moves(n, row[1]))
            continue;
        double shift = n->step[row[0]] / n->step[row[1]];
        for (int q = 0; q < 2; q++)
            n->share[c][q] = fmin(fmax(n->share[c][q] * shift, 1e-12), 1e12);
    }
}

/* Each turn gives a bound that holds; the best is kept. */
static void bound(struct network *n, int sweeps, struct calx_stability *out)
{
    first_shares(n);
    out->limit = n->contacts.count ? 0.0 : INFINITY;
    for (int sweep = 0; sweep < sweeps && n->contacts.count; sweep++) {
        double least = INFINITY;
        int32_t whose = -1;
        for (size_t row = 0; row < n->s->r.rows; row++) {
            n->step[row] = n->first[row + 1] > n->first[row] ? row_step(n, row) : INFINITY;
            if (n->step[row] < least) {
                least = n->step[row];
                whose = (int32_t)row;
            }
        }
        if (least > out->limit) {
            out->limit = least;
            out->id = whose < 0 ? -1 : n->s->r.id[whose];
            out->contacts = whose < 0 ? 0 : (int32_t)(n->first[whose + 1] - n->first[whose]);
        }
        shift_shares(n);
    }
}

/* Plain sums: as if a body's contacts all pulled the same way. */
static double plain_step(const struct network *n, struct calx_stability *out)
{
    double least = INFINITY;
    for (size_t row = 0; row < n->s->r.rows; row++) {
        double sum[2] = {0};
        for (size_t k = n->first[row]; k < n->first[row + 1]; k++) {
            const struct calx_tangent *t = &n->contacts.list[n->list[k] / 2];
            int b = (int)(n->list[k] % 2);
            struct end e = end_of(n->s, t, b), other = end_of(n->s, t, 1 - b);
            double normal = e.inverse_mass + other.inverse_mass, across = e.turn + other.turn;
            sum[0] += fmax(t->stiffness[0] * normal, t->stiffness[1] * across);
            sum[1] += fmax(t->damping[0] * normal, t->damping[1] * across);
        }
        double step = step_of(n->limit, sum[0], sum[1]);
        if (step < least && moves(n, (int32_t)row)) {
            least = step;
            out->id = n->s->r.id[row];
            out->contacts = (int32_t)(n->first[row + 1] - n->first[row]);
        }
    }
    return least;
}

/* ---- the eigenvalue itself ---- */

/* The displacement at the contact that scaled places and angles u = M^1/2 (x, phi) make. */
static void displacement(const struct calx_tangent *t, const struct end e[2], const double (*u)[LANES],
                         double out[3])
{
    const double *n = t->normal;
    memset(out, 0, 3 * sizeof *out);
    for (int b = 0; b < 2; b++) {
        if (t->row[b] < 0)
            continue;
        const double *v = u[t->row[b]], *w = v + 3;
        double m = (b ? -1.0 : 1.0) * sqrt(e[b].inverse_mass), l = e[b].lever * sqrt(e[b].inverse_inertia);
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            out[k] += m * v[k] + l * (n[p] * w[q] - n[q] * w[p]);
        }
    }
}

/* Adds the forces f at the contact to the scaled accelerations. */
static void react(const struct calx_tangent *t, const struct end e[2], const double f[3], double (*a)[LANES])
{
    const double *n = t->normal;
    for (int b = 0; b < 2; b++) {
        if (t->row[b] < 0)
            continue;
        double *v = a[t->row[b]], *w = v + 3;
        double m = (b ? -1.0 : 1.0) * sqrt(e[b].inverse_mass), l = e[b].lever * sqrt(e[b].inverse_inertia);
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            v[k] += m * f[k];
            w[k] += l * (f[p] * n[q] - f[q] * n[p]);
        }
    }
}

/* a = (K + r C) u in scaled coordinates; the quadratic forms of K and C come with it. */
static void apply(const struct network *n, double r, const double (*u)[LANES], double (*a)[LANES], double form[2])
{
    form[0] = form[1] = 0.0;
    memset(a, 0, n->s->r.rows * sizeof *a);
    for (size_t c = 0; c < n->contacts.count; c++) {
        const struct calx_tangent *t = &n->contacts.list[c];
        struct end e[2] = {end_of(n->s, t, 0), end_of(n->s, t, 1)};
        double d[3], f[3], along = 0.0;
        displacement(t, e, u, d);
        if (n->s->scene->dimension == 2)
            d[2] = 0.0;
        for (int k = 0; k < 3; k++)
            along += d[k] * t->normal[k];
        for (int k = 0; k < 3; k++) {
            double dn = along * t->normal[k], dt = d[k] - dn;
            double stiff = t->stiffness[0] * dn + t->stiffness[1] * dt, damp = t->damping[0] * dn + t->damping[1] * dt;
            f[k] = stiff + r * damp;
            form[0] += stiff * d[k];
            form[1] += damp * d[k];
        }
        react(t, e, f, a);
    }
}

/* The power method, from a start that has a part of every mode. Its quotient comes from below, and so the step from above. */
static double power_step(const struct network *n, double step, struct calx_error *e, int *code)
{
    size_t rows = n->s->r.rows;
    double(*u)[LANES] = calloc(rows + 1, sizeof *u), (*a)[LANES] = calloc(rows + 1, sizeof *a);
    if (!u || !a) {
        *code = calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the fastest vibration");
        step = NAN;
    }
    uint64_t seed = 1;
    for (size_t k = 0; u && a && k < LANES * rows; k++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        u[k / LANES][k % LANES] = (double)(seed >> 40) / (double)(1 << 24) - 0.5;
    }
    for (int turn = 0; u && a && turn < POWER_STEPS; turn++) {
        double form[2], size2 = 0.0, norm2 = 0.0;
        apply(n, n->limit / step, (const double(*)[LANES])u, a, form);
        for (size_t k = 0; k < LANES * rows; k++) {
            size2 += u[k / LANES][k % LANES] * u[k / LANES][k % LANES];
            norm2 += a[k / LANES][k % LANES] * a[k / LANES][k % LANES];
        }
        if (!(norm2 > 0.0))
            break;
        step = step_of(n->limit, form[0] / size2, form[1] / size2);
        for (size_t k = 0; k < LANES * rows; k++)
            u[k / LANES][k % LANES] = a[k / LANES][k % LANES] / sqrt(norm2);
    }
    free(u);
    free(a);
    return step;
}

/* Half a period of a single contact, the shortest. */
static void find_shortest(const struct network *n, struct calx_stability *out)
{
    double most = 0.0;
    for (size_t c = 0; c < n->contacts.count; c++) {
        const struct calx_tangent *t = &n->contacts.list[c];
        double omega2 = t->stiffness[0] * t->inverse_mass;
        if (omega2 <= most)
            continue;
        most = omega2;
        for (int b = 0; b < 2; b++)
            out->pair[b] = t->row[b] < 0 ? t->row[b] : n->s->r.id[t->row[b]];
    }
    out->shortest = most > 0.0 ? M_PI / sqrt(most) : INFINITY;
}

int calx_stability_look(struct calx_sim *s, enum calx_effort effort, struct calx_stability *out, struct calx_error *e)
{
    struct network n = {.s = s};
    *out = (struct calx_stability){INFINITY, NAN, INFINITY, -1, 0, INFINITY, {-1, -1}};
    if (!s->plan->motion || !s->plan->law_count || s->plan->nonsmooth) /* a rigid contact does not vibrate */
        return 0;
    CALX_TRY(calx_tangents_collect(s, &n.contacts, e));
    n.limit = s->plan->motion_law->stability;
    n.step = calloc(s->r.rows + 1, sizeof *n.step);
    n.share = malloc((n.contacts.count + 1) * sizeof *n.share);
    n.plate = calloc(s->scene->wall_count + 1, sizeof *n.plate);
    int code = 0;
    if (!n.step || !n.share || !n.plate || list_ends(&n)) {
        code = calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for the longest stable step");
    } else {
        find_shortest(&n, out);
        sum_plates(&n);
        out->limit = out->plain = plain_step(&n, out);
        if (effort > CALX_QUICK)
            bound(&n, effort == CALX_SHARP ? MANY_SWEEPS : SWEEPS, out);
        take_plates(&n, out);
        if (effort == CALX_SHARP && isfinite(out->limit))
            out->sharp = fmin(power_step(&n, out->limit, e, &code), plates_alone(&n));
    }
    void *all[] = {n.step, n.share, n.plate, n.first, n.list, n.contacts.list};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
    return code;
}

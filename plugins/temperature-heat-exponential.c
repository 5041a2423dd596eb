/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integrator of temperature "heat-exponential": C dT/dt = q(T) solved exactly while conductances,
 * sources and walls stay, dT = dt phi1(-dt A) C^-1 q(T), A = C^-1 L, phi1(z) = (e^z - 1)/z. The
 * function of A is taken on the space that powers of (1 + g dt A)^-1 span (van den Eshof and
 * Hochbruck, SIAM J. Sci. Comput. 27 (2006) 1438): it converges the same however stiff the network
 * is, as sqrt(2) - 1 to the number of vectors for the best g (Saff, Schoenhage and Varga, Numer.
 * Math. 25 (1976) 307), and in few vectors where it is not. Each vector is one solve by conjugate
 * gradients with the diagonal as preconditioner; the first is that power itself of C^-1 q, so that
 * what stiff contacts round does not reach the slow modes. Heat from walls is the integral over the
 * step, by phi2(z) = (phi1(z) - 1)/z on the same space. A shift by what the solver leaves keeps the
 * sum of heat to round-off. Sums in a fixed order, so that runs repeat bit by bit.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/plugin.h"

enum { VECTORS_MAX = 60 };

static const double SHIFT = 0.047; /* g: sqrt(2)/30, the best for 30 vectors */
static const double SOLVE = 1e-15; /* residual of a solve, relative to the right side */

struct exponential {
    double tolerance;
};

static const struct calx_parameter parameters[] = {
    {.name = "tolerance",
     .symbol = "tol",
     .unit = "1",
     .doc = "Error of the change of temperature in a step, relative to its size.",
     .initial = 1e-12,
     .min = 1e-13,
     .max = 1e-2,
     .scope = CALX_RUN,
     .offset = offsetof(struct exponential, tolerance)},
};

/* ---- the network ---- */

/* out += L t, walls at 0. */
static void add_outflow(const struct calx_network *net, const double *t, double *out)
{
    for (size_t e = 0; e < net->edges; e++) {
        int32_t i = net->edge[0][e], j = net->edge[1][e];
        double q = net->edge_conductance[e] * (t[i] - t[j]);
        out[i] += q;
        out[j] -= q;
    }
    for (size_t b = 0; b < net->boundaries; b++)
        out[net->boundary[b]] += net->boundary_conductance[b] * t[net->boundary[b]];
}

/* C^-1 q at the present temperatures, K/s; and the sum of conductances of each body. */
static void fill_rates(const struct calx_network *net, double *rate, double *sum)
{
    for (size_t i = 0; i < net->n; i++) {
        rate[i] = 0;
        sum[i] = 0;
    }
    for (size_t e = 0; e < net->edges; e++) {
        int32_t i = net->edge[0][e], j = net->edge[1][e];
        double h = net->edge_conductance[e], q = h * (net->temperature[j] - net->temperature[i]);
        rate[i] += q;
        rate[j] -= q;
        sum[i] += h;
        sum[j] += h;
    }
    for (size_t b = 0; b < net->boundaries; b++) {
        int32_t i = net->boundary[b];
        rate[i] +=
            net->boundary_conductance[b] * (net->boundary_temperature[b] - net->temperature[i]);
        sum[i] += net->boundary_conductance[b];
    }
    for (size_t i = 0; i < net->n; i++)
        rate[i] = (rate[i] + net->source[i]) / net->capacity[i];
}

/* ---- vectors ---- */

static double dot(size_t n, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* In the metric of the capacities, in which A is symmetric. */
static double product(const struct calx_network *net, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < net->n; i++)
        sum += net->capacity[i] * a[i] * b[i];
    return sum;
}

static void add(size_t n, double factor, const double *a, double *b)
{
    for (size_t i = 0; i < n; i++)
        b[i] += factor * a[i];
}

/* Solves (C + g dt L) x = C b from x = 0; work: 4 n numbers. Returns 0, or 1 if the residual stays
 * too large. */
static int solve_shifted(const struct calx_network *net, const double *sum, const double *b,
                         double *x, double *work)
{
    size_t n = net->n, most = 20 * n + 200;
    double *r = work, *z = r + n, *p = z + n, *ap = p + n, shift = SHIFT * net->dt;
    for (size_t i = 0; i < n; i++) {
        x[i] = 0;
        r[i] = net->capacity[i] * b[i];
        p[i] = z[i] = r[i] / (net->capacity[i] + shift * sum[i]);
    }
    double rz = dot(n, r, z), stop = SOLVE * SOLVE * rz;
    for (size_t k = 0; k < most && rz > stop; k++) {
        for (size_t i = 0; i < n; i++)
            ap[i] = 0;
        add_outflow(net, p, ap);
        for (size_t i = 0; i < n; i++)
            ap[i] = net->capacity[i] * p[i] + shift * ap[i];
        double alpha = rz / dot(n, p, ap), before = rz;
        for (size_t i = 0; i < n; i++) {
            x[i] += alpha * p[i];
            r[i] -= alpha * ap[i];
            z[i] = r[i] / (net->capacity[i] + shift * sum[i]);
        }
        rz = dot(n, r, z);
        for (size_t i = 0; i < n; i++)
            p[i] = z[i] + rz / before * p[i];
    }
    return !(rz <= stop);
}

/* ---- the small matrix ---- */

struct projection {
    size_t m;
    double matrix[VECTORS_MAX][VECTORS_MAX]; /* (1 + g dt A)^-1 on the vectors */
    double phi[2][VECTORS_MAX]; /* phi1 and phi2 of -dt A, applied to the first vector */
};

static double phi1(double z) /* z >= 0: of -z */
{
    return z > 1e-8 ? -expm1(-z) / z : 1 - 0.5 * z;
}

static double phi2(double z)
{
    return z > 1e-2 ? (1 - phi1(z)) / z
                    : 0.5 - z / 6 * (1 - z / 4 * (1 - z / 5 * (1 - z / 6 * (1 - z / 7))));
}

/* One rotation of Jacobi's, of rows and columns p and q of a, and of the columns of the vectors. */
static void rotate(size_t m, double (*a)[VECTORS_MAX], double (*v)[VECTORS_MAX], size_t p, size_t q)
{
    if (a[p][q] == 0)
        return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (size_t k = 0; k < m; k++) {
        double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (size_t k = 0; k < m; k++) {
        double pk = a[p][k], qk = a[q][k], vp = v[k][p], vq = v[k][q];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
    }
}

/* Jacobi's sweeps (Golub and Van Loan, Matrix Computations, sec. 8.5): a becomes diagonal, v its
 * eigenvectors. Quadratic once near: a dozen sweeps reach round-off. */
static void diagonalise(size_t m, double (*a)[VECTORS_MAX], double (*v)[VECTORS_MAX])
{
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            v[i][j] = i == j;
    for (int sweep = 0; sweep < 14; sweep++)
        for (size_t p = 0; p + 1 < m; p++)
            for (size_t q = p + 1; q < m; q++)
                rotate(m, a, v, p, q);
}

/* Fills phi from the matrix: an eigenvalue e of (1 + g dt A)^-1 is (1/e - 1)/g of dt A. The first
 * vector is (1 + g dt A)^-1 C^-1 q, of which phi1 is (1 + g z) phi1(z), phi2 (1 + g z) phi2(z). */
static void fill_phi(struct projection *s)
{
    double a[VECTORS_MAX][VECTORS_MAX], v[VECTORS_MAX][VECTORS_MAX];
    for (size_t i = 0; i < s->m; i++)
        for (size_t j = 0; j < s->m; j++)
            a[i][j] = 0.5 * (s->matrix[i][j] + s->matrix[j][i]);
    diagonalise(s->m, a, v);
    for (size_t i = 0; i < s->m; i++)
        s->phi[0][i] = s->phi[1][i] = 0;
    for (size_t k = 0; k < s->m; k++) {
        double e = fmin(fmax(a[k][k], 1e-300), 1), z = (1 / e - 1) / SHIFT;
        for (size_t i = 0; i < s->m; i++) {
            s->phi[0][i] += v[i][k] * (1 + SHIFT * z) * phi1(z) * v[0][k];
            s->phi[1][i] += v[i][k] * (phi2(z) + SHIFT * (1 - phi1(z))) * v[0][k];
        }
    }
}

/* How much the last vector changed phi1, relative to its size. */
static double change(const struct projection *s, const double *before)
{
    double off = 0, size = 0;
    for (size_t i = 0; i < s->m; i++) {
        double d = s->phi[0][i] - (i + 1 < s->m ? before[i] : 0);
        off += d * d;
        size += s->phi[0][i] * s->phi[0][i];
    }
    return sqrt(off / size);
}

/* ---- a step ---- */

/* Makes w orthogonal to the m vectors, twice, and of size 1; notes what it took off in the matrix's
 * last column. Returns the size that was left. */
static double orthogonalise(const struct calx_network *net, struct projection *s,
                            const double *vectors, double *w)
{
    size_t n = net->n;
    for (int twice = 0; twice < 2; twice++)
        for (size_t k = 0; k < s->m; k++) {
            double h = product(net, vectors + k * n, w);
            s->matrix[k][s->m - 1] += h;
            add(n, -h, vectors + k * n, w);
        }
    double size = sqrt(product(net, w, w));
    for (size_t i = 0; i < n && size > 0; i++)
        w[i] /= size;
    return size;
}

/* Grows the space until phi1 stands, twice in a row; the first vector is there. Returns 0, 1 if it
 * does not, 2 if a solve fails. */
static int grow(const struct calx_network *net, double tolerance, const double *sum,
                struct projection *s, double *vectors, double *work)
{
    double before[VECTORS_MAX] = {0};
    int stands = 0;
    for (s->m = 1; s->m < VECTORS_MAX; s->m++) {
        double *last = vectors + (s->m - 1) * net->n, *next = last + net->n;
        for (size_t k = 0; k < s->m; k++)
            s->matrix[k][s->m - 1] = 0;
        if (solve_shifted(net, sum, last, next, work))
            return 2;
        double left = orthogonalise(net, s, vectors, next);
        for (size_t k = 0; k + 1 < s->m; k++) /* symmetric */
            s->matrix[s->m - 1][k] = s->matrix[k][s->m - 1];
        fill_phi(s);
        stands = change(s, before) < tolerance ? stands + 1 : 0;
        if (stands == 2 || left < 1e-14) /* or the space holds all that the rates can reach */
            return 0;
        for (size_t i = 0; i < s->m; i++)
            before[i] = s->phi[0][i];
    }
    return 1;
}

/* What the space says: sum over vectors of phi, times factor. */
static void combine(const struct calx_network *net, const struct projection *s, int which,
                    double factor, const double *vectors, double *out)
{
    for (size_t i = 0; i < net->n; i++)
        out[i] = 0;
    for (size_t k = 0; k < s->m; k++)
        add(net->n, factor * s->phi[which][k], vectors + k * net->n, out);
}

/* Books the heat from the walls, integral: of the change of temperatures over the step, K s; and
 * adds the change with the shift that makes the heat of the bodies what sources and walls gave. */
static void finish(const struct calx_network *net, const double *change, const double *integral)
{
    double given = 0, taken = 0, capacity = 0;
    for (size_t b = 0; b < net->boundaries; b++) {
        int32_t i = net->boundary[b];
        net->boundary_heat[b] =
            net->boundary_conductance[b] *
            (net->dt * (net->boundary_temperature[b] - net->temperature[i]) - integral[i]);
        given += net->boundary_heat[b];
    }
    for (size_t i = 0; i < net->n; i++) {
        given += net->dt * net->source[i];
        taken += net->capacity[i] * change[i];
        capacity += net->capacity[i];
    }
    for (size_t i = 0; i < net->n; i++)
        net->temperature[i] += change[i] + (given - taken) / capacity;
}

static int advance(const struct calx_network *net, double tolerance, struct projection *s,
                   double *memory)
{
    size_t n = net->n;
    double *sum = memory, *work = sum + n, *vectors = work + 4 * n;
    double *rates = vectors + n;
    fill_rates(net, rates, sum);
    if (solve_shifted(net, sum, rates, vectors, work))
        return 2;
    double size = sqrt(product(net, vectors, vectors));
    for (size_t i = 0; i < n && size > 0; i++)
        vectors[i] /= size;
    int failed = isnan(size) ? 1 : size > 0 ? grow(net, tolerance, sum, s, vectors, work) : 0;
    if (failed)
        return failed;
    combine(net, s, 0, net->dt * size, vectors, work);
    combine(net, s, 1, net->dt * net->dt * size, vectors, work + n);
    finish(net, work, work + n);
    return 0;
}

static int solve(const void *params, const struct calx_network *net, char *why, size_t why_size)
{
    const struct exponential *p = params;
    size_t n = net->n;
    if (n == 0)
        return 0;
    double *memory = malloc((VECTORS_MAX + 6) * n * sizeof *memory);
    struct projection *s = calloc(1, sizeof *s);
    int failed = 3;
    if (memory && s)
        failed = advance(net, p->tolerance, s, memory);
    if (failed == 3)
        snprintf(why, why_size, "no memory for the temperatures of %zu bodies", n);
    else if (failed)
        snprintf(why, why_size, "%s for %zu temperatures did not reach the tolerance %g",
                 failed == 1 ? "the exponential" : "conjugate gradients", n,
                 failed == 1 ? p->tolerance : SOLVE);
    free(memory);
    free(s);
    return failed != 0;
}

static const struct calx_temperature_integrator law = {
    .order = 2,
    .exact = 1,
    .unconditional = 1,
    .solve = solve,
};

CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_TEMPERATURE,
    .name = "heat-exponential",
    .summary = "exact while the network stays, however stiff",
    .reference = "van den Eshof and Hochbruck, SIAM J. Sci. Comput. 27 (2006) 1438",
    .equation = "T += dt phi1(-dt C^-1 L) C^-1 q(T), phi1(z) = (e^z - 1)/z;  q_i = source_i + "
                "sum_j H_ij (T_j - T_i)",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct exponential),
    .law = &law,
};

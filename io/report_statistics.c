/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The few statistics that a report needs.
 * Student's t: Cornish-Fisher expansion of the quantile about the normal one (Abramowitz and Stegun,
 * 26.7.5), exact values below 3 degrees of freedom, where it is poor; within 0.5 % of the tables.
 */
#include <math.h>
#include <stdlib.h>

#include "io/report_parts.h"

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Linear between the order statistics. */
static double quantile(const double *sorted, size_t n, double share)
{
    double at = share * (double)(n - 1);
    size_t below = (size_t)at, above = below + 1 < n ? below + 1 : below;
    return sorted[below] + (at - (double)below) * (sorted[above] - sorted[below]);
}

double calx_report_median(double *v, size_t n)
{
    qsort(v, n, sizeof *v, ascending);
    return n ? quantile(v, n, 0.5) : NAN;
}

double calx_report_scatter(double *v, size_t n)
{
    qsort(v, n, sizeof *v, ascending);
    return n ? 0.5 * (quantile(v, n, 0.75) - quantile(v, n, 0.25)) : NAN;
}

static int by_value(const void *a, const void *b)
{
    return ascending(&((const struct calx_report_weighted *)a)->value, &((const struct calx_report_weighted *)b)->value);
}

double calx_report_weighted_quantile(struct calx_report_weighted *v, size_t n, double share)
{
    double all = 0, before = 0;
    qsort(v, n, sizeof *v, by_value);
    for (size_t k = 0; k < n; k++)
        all += v[k].weight;
    for (size_t k = 0; k < n; k++) {
        before += v[k].weight;
        if (before >= share * all)
            return v[k].value;
    }
    return NAN;
}

double calx_report_student(size_t degrees)
{
    static const double exact[] = {INFINITY, 12.7062, 4.30265, 3.18245};
    const double z = 1.959964, n = (double)degrees;
    if (degrees < sizeof exact / sizeof *exact)
        return exact[degrees];
    double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
    return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
           (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

double calx_report_slope(const double *x, const double *y, size_t n, double *error)
{
    double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;
    for (size_t k = 0; k < n; k++) {
        mx += x[k] / (double)n;
        my += y[k] / (double)n;
    }
    for (size_t k = 0; k < n; k++) {
        xx += (x[k] - mx) * (x[k] - mx);
        xy += (x[k] - mx) * (y[k] - my);
    }
    double slope = xy / xx;
    for (size_t k = 0; k < n; k++)
        rest += (y[k] - my - slope * (x[k] - mx)) * (y[k] - my - slope * (x[k] - mx));
    *error = n > 2 ? sqrt(rest / (double)(n - 2) / xx) : NAN;
    return slope;
}

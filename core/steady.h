/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Private to core and the tests: what means of equal blocks of time say about whether a signal is stationary.
 */
#ifndef CALX_STEADY_H
#define CALX_STEADY_H

#include <stddef.h>

/* In the unit of the signal; uncertainties are half-widths of 95 % confidence intervals. */
struct calx_steady_verdict {
    double mean, error;   /* of all blocks */
    double change, doubt; /* of the mean from the first half to the second */
    double drift;         /* (|change| + doubt)/within: steady where it is at most 1 */
};

/* Of n > 2 blocks, an even number, the oldest first. NaN if one of them is. */
struct calx_steady_verdict calx_steady_judge(const double *blocks, size_t n, double within);

/* The t that Student's distribution of an even number of degrees of freedom exceeds in size with a probability of 5 %. */
double calx_steady_student(size_t freedom);

#endif

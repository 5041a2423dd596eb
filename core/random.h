/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A small random number generator with the same stream for a seed on every platform: xoshiro256**
 * seeded by splitmix64 (Blackman and Vigna, "Scrambled linear pseudorandom number generators", ACM
 * Trans. Math. Softw. 47(4), 2021). Not for cryptography.
 */
#ifndef CALX_RANDOM_H
#define CALX_RANDOM_H

#include <stdint.h>

struct calx_random {
    uint64_t s[4];
};

/* Starts the stream of a seed; every seed, 0 too, is good. */
void calx_random_seed(struct calx_random *random, uint64_t seed);

/* The next 64 random bits. */
uint64_t calx_random_bits(struct calx_random *random);

/* Uniform in [0, 1), a multiple of 2^-53. */
double calx_random_uniform(struct calx_random *random);

/* Normal with mean 0 and standard deviation 1 (Marsaglia's polar method; one value per call,
 * nothing is cached). */
double calx_random_normal(struct calx_random *random);

/* Lognormal with this mean and standard deviation of the value itself (not of its logarithm); both
 * > 0. */
double calx_random_lognormal(struct calx_random *random, double mean, double deviation);

/* Uniform in 0 ... n-1 without bias; n > 0. */
uint64_t calx_random_below(struct calx_random *random, uint64_t n);

#endif

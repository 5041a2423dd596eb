/* SPDX-License-Identifier: BSD-3-Clause
 *
 * xoshiro256** with seeding by splitmix64, and the distributions that packings draw from. Input: a
 * seed; output: the same stream on every platform. D. Blackman, S. Vigna, "Scrambled linear
 * pseudorandom number generators", ACM Trans. Math. Softw. 47(4), 36 (2021); G. Marsaglia, T. A.
 * Bray, SIAM Review 6, 260 (1964) for the normal distribution.
 */
#include "core/random.h"

#include <math.h>

static uint64_t rotate(uint64_t x, int bits)
{
    return x << bits | x >> (64 - bits);
}

void calx_random_seed(struct calx_random *random, uint64_t seed)
{
    for (int k = 0; k < 4; k++) {
        uint64_t z = seed += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        random->s[k] = z ^ z >> 31;
    }
}

uint64_t calx_random_bits(struct calx_random *random)
{
    uint64_t *s = random->s, result = rotate(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate(s[3], 45);
    return result;
}

double calx_random_uniform(struct calx_random *random)
{
    return (double)(calx_random_bits(random) >> 11) * 0x1p-53;
}

double calx_random_normal(struct calx_random *random)
{
    for (;;) {
        double u = 2 * calx_random_uniform(random) - 1, v = 2 * calx_random_uniform(random) - 1;
        double s = u * u + v * v;
        if (s > 0 && s < 1)
            return u * sqrt(-2 * log(s) / s);
    }
}

double calx_random_lognormal(struct calx_random *random, double mean, double deviation)
{
    double ratio = deviation / mean, variance = log(1 + ratio * ratio); /* of the logarithm */
    return mean * exp(sqrt(variance) * calx_random_normal(random) - variance / 2);
}

uint64_t calx_random_below(struct calx_random *random, uint64_t n)
{
    uint64_t rest = -n % n,
             bits; /* 2^64 mod n: the first values would make small results likelier */
    do
        bits = calx_random_bits(random);
    while (bits < rest);
    return bits % n;
}

/* SPDX-License-Identifier: MIT
 *
 * Random numbers: xoshiro256++ (D. Blackman, S. Vigna, "Scrambled Linear Pseudorandom Number
 * Generators", ACM TOMS 47, 2021), one stream per (seed, pixel, sample). The initial state is a
 * hash of the three, 128 bits wide before it is expanded to the 256 bits of the state, so that no
 * two streams of a render, or of two seeds, overlap.
 */
#ifndef NEPH_TRUTH_RANDOM_H
#define NEPH_TRUTH_RANDOM_H

#include <stdint.h>

struct neph_random {
    uint64_t state[4];
};

/* The stream of one sample of one pixel. */
struct neph_random neph_random_stream(uint64_t seed, uint64_t pixel, uint64_t sample);

static inline uint64_t neph_random_bits(struct neph_random *random)
{
    uint64_t *s = random->state;
    const uint64_t sum = s[0] + s[3];
    const uint64_t result = (sum << 23 | sum >> 41) + s[0];
    const uint64_t shifted = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= shifted;
    s[3] = s[3] << 45 | s[3] >> 19;
    return result;
}

/* Uniform in (0, 1): the midpoints of 2^52 equal cells, so that log(u) and log(1 - u) are
 * finite. */
static inline double neph_random_uniform(struct neph_random *random)
{
    return ((double)(neph_random_bits(random) >> 12) + 0.5) * 0x1p-52;
}

#endif

/* SPDX-License-Identifier: MIT */
#include "truth/random.h"

/* The finalizer of splitmix64 (S. Vigna 2015, after D. Stafford's mix 13). */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Chained, so that the order of the arguments matters. */
static uint64_t hash(uint64_t salt, uint64_t seed, uint64_t pixel, uint64_t sample)
{
    return mix(mix(mix(salt + seed) + pixel) + sample);
}

struct neph_random neph_random_stream(uint64_t seed, uint64_t pixel, uint64_t sample)
{
    static const uint64_t golden = 0x9e3779b97f4a7c15u;
    const uint64_t a = hash(golden, seed, pixel, sample);
    const uint64_t b = hash(0x6a09e667f3bcc909u, seed, pixel, sample); /* sqrt(2) */
    return (struct neph_random){{mix(a), mix(b), mix(a + golden), mix(b + golden)}};
}

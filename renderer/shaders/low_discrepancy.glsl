// SPDX-License-Identifier: MIT
//
// Numbers that fill the square more evenly than chance: the first two dimensions of I. M. Sobol's
// sequence (1967), of which 2^k points from any multiple of that on have one in each of the 2^k
// rectangles of any one shape. Owen's scrambling (A. Owen, "Randomly Permuted (t,m,s)-Nets and
// (t,s)-Sequences", 1995) makes each point uniform and keeps that; it is drawn by a hash, as in B.
// Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, whose function this is. Further
// dimensions are further pairs in an order of their own (also Burley's).
#ifndef NEPH_LOW_DISCREPANCY_GLSL
#define NEPH_LOW_DISCREPANCY_GLSL

#include "random.glsl"

// A permutation in which a bit depends on those above it alone; from a uniform `seed` every number
// is uniform.
uint owen_scrambled(uint bits, uint seed)
{
    uint x = bitfieldReverse(bits) + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return bitfieldReverse(x);
}

// The second dimension: bit j of the result is the sum modulo 2 of the bits i of the index whose
// binomial (i, j) is odd, that is, whose number has all the bits of j (E. Lucas, 1878). So it is a
// sum over supersets, bit by bit of the numbers.
uint sobol_second(uint index)
{
    uint x = index;
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    x ^= x >> 16;
    return bitfieldReverse(x);
}

// Point `index` of a pair of dimensions; the key's four numbers are all that it depends on beside.
uvec2 sobol_pair(uint index, uvec4 key)
{
    uvec4 seeds = pcg4d(key);
    uint shuffled = owen_scrambled(index, seeds.x);
    return uvec2(owen_scrambled(bitfieldReverse(shuffled), seeds.y),
                 owen_scrambled(sobol_second(shuffled), seeds.z));
}

#endif

// SPDX-License-Identifier: MIT
//
// Low-discrepancy samples of the unit square: the first two dimensions of I. M. Sobol's sequence
// (1967), with hash-based Owen scrambling.
//
// Any 2^k points that start at a multiple of 2^k are stratified: exactly one lies in each of the
// 2^k elementary rectangles of any one shape:
//
//   k = 2:   +---+---+   +-------+   +-+-+-+-+
//            |   |   |   +-------+   | | | | |
//            +---+---+   +-------+   | | | | |
//            |   |   |   +-------+   | | | | |
//            +---+---+   +-------+   +-+-+-+-+
//
// Scrambling (A. Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995) makes each point
// uniform and keeps this property. The scrambling function is from B. Burley, "Practical Hash-based
// Owen Scrambling", JCGT 9(4), 2020. Further dimensions are independent pairs in shuffled order,
// also after Burley.
#ifndef NEPH_LOW_DISCREPANCY_GLSL
#define NEPH_LOW_DISCREPANCY_GLSL

#include "random.glsl"

// Nested uniform scramble: each bit of the result depends only on that bit and the higher ones. For
// a uniform `seed` the result is uniform for every number.
uint owen_scrambled(uint bits, uint seed)
{
    uint x = bitfieldReverse(bits) + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return bitfieldReverse(x);
}

// Second Sobol dimension. Bit j of the (reversed) result is the sum modulo 2 of the index bits i
// for which the binomial (i, j) is odd, which means that i contains all bits of j (E. Lucas, 1878).
// This is a sum over supersets, computed one bit of the positions at a time.
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

// Point `index` of a pair of dimensions as 32-bit fractions. `key` selects an independent pair.
uvec2 sobol_pair(uint index, uvec4 key)
{
    uvec4 seeds = pcg4d(key);
    uint shuffled = owen_scrambled(index, seeds.x);
    return uvec2(owen_scrambled(bitfieldReverse(shuffled), seeds.y),
                 owen_scrambled(sobol_second(shuffled), seeds.z));
}

#endif

// SPDX-License-Identifier: MIT
//
// A 64-bit counter for shaders without 64-bit atomics: two 32-bit words, to which all threads add.
#ifndef NEPH_COUNTING_GLSL
#define NEPH_COUNTING_GLSL

// Adds `amount` to the lower word and carries into the upper one. An amount of 0 is skipped,
// because all threads contend for the same word.
#define ADD_64(counter, amount)                                                                    \
    if ((amount) > 0u && atomicAdd(counter[0], amount) > 0xffffffffu - (amount))                   \
        atomicAdd(counter[1], 1u)

#endif

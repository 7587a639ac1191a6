// SPDX-License-Identifier: MIT
//
// Counters of 64 bits, in two halves, that all threads add to.
#ifndef NEPH_COUNTING_GLSL
#define NEPH_COUNTING_GLSL

// Nothing is added where there is nothing: all threads would wait for the same word.
#define ADD_64(counter, amount)                                                                    \
    if ((amount) > 0u && atomicAdd(counter[0], amount) > 0xffffffffu - (amount))                   \
        atomicAdd(counter[1], 1u)

#endif

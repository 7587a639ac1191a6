// SPDX-License-Identifier: MIT
//
// Frame of a pass without the scene: one thread writes one element of an image.
#ifndef NEPH_REALTIME_PASS_GLSL
#define NEPH_REALTIME_PASS_GLSL

#include "view.glsl"

const int GROUP_THREADS = 64;
layout(local_size_x = GROUP_THREADS) in;

layout(push_constant) uniform PassRun {
    uint first_thread;
    uint colour; // index of the element in 2x2, 0..3, in passes that run in four phases
} run;

// The element of this thread in an image, in rows; false for threads past the last element.
bool find_element(ivec2 size, out ivec2 element)
{
    element = element_at(int(run.first_thread + gl_GlobalInvocationID.x), size.x);
    return element.y < size.y;
}

// First element of the block of this work group in an image; blocks are in rows.
ivec2 find_block(ivec2 size, ivec2 block)
{
    int index = int(run.first_thread / GROUP_THREADS + gl_WorkGroupID.x);
    return block * element_at(index, (size.x - 1) / block.x + 1);
}

#endif

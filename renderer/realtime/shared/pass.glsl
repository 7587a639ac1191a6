// SPDX-License-Identifier: MIT
//
// The frame of a pass without the scene: one thread, one element of the image that it writes.
#ifndef NEPH_REALTIME_PASS_GLSL
#define NEPH_REALTIME_PASS_GLSL

#include "view.glsl"

const int GROUP_THREADS = 64;
layout(local_size_x = GROUP_THREADS) in;

layout(push_constant) uniform PassRun {
    uint first_thread;
    uint colour; // which of 2x2 elements, 0..3, of a pass that takes them by turns
} run;

// The element of this thread in an image, row by row; false when there is none left.
bool own_element(ivec2 size, out ivec2 element)
{
    element = element_at(int(run.first_thread + gl_GlobalInvocationID.x), size.x);
    return element.y < size.y;
}

// The block of this work group in an image, row by row of blocks; its first element.
ivec2 own_block(ivec2 size, ivec2 block)
{
    int index = int(run.first_thread / GROUP_THREADS + gl_WorkGroupID.x);
    return block * element_at(index, (size.x - 1) / block.x + 1);
}

#endif

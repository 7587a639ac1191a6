#version 450
// SPDX-License-Identifier: MIT
//
// Micro-benchmark of memory bandwidth, for the roofline limits of renderer/roofline.h: each thread
// copies 16 bytes. The bytes that a pass moves are compared with this rate.

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer From {
    vec4 from_words[];
};

layout(std430, binding = 1) writeonly buffer To {
    vec4 to_words[];
};

void main()
{
    to_words[gl_GlobalInvocationID.x] = from_words[gl_GlobalInvocationID.x];
}

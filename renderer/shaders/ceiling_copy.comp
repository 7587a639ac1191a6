#version 450
// SPDX-License-Identifier: MIT
//
// As many bytes as the memory can read and write: each thread copies 16 of them. What passes move
// is measured against it (renderer/ceilings.h).

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

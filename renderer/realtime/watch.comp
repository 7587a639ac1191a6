#version 450
// SPDX-License-Identifier: MIT
//
// Counts the values of a rectangle of a target that are not finite, or are negative where they may
// not be. Works on the bits, in each format of a target. For neph_rt_watch(); no pass of a frame.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/names.h"

layout(local_size_x = 64) in;

layout(std430, binding = 0) buffer Watched {
    uint bad;
} watched;

layout(std430, binding = 1) readonly buffer Words {
    uint words[];
};

layout(push_constant) uniform WatchRun {
    uint first;  // texel of the rectangle, row by row
    uint format; // RT_R16F, ..
    uint row;    // texels in a row of the target
    uint left, top, width, height;
    uint is_signed;
} run;

bool is_bad(uint bits, uint sign, uint infinite)
{
    uint magnitude = bits & (sign - 1u);
    return magnitude >= infinite || (run.is_signed == 0u && bits > sign);
}

uint bad_halves(uint word, uint count)
{
    uint bad = uint(is_bad(word & 0xffffu, 0x8000u, 0x7c00u));
    return count == 1u ? bad : bad + uint(is_bad(word >> 16, 0x8000u, 0x7c00u));
}

uint bad_in(uint word) { return uint(is_bad(word, 0x80000000u, 0x7f800000u)); }

uint bad_in_texel(uint texel)
{
    switch (run.format) {
    case RT_R16F:
        return bad_halves(words[texel], 1u);
    case RT_RG16F:
        return bad_halves(words[texel], 2u);
    case RT_RGBA16F:
        return bad_halves(words[2u * texel], 2u) + bad_halves(words[2u * texel + 1u], 2u);
    case RT_R32F:
        return bad_in(words[texel]);
    case RT_RG32F:
        return bad_in(words[2u * texel]) + bad_in(words[2u * texel + 1u]);
    default:
        return bad_in(words[4u * texel]) + bad_in(words[4u * texel + 1u]) +
               bad_in(words[4u * texel + 2u]) + bad_in(words[4u * texel + 3u]);
    }
}

void main()
{
    uint index = run.first + gl_GlobalInvocationID.x;
    if (index >= run.width * run.height)
        return;
    uint y = index / run.width, x = index - y * run.width;
    uint bad = bad_in_texel((run.top + y) * run.row + run.left + x);
    if (bad > 0u)
        atomicAdd(watched.bad, bad);
}

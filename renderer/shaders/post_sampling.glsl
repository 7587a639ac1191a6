// SPDX-License-Identifier: MIT
//
// Bilinear sampling of the input image, and luma. Texel centres are at integers + 1/2.
#ifndef NEPH_POST_SAMPLING_GLSL
#define NEPH_POST_SAMPLING_GLSL

#include "post.glsl"

// In float32, because texture units have 8-bit weights.
vec3 bilinear(vec2 place)
{
    vec2 corner = floor(place - 0.5);
    vec2 way = place - 0.5 - corner;
    ivec2 at = ivec2(corner);
    return mix(mix(fetch(at), fetch(at + ivec2(1, 0)), way.x),
               mix(fetch(at + ivec2(0, 1)), fetch(at + ivec2(1, 1)), way.x), way.y);
}

// Luma of encoded values, ITU-R BT.601.
float luma(vec3 c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

#endif

#version 450
// SPDX-License-Identifier: MIT
//
// Fills the colour table of a frame: tone curve and display encoding of 32^3 colours (tone.glsl).
// One thread per node.
#extension GL_GOOGLE_include_directive : require

#include "tone.glsl"

layout(std430, binding = 3) writeonly buffer Table {
    vec4 table[];
};

void main()
{
    uint node = get_thread_index();
    if (node >= uint(POST_LUT_SIDE * POST_LUT_SIDE * POST_LUT_SIDE))
        return;
    uvec3 at = uvec3(node, node / POST_LUT_SIDE, node / (POST_LUT_SIDE * POST_LUT_SIDE)) %
               uint(POST_LUT_SIDE);
    table[node] = vec4(develop_colour(table_to_colour(vec3(at) / float(POST_LUT_SIDE - 1))), 1.0);
}

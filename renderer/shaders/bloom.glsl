// SPDX-License-Identifier: MIT
//
// The pyramid of bloom. Each level has half the size of the finer one, rounded up. Going up, a fine
// texel lies a quarter of a texel off the centre of a coarse one, and is 3/4 of that and 1/4 of its
// neighbour, along each axis. Going down, a coarse texel is the mean of the fine ones by what it
// gives to each on the way up, times what these stand for: w, in pixels. So both ways together a
// constant stays what it is, and no light is won or lost, whatever the sizes.
#ifndef NEPH_BLOOM_GLSL
#define NEPH_BLOOM_GLSL

#include "post.glsl"

layout(std430, binding = 5) buffer Pyramid {
    vec4 pyramid[]; // RGB; w: what the texel stands for [px]
};

ivec2 level_size(uint level)
{
    return ivec2(view.level_px[2 * level], view.level_px[2 * level + 1]);
}

int index_in(uint level, ivec2 texel)
{
    return int(view.level_at[level]) + texel.y * level_size(level).x + texel.x;
}

// The texel of this thread; false when there is none left.
bool own_texel(out ivec2 texel)
{
    ivec2 size = level_size(run.level);
    int thread = int(own_thread());
    texel = ivec2(thread % size.x, thread / size.x);
    return texel.y < size.y;
}

// The coarse texels along an axis that a fine one is made of, 3/4 and 1/4.
int near_of(int fine) { return fine / 2; }
int far_of(int fine, int size) { return clamp(fine / 2 + 2 * (fine & 1) - 1, 0, size - 1); }

#endif

// SPDX-License-Identifier: MIT
//
// The mip pyramid of bloom: layout, indexing, and the tent filter between two levels. Included by
// post_bloom_down.comp and post_bloom_up.comp.
//
// Each level has half the size of the finer one, rounded up. Along one axis:
//
//   coarse  |       0       |       1       |
//   fine    |   0   |   1   |   2   |   3   |
//
// A fine texel centre lies a quarter of a coarse texel off the nearest coarse centre. On the way up
// a fine texel is therefore 3/4 of the nearest coarse texel and 1/4 of the next one, along each
// axis.
//
// On the way down a coarse texel is the weighted mean of the same fine texels. The weight of a fine
// texel is its share on the way up (3/4 or 1/4 per axis) times its w, the number of pixels that it
// represents. The two ways are transposes of each other, so a constant image stays constant and the
// sum of the light is kept for every image size.
#ifndef NEPH_BLOOM_GLSL
#define NEPH_BLOOM_GLSL

#include "post.glsl"

layout(std430, binding = 5) buffer Pyramid {
    vec4 pyramid[]; // RGB; w: pixels that the texel represents
};

ivec2 level_size(uint level)
{
    return ivec2(view.level_px[2 * level], view.level_px[2 * level + 1]);
}

int index_in(uint level, ivec2 texel)
{
    return int(view.level_at[level]) + texel.y * level_size(level).x + texel.x;
}

// The texel of this thread in level run.level; false when the thread has no texel.
bool get_thread_texel(out ivec2 texel)
{
    ivec2 size = level_size(run.level);
    int thread = int(get_thread_index());
    texel = ivec2(thread % size.x, thread / size.x);
    return texel.y < size.y;
}

// The two coarse texels along an axis that a fine texel is interpolated from: the near one with
// weight 3/4, the far one with 1/4. At the border both are the same texel.
int near_coarse_texel(int fine) { return fine / 2; }
int far_coarse_texel(int fine, int size)
{
    return clamp(fine / 2 + 2 * (fine & 1) - 1, 0, size - 1);
}

#endif

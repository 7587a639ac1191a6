#version 450
// SPDX-License-Identifier: MIT
//
// Bloom, downwards: computes a level of the pyramid (bloom.glsl) from the finer level. One thread
// per texel of the level; run.level 1 reads the image.
#extension GL_GOOGLE_include_directive : require

#include "bloom.glsl"
#include "eye.glsl"

// The part of a pixel that is spread. Conserving bloom spreads all; additive (classic) bloom
// nothing below the threshold, and all from 2 above it.
vec3 spread(vec3 colour)
{
    float threshold = setting(POST_BLOOM_THRESHOLD);
    if (choice(POST_BLOOM) != POST_BLOOM_ADDITIVE || threshold <= -1.0)
        return colour;
    float above = exp2(exposure_ev()) * luminance(colour) - threshold;
    return colour * clamp(0.5 * above, 0.0, 1.0);
}

vec4 finer(ivec2 texel)
{
    return run.level == 1 ? vec4(spread(fetch(texel)), 1.0)
                          : pyramid[index_in(run.level - 1, texel)];
}

// Share of a coarse texel in a fine one along an axis: 3/4, 1/4 or 0, or their sum at the border.
float share(int fine, int coarse, int size)
{
    return (near_coarse_texel(fine) == coarse ? 0.75 : 0.0) +
           (far_coarse_texel(fine, size) == coarse ? 0.25 : 0.0);
}

void main()
{
    ivec2 texel;
    if (!get_thread_texel(texel))
        return;
    ivec2 size = level_size(run.level), finer_size = level_size(run.level - 1);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 16; i++) {
        ivec2 at = 2 * texel - 1 + ivec2(i % 4, i / 4);
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, finer_size)))
            continue;
        vec4 fine = finer(at);
        float weight = share(at.x, texel.x, size.x) * share(at.y, texel.y, size.y) * fine.w;
        sum += weight * vec4(fine.rgb, 1.0);
    }
    pyramid[index_in(run.level, texel)] = vec4(sum.rgb / sum.w, sum.w);
}

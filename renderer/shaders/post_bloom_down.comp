#version 450
// SPDX-License-Identifier: MIT
//
// Bloom, down the pyramid: a level from the finer one.
#extension GL_GOOGLE_include_directive : require

#include "bloom.glsl"
#include "eye.glsl"

// What is spread of a pixel. The classic: from the threshold on, all of it from 2 above.
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

float share(int fine, int coarse, int size)
{
    return (near_of(fine) == coarse ? 0.75 : 0.0) + (far_of(fine, size) == coarse ? 0.25 : 0.0);
}

void main()
{
    ivec2 texel;
    if (!own_texel(texel))
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

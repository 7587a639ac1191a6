#version 450
// SPDX-License-Identifier: MIT
//
// Bloom, upwards: each level of the pyramid (bloom.glsl) becomes a mix of itself and the
// interpolated coarser level. Level 0 is the image, which gets the result:
//
//   conserving  (1 - scattered) image + scattered spread
//   additive    image + intensity * spread
#extension GL_GOOGLE_include_directive : require

#include "bloom.glsl"

vec3 coarse(ivec2 texel)
{
    return pyramid[index_in(run.level + 1, texel)].rgb;
}

// The coarser level at a fine texel: 9/16, 3/16, 3/16 and 1/16 of four texels.
vec3 from_coarser(ivec2 texel)
{
    ivec2 size = level_size(run.level + 1);
    ivec2 near = ivec2(near_coarse_texel(texel.x), near_coarse_texel(texel.y));
    ivec2 far = ivec2(far_coarse_texel(texel.x, size.x), far_coarse_texel(texel.y, size.y));
    return 0.5625 * coarse(near) + 0.0625 * coarse(far) +
           0.1875 * (coarse(ivec2(far.x, near.y)) + coarse(ivec2(near.x, far.y)));
}

void main()
{
    ivec2 texel;
    if (!get_thread_texel(texel))
        return;
    vec3 spread = from_coarser(texel);
    if (run.level > 0) {
        int own = index_in(run.level, texel);
        pyramid[own].rgb = mix(pyramid[own].rgb, spread, setting(POST_BLOOM_SPREAD));
        return;
    }
    vec3 picture = fetch(texel);
    put(texel, choice(POST_BLOOM) == POST_BLOOM_ADDITIVE
                   ? picture + setting(POST_BLOOM_INTENSITY) * spread
                   : mix(picture, spread, setting(POST_BLOOM_SCATTERED)));
}

// SPDX-License-Identifier: MIT
//
// The output of the upscale (upscale.comp): a pixel's volume, or the pixel composed.
#ifndef NEPH_REALTIME_PUT_UPSCALED_GLSL
#define NEPH_REALTIME_PUT_UPSCALED_GLSL

#include "upscale.glsl"

// The volume as a later pass would read it from its target.
vec4 as_kept(vec4 volume)
{
    return get_format(RT_VOLUME) == RT_RGBA16F
               ? from_words(uvec2(pack(volume.xy), pack(volume.zw)))
               : volume;
}

// Whether the volume is composed with the background here, because no later pass changes it
// (composition/compose.comp).
bool composes() { return choice(RT_COMPOSITION) == RT_COMPOSITION_UPSCALE; }

void put_composed(ivec2 pixel, vec4 volume)
{
    vec3 radiance = over(as_kept(volume), fetch_full(RT_BEHIND, pixel).xyz);
    put_full(RT_COLOR, pixel, vec4(radiance, 1.0));
}

// Adds the oracle, the error of the upscale of error-free texels (oracle/oracle_pixels.comp). Where
// the texels have errors of their own a sum may be negative, which no volume is.
vec4 correct_volume(ivec2 pixel, vec4 volume)
{
    if (choice(RT_ORACLE_UPSCALE) == 0)
        return volume;
    return max(volume + fetch_full(RT_VOLUME, pixel), vec4(0.0));
}

void put_upscaled(ivec2 pixel, Upscaled made)
{
    vec4 volume = correct_volume(pixel, made.volume);
    if (!is_output_elided()) {
        put_full(RT_VOLUME, pixel, volume);
        put_full(RT_VOLUME_DISTANCE, pixel, vec4(made.distance_m));
    }
    if (composes())
        put_composed(pixel, volume);
}

#endif

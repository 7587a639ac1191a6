#version 450
// SPDX-License-Identifier: MIT
//
// Composition: the volume over what is behind it, L = volume + T behind, with T the transmittance
// of all media together (the article has in one place that of the fog alone). Without a volume,
// (0, 0, 0, 1), the scene comes out as it went in.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"

void main()
{
    ivec2 pixel;
    if (!own_element(view_size(), pixel))
        return;
    vec3 radiance = over(fetch_full(RT_VOLUME, pixel), fetch_full(RT_BEHIND, pixel).xyz);
    put_full(RT_COLOR, pixel, vec4(radiance, 1.0));
}

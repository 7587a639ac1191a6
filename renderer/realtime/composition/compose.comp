#version 450
// SPDX-License-Identifier: MIT
//
// Composition: L = volume + T background, where T is the transmittance of all media together (in
// one place the article uses only the fog's transmittance). Without a volume, (0, 0, 0, 1), the
// background is unchanged.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"

void main()
{
    ivec2 pixel;
    if (!find_element(view_size(), pixel))
        return;
    vec3 radiance = over(fetch_full(RT_VOLUME, pixel), fetch_full(RT_BEHIND, pixel).xyz);
    put_full(RT_COLOR, pixel, vec4(radiance, 1.0));
}

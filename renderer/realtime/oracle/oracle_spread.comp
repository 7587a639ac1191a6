#version 450
// SPDX-License-Identifier: MIT
//
// The upscale (upscale.comp) of the texels' own rays: what the upscale would show if the
// reconstruction had no error.
#extension GL_GOOGLE_include_directive : require

#include "renderer/realtime/shared/pass.glsl"
#include "renderer/realtime/upscale/weighted_mean.glsl"

void put_upscaled(ivec2 pixel, Upscaled made) { put_full(RT_VOLUME, pixel, made.volume); }

void main()
{
    ivec2 quad;
    if (find_element(view_size() / 2 + 1, quad))
        upscale(quad);
}

// SPDX-License-Identifier: MIT
//
// Dither: one number per pixel, frame and channel. What the kinds are, and where they come from, is
// said in renderer/realtime/dither.h; this is the same once more, bit for bit, in whole numbers
// modulo 2^32.
#ifndef NEPH_REALTIME_DITHER_GLSL
#define NEPH_REALTIME_DITHER_GLSL

#include "random.glsl"
#include "realtime.glsl"

// Of the circle, per frame, in each of four channels.
const uint DITHER_STEPS[4] = uint[](2654435769u, 3144134277u, 1779033703u, 2773480763u);
const uint GRADIENT_STEPS[4] = uint[](1750839832u, 1761670891u, 1735905692u, 1754675036u);

const uint SPATIAL_MASK = 0u, SPATIOTEMPORAL_MASK = 64u * 64u; // first of their ranks

uint white_word(ivec2 pixel, uint frame, uint channel)
{
    return pcg4d(uvec4(uvec2(pixel), frame, view.seed + channel * DITHER_STEPS[0])).x | 0x100u;
}

uint interleaved_word(ivec2 pixel, uint frame, uint channel)
{
    uvec2 place = (channel & 1u) != 0u ? pixel.yx : pixel;
    if ((channel & 2u) != 0u)
        place.x = -place.x;
    uint inner = 288237660u * place.x + 25070368u * place.y +
                 GRADIENT_STEPS[channel & 3u] * (frame & 63u);
    uint high, low;
    umulExtended(inner, 4221604530u, high, low);
    return 52u * inner + high;
}

uint mask_word(uint first, ivec2 pixel, uint channel)
{
    uvec2 place = (uvec2(pixel) + channel * uvec2(47u, 37u)) & 63u;
    return (2u * noise_ranks[first + 64u * place.y + place.x] + 1u) << 19;
}

uint dither_word(int kind, ivec2 pixel, uint frame, uint channel)
{
    switch (kind) {
    case RT_DITHER_WHITE:
        return white_word(pixel, frame, channel);
    case RT_DITHER_INTERLEAVED:
        return interleaved_word(pixel, frame, channel);
    case RT_DITHER_BLUE:
        return mask_word(SPATIAL_MASK, pixel, channel) + DITHER_STEPS[channel & 3u] * frame;
    case RT_DITHER_SPATIOTEMPORAL:
        return mask_word(SPATIOTEMPORAL_MASK + 4096u * (frame & 31u), pixel, channel);
    case RT_DITHER_SLICE:
        return mask_word(SPATIOTEMPORAL_MASK, pixel, channel) + DITHER_STEPS[channel & 3u] * frame;
    default:
        return 0x80000000u;
    }
}

// In 0 .. 1 without 1, and 0.5 for "none"; `pixel` is one of the view.
float dither(int kind, ivec2 pixel, uint frame, uint channel)
{
    return float(dither_word(kind, pixel, frame, channel) >> 8) * exp2(-24.0);
}

#endif

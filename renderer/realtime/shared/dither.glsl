// SPDX-License-Identifier: MIT
//
// Dither: one number per pixel, frame and channel, for the start of a ray, the place of a tap or a
// rounding. All arithmetic is in words, whole numbers modulo 2^32; the upper 24 bits of a word are
// the value, 0 <= value < 1.
//
// white: pcg4d (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020) of
// (x, y, frame, seed); the upper 23 bits h of its first word give (h + 0.5) 2^-23.
//
// interleaved: gradient noise (J. Jimenez, "Next Generation Post Processing in Call of Duty:
// Advanced Warfare", SIGGRAPH 2014), frac(52.9829189 frac(0.06711056 X + 0.00583715 Y)), where
// X = x + s, Y = y + s, s = 5.588238 (frame mod 64) (A. Wolfe, "Interleaved Gradient Noise: A
// Deeper Look", 2022). x and y are whole numbers: no half pixel is added. It has no seed. The inner
// sum is kept in steps of 2^-32, and its error comes out 53 times larger: up to
// 53 (|x| + |y| + 64) 2^-33 of the circle, 2e-5 at 1920x1080. (In floats the rounding of a
// sum between 256 and 512 would already be up to 8e-4.)
//
// blue: frac(v(x, y) + frame g), with v the spatial blue noise of 64x64 pixels
// (renderer/blue_noise.h) and g the golden ratio: a golden-ratio sequence in each pixel.
//
// spatiotemporal: v(x, y, frame), blue noise of 64x64 pixels and 32 frames.
//
// slice: frac(v(x, y, 0) + frame g), with the first of those 32 frames as the spatial mask.
//
// Channels are unrelated numbers of the same pixel:
// - white has another seed,
// - masks are read at coordinates shifted by 47 and 37 pixels,
// - interleaved has x and y swapped (channels 1, 3) and x mirrored (2, 3).
// Kinds that advance by one step per frame in all pixels use another step in each of four channels:
// (sqrt(5) - 1) / 2, sqrt(3), sqrt(2), sqrt(7) (R. D. Richtmyer, "The evaluation of definite
// integrals, and a quasi-Monte-Carlo method", LA-1342, 1951); interleaved has approximately these,
// with s = 5.588238, 5.622808, 5.540572 or 5.600479 (frame mod 64). Two channels with the same step
// would keep their difference for ever, so that the pairs of a pixel would lie on a line.
#ifndef NEPH_REALTIME_DITHER_GLSL
#define NEPH_REALTIME_DITHER_GLSL

#include "renderer/shaders/random.glsl"
#include "view.glsl"

// Advance of a pixel's number per frame in units of 2^-32, in each of four channels: for masks, and
// for interleaved gradient noise.
const uint DITHER_STEPS[4] = uint[](2654435769u, 3144134277u, 1779033703u, 2773480763u);
const uint GRADIENT_STEPS[4] = uint[](1750839832u, 1761670891u, 1735905692u, 1754675036u);

const uint SPATIAL_MASK = 0u, SPATIOTEMPORAL_MASK = 64u * 64u; // index of their first ranks

uint white_word(ivec2 pixel, uint frame, uint channel)
{
    return pcg4d(uvec4(uvec2(pixel), frame, view_seed + channel * DITHER_STEPS[0])).x | 0x100u;
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

// 0 <= value < 1; 0.5 for "none". `pixel` is a pixel of the view.
float dither(int kind, ivec2 pixel, uint frame, uint channel)
{
    return float(dither_word(kind, pixel, frame, channel) >> 8) * exp2(-24.0);
}

#endif

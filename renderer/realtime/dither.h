/* SPDX-License-Identifier: MIT
 *
 * Dither: one number per pixel, frame and channel, for the start of a ray, the place of a tap or a
 * rounding. The mirror of shaders/realtime_dither.glsl, bit for bit: all is done in whole numbers
 * modulo 2^32, a word, of which the upper 24 bits are the value, in 0 .. 1 without 1.
 *
 * white: pcg4d (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020) of
 * (x, y, frame, seed); the upper 23 bits h of its first word give (h + 0.5) 2^-23.
 *
 * interleaved: gradient noise (J. Jimenez, "Next Generation Post Processing in Call of Duty:
 * Advanced Warfare", SIGGRAPH 2014), frac(52.9829189 frac(0.06711056 X + 0.00583715 Y)), where
 * X = x + s, Y = y + s, s = 5.588238 (frame mod 64) (A. Wolfe, "Interleaved Gradient Noise: A
 * Deeper Look", 2022). x and y are whole numbers: no half pixel is added. It has no seed. The inner
 * sum is kept in steps of 2^-32, and its error comes out 53 times larger: up to
 * 53 (|x| + |y| + 64) 2^-33 of the circle, 2e-5 at 1920x1080. (In floats the rounding of a
 * sum between 256 and 512 alone is up to 8e-4.)
 *
 * blue: v(x, y) + frame g, round the circle, with v the spatial blue noise of 64x64 pixels
 * (renderer/blue_noise.h) and g the golden ratio: each pixel goes on by itself.
 *
 * spatiotemporal: v(x, y, frame), blue noise of 64x64 pixels and 32 frames.
 *
 * slice: v(x, y, 0) + frame g, the first of those 32 in place of the spatial mask.
 *
 * Channels are unrelated numbers of the same pixel. They have other places: white another seed, the
 * masks coordinates shifted by 47 and 37 pixels, interleaved x and y swapped (1, 3) and mirrored
 * (2, 3). And those kinds that go round the circle by the same step in all pixels go another step
 * in each of four channels: (sqrt(5) - 1) / 2, sqrt(3), sqrt(2), sqrt(7) (R. D. Richtmyer, "The
 * evaluation of definite integrals, and a quasi-Monte-Carlo method", LA-1342, 1951); interleaved
 * has s = 5.588238, 5.622808, 5.540572 or 5.600479 (frame mod 64) for about these. Two channels of
 * one step would keep their difference for ever: a pixel's pairs would stay on a line (X13).
 */
#ifndef NEPH_RENDERER_REALTIME_DITHER_H
#define NEPH_RENDERER_REALTIME_DITHER_H

#include <stdint.h>

struct neph_rt_dither {
    uint32_t seed;               /* of the white one */
    const uint32_t *noise_ranks; /* borrowed; as of neph_rt_noise_ranks(), for the blue ones */
};

/* After how many frames the numbers of a pixel come again; 0: never, or they do not change. */
int neph_rt_dither_period(int kind);

/* `kind`: RT_DITHER_*; "none" is 0.5. For any pixel. */
float neph_rt_dither(const struct neph_rt_dither *dither, int kind, int x_px, int y_px,
                     uint32_t frame, uint32_t channel);

#endif

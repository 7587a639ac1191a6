/* SPDX-License-Identifier: MIT
 *
 * Dither: one number per pixel and frame, for the start of a ray, the place of a tap or a rounding.
 * The same four kinds are to exist in shaders; these formulas are what a shader is tested against.
 *
 * white: pcg4d (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020) of
 * (x, y, frame, seed), all modulo 2^32; the upper 23 bits h of its first word give
 * (h + 0.5) 2^-23, which a float holds exactly.
 *
 * interleaved: gradient noise (J. Jimenez, "Next Generation Post Processing in Call of Duty:
 * Advanced Warfare", SIGGRAPH 2014), frac(52.9829189 frac(0.06711056 X + 0.00583715 Y)), where
 * X = x + s, Y = y + s, s = 5.588238 (frame mod 64) (A. Wolfe, "Interleaved Gradient Noise: A
 * Deeper Look", 2022). x and y are whole numbers: no half pixel is added. It has no seed: swap x
 * and y for a second channel. An error of the inner sum comes out 53 times larger: in floats, a
 * rounding of a sum between 256 and 512 is up to 8e-4 of the circle.
 *
 * blue: frac(v(x, y) + g 2^-32), g = 2654435769 frame mod 2^32, with v the spatial blue noise of
 * 64x64 pixels: each pixel goes on by the golden ratio, round the circle. v and the sum are whole
 * multiples of 2^-32, so that integers have it exactly.
 *
 * spatiotemporal: v(x, y, frame), blue noise of 64x64 pixels and 32 frames.
 */
#ifndef NEPH_RENDERER_DITHER_H
#define NEPH_RENDERER_DITHER_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum neph_dither_kind {
    NEPH_DITHER_WHITE,
    NEPH_DITHER_INTERLEAVED,
    NEPH_DITHER_BLUE,
    NEPH_DITHER_SPATIOTEMPORAL,
    NEPH_DITHER_KIND_COUNT,
};

struct neph_dither;

/* "white", "interleaved", "blue", "spatiotemporal". */
const char *neph_dither_name(enum neph_dither_kind kind);

/* False, and `*kind` untouched, for any other name. */
bool neph_dither_find(const char *name, enum neph_dither_kind *kind);

/* Different seeds give unrelated dithers (interleaved has only one). The blue ones keep their
 * masks in the folder: errors of neph_blue_noise_load(). The others leave the folder alone, and it
 * may be NULL. For neph_dither_destroy(). */
enum neph_status neph_dither_create(enum neph_dither_kind kind, uint32_t seed,
                                    const char *cache_folder, struct neph_dither **dither,
                                    struct neph_diag *diag);
void neph_dither_destroy(struct neph_dither *dither);

/* In 0 .. 1 without 1, for any pixel. */
double neph_dither_value(const struct neph_dither *dither, int x_px, int y_px, uint32_t frame);

#endif

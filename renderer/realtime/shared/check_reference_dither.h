/* SPDX-License-Identifier: MIT
 *
 * The twin of dither.glsl, bit for bit.
 */
#ifndef NEPH_TESTS_TWINS_DITHER_H
#define NEPH_TESTS_TWINS_DITHER_H

#include <stdint.h>

struct twin_dither {
    uint32_t seed;               /* of the white one */
    const uint32_t *noise_ranks; /* borrowed; of neph_blue_noise_load() for blue kinds */
};

/* pcg4d() of renderer/shaders/random.glsl, in place. */
void twin_pcg4d(uint32_t v[4]);

/* `kind`: RT_DITHER_*; "none" is 0.5. For any pixel. */
float twin_dither(const struct twin_dither *dither, int kind, int x_px, int y_px, uint32_t frame,
                  uint32_t channel);

#endif

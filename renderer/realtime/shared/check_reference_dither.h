/* SPDX-License-Identifier: MIT
 *
 * The CPU reference of dither.glsl, bit for bit.
 */
#ifndef NEPH_CHECK_REFERENCE_DITHER_H
#define NEPH_CHECK_REFERENCE_DITHER_H

#include <stdint.h>

struct cpu_dither {
    uint32_t seed;               /* of RT_DITHER_WHITE */
    const uint32_t *noise_ranks; /* borrowed; of neph_blue_noise_load(), for blue kinds */
};

/* pcg4d() of renderer/shaders/random.glsl, in place. */
void cpu_pcg4d(uint32_t v[4]);

/* `kind`: RT_DITHER_*; "none" is 0.5. For any pixel. */
float cpu_dither(const struct cpu_dither *dither, int kind, int x_px, int y_px, uint32_t frame,
                 uint32_t channel);

#endif

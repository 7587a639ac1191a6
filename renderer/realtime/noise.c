/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/noise.h"

#include "renderer/blue_noise.h"
#include "renderer/realtime/shared/names.h"

enum { GRADIENT_FRAMES = 64 }; /* of realtime/shared/dither.glsl */

int neph_rt_dither_period(int kind)
{
    return kind == RT_DITHER_INTERLEAVED      ? GRADIENT_FRAMES
           : kind == RT_DITHER_SPATIOTEMPORAL ? NEPH_BLUE_NOISE_FRAMES
                                              : 0;
}

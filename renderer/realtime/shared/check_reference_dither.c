/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference_dither.h"

#include "renderer/realtime/shared/names.h"

#include <stddef.h>

enum { MASK_SIDE_PX = 64, MASK_FRAMES = 32, GRADIENT_FRAMES = 64, CHANNELS = 4 };

/* Advance per frame in units of 2^-32: the fractions of (sqrt(5) - 1) / 2, sqrt(3), sqrt(2) and
 * sqrt(7), to the next odd number. */
static const uint32_t steps[CHANNELS] = {2654435769u, 3144134277u, 1779033703u, 2773480763u};

/* Jimenez's 0.06711056, 0.00583715 and 0.9829189, and the sum of the first two times s of one frame
 * in each channel. */
static const uint32_t gradient_x = 288237660u, gradient_y = 25070368u, gradient_rest = 4221604530u;
static const uint32_t gradient_steps[CHANNELS] = {1750839832u, 1761670891u, 1735905692u,
                                                  1754675036u};

static void mix(uint32_t v[4])
{
    v[0] += v[1] * v[3];
    v[1] += v[2] * v[0];
    v[2] += v[0] * v[1];
    v[3] += v[1] * v[2];
}

void cpu_pcg4d(uint32_t v[4])
{
    for (int i = 0; i < 4; i++)
        v[i] = v[i] * 1664525u + 1013904223u;
    mix(v);
    for (int i = 0; i < 4; i++)
        v[i] ^= v[i] >> 16;
    mix(v);
}

static uint32_t white_word(uint32_t seed, uint32_t x, uint32_t y, uint32_t frame, uint32_t channel)
{
    uint32_t v[4] = {x, y, frame, seed + channel * steps[0]};
    cpu_pcg4d(v);
    return v[0] | 0x100u;
}

static uint32_t interleaved_word(uint32_t x, uint32_t y, uint32_t frame, uint32_t channel)
{
    const uint32_t first = channel & 1 ? y : x, second = channel & 1 ? x : y;
    const uint32_t inner = gradient_x * (channel & 2 ? -first : first) + gradient_y * second +
                           gradient_steps[channel % CHANNELS] * (frame % GRADIENT_FRAMES);
    return 52u * inner + (uint32_t)((uint64_t)inner * gradient_rest >> 32);
}

static uint32_t mask_word(const uint32_t *ranks, uint32_t x, uint32_t y, uint32_t channel)
{
    const uint32_t column = (x + 47u * channel) % MASK_SIDE_PX;
    const uint32_t row = (y + 37u * channel) % MASK_SIDE_PX;
    return (2u * ranks[row * MASK_SIDE_PX + column] + 1u) << 19;
}

static uint32_t word(const struct cpu_dither *dither, int kind, uint32_t x, uint32_t y,
                     uint32_t frame, uint32_t channel)
{
    const size_t slice = MASK_SIDE_PX * MASK_SIDE_PX;
    switch (kind) {
    case RT_DITHER_WHITE:
        return white_word(dither->seed, x, y, frame, channel);
    case RT_DITHER_INTERLEAVED:
        return interleaved_word(x, y, frame, channel);
    case RT_DITHER_BLUE:
        return mask_word(dither->noise_ranks, x, y, channel) + steps[channel % CHANNELS] * frame;
    case RT_DITHER_SPATIOTEMPORAL:
        return mask_word(dither->noise_ranks + (1 + frame % MASK_FRAMES) * slice, x, y, channel);
    case RT_DITHER_SLICE:
        return mask_word(dither->noise_ranks + slice, x, y, channel) +
               steps[channel % CHANNELS] * frame;
    default:
        return 0x80000000u;
    }
}

float cpu_dither(const struct cpu_dither *dither, int kind, int x_px, int y_px, uint32_t frame,
                 uint32_t channel)
{
    return (float)(word(dither, kind, (uint32_t)x_px, (uint32_t)y_px, frame, channel) >> 8) *
           0x1p-24f;
}

/* SPDX-License-Identifier: MIT */
#include "scenes/surface.h"

#include <math.h>
#include <stdint.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_PATTERN_COUNT == 2, "a new kind");

static uint32_t pcg3d_first(uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t v[3] = {x, y, z};
    for (int k = 0; k < 3; k++)
        v[k] = v[k] * 1664525u + 1013904223u;
    for (int k = 0; k < 3; k++)
        v[k] += v[(k + 1) % 3] * v[(k + 2) % 3];
    for (int k = 0; k < 3; k++)
        v[k] ^= v[k] >> 16;
    return v[0] + v[1] * v[2];
}

static uint32_t wrap(int cell)
{
    return (uint32_t)cell % NEPH_NOISE_CELLS; /* divides 2^32: correct below 0, too */
}

double neph_noise_value(int seed, int i, int j)
{
    return (double)(pcg3d_first(wrap(i), wrap(j), (uint32_t)seed) >> 8) * 0x1p-24;
}

static double noise(int seed, double u, double v)
{
    const int i = (int)floor(u), j = (int)floor(v);
    const double x = u - i, y = v - j;
    return (1.0 - y) *
               ((1.0 - x) * neph_noise_value(seed, i, j) + x * neph_noise_value(seed, i + 1, j)) +
           y * ((1.0 - x) * neph_noise_value(seed, i, j + 1) +
                x * neph_noise_value(seed, i + 1, j + 1));
}

double neph_paint_value(const struct neph_paint *texture, double u, double v)
{
    if (texture->pattern == NEPH_PATTERN_NOISE)
        return noise(texture->seed, u, v);
    return fabs(fmod(floor(u) + floor(v), 2.0)) == 1.0;
}

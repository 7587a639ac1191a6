/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/jitter.h"

#include "renderer/realtime/shared/names.h"

#include <math.h>

/* The digits of a number in base `base`, mirrored at the radix point. */
static double radical_inverse(uint32_t number, uint32_t base)
{
    double result = 0.0, digit_value = 1.0;
    for (; number > 0; number /= base) {
        digit_value /= base;
        result += digit_value * (number % base);
    }
    return result;
}

/* A Gaussian cut off at `window_px`: u1 gives the radius, u2 the angle. */
static void warp(double u1, double u2, double offset_px[2])
{
    static const double sigma_px = 0.47, window_px = 0.5;
    const double beyond_window = exp(-0.5 * (window_px / sigma_px) * (window_px / sigma_px));
    const double radius_px = sigma_px * sqrt(-2.0 * log((1.0 - u1) * beyond_window + u1));
    offset_px[0] = radius_px * cos(2.0 * M_PI * u2);
    offset_px[1] = radius_px * sin(2.0 * M_PI * u2);
}

void neph_rt_jitter(int kind, int length, uint32_t index, double offset_px[2])
{
    const uint32_t number = index % (uint32_t)length + 1;
    const double u1 = radical_inverse(number, 2), u2 = radical_inverse(number, 3);
    offset_px[0] = offset_px[1] = 0.0;
    if (kind == RT_JITTER_UE) {
        warp(u1, u2, offset_px);
    } else if (kind == RT_JITTER_HALTON) {
        offset_px[0] = u1 - 0.5;
        offset_px[1] = u2 - 0.5;
    }
}

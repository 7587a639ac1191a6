/* SPDX-License-Identifier: MIT
 *
 * The curve of sRGB: IEC 61966-2-1:1999, 5.2, between code values and linear light, both in 0..1.
 */
#ifndef NEPH_BASE_SRGB_H
#define NEPH_BASE_SRGB_H

#include <math.h>

static inline double neph_srgb_to_linear(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

static inline double neph_srgb_from_linear(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

#endif

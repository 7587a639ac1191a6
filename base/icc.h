/* SPDX-License-Identifier: MIT
 *
 * Colour profiles of the International Color Consortium (ICC.1:2022): whether one describes sRGB.
 */
#ifndef NEPH_BASE_ICC_H
#define NEPH_BASE_ICC_H

#include <stdbool.h>
#include <stddef.h>

/* Whether a profile is sRGB by its own numbers, whatever its name: an RGB profile of curves and a
 * matrix (tags rTRC, gTRC, bTRC and rXYZ, gXYZ, bXYZ; no table A2B0, which would have precedence),
 * whose matrix is that of sRGB, adapted to D50 by Bradford's method, within 1e-3, and whose curves
 * (types curv and para) are within 1e-3 of IEC 61966-2-1:1999 in linear light, and within half a
 * code of 8 bits in code values. False also for damaged profiles. */
bool neph_icc_is_srgb(const void *profile, size_t size);

#endif

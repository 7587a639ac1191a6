/* SPDX-License-Identifier: MIT
 *
 * The displayed brightness of a pixel: the luma of its encoded display values, in which equal steps
 * are about equally visible, and the luminance of the display.
 */
#ifndef NEPH_METRICS_EXTRACTORS_DISPLAY_LUMA_H
#define NEPH_METRICS_EXTRACTORS_DISPLAY_LUMA_H

#include <stddef.h>

/* For `count` pixels of scene-linear Rec.709. With c = clamp(gain * channel, 0, 1), gain =
 * 2^exposure_ev, no tone curve:
 *   luma      0.2126 R' + 0.7152 G' + 0.0722 B' with c' = c <= 0.0031308 ? 12.92 c
 *             : 1.055 c^(1/2.4) - 0.055 (IEC 61966-2-1, the weights of ITU-R BT.709)
 *   luminance 0.2126 R + 0.7152 G + 0.0722 B of the clamped values, 1 = display white
 * Both are in [0, 1] up to rounding; the relative error is 2e-15. `luminance` may be NULL. */
void neph_display_luma(const float *const rgb[3], size_t count, double gain, double *luma,
                       double *luminance);

/* The encoded values c' of one channel. */
void neph_display_codes(const float *channel, size_t count, double gain, double *codes);

#endif

/* SPDX-License-Identifier: MIT
 *
 * From code values of the post-processing chain to the light that a display emits.
 */
#ifndef NEPH_RENDERER_POST_DISPLAY_H
#define NEPH_RENDERER_POST_DISPLAY_H

#include "base/image.h"
#include "renderer/post/options.h"

#include <stdint.h>

/* Whether the output is for an HDR display: code values of ST 2084 in BT.2020. */
bool neph_post_is_hdr(const struct neph_settings *settings);

/* SMPTE ST 2084:2014, eq. 4: the luminance of a code of 0..1 [cd/m^2]. */
double neph_pq_nits(double code);

/* The channels R G B of an output image as codes of 0 .. 2^bits - 1 (8 to 16 bits, full range), row
 * by row; `codes` has room for 3 a pixel. With encode=linear the sRGB curve is applied first. */
void neph_post_encode_codes(const struct neph_settings *settings, const struct neph_image *picture,
                            int bits, uint16_t *codes);

/* Convert R G B from code values to the display's linear light in Rec.709, in double, rounded once;
 * linear output is unchanged. 1 is the white of an sRGB display (IEC 61966-2-1:1999), or the peak
 * of an HDR display, whose colours outside of Rec.709 are clamped to its gamut. */
void neph_post_apply_display(const struct neph_settings *settings, struct neph_image *picture);

#endif

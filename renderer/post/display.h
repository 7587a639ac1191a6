/* SPDX-License-Identifier: MIT
 *
 * What a display makes of the code values of the picture chain.
 */
#ifndef NEPH_RENDERER_POST_DISPLAY_H
#define NEPH_RENDERER_POST_DISPLAY_H

#include "base/image.h"
#include "renderer/post/options.h"

#include <stdint.h>

/* Whether the picture is one for an HDR display: code values of ST 2084 in BT.2020. */
bool neph_post_is_hdr(const struct neph_settings *settings);

/* SMPTE ST 2084:2014, eq. 4: the luminance of a code of 0..1 [cd/m^2]. */
double neph_pq_nits(double code);

/* Codes of 0 .. 2^bits - 1 (8 to 16 bits, full range) of the channels R G B of a picture of the
 * chain, row by row: `codes` holds 3 a pixel. With encode=linear sRGB's curve is applied first. */
void neph_post_codes(const struct neph_settings *settings, const struct neph_image *picture,
                     int bits, uint16_t *codes);

/* R G B from code values to the linear light that the display makes of them, in Rec.709, in double
 * and rounded once; linear ones stay. 1 is the white of an sRGB display (IEC 61966-2-1:1999), or
 * the peak of an HDR display; what is outside of Rec.709 there is held at its border. */
void neph_post_show(const struct neph_settings *settings, struct neph_image *picture);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Subsampled channels of OpenEXR files at full size, and luminance with chroma as R, G, B. Private
 * to the reader (base/exr.c).
 */
#ifndef NEPH_BASE_EXR_CHROMA_H
#define NEPH_BASE_EXR_CHROMA_H

#include "base/image.h"

/* Replace the samples of a channel, which has every `step[0]`-th pixel of a row and every
 * `step[1]`-th row (1 or 2; the size of the image is a multiple of them) in the first samples of
 * its memory, by those of all pixels. Samples between two others are interpolated with the filter
 * of OpenEXR's own reader: 14 samples on a line, windowed sinc, first in rows, then in columns;
 * beyond the border the outermost sample is repeated. NEPH_ERR_MEMORY. */
enum neph_status neph_exr_upsample(const struct neph_image *image, struct neph_channel *channel,
                                   const int step[2], struct neph_diag *diag);

/* If the image has Y, RY and BY and none of R, G and B, turn the three into G, R and B:
 * R = (RY + 1) Y, B = (BY + 1) Y, Y = w_r R + w_g G + w_b B, with the luminances w of the primaries
 * in `chromaticities` (x and y of red, green, blue and white). "Luminance/Chroma Images" in
 * https://openexr.com/en/latest/TechnicalIntroduction.html. NEPH_ERR_INPUT: the chromaticities give
 * no luminances. */
enum neph_status neph_exr_convert_chroma(struct neph_image *image, const float chromaticities[8],
                                         struct neph_diag *diag);

#endif

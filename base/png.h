/* SPDX-License-Identifier: MIT
 *
 * PNG files through libpng: pictures of 8 to 16 bits out; any picture, or raw 16-bit code values,
 * in.
 */
#ifndef NEPH_BASE_PNG_H
#define NEPH_BASE_PNG_H

#include "base/image.h"

#include <stdint.h>

/* Write a picture. `rgb` holds width * height * 3 display-encoded bytes, row 0 on top.
 * Complete or not there at all, as neph_exr_write. */
enum neph_status neph_png_write_rgb8(const char *path, int width_px, int height_px,
                                     const uint8_t *rgb, struct neph_diag *diag);

/* What code values mean; the file says so (chunks sRGB, or cICP of 9/16/0/1). */
enum neph_png_space {
    NEPH_PNG_SRGB,
    NEPH_PNG_BT2020_PQ, /* ITU-R BT.2100 PQ, full range */
    NEPH_PNG_SPACE_COUNT,
};

/* Write a picture of `bits` a channel, 9 to 16: `rgb` holds width * height * 3 codes of
 * 0 .. 2^bits - 1. In the file they are scaled to 16 bits, and sBIT says how many count. */
enum neph_status neph_png_write_rgb16(const char *path, int width_px, int height_px, int bits,
                                      enum neph_png_space space, const uint16_t *rgb,
                                      struct neph_diag *diag);

/* Read the raw code values of a 16-bit RGB PNG, without any gamma or colour conversion.
 * `*rgb` holds width * height * 3 values 0..65535 and is freed by the caller with free().
 * NEPH_ERR_INPUT: not a PNG, of another kind (the message names it), oversized or damaged. */
enum neph_status neph_png_read_rgb16(const char *path, int *width_px, int *height_px,
                                     uint16_t **rgb, struct neph_diag *diag);

/* Read any PNG (1 to 16 bits; grey, palette or RGB; interlaced or not) as linear R G B, display
 * value 1 at the largest code, by the inverse of the sRGB curve (IEC 61966-2-1:1999), evaluated in
 * double and rounded once. The attribute "encoding" = "sRGB" says that it was a display picture,
 * and no radiance; "pixel_aspect" is width / height of a pixel, where the file says that it is not
 * 1. An alpha channel is dropped when it is opaque everywhere.
 *
 * A file without colour chunks is taken for sRGB. With chunks it must be sRGB: an sRGB chunk, a
 * profile that libpng knows to be sRGB, a cICP of 1/13/0/1, or gAMA 0.45455 and the chromaticities
 * of Rec.709 (each alone is enough). NEPH_ERR_INPUT: of another colour space, translucent, an
 * animation, larger than NEPH_IMAGE_SIDE_MAX_PX, truncated, damaged (wrong checksums of colour
 * chunks are damage too), or not a PNG. NEPH_ERR_NOT_FOUND, NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_png_read_image(const char *path, struct neph_image **image,
                                     struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * PNG files through libpng. Writes images of 8 to 16 bits a channel. Reads any image as floats, or
 * raw 16-bit code values.
 */
#ifndef NEPH_BASE_PNG_H
#define NEPH_BASE_PNG_H

#include "base/image.h"

#include <stdbool.h>
#include <stdint.h>

/* Write an 8-bit image. `rgb` has width * height * 3 display-encoded bytes, row 0 on top. Written
 * completely or not at all, as by neph_exr_write(). */
enum neph_status neph_png_write_rgb8(const char *path, int width_px, int height_px,
                                     const uint8_t *rgb, struct neph_diag *diag);

/* The colour space of code values, recorded in the file (chunks sRGB, or cICP of 9/16/0/1). */
enum neph_png_space {
    NEPH_PNG_SRGB,
    NEPH_PNG_BT2020_PQ, /* ITU-R BT.2100 PQ, full range */
    NEPH_PNG_SPACE_COUNT,
};

/* Write an image of `bits` a channel, 9 to 16: `rgb` has width * height * 3 codes of 0 .. 2^bits -
 * 1. The file has 16 bits a channel; the codes are scaled to it, and sBIT has the significant bits.
 */
enum neph_status neph_png_write_rgb16(const char *path, int width_px, int height_px, int bits,
                                      enum neph_png_space space, const uint16_t *rgb,
                                      struct neph_diag *diag);

/* Read the raw code values of a 16-bit RGB PNG, without any gamma or colour conversion. `*rgb` has
 * width * height * 3 values 0..65535 and is freed by the caller with free(). NEPH_ERR_INPUT: not a
 * PNG, of another kind (the message names it), oversized or damaged. */
enum neph_status neph_png_read_rgb16(const char *path, int *width_px, int *height_px,
                                     uint16_t **rgb, struct neph_diag *diag);

/* The same, of a 16-bit grey PNG: width * height values. */
enum neph_status neph_png_read_grey16(const char *path, int *width_px, int *height_px,
                                      uint16_t **grey, struct neph_diag *diag);

/* Read any PNG (1 to 16 bits; grey, palette or RGB; interlaced or not) as linear R G B by the
 * inverse of the sRGB curve (IEC 61966-2-1:1999), evaluated in double and rounded once. The largest
 * code becomes 1. Attributes of the image:
 *
 *   encoding      "sRGB": values are relative to a display's white, not radiance
 *
 * The pixel density (pHYs) has no effect: programs round it to unequal numbers. An alpha channel is
 * dropped when it is opaque everywhere. A file without colour chunks is read as sRGB. A file with
 * them must be sRGB by one of: an sRGB chunk, a profile of sRGB (base/icc.h), a cICP of 1/13/0/1,
 * or gAMA 0.45455 and the chromaticities of Rec.709.
 *
 * NEPH_ERR_INPUT: another colour space, translucent pixels, an animation, sides above
 * NEPH_IMAGE_SIDE_MAX_PX, truncated or damaged (also by checksums of colour chunks), or not a PNG.
 * NEPH_ERR_NOT_FOUND, NEPH_ERR_IO, NEPH_ERR_MEMORY. */
enum neph_status neph_png_read_image(const char *path, struct neph_image **image,
                                     struct neph_diag *diag);

/* Read any PNG as neph_png_read_image() does, with its alpha: `*rgba` has four values a pixel, rows
 * from the top: linear R G B, not multiplied by alpha, and alpha, where the largest code is 1. The
 * caller frees it with free(). `*has_alpha`: any alpha is below 1. NEPH_ERR_INPUT also for a file
 * or values of more than `limit_bytes`. */
enum neph_status neph_png_read_rgba(const char *path, size_t limit_bytes, int *width_px,
                                    int *height_px, float **rgba, bool *has_alpha,
                                    struct neph_diag *diag);

#endif

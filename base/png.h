/* SPDX-License-Identifier: MIT
 *
 * PNG files through libpng: 8-bit sRGB pictures out, 16-bit code values in.
 */
#ifndef NEPH_BASE_PNG_H
#define NEPH_BASE_PNG_H

#include "base/status.h"

#include <stdint.h>

/* Write a picture. `rgb` holds width * height * 3 display-encoded bytes, row 0 on top.
 * Complete or not there at all, as neph_exr_write. */
enum neph_status neph_png_write_rgb8(const char *path, int width_px, int height_px,
                                     const uint8_t *rgb, struct neph_diag *diag);

/* Read the raw code values of a 16-bit RGB PNG, without any gamma or colour conversion.
 * `*rgb` holds width * height * 3 values 0..65535 and is freed by the caller with free().
 * NEPH_ERR_INPUT: not a PNG, of another kind (the message names it), oversized or damaged. */
enum neph_status neph_png_read_rgb16(const char *path, int *width_px, int *height_px,
                                     uint16_t **rgb, struct neph_diag *diag);

#endif

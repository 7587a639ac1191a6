/* SPDX-License-Identifier: MIT
 *
 * A frame of any renderer, from a file.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_H
#define NEPH_HARNESS_COMPARE_FRAME_H

#include "base/image.h"

/* The attribute of a frame of a sequence: how many of them a second it was made for. */
#define NEPH_FRAME_RATE_ATTRIBUTE "neph.frame_rate_hz"

/* The attribute of a picture for a display (`neph post`): "sRGB", or "PQ" for an HDR display. Its
 * values are the linear light that the display makes of it, 1 being its white, or an HDR display's
 * peak. */
#define NEPH_DISPLAY_ATTRIBUTE "neph.display"

/* How many frames a second a frame was made for, as its file says: NEPH_FRAME_RATE_ATTRIBUTE, else
 * OpenEXR's framesPerSecond. NaN: the file does not say it. */
double neph_frame_rate_hz(const struct neph_image *image);

/* Read an OpenEXR or PNG file, told apart by content, and pass it through gate G0
 * (metrics/validity.h); the diag names the file. A PNG has the attribute "encoding" = "sRGB", and
 * so has a picture for a display. `layer`: its channels "<layer>.R" are R, and so on, and there is
 * no other colour; NULL: the names are as they are. Y alone is a grey picture. X, Y and Z beside R
 * G B are a vector and are called vector.X, ... A depth of 0, 65504, 65535, 1e9, or 1e10 and more
 * is the sky, +inf. Channels that have no meaning for us and hold values that are not finite
 * (identifiers) are left out. `negative_allowed`: values below 0 that are let through, as for
 * neph_validity_gate(). NEPH_ERR_GATE: a value is not finite (depth may be +inf), or too many are
 * negative. NEPH_ERR_INPUT: neither format, or of a kind that is not read, or damaged; colours that
 * are not in Rec.709, or CIE XYZ. NEPH_ERR_NOT_FOUND, NEPH_ERR_IO. */
enum neph_status neph_frame_read(const char *path, const char *layer, size_t negative_allowed,
                                 struct neph_image **image, struct neph_diag *diag);

/* The same, but depth is what the file has, and all channels are there. */
enum neph_status neph_frame_read_as_written(const char *path, const char *layer,
                                            size_t negative_allowed, struct neph_image **image,
                                            struct neph_diag *diag);

#endif

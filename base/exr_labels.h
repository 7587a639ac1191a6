/* SPDX-License-Identifier: MIT
 *
 * Which attributes of an OpenEXR file say something of its image, and which are only kept.
 */
#ifndef NEPH_BASE_EXR_LABELS_H
#define NEPH_BASE_EXR_LABELS_H

#include "base/image.h"

/* Names that the format itself gives a meaning to. */
bool neph_exr_is_reserved(const char *name);

/* Names of our attributes of an image that tell of the file itself (base/exr.h): they are neither
 * read from a file nor written. */
bool neph_exr_is_ours(const char *name);

/* Set the attributes colour_space, white_luminance and frames_per_second of base/exr.h by the bytes
 * of a header (base/exr_header.h). */
enum neph_status neph_exr_interpret_attributes(const char *header, size_t size,
                                               struct neph_image *image, struct neph_diag *diag);

/* Copy the attributes that no image has, as they are, into `kept`, which has room for `size` bytes;
 * how many bytes these are. */
size_t neph_exr_keep_attributes(const char *header, size_t size, char *kept);

#endif

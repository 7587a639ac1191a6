/* SPDX-License-Identifier: MIT
 *
 * Attributes of OpenEXR files: those that describe the image, and those that are only preserved.
 */
#ifndef NEPH_BASE_EXR_LABELS_H
#define NEPH_BASE_EXR_LABELS_H

#include "base/image.h"

/* Whether the format defines the meaning of the name. */
bool neph_exr_is_reserved(const char *name);

/* Whether the name belongs to an attribute that neph derives from the file itself (base/exr.h).
 * Such attributes are neither read from files nor written. */
bool neph_exr_is_derived(const char *name);

/* Set the attributes colour_space, white_luminance and frames_per_second of base/exr.h from the
 * bytes of a header (base/exr_header.h). */
enum neph_status neph_exr_interpret_attributes(const char *header, size_t size,
                                               struct neph_image *image, struct neph_diag *diag);

/* Copy the attributes that the image itself does not store, unparsed, to `kept`, which has room for
 * `size` bytes. Returns the number of bytes copied. */
size_t neph_exr_copy_preserved(const char *header, size_t size, char *kept);

#endif

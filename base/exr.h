/* SPDX-License-Identifier: MIT
 *
 * OpenEXR files through OpenEXRCore: single-part, scanline, ZIP, 32-bit float out; half, float and
 * uint scanlines in.
 */
#ifndef NEPH_BASE_EXR_H
#define NEPH_BASE_EXR_H

#include "base/image.h"

/* Write all channels as 32-bit float and all attributes as strings. The file appears under `path`
 * only when it is complete and on disk (temporary name, fsync, rename). */
enum neph_status neph_exr_write(const char *path, const struct neph_image *image,
                                struct neph_diag *diag);

/* Read all channels (converted to float) and all string attributes. Deep, tiled, multi-part,
 * truncated or oversized files are refused with a message that says which. */
enum neph_status neph_exr_read(const char *path, struct neph_image **image, struct neph_diag *diag);

#endif

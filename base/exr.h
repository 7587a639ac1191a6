/* SPDX-License-Identifier: MIT
 *
 * OpenEXR files through OpenEXRCore: single-part, scanline, ZIP or plain, 32-bit float out; half,
 * float and uint scanlines in.
 */
#ifndef NEPH_BASE_EXR_H
#define NEPH_BASE_EXR_H

#include "base/image.h"

/* Write all channels as 32-bit float and all attributes as strings. The file appears under `path`
 * only when it is complete and on disk (temporary name, fsync, rename). An image that was read from
 * a file goes to the same place in the same picture, with all attributes of that file
 * (base/image.h). The same image gives the same bytes. NEPH_ERR_INPUT: no channels, or an attribute
 * named like one of the format's own ("channels", "type", ...). NEPH_ERR_IO: disk full, no such
 * folder, ... */
enum neph_status neph_exr_write(const char *path, const struct neph_image *image,
                                struct neph_diag *diag);

/* The same without compression: for files that are read soon and then go. */
enum neph_status neph_exr_write_plain(const char *path, const struct neph_image *image,
                                      struct neph_diag *diag);

/* Read all channels (converted to float; uint above 2^24 is rounded) and all string attributes but
 * the format's own. Channels come in the order of the file, which is alphabetical. What is unusual
 * about the file is said in attributes of ours, which texts of that name in the file do not reach:
 *   crop          the image is the data window; when the display window is another one, where it
 *                 lies in that, as "(10, 5) of 100x60"
 *   primaries     the chromaticities, when they are not those of Rec.709
 *   pixel_aspect  width / height of a pixel, when it is not 1
 *   colour_space  by the names colorInteropID and oiio:ColorSpace (base/colour_space.h), when it is
 *                 not linear Rec.709
 *   white_luminance    whiteLuminance, when there is one [cd/m^2]
 *   frames_per_second  framesPerSecond, when there is one [Hz]
 * Deep, tiled, multi-part, subsampled, oversized, and truncated or damaged files, and those of DWA
 * or a compression of no name here, are refused with NEPH_ERR_INPUT and a message that says which.
 * NEPH_ERR_NOT_FOUND: no such file. NEPH_ERR_IO: it is there but cannot be read. */
enum neph_status neph_exr_read(const char *path, struct neph_image **image, struct neph_diag *diag);

#endif

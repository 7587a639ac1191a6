/* SPDX-License-Identifier: MIT
 *
 * OpenEXR files through OpenEXRCore. Writes single-part scanline files, ZIP or uncompressed, 32-bit
 * float. Reads half, float and uint, scanlines or tiles.
 */
#ifndef NEPH_BASE_EXR_H
#define NEPH_BASE_EXR_H

#include "base/image.h"

struct neph_oiio_server;

/* Write all channels as 32-bit float and all attributes as strings. The file appears under `path`
 * only when it is complete and on disk (temporary name, fsync, rename). An image that was read from
 * a file keeps that file's data window, display window and attributes (base/image.h). Equal images
 * give equal bytes. NEPH_ERR_INPUT: no channels, or an attribute with a name that the format
 * reserves ("channels", "type", ...). NEPH_ERR_IO: disk full, no such folder, ... */
enum neph_status neph_exr_write(const char *path, const struct neph_image *image,
                                struct neph_diag *diag);

/* As neph_exr_write(), uncompressed: for files that are read soon and then removed. */
enum neph_status neph_exr_write_plain(const char *path, const struct neph_image *image,
                                      struct neph_diag *diag);

/* Read all channels (converted to float; uint above 2^24 is rounded) and all string attributes
 * except the reserved ones. Channels are in the order of the file, which is alphabetical. Of a file
 * with several levels (mipmap, ripmap) the first one, which has the full size, is read. Subsampled
 * channels get all pixels, and luminance with chroma (Y, RY, BY) becomes R, G, B
 * (base/exr_chroma.h). Unusual properties of the file become attributes of the image; texts of
 * these names in the file are ignored:
 *
 *   crop          the image is the data window; if the display window is another one, the position
 *                 in it, as "(10, 5) of 100x60"
 *   primaries     the chromaticities, if they are not those of Rec.709
 *   pixel_aspect  width / height of a pixel, if it is not 1
 *   colour_space  from colorInteropID and oiio:ColorSpace (base/colour_space.h), if it is not
 *                 linear Rec.709
 *   white_luminance    whiteLuminance, if present [cd/m^2]
 *   frames_per_second  framesPerSecond, if present [Hz]
 *
 * NEPH_ERR_INPUT, with a message that names the cause: deep, oversized, truncated or damaged files,
 * files with an unknown compression, with DWA where neph was built without OpenImageIO
 * (base/oiio.h), and other subsampling than by 2.
 * NEPH_ERR_MEMORY, also before pixels are read: they need more memory than the machine has.
 * NEPH_ERR_NOT_FOUND: no such file. NEPH_ERR_IO: the file exists but cannot be read. */
enum neph_status neph_exr_read(const char *path, struct neph_image **image, struct neph_diag *diag);

/* As neph_exr_read(), of a file with several parts the one whose name, or whose number from 0, is
 * `part`. NULL: the only flat part with colour channels (base/colour_names.h), as neph_exr_read()
 * reads it. NEPH_ERR_INPUT also: there is no such part, or more than one; the message lists the
 * parts. `part` has no effect on a file with one part. `server` (base/oiio_server.h) decodes DWA;
 * NULL: a process is started for this file. */
enum neph_status neph_exr_read_part(const char *path, const char *part,
                                    struct neph_oiio_server *server, struct neph_image **image,
                                    struct neph_diag *diag);

#endif

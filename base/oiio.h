/* SPDX-License-Identifier: MIT
 *
 * Images of formats that OpenImageIO reads, through the helper program neph-image, which exists
 * where OpenImageIO was installed when neph was built.
 */
#ifndef NEPH_BASE_OIIO_H
#define NEPH_BASE_OIIO_H

#include "base/image.h"
#include "base/oiio_server.h"

/* The name of such a format by the first bytes of a file: "TIFF", "Radiance HDR", "PFM", "PPM",
 * "JPEG", "WebP", "DPX". NULL: it is none of them. */
const char *neph_oiio_format(const void *bytes, size_t size);

/* Read a file. Channels keep their names. `part` is the number of an image in a file with several,
 * from 0; NULL: the only one. `server` NULL: a process is started for this file.
 *
 * Integers of 8 bits are decoded from sRGB, and those of more bits if the file says sRGB; the image
 * then has the attribute "encoding", "sRGB", as a PNG has, and alpha is dropped where it is 1.
 * Floats are linear. So are integers of which the file says linear. PPM is sRGB in practice,
 * although its specification has the curve of BT.709, and PFM is linear. A colour profile must be
 * that of sRGB (base/icc.h). Windows and frame rate as for neph_exr_read().
 *
 * NEPH_ERR_INPUT: damaged or truncated, too large, translucent, or of another colour space, with
 * the way out. NEPH_ERR_UNAVAILABLE: neph was built without OpenImageIO. NEPH_ERR_MEMORY: more
 * memory is needed than half of the machine's. NEPH_ERR_NOT_FOUND, NEPH_ERR_IO. */
enum neph_status neph_oiio_read_part(const char *path, const char *part,
                                     struct neph_oiio_server *server, struct neph_image **image,
                                     struct neph_diag *diag);

/* Fill the channels of an image with the samples of a part, from 0, of a file, which has all of
 * them and its size. For OpenEXR files that the C library does not decode. Errors as of
 * neph_oiio_read_part(), but no colour space is refused. */
enum neph_status neph_oiio_fill(const char *path, int part, struct neph_oiio_server *server,
                                struct neph_image *image, struct neph_diag *diag);

/* The image of the output of neph-image (base/oiio_stream.h); `path` names its file in messages. */
enum neph_status neph_oiio_image(const char *path, const void *bytes, size_t size,
                                 struct neph_image **image, struct neph_diag *diag);

#endif

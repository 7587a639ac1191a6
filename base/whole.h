/* SPDX-License-Identifier: MIT
 *
 * Whether a TIFF or JPEG file has all its pixels, by its structure. The libraries that decode them
 * fill missing pixels with zeros or grey, without an error.
 */
#ifndef NEPH_BASE_WHOLE_H
#define NEPH_BASE_WHOLE_H

#include "base/status.h"

#include <stdint.h>

/* Check an open file of `size_bytes`; other formats are not checked. `path` names it in messages.
 * No pixel is decoded.
 *
 * TIFF 6.0 and BigTIFF, each image: the directory and all strips or tiles are inside the file;
 * there are as many as the size needs; their bytes can hold it: exactly for uncompressed pixels,
 * else by the largest ratio of the compression, where there is one. JPEG (ISO/IEC 10918-1, annex
 * B): there is an end-of-image marker after the first scan, and a bit for each block of 8x8 pixels.
 *
 * NEPH_ERR_INPUT: it is truncated, or its header lies. NEPH_ERR_IO. */
enum neph_status neph_whole_check(const char *path, int fd, uint64_t size_bytes,
                                  struct neph_diag *diag);

#endif

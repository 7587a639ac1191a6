/* SPDX-License-Identifier: MIT
 *
 * Animated PNG files (PNG specification, third edition, 5.3 and 11.3.6), which libpng does not
 * know.
 */
#ifndef NEPH_BASE_APNG_H
#define NEPH_BASE_APNG_H

#include "base/image.h"

struct neph_apng;

/* The number of frames that a PNG file declares, 0 for any other file. The chunks before the pixels
 * are examined, no pixel is read. */
int neph_apng_count(const char *path);

/* Open an animation of at least one frame. All chunks and their checksums are checked.
 * NEPH_ERR_INPUT: damaged, truncated or no animation. NEPH_ERR_NOT_FOUND, NEPH_ERR_IO,
 * NEPH_ERR_MEMORY. */
enum neph_status neph_apng_open(const char *path, struct neph_apng **apng, struct neph_diag *diag);

/* NULL is fine. */
void neph_apng_close(struct neph_apng *apng);

/* Number of frames. An image before the first frame control chunk is none of them. */
int neph_apng_frame_count(const struct neph_apng *apng);

/* Read a frame, counted from 0, as neph_png_read_image() reads an image: the whole canvas after
 * this frame was drawn. Partly transparent pixels are drawn over others by their code values, as
 * browsers do. Frames in ascending order cost a frame each; a lower number starts from frame 0. If
 * all frames but the last are shown for the same time, the attribute frames_per_second is set.
 * `path` names the frame in messages. Errors as of neph_png_read_image(); NEPH_ERR_INPUT also: a
 * pixel of the canvas is still transparent. */
enum neph_status neph_apng_read(struct neph_apng *apng, int frame, const char *path,
                                struct neph_image **image, struct neph_diag *diag);

#endif

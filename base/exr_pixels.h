/* SPDX-License-Identifier: MIT
 *
 * Pixels of one part of an OpenEXR file: the layout of its chunks, and their decoding. Private to
 * the reader (base/exr.c).
 */
#ifndef NEPH_BASE_EXR_PIXELS_H
#define NEPH_BASE_EXR_PIXELS_H

#include "base/exr_library.h"
#include "base/image.h"

/* Layout of the pixels, from the header. A chunk has the pixels of a block: a tile, or as many
 * whole rows as the compression takes. Blocks at the right and at the bottom may be smaller. */
struct neph_exr_layout {
    int part;
    bool is_tiled;            /* then only the first level, which has the full size, is read */
    exr_attr_box2i_t window;  /* data window */
    exr_attr_box2i_t display; /* display window */
    int width_px, height_px;
    int block_width_px, block_height_px;
    bool is_subsampled; /* at least one of the channels */
    exr_compression_t compression;
    const exr_attr_chlist_t *channels;
};

/* Find each chunk and compare its place and its sizes with the header. Runs before pixel memory is
 * allocated: a small damaged file may claim gigabytes. */
exr_result_t neph_exr_check_chunks(exr_const_context_t context,
                                   const struct neph_exr_layout *layout);

/* Decode all pixels into the channels of the image, which has the size of the data window and the
 * channels in the order of the file. A subsampled channel gets its samples row by row without gaps
 * (base/exr_chroma.h). */
exr_result_t neph_exr_read_pixels(exr_const_context_t context, const struct neph_exr_layout *layout,
                                  const struct neph_image *image);

#endif

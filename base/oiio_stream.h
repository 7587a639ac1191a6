/* SPDX-License-Identifier: MIT
 *
 * The protocol between neph and the helper program neph-image (base/helper.h), which alone links
 * OpenImageIO:
 *
 *     neph-image read STREAM FILE PART MEMORY_LIMIT_BYTES CPU_LIMIT_S SIDE_MAX
 *
 * PART is the number of an image in a file with several, from 0, or "only". STREAM is a path to
 * memory of neph (base/helper.h). It gets a head, the names of the channels (NEPH_OIIO_NAME_BYTES
 * each, ended by zero bytes), the colour profile, and the channels one after the other as 32-bit
 * floats, row 0 on top, in this machine's byte order. Integers are divided by their largest value.
 */
#ifndef NEPH_BASE_OIIO_STREAM_H
#define NEPH_BASE_OIIO_STREAM_H

#include <stdint.h>

enum { NEPH_OIIO_MAGIC = 0x4e494d31, NEPH_OIIO_NAME_BYTES = 256, NEPH_OIIO_CHANNELS_MAX = 1024 };

struct neph_oiio_head {
    uint32_t magic;
    int32_t data_min_px[2], data_px[2]; /* corner in the display window, and size */
    int32_t display_px[2];
    int32_t channel_count;
    int32_t integer_bits;                    /* of a channel; 0: floats */
    uint32_t profile_bytes;                  /* ICC profile; 0: none */
    double pixel_aspect, frames_per_second;  /* 0: not said */
    char format[NEPH_OIIO_NAME_BYTES];       /* "tiff" */
    char colour_space[NEPH_OIIO_NAME_BYTES]; /* oiio:ColorSpace; "": not said */
};

#endif

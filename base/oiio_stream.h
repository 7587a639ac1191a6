/* SPDX-License-Identifier: MIT
 *
 * The protocol between neph and the helper program neph-image (base/helper.h), which alone links
 * OpenImageIO. Its stdin is a pipe of requests, one for each file. It ends at the end of the pipe.
 *
 * The descriptors of a request are those of neph, opened through /proc/PROCESS/fd. The stream gets
 * a head, the names of the channels (NEPH_OIIO_NAME_BYTES each, ended by zero bytes), the colour
 * profile, and the channels one after the other as 32-bit floats, row 0 on top, in this machine's
 * byte order. Integers are divided by their largest value. The log gets the messages, the last of
 * which is the reason of an error. The pipe `answer_fd` gets a neph_oiio_answer at the end.
 */
#ifndef NEPH_BASE_OIIO_STREAM_H
#define NEPH_BASE_OIIO_STREAM_H

#include <limits.h>
#include <stdint.h>

enum { NEPH_OIIO_MAGIC = 0x4e494d31, NEPH_OIIO_NAME_BYTES = 256, NEPH_OIIO_CHANNELS_MAX = 1024 };

struct neph_oiio_request {
    uint32_t magic;
    int32_t process, stream_fd, log_fd, answer_fd;
    int32_t part; /* of a file with several images, from 0; -1: the only one */
    int32_t side_max_px;
    uint32_t cpu_limit_s, wall_limit_s;
    uint64_t memory_limit_bytes;
    char path[PATH_MAX];
};

/* The end of the process that read the file. */
struct neph_oiio_answer {
    int32_t exit_code; /* as of base/helper.h, if signal is 0 */
    int32_t signal;
    double cpu_s;
};

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

/* SPDX-License-Identifier: MIT
 *
 * Code values of PNG images, for the readers of single images and of animations. Private to
 * base/png.c and base/apng.c.
 */
#ifndef NEPH_BASE_PNG_CODES_H
#define NEPH_BASE_PNG_CODES_H

#include "base/image.h"

struct neph_png_codes {
    int width_px, height_px;
    size_t channel_count; /* 3, or 4 with alpha */
    uint32_t code_max;    /* 255: samples are uint8_t; 65535: uint16_t */
    void *samples;        /* rows from the top, channels of a pixel side by side; owned */
};

static inline uint32_t neph_png_code(const struct neph_png_codes *codes, size_t index)
{
    return codes->code_max == 255 ? ((const uint8_t *)codes->samples)[index]
                                  : ((const uint16_t *)codes->samples)[index];
}

/* The big-endian number in the bytes of a file. */
static inline uint32_t neph_png_u32(const char *bytes)
{
    const unsigned char *b = (const unsigned char *)bytes;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | (uint32_t)b[3];
}

/* Decode a file in memory, of which a zero byte follows. It must be sRGB as for
 * neph_png_read_image(); `path` is for messages. The caller frees the samples. */
enum neph_status neph_png_decode(const char *path, const char *file, size_t size,
                                 struct neph_png_codes *codes, struct neph_diag *diag);

/* Code values as neph_png_read_image() returns them. NEPH_ERR_INPUT: translucent pixels. */
enum neph_status neph_png_make_image(const char *path, const struct neph_png_codes *codes,
                                     struct neph_image **image, struct neph_diag *diag);

#endif

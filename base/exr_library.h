/* SPDX-License-Identifier: MIT
 *
 * Declarations shared by exr.c, exr_pixels.c (reading) and exr_write.c (writing). Private to these.
 */
#ifndef NEPH_BASE_EXR_LIBRARY_H
#define NEPH_BASE_EXR_LIBRARY_H

#include <stdint.h>
#include <stdio.h>

#include <openexr.h>

enum { NEPH_EXR_ONLY_PART = 0 };

/* First member of the user data of a context. */
struct neph_exr_error {
    int io_error;        /* errno of a failed read, or ENOMEM of a failed write */
    char complaint[256]; /* the library's last message */
};

static inline void neph_exr_store_message(exr_const_context_t context, exr_result_t code,
                                          const char *message)
{
    (void)code;
    void *data = NULL;
    if (!context || exr_get_user_data(context, &data) != EXR_ERR_SUCCESS || !data)
        return;
    struct neph_exr_error *trouble = data;
    snprintf(trouble->complaint, sizeof(trouble->complaint), "%s", message);
}

/* The library's last message if there is one, else the meaning of its code. */
static inline const char *neph_exr_reason(const struct neph_exr_error *trouble, exr_result_t result)
{
    return trouble->complaint[0] ? trouble->complaint : exr_get_default_error_message(result);
}

/* The memory layout of a channel: rows of `width_px` floats. */
static inline void neph_exr_float_rows(exr_coding_channel_info_t *channel, int width_px)
{
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_bytes_per_element = sizeof(float);
    channel->user_pixel_stride = sizeof(float);
    channel->user_line_stride = width_px * (int32_t)sizeof(float);
}

#endif

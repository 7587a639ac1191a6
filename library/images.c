/* SPDX-License-Identifier: MIT */
#include "base/srgb.h"
#include "base/text.h"
#include "library/handles.h"

#include <stdlib.h>
#include <string.h>

int nephm_image_create(int width_px, int height_px, nephm_image **image, struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    nephm_image *made = calloc(1, sizeof(*made));
    const enum neph_status status = made ? neph_image_create(width_px, height_px, &made->image,
                                                             &diag)
                                         : neph_fail_memory(&diag);
    if (status)
        free(made);
    else
        *image = made;
    return neph_library_tell(status, &diag, error);
}

void nephm_image_destroy(nephm_image *image)
{
    if (image)
        neph_image_destroy(image->image);
    free(image);
}

/* The samples of a channel, which is added where it is missing. */
static enum neph_status find_channel(nephm_image *image, const char *name, float **samples,
                                     struct neph_diag *diag)
{
    const size_t length = name ? strlen(name) : 0;
    if (!image)
        return neph_fail(diag, NEPH_ERR_USAGE, "the image is NULL");
    if (length == 0 || length >= NEPH_IMAGE_NAME_MAX || !neph_text_is_utf8(name, length))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "the name of a channel has %zu bytes: 1 to %d of UTF-8 are allowed",
                         length, NEPH_IMAGE_NAME_MAX - 1);
    *samples = neph_image_channel(image->image, name);
    return *samples ? NEPH_OK : neph_image_add_channel(image->image, name, samples, diag);
}

int nephm_image_set_floats(nephm_image *image, const char *channel, const void *samples,
                           ptrdiff_t pixel_stride_bytes, ptrdiff_t row_stride_bytes,
                           struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    float *to;
    const enum neph_status status = samples
                                        ? find_channel(image, channel, &to, &diag)
                                        : neph_fail(&diag, NEPH_ERR_USAGE, "the samples are NULL");
    for (int y = 0; !status && y < image->image->height_px; y++) {
        const char *from = (const char *)samples + y * row_stride_bytes;
        for (int x = 0; x < image->image->width_px; x++, to++, from += pixel_stride_bytes)
            memcpy(to, from, sizeof(*to)); /* it may be unaligned */
    }
    return neph_library_tell(status, &diag, error);
}

static unsigned read_code(const char *from, int code_bytes)
{
    uint16_t two;
    if (code_bytes == 1)
        return *(const unsigned char *)from;
    memcpy(&two, from, sizeof(two));
    return two;
}

/* Light of each code as base/png.c has it. Freed by the caller. */
static float *make_light(int code_bytes)
{
    const size_t count = code_bytes == 1 ? 1u << 8 : 1u << 16;
    float *light = malloc(count * sizeof(*light));
    for (size_t code = 0; light && code < count; code++)
        light[code] = (float)neph_srgb_to_linear((double)code / (double)(count - 1));
    return light;
}

static enum neph_status set_srgb_codes(nephm_image *image, const char *channel, const void *codes,
                                       int code_bytes, ptrdiff_t pixel_stride_bytes,
                                       ptrdiff_t row_stride_bytes, struct neph_diag *diag)
{
    float *to;
    if (!codes)
        return neph_fail(diag, NEPH_ERR_USAGE, "the codes are NULL");
    if (code_bytes != 1 && code_bytes != 2)
        return neph_fail(diag, NEPH_ERR_USAGE, "codes of %d bytes: 1 and 2 are allowed",
                         code_bytes);
    enum neph_status status = find_channel(image, channel, &to, diag);
    float *light = status ? NULL : make_light(code_bytes);
    if (!status && !light)
        status = neph_fail_memory(diag);
    for (int y = 0; !status && y < image->image->height_px; y++) {
        const char *from = (const char *)codes + y * row_stride_bytes;
        for (int x = 0; x < image->image->width_px; x++, to++, from += pixel_stride_bytes)
            *to = light[read_code(from, code_bytes)];
    }
    free(light);
    return status ? status : neph_image_set_attribute(image->image, "encoding", diag, "sRGB");
}

int nephm_image_set_srgb_codes(nephm_image *image, const char *channel, const void *codes,
                               int code_bytes, ptrdiff_t pixel_stride_bytes,
                               ptrdiff_t row_stride_bytes, struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    const enum neph_status status = set_srgb_codes(image, channel, codes, code_bytes,
                                                   pixel_stride_bytes, row_stride_bytes, &diag);
    return neph_library_tell(status, &diag, error);
}

int nephm_image_set_text(nephm_image *image, const char *name, const char *value,
                         struct nephm_error *error)
{
    struct neph_diag diag = {.line = 0};
    const size_t length = name ? strlen(name) : 0;
    const bool is_valid = image && value && length > 0 && length < NEPH_IMAGE_NAME_MAX &&
                          neph_text_is_utf8(name, length) &&
                          neph_text_is_utf8(value, strlen(value));
    const enum neph_status status =
        is_valid ? neph_image_set_attribute(image->image, name, &diag, "%s", value)
                 : neph_fail(&diag, NEPH_ERR_USAGE,
                             "a text of an image has a name of 1 to %d bytes and a value, in UTF-8",
                             NEPH_IMAGE_NAME_MAX - 1);
    return neph_library_tell(status, &diag, error);
}

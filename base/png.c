/* SPDX-License-Identifier: MIT
 *
 * Pictures go out through libpng's simplified API. Code values come in through the classic one,
 * because the simplified API always converts 16-bit files to linear light. Both work in memory,
 * with base/files.h doing the rest.
 */
#include "base/png.h"

#include "base/files.h"
#include "base/image.h"

#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>

static const size_t file_limit_bytes = (size_t)1 << 32;

static enum neph_status check_side(const char *path, int width_px, int height_px,
                                   struct neph_diag *diag)
{
    if (width_px >= 1 && height_px >= 1 && width_px <= NEPH_IMAGE_SIDE_MAX_PX &&
        height_px <= NEPH_IMAGE_SIDE_MAX_PX)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT, "'%s': a size of %dx%d pixels is outside 1..%d", path,
                     width_px, height_px, NEPH_IMAGE_SIDE_MAX_PX);
}

enum neph_status neph_png_write_rgb8(const char *path, int width_px, int height_px,
                                     const uint8_t *rgb, struct neph_diag *diag)
{
    enum neph_status status = check_side(path, width_px, height_px, diag);
    if (status)
        return status;
    png_image picture = {
        .version = PNG_IMAGE_VERSION,
        .width = (png_uint_32)width_px,
        .height = (png_uint_32)height_px,
        .format = PNG_FORMAT_RGB, /* display-encoded: libpng adds the sRGB chunk */
    };
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(picture);
    void *file = malloc(size);
    if (!file)
        return neph_fail_memory(diag);
    if (png_image_write_to_memory(&picture, file, &size, 0, rgb, 0, NULL))
        status = neph_file_write(path, file, size, diag);
    else
        status = neph_fail(diag, NEPH_ERR_INTERNAL, "cannot encode '%s': %s", path,
                           picture.message);
    free(file);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------- */

/* All that lives across a longjmp() of libpng is in here and not in local variables. */
struct reader {
    const char *path;
    char *file;
    size_t file_size, position;
    int width_px, height_px;
    uint16_t *rgb;
    png_bytep *rows;
    png_structp png;
    png_infop info;
    jmp_buf escape;
    enum neph_status status;
    struct neph_diag *diag;
};

_Noreturn static void escape_with(struct reader *reader, enum neph_status status)
{
    reader->status = status;
    longjmp(reader->escape, 1);
}

_Noreturn static void on_error(png_structp png, png_const_charp message)
{
    struct reader *reader = png_get_error_ptr(png);
    bool truncated = reader->position == reader->file_size;
    escape_with(reader, neph_fail(reader->diag, NEPH_ERR_INPUT, "'%s' is %s: %s", reader->path,
                                  truncated ? "truncated or damaged" : "damaged", message));
}

/* Warnings are about chunks that say nothing about code values. */
static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void give_bytes(png_structp png, png_bytep target, size_t size)
{
    struct reader *reader = png_get_io_ptr(png);
    if (size > reader->file_size - reader->position) {
        reader->position = reader->file_size;
        png_error(png, "the file ends too early");
    }
    memcpy(target, reader->file + reader->position, size);
    reader->position += size;
}

static const char *colour_type_name(int colour_type)
{
    switch (colour_type) {
    case PNG_COLOR_TYPE_GRAY:
        return "grey";
    case PNG_COLOR_TYPE_GRAY_ALPHA:
        return "grey and alpha";
    case PNG_COLOR_TYPE_PALETTE:
        return "palette";
    case PNG_COLOR_TYPE_RGB:
        return "RGB";
    default:
        return "RGB and alpha";
    }
}

static void read_header(struct reader *reader)
{
    png_set_user_limits(reader->png, NEPH_IMAGE_SIDE_MAX_PX, NEPH_IMAGE_SIDE_MAX_PX);
    png_read_info(reader->png, reader->info);
    int depth = png_get_bit_depth(reader->png, reader->info);
    int colour_type = png_get_color_type(reader->png, reader->info);
    if (depth != 16 || colour_type != PNG_COLOR_TYPE_RGB)
        escape_with(reader, neph_fail(reader->diag, NEPH_ERR_INPUT,
                                      "'%s' is a %d-bit %s PNG; only 16-bit RGB is read",
                                      reader->path, depth, colour_type_name(colour_type)));
    reader->width_px = (int)png_get_image_width(reader->png, reader->info);
    reader->height_px = (int)png_get_image_height(reader->png, reader->info);
}

static void read_rows(struct reader *reader)
{
    size_t row_values = (size_t)reader->width_px * 3;
    reader->rgb = calloc((size_t)reader->height_px * row_values, sizeof(*reader->rgb));
    reader->rows = calloc((size_t)reader->height_px, sizeof(png_bytep));
    if (!reader->rgb || !reader->rows)
        escape_with(reader, neph_fail_memory(reader->diag));
    for (int y = 0; y < reader->height_px; y++)
        reader->rows[y] = (png_bytep)(reader->rgb + (size_t)y * row_values);
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    png_set_swap(reader->png); /* the file is big-endian; no other transformation is asked for */
#endif
    png_read_image(reader->png, reader->rows);
    png_read_end(reader->png, NULL); /* sees a file without its end */
}

static void decode(struct reader *reader)
{
    reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    if (!reader->info) {
        reader->status = neph_fail_memory(reader->diag);
    } else if (setjmp(reader->escape) == 0) {
        png_set_read_fn(reader->png, reader, give_bytes);
        read_header(reader);
        read_rows(reader);
    }
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
    free(reader->rows);
}

enum neph_status neph_png_read_rgb16(const char *path, int *width_px, int *height_px,
                                     uint16_t **rgb, struct neph_diag *diag)
{
    struct reader reader = {.path = path, .diag = diag};
    reader.status = neph_file_read(path, file_limit_bytes, &reader.file, &reader.file_size, diag);
    if (reader.status)
        return reader.status;
    if (reader.file_size < 8 || png_sig_cmp((png_const_bytep)reader.file, 0, 8) != 0)
        reader.status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a PNG file", path);
    else
        decode(&reader);
    free(reader.file);
    if (reader.status) {
        free(reader.rgb);
        return reader.status;
    }
    *width_px = reader.width_px;
    *height_px = reader.height_px;
    *rgb = reader.rgb;
    return NEPH_OK;
}

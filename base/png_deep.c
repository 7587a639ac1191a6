/* SPDX-License-Identifier: MIT
 *
 * PNG files with more than 8 bits a channel, written through libpng's classic API: the simplified
 * one takes 16-bit samples as linear light.
 */
#include "base/png.h"

#include "base/files.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>

/* Does not compile with a new colour space: this file then needs a change. */
_Static_assert(NEPH_PNG_SPACE_COUNT == 2, "a new kind");

/* Everything that must survive a longjmp() of libpng is here and not in local variables. */
struct writer {
    const char *path;
    char *file;
    size_t size, room;
    uint8_t *row;
    png_structp png;
    png_infop info;
    jmp_buf escape;
    enum neph_status status;
    struct neph_diag *diag;
};

_Noreturn static void on_error(png_structp png, png_const_charp message)
{
    struct writer *writer = png_get_error_ptr(png);
    writer->status = neph_fail(writer->diag, NEPH_ERR_INTERNAL, "cannot encode '%s': %s",
                               writer->path, message);
    longjmp(writer->escape, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void store_bytes(png_structp png, png_bytep bytes, size_t size)
{
    struct writer *writer = png_get_io_ptr(png);
    if (writer->size + size > writer->room) {
        const size_t room = 2 * (writer->size + size);
        char *file = realloc(writer->file, room);
        if (!file) {
            writer->status = neph_fail_memory(writer->diag);
            longjmp(writer->escape, 1);
        }
        writer->file = file;
        writer->room = room;
    }
    memcpy(writer->file + writer->size, bytes, size);
    writer->size += size;
}

static void flush(png_structp png)
{
    (void)png;
}

/* Add the chunk cICP of ITU-T H.273: primaries of BT.2020, the transfer function of ST 2084, RGB,
 * full range. libpng 1.6 does not know the chunk. */
static void write_bt2020_pq_chunk(struct writer *writer)
{
    static const png_byte name[] = "cICP";
    png_unknown_chunk chunk = {.size = 4, .location = PNG_HAVE_IHDR};
    png_byte values[4] = {9, 16, 0, 1};
    memcpy(chunk.name, name, sizeof(name));
    chunk.data = values;
    png_set_keep_unknown_chunks(writer->png, PNG_HANDLE_CHUNK_ALWAYS, name, 1);
    png_set_unknown_chunks(writer->png, writer->info, &chunk, 1);
}

static void write_head(struct writer *writer, int width_px, int height_px, int bits,
                       enum neph_png_space space)
{
    const png_byte depth = (png_byte)bits;
    png_set_write_fn(writer->png, writer, store_bytes, flush);
    png_set_IHDR(writer->png, writer->info, (png_uint_32)width_px, (png_uint_32)height_px, 16,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sBIT(writer->png, writer->info,
                 &(png_color_8){.red = depth, .green = depth, .blue = depth});
    if (space == NEPH_PNG_SRGB)
        png_set_sRGB(writer->png, writer->info, PNG_sRGB_INTENT_PERCEPTUAL);
    else
        write_bt2020_pq_chunk(writer);
    png_write_info(writer->png, writer->info);
}

static void write_rows(struct writer *writer, int width_px, int height_px, int bits,
                       const uint16_t *rgb)
{
    const uint32_t largest = (1u << bits) - 1;
    const size_t count = 3 * (size_t)width_px;
    for (int y = 0; y < height_px; y++) {
        for (size_t i = 0; i < count; i++) {
            const uint32_t code = rgb[(size_t)y * count + i];
            const uint32_t scaled = (code * 65535u + largest / 2) / largest;
            writer->row[2 * i] = (uint8_t)(scaled >> 8);
            writer->row[2 * i + 1] = (uint8_t)scaled;
        }
        png_write_row(writer->png, writer->row);
    }
    png_write_end(writer->png, writer->info);
}

static enum neph_status encode(struct writer *writer, int width_px, int height_px, int bits,
                               enum neph_png_space space, const uint16_t *rgb)
{
    writer->row = malloc(6 * (size_t)width_px);
    if (!writer->row)
        return neph_fail_memory(writer->diag);
    if (setjmp(writer->escape))
        return writer->status;
    writer->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, writer, on_error, on_warning);
    writer->info = writer->png ? png_create_info_struct(writer->png) : NULL;
    if (!writer->info)
        return neph_fail_memory(writer->diag);
    write_head(writer, width_px, height_px, bits, space);
    write_rows(writer, width_px, height_px, bits, rgb);
    return NEPH_OK;
}

enum neph_status neph_png_write_rgb16(const char *path, int width_px, int height_px, int bits,
                                      enum neph_png_space space, const uint16_t *rgb,
                                      struct neph_diag *diag)
{
    struct writer writer = {.path = path, .diag = diag};
    if (width_px < 1 || height_px < 1 || width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s': a size of %dx%d pixels is outside 1..%d",
                         path, width_px, height_px, NEPH_IMAGE_SIDE_MAX_PX);
    enum neph_status status = encode(&writer, width_px, height_px, bits, space, rgb);
    if (!status)
        status = neph_file_write(path, writer.file, writer.size, diag);
    png_destroy_write_struct(&writer.png, &writer.info);
    free(writer.row);
    free(writer.file);
    return status;
}

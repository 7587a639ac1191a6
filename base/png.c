/* SPDX-License-Identifier: MIT
 *
 * PNG files. 8-bit images are written through libpng's simplified API. Code values are read through
 * the classic one, because the simplified API converts 16-bit files to linear light and trusts any
 * gAMA chunk. Both work in memory; base/files.h reads and writes the files.
 */
#include "base/png.h"

#include "base/files.h"
#include "base/icc.h"
#include "base/png_codes.h"
#include "base/srgb.h"

#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>
#include <zlib.h>

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

/* Everything that must survive a longjmp() of libpng is here and not in local variables. */
struct reader {
    const char *path;
    const char *file; /* borrowed; ends with a zero byte */
    size_t file_size, position;
    int width_px, height_px;
    size_t channel_count;
    uint32_t code_max;
    void *samples; /* rows in libpng's layout */
    png_bytep *rows;
    png_structp png;
    png_infop info;
    jmp_buf escape;
    enum neph_status status;
    struct neph_diag *diag;
};

_Noreturn static void fail_and_jump(struct reader *reader, enum neph_status status)
{
    reader->status = status;
    longjmp(reader->escape, 1);
}

_Noreturn static void on_error(png_structp png, png_const_charp message)
{
    struct reader *reader = png_get_error_ptr(png);
    bool truncated = reader->position == reader->file_size;
    fail_and_jump(reader, neph_fail(reader->diag, NEPH_ERR_INPUT, "'%s' is %s: %s", reader->path,
                                    truncated ? "truncated or damaged" : "damaged", message));
}

/* Ignored: warnings concern chunks that do not affect code values. */
static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void supply_bytes(png_structp png, png_bytep target, size_t size)
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

/* Deflate compresses at most by this ratio (zlib's technical details: 1032:1). A small file that
 * claims gigabytes is thereby refused before memory is allocated. */
static const size_t shrink_max = 1032;

/* Read all rows into `samples`, row_bytes each. */
static void read_rows(struct reader *reader, size_t row_bytes)
{
    const size_t height = (size_t)reader->height_px;
    const size_t file_row_bytes = png_get_rowbytes(reader->png, reader->info);
    if (reader->file_size < file_row_bytes * height / shrink_max)
        fail_and_jump(reader, neph_fail(reader->diag, NEPH_ERR_INPUT,
                                        "'%s' is truncated or damaged: %zu bytes cannot hold %dx%d "
                                        "pixels",
                                        reader->path, reader->file_size, reader->width_px,
                                        reader->height_px));
    reader->samples = calloc(height, row_bytes);
    reader->rows = calloc(height, sizeof(png_bytep));
    if (!reader->samples || !reader->rows)
        fail_and_jump(reader, neph_fail_memory(reader->diag));
    for (size_t y = 0; y < height; y++)
        reader->rows[y] = (png_bytep)reader->samples + y * row_bytes;
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    png_set_swap(reader->png); /* files are big-endian */
#endif
    png_set_interlace_handling(reader->png);
    png_read_update_info(reader->png, reader->info);
    if (png_get_rowbytes(reader->png, reader->info) != row_bytes)
        png_error(reader->png, "its header is inconsistent");
    png_read_image(reader->png, reader->rows);
    png_read_end(reader->png, NULL); /* detects a file without its end */
}

static void read_size(struct reader *reader)
{
    png_set_user_limits(reader->png, NEPH_IMAGE_SIDE_MAX_PX, NEPH_IMAGE_SIDE_MAX_PX);
    png_read_info(reader->png, reader->info);
    reader->width_px = (int)png_get_image_width(reader->png, reader->info);
    reader->height_px = (int)png_get_image_height(reader->png, reader->info);
}

static void read_codes(struct reader *reader, int wanted_type)
{
    read_size(reader);
    int depth = png_get_bit_depth(reader->png, reader->info);
    int colour_type = png_get_color_type(reader->png, reader->info);
    if (depth != 16 || colour_type != wanted_type)
        fail_and_jump(reader, neph_fail(reader->diag, NEPH_ERR_INPUT,
                                        "'%s' is a %d-bit %s PNG; only 16-bit %s is read",
                                        reader->path, depth, colour_type_name(colour_type),
                                        colour_type_name(wanted_type)));
    read_rows(reader, (size_t)reader->width_px * (wanted_type == PNG_COLOR_TYPE_RGB ? 3 : 1) *
                          sizeof(uint16_t));
}

static void read_rgb_codes(struct reader *reader)
{
    read_codes(reader, PNG_COLOR_TYPE_RGB);
}

static void read_grey_codes(struct reader *reader)
{
    read_codes(reader, PNG_COLOR_TYPE_GRAY);
}

static void decode(struct reader *reader, void (*read)(struct reader *))
{
    reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    if (!reader->info) {
        reader->status = neph_fail_memory(reader->diag);
    } else if (setjmp(reader->escape) == 0) {
        png_set_read_fn(reader->png, reader, supply_bytes);
        read(reader);
    }
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
    free(reader->rows);
}

static bool is_png(const struct reader *reader)
{
    return reader->file_size >= 8 && png_sig_cmp((png_const_bytep)reader->file, 0, 8) == 0;
}

/* Call `read` on a file in memory; after a failure nothing is left to free. */
static enum neph_status read_bytes(struct reader *reader, void (*read)(struct reader *))
{
    if (!is_png(reader))
        reader->status = neph_fail(reader->diag, NEPH_ERR_INPUT, "'%s' is not a PNG file",
                                   reader->path);
    else
        decode(reader, read);
    if (reader->status)
        free(reader->samples);
    return reader->status;
}

static enum neph_status read_code_file(const char *path, void (*read)(struct reader *),
                                       int *width_px, int *height_px, uint16_t **codes,
                                       struct neph_diag *diag)
{
    struct reader reader = {.path = path, .diag = diag};
    char *file = NULL;
    enum neph_status status = neph_file_read(path, file_limit_bytes, &file, &reader.file_size,
                                             diag);
    if (status)
        return status;
    reader.file = file;
    status = read_bytes(&reader, read);
    free(file);
    if (status)
        return status;
    *width_px = reader.width_px;
    *height_px = reader.height_px;
    *codes = reader.samples;
    return NEPH_OK;
}

enum neph_status neph_png_read_rgb16(const char *path, int *width_px, int *height_px,
                                     uint16_t **rgb, struct neph_diag *diag)
{
    return read_code_file(path, read_rgb_codes, width_px, height_px, rgb, diag);
}

enum neph_status neph_png_read_grey16(const char *path, int *width_px, int *height_px,
                                      uint16_t **grey, struct neph_diag *diag)
{
    return read_code_file(path, read_grey_codes, width_px, height_px, grey, diag);
}

/* ---- images in linear light ------------------------------------------------------------------ */

/* The data of the first chunk of that name and at least that size before the pixels, or NULL.
 * Searched here because libpng drops colour chunks that it finds wrong, and does not know cICP. */
static const char *find_chunk(const struct reader *reader, const char *name, size_t size_bytes)
{
    size_t at = 8;
    while (reader->file_size - at >= 12) {
        const char *chunk = reader->file + at;
        const size_t chunk_bytes = neph_png_u32(chunk);
        if (chunk_bytes > reader->file_size - at - 12 || memcmp(chunk + 4, "IDAT", 4) == 0)
            return NULL;
        if (memcmp(chunk + 4, name, 4) == 0 && chunk_bytes >= size_bytes)
            return chunk + 8;
        at += 12 + chunk_bytes;
    }
    return NULL;
}

/* Refuse animations (chunk acTL, third edition of the specification, 11.3.6), since only one of
 * their frames would be compared. An animation of one frame is accepted if its control chunk (fcTL)
 * is before the pixels; otherwise the pixels are not part of the animation. */
static enum neph_status check_not_animated(const struct reader *reader)
{
    const char *animation = is_png(reader) ? find_chunk(reader, "acTL", 8) : NULL;
    if (!animation)
        return NEPH_OK;
    const uint32_t frame_count = neph_png_u32(animation);
    const bool is_first = find_chunk(reader, "fcTL", 26) != NULL;
    if (frame_count == 1 && is_first)
        return NEPH_OK;
    neph_fail(reader->diag, NEPH_ERR_INPUT, "'%s' is an animated PNG: it has %llu frames",
              reader->path, (unsigned long long)frame_count + !is_first);
    neph_hint(reader->diag, frame_count > 1 ? "name it by itself: its frames are a sequence"
                                            : "write each frame to a separate file");
    return NEPH_ERR_INPUT;
}

_Noreturn static void refuse_colour(struct reader *reader, const char *what)
{
    neph_fail(reader->diag, NEPH_ERR_INPUT, "'%s' is not an sRGB image: %s", reader->path, what);
    neph_hint(reader->diag, "convert it to sRGB; if its values already are sRGB, write it again "
                            "without colour chunks, or use an EXR file with linear values");
    fail_and_jump(reader, NEPH_ERR_INPUT);
}

/* Whether the chromaticities of white, red, green, blue, in 1/100000, are those of ITU-R BT.709 and
 * so of sRGB. */
static bool is_srgb_primaries(const char *chunk)
{
    static const int expected[8] = {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
    static const int rounding = 100; /* writers round to three digits */
    for (int i = 0; i < 8; i++)
        if (llabs((long long)neph_png_u32(chunk + 4 * i) - expected[i]) > rounding)
            return false;
    return true;
}

/* Whether the data of an iCCP chunk (a name, a zero byte, the method 0, a deflated profile) is a
 * profile of sRGB. Profiles of curves and a matrix have a few kilobytes. */
static bool is_srgb_profile(const char *chunk, size_t size)
{
    enum { ROOM = 1 << 20 };
    const size_t head = strnlen(chunk, size) + 2;
    uLongf profile_bytes = ROOM;
    if (head > size || chunk[head - 1] != 0)
        return false;
    Bytef *profile = malloc(ROOM);
    const bool is_srgb = profile &&
                         uncompress(profile, &profile_bytes, (const Bytef *)chunk + head,
                                    (uLong)(size - head)) == Z_OK &&
                         neph_icc_is_srgb(profile, profile_bytes);
    free(profile);
    return is_srgb;
}

/* Check the colour space by the precedence of the PNG specification (third edition, 4.3): cICP,
 * iCCP, sRGB, then gAMA and cHRM. A file without these is read as sRGB, as by browsers and viewers.
 */
static void check_colour_space(struct reader *reader)
{
    static const uint32_t srgb_gamma = 45455, gamma_rounding = 50;
    char what[160];
    const char *cicp = find_chunk(reader, "cICP", 4);
    if (cicp && memcmp(cicp, "\1\15\0\1", 4) != 0)
        refuse_colour(reader, "its cICP chunk names another colour space or transfer curve");
    if (cicp || png_get_valid(reader->png, reader->info, PNG_INFO_sRGB))
        return; /* libpng sets the flag also for profiles that it recognises as sRGB */
    const char *profile = find_chunk(reader, "iCCP", 1);
    if (profile && is_srgb_profile(profile, neph_png_u32(profile - 8)))
        return;
    if (profile) {
        /* The file in memory ends with a NUL, so the name does, too. */
        snprintf(what, sizeof(what), "it has the colour profile '%.79s'", profile);
        for (char *c = what; *c; c++)
            *c = *c >= ' ' && *c <= '~' ? *c : '?';
        refuse_colour(reader, what);
    }
    const char *gamma = find_chunk(reader, "gAMA", 4);
    if (gamma && llabs((long long)neph_png_u32(gamma) - srgb_gamma) > gamma_rounding) {
        snprintf(what, sizeof(what), "its gAMA is %.5f, not 0.45455", neph_png_u32(gamma) / 1e5);
        refuse_colour(reader, what);
    }
    const char *primaries = find_chunk(reader, "cHRM", 32);
    if (primaries && !is_srgb_primaries(primaries))
        refuse_colour(reader, "its cHRM chunk has primaries other than Rec.709");
}

static void read_display_codes(struct reader *reader)
{
    /* A damaged colour chunk is an error: libpng would drop it, and the file would be read as
     * sRGB. */
    png_set_crc_action(reader->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    read_size(reader);
    check_colour_space(reader);
    /* Convert to 8 or 16 bits of RGB, and alpha if the file has it. The conversions are exact: 1, 2
     * and 4 bits of grey are multiplied by 255, 85 and 17. */
    png_set_expand(reader->png);
    png_set_gray_to_rgb(reader->png);
    const bool has_alpha = (png_get_color_type(reader->png, reader->info) & PNG_COLOR_MASK_ALPHA) ||
                           png_get_valid(reader->png, reader->info, PNG_INFO_tRNS);
    const bool is_wide = png_get_bit_depth(reader->png, reader->info) == 16;
    reader->channel_count = has_alpha ? 4 : 3;
    reader->code_max = is_wide ? 65535 : 255;
    read_rows(reader, (size_t)reader->width_px * reader->channel_count * (is_wide ? 2 : 1));
}

enum neph_status neph_png_decode(const char *path, const char *file, size_t size,
                                 struct neph_png_codes *codes, struct neph_diag *diag)
{
    struct reader reader = {.path = path, .file = file, .file_size = size, .diag = diag};
    const enum neph_status status = read_bytes(&reader, read_display_codes);
    if (status)
        return status;
    *codes = (struct neph_png_codes){.width_px = reader.width_px,
                                     .height_px = reader.height_px,
                                     .channel_count = reader.channel_count,
                                     .code_max = reader.code_max,
                                     .samples = reader.samples};
    return NEPH_OK;
}

static enum neph_status check_opaque(const char *path, const struct neph_png_codes *codes,
                                     struct neph_diag *diag)
{
    const size_t width = (size_t)codes->width_px, count = width * (size_t)codes->height_px;
    for (size_t i = 0; i < count && codes->channel_count == 4; i++)
        if (neph_png_code(codes, 4 * i + 3) != codes->code_max) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "'%s' is translucent (first at pixel (%zu, %zu)); its background is unknown",
                      path, i % width, i / width);
            neph_hint(diag, "flatten it onto its background");
            return NEPH_ERR_INPUT;
        }
    return NEPH_OK;
}

/* Linear light of each code; NULL: no memory. */
static float *make_linear_table(const struct neph_png_codes *codes)
{
    float *linear = calloc((size_t)codes->code_max + 1, sizeof(*linear));
    for (uint32_t code = 0; code <= codes->code_max && linear; code++)
        linear[code] = (float)neph_srgb_to_linear((double)code / codes->code_max);
    return linear;
}

static enum neph_status fill_planes(const struct neph_png_codes *codes, float *planes[3],
                                    struct neph_diag *diag)
{
    const size_t count = (size_t)codes->width_px * (size_t)codes->height_px;
    float *linear = make_linear_table(codes);
    if (!linear)
        return neph_fail_memory(diag);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++)
            planes[c][i] = linear[neph_png_code(codes, codes->channel_count * i + c)];
    free(linear);
    return NEPH_OK;
}

enum neph_status neph_png_make_image(const char *path, const struct neph_png_codes *codes,
                                     struct neph_image **image, struct neph_diag *diag)
{
    float *planes[3];
    struct neph_image *made = NULL;
    enum neph_status status = check_opaque(path, codes, diag);
    if (!status)
        status = neph_image_create(codes->width_px, codes->height_px, &made, diag);
    if (!status)
        status = neph_image_add_rgb(made, NULL, planes, diag);
    if (!status)
        status = neph_image_set_attribute(made, "encoding", diag, "sRGB");
    if (!status)
        status = fill_planes(codes, planes, diag);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

enum neph_status neph_png_read_image(const char *path, struct neph_image **image,
                                     struct neph_diag *diag)
{
    struct reader reader = {.path = path, .diag = diag};
    struct neph_png_codes codes = {.samples = NULL};
    char *file = NULL;
    enum neph_status status = neph_file_read(path, file_limit_bytes, &file, &reader.file_size,
                                             diag);
    if (status)
        return status;
    reader.file = file;
    status = check_not_animated(&reader);
    if (!status)
        status = neph_png_decode(path, file, reader.file_size, &codes, diag);
    free(file);
    if (!status)
        status = neph_png_make_image(path, &codes, image, diag);
    free(codes.samples);
    return status;
}

/* ---- images with alpha ----------------------------------------------------------------------- */

/* Before memory for the values is allocated. */
static enum neph_status check_values(const struct reader *reader, size_t limit_bytes)
{
    const char *header = is_png(reader) ? find_chunk(reader, "IHDR", 13) : NULL;
    const uint32_t width = header ? neph_png_u32(header) : 0;
    const uint32_t height = header ? neph_png_u32(header + 4) : 0;
    const double bytes = (double)width * height * 4.0 * sizeof(float);
    if (bytes <= (double)limit_bytes)
        return NEPH_OK;
    neph_fail(reader->diag, NEPH_ERR_INPUT,
              "'%s' has %ux%u pixels, which need %.0f MiB; the limit is %.0f MiB", reader->path,
              width, height, bytes / 0x1p20, (double)limit_bytes / 0x1p20);
    neph_hint(reader->diag, "make it smaller, or raise memory_limit_mib");
    return NEPH_ERR_INPUT;
}

static enum neph_status make_rgba(const struct neph_png_codes *codes, float **rgba, bool *has_alpha,
                                  struct neph_diag *diag)
{
    const size_t count = (size_t)codes->width_px * (size_t)codes->height_px;
    float *linear = make_linear_table(codes), *made = malloc(count * 4 * sizeof(*made));
    if (!linear || !made) {
        free(linear);
        free(made);
        return neph_fail_memory(diag);
    }
    *has_alpha = false;
    for (size_t i = 0; i < count; i++) {
        const size_t at = codes->channel_count * i;
        const uint32_t alpha = codes->channel_count == 4 ? neph_png_code(codes, at + 3)
                                                         : codes->code_max;
        for (size_t c = 0; c < 3; c++)
            made[4 * i + c] = linear[neph_png_code(codes, at + c)];
        made[4 * i + 3] = (float)((double)alpha / codes->code_max);
        *has_alpha |= alpha != codes->code_max;
    }
    free(linear);
    *rgba = made;
    return NEPH_OK;
}

enum neph_status neph_png_read_rgba(const char *path, size_t limit_bytes, int *width_px,
                                    int *height_px, float **rgba, bool *has_alpha,
                                    struct neph_diag *diag)
{
    struct reader reader = {.path = path, .diag = diag};
    struct neph_png_codes codes = {.samples = NULL};
    char *file = NULL;
    enum neph_status status = neph_file_read(path, limit_bytes, &file, &reader.file_size, diag);
    if (status)
        return status;
    reader.file = file;
    status = check_not_animated(&reader);
    if (!status)
        status = check_values(&reader, limit_bytes);
    if (!status)
        status = neph_png_decode(path, file, reader.file_size, &codes, diag);
    free(file);
    if (!status)
        status = make_rgba(&codes, rgba, has_alpha, diag);
    free(codes.samples);
    if (status)
        return status;
    *width_px = codes.width_px;
    *height_px = codes.height_px;
    return NEPH_OK;
}

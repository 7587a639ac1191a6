/* SPDX-License-Identifier: MIT */
#include "base/apng.h"

#include "base/files.h"
#include "base/png_codes.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <zlib.h>

enum {
    SIGNATURE_BYTES = 8,
    AROUND_BYTES = 12, /* of a chunk beside its data: length, name and checksum */
    HEADER_BYTES = 13, /* data of IHDR */
    CONTROL_BYTES = 26,
    FRAMES_MAX = 1 << 20,
    CHUNKS_BEFORE_MAX = 4096, /* before the pixels, for neph_apng_count() */
};

enum dispose { DISPOSE_NONE, DISPOSE_BACKGROUND, DISPOSE_PREVIOUS, DISPOSE_COUNT };
enum blend { BLEND_SOURCE, BLEND_OVER, BLEND_COUNT };

static const size_t file_limit_bytes = (size_t)1 << 32;

static const char signature[SIGNATURE_BYTES] = "\x89PNG\r\n\x1a\n";

/* A frame control chunk, and the chunks of pixels after it. */
struct frame {
    int64_t x_px, y_px, width_px, height_px;
    unsigned delay, delay_unit; /* delay / delay_unit seconds */
    enum dispose dispose;
    enum blend blend;
    size_t data_at, data_end; /* bytes of the file */
};

struct neph_apng {
    char *file;
    size_t size;
    size_t header_end; /* of the chunks before the pixels */
    int frame_count;
    struct frame *frames;
    struct neph_png_codes canvas, before; /* RGBA; `before` the last frame was drawn */
    int next;                             /* frame that is drawn next; the canvas has the last */
};

struct chunk {
    const char *name, *data;
    size_t size, end; /* of the data; place behind the chunk */
};

/* ---- chunks ---------------------------------------------------------------------------------- */

/* The chunk at a place; false: the file ends there. */
static bool read_chunk(const struct neph_apng *apng, size_t at, struct chunk *chunk)
{
    if (apng->size - at < AROUND_BYTES)
        return false;
    const char *start = apng->file + at;
    *chunk = (struct chunk){.name = start + 4, .data = start + 8, .size = neph_png_u32(start)};
    chunk->end = at + AROUND_BYTES + chunk->size;
    return chunk->size <= apng->size - at - AROUND_BYTES;
}

static bool is_named(const struct chunk *chunk, const char *name)
{
    return memcmp(chunk->name, name, 4) == 0;
}

static uint32_t compute_checksum(const struct chunk *chunk)
{
    return (uint32_t)crc32(0, (const Bytef *)chunk->name, (uInt)chunk->size + 4);
}

static unsigned read_u16(const char *bytes)
{
    return (unsigned)(unsigned char)bytes[0] << 8 | (unsigned char)bytes[1];
}

int neph_apng_count(const char *path)
{
    char head[20];
    uint64_t size = 0, at = SIGNATURE_BYTES;
    int fd, count = 0;
    if (neph_file_open(path, &fd, &size, NULL))
        return 0;
    bool goes_on = pread(fd, head, SIGNATURE_BYTES, 0) == SIGNATURE_BYTES &&
                   memcmp(head, signature, SIGNATURE_BYTES) == 0;
    for (int i = 0; i < CHUNKS_BEFORE_MAX && goes_on; i++) {
        goes_on = pread(fd, head, sizeof(head), (off_t)at) == sizeof(head) &&
                  memcmp(head + 4, "IDAT", 4) != 0;
        if (goes_on && memcmp(head + 4, "acTL", 4) == 0) {
            const uint32_t frames = neph_png_u32(head + 8);
            count = frames <= FRAMES_MAX ? (int)frames : 0;
            goes_on = false;
        }
        at += AROUND_BYTES + (uint64_t)neph_png_u32(head);
    }
    close(fd);
    return count;
}

/* ---- opening --------------------------------------------------------------------------------- */

static enum neph_status fail_damaged(const char *path, const char *why, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is a truncated or damaged animated PNG: %s", path,
                     why);
}

static enum neph_status read_canvas(const char *path, struct neph_apng *apng,
                                    const struct chunk *chunk, struct neph_diag *diag)
{
    if (chunk->size != HEADER_BYTES)
        return fail_damaged(path, "its header is inconsistent", diag);
    const uint32_t width_px = neph_png_u32(chunk->data), height_px = neph_png_u32(chunk->data + 4);
    if (width_px < 1 || height_px < 1 || width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s': a size of %ux%u pixels is outside 1..%d",
                         path, width_px, height_px, NEPH_IMAGE_SIDE_MAX_PX);
    apng->canvas.width_px = (int)width_px;
    apng->canvas.height_px = (int)height_px;
    apng->canvas.channel_count = 4;
    return NEPH_OK;
}

static enum neph_status add_frame(const char *path, struct neph_apng *apng,
                                  const struct chunk *chunk, struct neph_diag *diag)
{
    const size_t count = (size_t)apng->frame_count;
    const char *d = chunk->data;
    if (chunk->size != CONTROL_BYTES)
        return fail_damaged(path, "a frame control chunk has another size", diag);
    const struct frame frame = {.width_px = neph_png_u32(d + 4),
                                .height_px = neph_png_u32(d + 8),
                                .x_px = neph_png_u32(d + 12),
                                .y_px = neph_png_u32(d + 16),
                                .delay = read_u16(d + 20),
                                .delay_unit = read_u16(d + 22) ? read_u16(d + 22) : 100,
                                .dispose = (enum dispose)(unsigned char)d[24],
                                .blend = (enum blend)(unsigned char)d[25],
                                .data_at = chunk->end,
                                .data_end = chunk->end};
    if (frame.width_px < 1 || frame.height_px < 1 ||
        frame.x_px + frame.width_px > apng->canvas.width_px ||
        frame.y_px + frame.height_px > apng->canvas.height_px || frame.dispose >= DISPOSE_COUNT ||
        frame.blend >= BLEND_COUNT || count == FRAMES_MAX)
        return fail_damaged(path, "a frame is not inside the image, or drawn in an unknown way",
                            diag);
    if ((count & (count - 1)) == 0) { /* capacity is a power of two */
        struct frame *grown = realloc(apng->frames, (count ? 2 * count : 1) * sizeof(*grown));
        if (!grown)
            return neph_fail_memory(diag);
        apng->frames = grown;
    }
    apng->frames[apng->frame_count++] = frame;
    return NEPH_OK;
}

/* Chunks with numbers of a common sequence: frame control, and pixels of all frames that are not
 * in IDAT. */
static bool is_in_order(const struct chunk *chunk, uint32_t *expected)
{
    const bool has_number = is_named(chunk, "fcTL") || is_named(chunk, "fdAT");
    return !has_number || (chunk->size >= 4 && neph_png_u32(chunk->data) == (*expected)++);
}

static enum neph_status add_chunk(const char *path, struct neph_apng *apng,
                                  const struct chunk *chunk, struct neph_diag *diag)
{
    const bool is_control = is_named(chunk, "fcTL");
    const bool is_pixels = is_named(chunk, "IDAT") || is_named(chunk, "fdAT");
    struct frame *frame = apng->frame_count > 0 ? &apng->frames[apng->frame_count - 1] : NULL;
    const size_t at = (size_t)(chunk->name - 4 - apng->file);
    if (is_pixels && apng->header_end == 0)
        apng->header_end = at;
    if (is_control)
        return add_frame(path, apng, chunk, diag);
    if (is_pixels && frame)
        frame->data_end = chunk->end;
    return NEPH_OK;
}

static enum neph_status check_frames(const char *path, const struct neph_apng *apng,
                                     uint32_t declared, struct neph_diag *diag)
{
    /* Deflate compresses at most 1032:1, and a pixel has at least a bit: the file contains an image
     * of the size of the canvas. */
    const size_t least = (size_t)apng->canvas.width_px * (size_t)apng->canvas.height_px / 8 / 1032;
    if (apng->size < least)
        return fail_damaged(path, "it is too small for its size in pixels", diag);
    for (int i = 0; i < apng->frame_count; i++)
        if (apng->frames[i].data_end == apng->frames[i].data_at)
            return fail_damaged(path, "a frame has no pixels", diag);
    if (apng->frame_count > 0 && (uint32_t)apng->frame_count == declared)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT,
                     "'%s' is truncated or damaged: it declares %u frames and has %d", path,
                     declared, apng->frame_count);
}

static enum neph_status read_chunks(const char *path, struct neph_apng *apng,
                                    struct neph_diag *diag)
{
    struct chunk chunk;
    uint32_t declared = 0, sequence = 0;
    bool has_end = false;
    enum neph_status status = NEPH_OK;
    for (size_t at = SIGNATURE_BYTES; !status && !has_end && read_chunk(apng, at, &chunk);
         at = chunk.end) {
        if (neph_png_u32(chunk.data + chunk.size) != compute_checksum(&chunk))
            return fail_damaged(path, "a checksum is wrong", diag);
        if ((at == SIGNATURE_BYTES) != is_named(&chunk, "IHDR") || !is_in_order(&chunk, &sequence))
            return fail_damaged(path, "its chunks are out of order", diag);
        if (is_named(&chunk, "IHDR"))
            status = read_canvas(path, apng, &chunk, diag);
        else if (is_named(&chunk, "acTL") && chunk.size >= 8)
            declared = neph_png_u32(chunk.data);
        else
            status = add_chunk(path, apng, &chunk, diag);
        has_end = is_named(&chunk, "IEND");
    }
    if (status)
        return status;
    return has_end ? check_frames(path, apng, declared, diag)
                   : fail_damaged(path, "the file ends too early", diag);
}

enum neph_status neph_apng_open(const char *path, struct neph_apng **apng, struct neph_diag *diag)
{
    struct neph_apng *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    enum neph_status status = neph_file_read(path, file_limit_bytes, &made->file, &made->size,
                                             diag);
    if (!status &&
        (made->size < SIGNATURE_BYTES || memcmp(made->file, signature, SIGNATURE_BYTES) != 0))
        status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not a PNG file", path);
    if (!status)
        status = read_chunks(path, made, diag);
    if (status)
        neph_apng_close(made);
    else
        *apng = made;
    return status;
}

void neph_apng_close(struct neph_apng *apng)
{
    if (!apng)
        return;
    free(apng->canvas.samples);
    free(apng->before.samples);
    free(apng->frames);
    free(apng->file);
    free(apng);
}

int neph_apng_frame_count(const struct neph_apng *apng)
{
    return apng->frame_count;
}

/* ---- pixels of a frame ----------------------------------------------------------------------- */

static void put_u32(char *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (char)(value >> (24 - 8 * i));
}

/* Append a chunk to a file in memory. */
static void put_chunk(char **end, const char *name, const char *data, size_t size)
{
    char *start = *end;
    put_u32(start, (uint32_t)size);
    memcpy(start + 4, name, 4);
    memcpy(start + 8, data, size);
    put_u32(start + 8 + size, (uint32_t)crc32(0, (const Bytef *)start + 4, (uInt)size + 4));
    *end = start + AROUND_BYTES + size;
}

/* Make a file of a single image: the chunks before the pixels, with the size of the frame, and the
 * chunks of the frame as IDAT. */
static enum neph_status make_single(const struct neph_apng *apng, const struct frame *frame,
                                    char **file, size_t *size, struct neph_diag *diag)
{
    struct chunk chunk;
    char *made = malloc(apng->header_end + (frame->data_end - frame->data_at) + AROUND_BYTES + 1),
         *end = made + SIGNATURE_BYTES;
    if (!made)
        return neph_fail_memory(diag);
    memcpy(made, signature, SIGNATURE_BYTES);
    for (size_t at = SIGNATURE_BYTES; at < apng->header_end && read_chunk(apng, at, &chunk);
         at = chunk.end) {
        char header[HEADER_BYTES];
        if (is_named(&chunk, "acTL") || is_named(&chunk, "fcTL"))
            continue;
        if (!is_named(&chunk, "IHDR")) {
            put_chunk(&end, chunk.name, chunk.data, chunk.size);
            continue;
        }
        memcpy(header, chunk.data, sizeof(header));
        put_u32(header, (uint32_t)frame->width_px);
        put_u32(header + 4, (uint32_t)frame->height_px);
        put_chunk(&end, "IHDR", header, sizeof(header));
    }
    for (size_t at = frame->data_at; at < frame->data_end && read_chunk(apng, at, &chunk);
         at = chunk.end) {
        if (is_named(&chunk, "IDAT"))
            put_chunk(&end, "IDAT", chunk.data, chunk.size);
        else if (is_named(&chunk, "fdAT"))
            put_chunk(&end, "IDAT", chunk.data + 4, chunk.size - 4);
    }
    put_chunk(&end, "IEND", "", 0);
    *end = '\0';
    *file = made;
    *size = (size_t)(end - made);
    return NEPH_OK;
}

/* ---- the canvas ------------------------------------------------------------------------------ */

static size_t count_bytes(const struct neph_png_codes *codes)
{
    return (size_t)codes->width_px * (size_t)codes->height_px * 4 *
           (codes->code_max == 255 ? 1 : 2);
}

static void store(struct neph_png_codes *codes, size_t index, uint32_t code)
{
    if (codes->code_max == 255)
        ((uint8_t *)codes->samples)[index] = (uint8_t)code;
    else
        ((uint16_t *)codes->samples)[index] = (uint16_t)code;
}

/* The canvas at the start: transparent black. */
static enum neph_status clear_canvas(struct neph_apng *apng, uint32_t code_max,
                                     struct neph_diag *diag)
{
    apng->next = 0;
    if (!apng->canvas.samples) {
        apng->canvas.code_max = code_max;
        apng->before = apng->canvas;
        apng->canvas.samples = calloc(1, count_bytes(&apng->canvas));
        return apng->canvas.samples ? NEPH_OK : neph_fail_memory(diag);
    }
    memset(apng->canvas.samples, 0, count_bytes(&apng->canvas));
    return NEPH_OK;
}

/* A pixel over another one by their code values ("Alpha channel processing" of the
 * specification). */
static void blend_over(struct neph_png_codes *canvas, size_t place, const uint32_t source[4])
{
    const double most = canvas->code_max, alpha = source[3] / most;
    const double below = neph_png_code(canvas, place + 3) / most * (1.0 - alpha);
    const double both = alpha + below;
    for (size_t c = 0; c < 3 && both > 0.0; c++) {
        const double code = (source[c] * alpha + neph_png_code(canvas, place + c) * below) / both;
        store(canvas, place + c, (uint32_t)(code + 0.5));
    }
    store(canvas, place + 3, (uint32_t)(both * most + 0.5));
}

static void draw(struct neph_png_codes *canvas, const struct frame *frame,
                 const struct neph_png_codes *pixels)
{
    for (int64_t y = 0; y < frame->height_px; y++)
        for (int64_t x = 0; x < frame->width_px; x++) {
            const size_t from = (size_t)(y * frame->width_px + x) * pixels->channel_count;
            const size_t to = (size_t)((y + frame->y_px) * canvas->width_px + x + frame->x_px) * 4;
            uint32_t source[4] = {[3] = pixels->code_max};
            for (size_t c = 0; c < pixels->channel_count; c++)
                source[c] = neph_png_code(pixels, from + c);
            if (frame->blend == BLEND_OVER && source[3] != pixels->code_max) {
                blend_over(canvas, to, source);
                continue;
            }
            for (size_t c = 0; c < 4; c++)
                store(canvas, to + c, source[c]);
        }
}

static void clear(struct neph_png_codes *canvas, const struct frame *frame)
{
    const size_t pixel_bytes = canvas->code_max == 255 ? 4 : 8;
    for (int64_t y = frame->y_px; y < frame->y_px + frame->height_px; y++)
        memset((char *)canvas->samples + (size_t)(y * canvas->width_px + frame->x_px) * pixel_bytes,
               0, (size_t)frame->width_px * pixel_bytes);
}

/* Prepare the canvas for the frame after this one. The first frame has no previous canvas. */
static void dispose(struct neph_apng *apng, const struct frame *frame)
{
    if (frame->dispose == DISPOSE_BACKGROUND ||
        (frame->dispose == DISPOSE_PREVIOUS && frame == apng->frames))
        clear(&apng->canvas, frame);
    else if (frame->dispose == DISPOSE_PREVIOUS)
        memcpy(apng->canvas.samples, apng->before.samples, count_bytes(&apng->canvas));
}

static enum neph_status keep_canvas(struct neph_apng *apng, struct neph_diag *diag)
{
    const size_t bytes = count_bytes(&apng->canvas);
    if (!apng->before.samples)
        apng->before.samples = malloc(bytes);
    if (!apng->before.samples)
        return neph_fail_memory(diag);
    memcpy(apng->before.samples, apng->canvas.samples, bytes);
    return NEPH_OK;
}

/* Draw the next frame. */
static enum neph_status draw_next(struct neph_apng *apng, const char *path, struct neph_diag *diag)
{
    const struct frame *frame = &apng->frames[apng->next];
    struct neph_png_codes pixels = {.samples = NULL};
    char *file = NULL;
    size_t size = 0;
    enum neph_status status = make_single(apng, frame, &file, &size, diag);
    if (!status)
        status = neph_png_decode(path, file, size, &pixels, diag);
    free(file);
    if (!status && apng->next == 0)
        status = clear_canvas(apng, pixels.code_max, diag);
    else if (!status)
        dispose(apng, frame - 1);
    if (!status && frame->dispose == DISPOSE_PREVIOUS)
        status = keep_canvas(apng, diag);
    if (!status)
        draw(&apng->canvas, frame, &pixels);
    free(pixels.samples);
    apng->next = status ? 0 : apng->next + 1;
    return status;
}

/* ---- images ---------------------------------------------------------------------------------- */

/* Set frames_per_second if all frames but the last, after which loops pause, are shown for one
 * time. */
static enum neph_status add_rate(const struct neph_apng *apng, struct neph_image *image,
                                 struct neph_diag *diag)
{
    const struct frame *first = apng->frames;
    bool is_equal = first->delay > 0;
    for (int i = 1; i < apng->frame_count - 1; i++)
        is_equal &= apng->frames[i].delay * first->delay_unit ==
                    first->delay * apng->frames[i].delay_unit;
    return is_equal ? neph_image_set_attribute(image, "frames_per_second", diag, "%.15g",
                                               (double)first->delay_unit / first->delay)
                    : NEPH_OK;
}

enum neph_status neph_apng_read(struct neph_apng *apng, int frame, const char *path,
                                struct neph_image **image, struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    enum neph_status status = NEPH_OK;
    if (frame < apng->next - 1)
        apng->next = 0;
    while (apng->next <= frame && !status)
        status = draw_next(apng, path, diag);
    if (!status)
        status = neph_png_make_image(path, &apng->canvas, &made, diag);
    if (!status)
        status = add_rate(apng, made, diag);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

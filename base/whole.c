/* SPDX-License-Identifier: MIT */
#include "base/whole.h"

#include "base/image.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { BLOCK_BYTES = 1024, DIRECTORIES_MAX = 4096 };

/* A file, read through a block of it. */
struct file {
    const char *path;
    struct neph_diag *diag;
    int fd;
    uint64_t size;
};

struct block {
    unsigned char bytes[BLOCK_BYTES];
    uint64_t at, have;
};

static enum neph_status fail_truncated(const struct file *file, const char *what, uint64_t end)
{
    return neph_fail(file->diag, NEPH_ERR_INPUT,
                     "'%s' is truncated or damaged: %s ends at byte %" PRIu64 " of %" PRIu64,
                     file->path, what, end, file->size);
}

/* At most 20 bytes at a place; NULL: the file ends before, or cannot be read. */
static const unsigned char *get_bytes(const struct file *file, struct block *block, uint64_t at,
                                      size_t size)
{
    if (at > file->size || size > file->size - at)
        return NULL;
    if (at < block->at || at + size > block->at + block->have) {
        const ssize_t got = pread(file->fd, block->bytes, BLOCK_BYTES, (off_t)at);
        block->at = at;
        block->have = got > 0 ? (uint64_t)got : 0;
        if (block->have < size)
            return NULL;
    }
    return block->bytes + (at - block->at);
}

/* ---- TIFF ------------------------------------------------------------------------------------ */

struct tiff {
    const struct file *file;
    bool is_big_endian, is_big; /* BigTIFF: 64-bit offsets and counts */
};

/* The values of a field. */
struct field {
    uint64_t at, count;
    size_t size; /* bytes of a value; 0: there is no such field */
    struct block block;
};

enum tag {
    TAG_WIDTH,
    TAG_HEIGHT,
    TAG_BITS,
    TAG_COMPRESSION,
    TAG_COLOURS,
    TAG_STRIP_OFFSETS,
    TAG_CHANNELS,
    TAG_STRIP_ROWS,
    TAG_STRIP_BYTES,
    TAG_PLANES,
    TAG_TILE_WIDTH,
    TAG_TILE_HEIGHT,
    TAG_TILE_OFFSETS,
    TAG_TILE_BYTES,
    TAG_COUNT,
};

/* TIFF 6.0, appendix A. */
static const uint64_t tag_numbers[TAG_COUNT] = {256, 257, 258, 259, 262, 273, 277,
                                                278, 279, 284, 322, 323, 324, 325};

/* The most bytes of pixels that a byte of the file can hold: PackBits 128 from 2; LZW a string of
 * 3838 bytes from a code of 12 bits; Deflate 258 from 2 bits. */
static const struct {
    uint64_t compression;
    double ratio;
} ratios[] = {{1, 1.0}, {5, 2560.0}, {8, 1032.0}, {32773, 64.0}, {32946, 1032.0}};

enum { COLOURS_YCBCR = 6, PLANES_SEPARATE = 2 };

static uint64_t get_number(const struct tiff *tiff, const unsigned char *bytes, size_t size)
{
    uint64_t number = 0;
    for (size_t i = 0; bytes && i < size; i++)
        number = number << 8 | bytes[tiff->is_big_endian ? i : size - 1 - i];
    return number;
}

/* Bytes of the integers of a type; 0: no such type. */
static size_t find_type_size(uint64_t type)
{
    return type == 1 ? 1 : type == 3 ? 2 : type == 4 ? 4 : type == 16 ? 8 : 0;
}

/* An entry: tag, type, count, and the values or their place. */
static void add_field(const struct tiff *tiff, const unsigned char *entry, uint64_t at,
                      struct field fields[TAG_COUNT])
{
    const size_t word = tiff->is_big ? 8 : 4;
    const uint64_t number = get_number(tiff, entry, 2);
    for (int t = 0; t < TAG_COUNT; t++) {
        struct field *field = &fields[t];
        if (tag_numbers[t] != number || field->size)
            continue;
        field->size = find_type_size(get_number(tiff, entry + 2, 2));
        field->count = get_number(tiff, entry + 4, word);
        field->at = field->count <= word / (field->size ? field->size : 1)
                        ? at + 4 + word
                        : get_number(tiff, entry + 4 + word, word);
    }
}

/* A value of a field, `otherwise` if there is no such field. False: the file ends before it. */
static bool get_value(const struct tiff *tiff, struct field *field, uint64_t index,
                      uint64_t otherwise, uint64_t *value)
{
    *value = otherwise;
    if (field->size == 0 || index >= field->count)
        return true;
    const uint64_t at = field->at + index * field->size;
    const unsigned char *bytes = index > tiff->file->size || field->at > tiff->file->size
                                     ? NULL
                                     : get_bytes(tiff->file, &field->block, at, field->size);
    *value = get_number(tiff, bytes, field->size);
    return bytes != NULL;
}

/* Pixels in strips or tiles. */
struct layout {
    uint64_t width, height, bits, channels, compression, colours;
    uint64_t piece_width, piece_height, pieces; /* strips or tiles; of all planes */
    bool is_separate;                           /* a plane for each channel */
    const char *name;                           /* "strip" */
    struct field *offsets, *bytes;
};

static uint64_t divide_up(uint64_t a, uint64_t b)
{
    return a / b + (a % b > 0);
}

static bool find_layout(const struct tiff *tiff, struct field fields[TAG_COUNT],
                        struct layout *layout)
{
    uint64_t planes = 1;
    const bool is_tiled = fields[TAG_TILE_OFFSETS].size > 0;
    bool is_read = get_value(tiff, &fields[TAG_WIDTH], 0, 0, &layout->width) &&
                   get_value(tiff, &fields[TAG_HEIGHT], 0, 0, &layout->height) &&
                   get_value(tiff, &fields[TAG_BITS], 0, 1, &layout->bits) &&
                   get_value(tiff, &fields[TAG_CHANNELS], 0, 1, &layout->channels) &&
                   get_value(tiff, &fields[TAG_COMPRESSION], 0, 1, &layout->compression) &&
                   get_value(tiff, &fields[TAG_COLOURS], 0, 0, &layout->colours) &&
                   get_value(tiff, &fields[TAG_PLANES], 0, 1, &planes);
    layout->is_separate = planes == PLANES_SEPARATE;
    layout->name = is_tiled ? "tile" : "strip";
    layout->offsets = &fields[is_tiled ? TAG_TILE_OFFSETS : TAG_STRIP_OFFSETS];
    layout->bytes = &fields[is_tiled ? TAG_TILE_BYTES : TAG_STRIP_BYTES];
    layout->piece_width = layout->width;
    if (is_tiled)
        is_read = is_read && get_value(tiff, &fields[TAG_TILE_WIDTH], 0, 0, &layout->piece_width) &&
                  get_value(tiff, &fields[TAG_TILE_HEIGHT], 0, 0, &layout->piece_height);
    else
        is_read = is_read && get_value(tiff, &fields[TAG_STRIP_ROWS], 0, layout->height,
                                       &layout->piece_height);
    return is_read;
}

static enum neph_status check_size(const struct file *file, struct layout *layout)
{
    const uint64_t most = NEPH_IMAGE_SIDE_MAX_PX;
    if (layout->width < 1 || layout->width > most || layout->height < 1 || layout->height > most)
        return neph_fail(file->diag, NEPH_ERR_INPUT,
                         "'%s' has a size of %" PRIu64 "x%" PRIu64
                         " pixels; allowed are 1 to %d per side",
                         file->path, layout->width, layout->height, NEPH_IMAGE_SIDE_MAX_PX);
    if (layout->piece_width < 1 || layout->piece_height < 1 || layout->channels < 1 ||
        layout->channels > UINT16_MAX || layout->bits < 1 || layout->bits > 64)
        return neph_fail(file->diag, NEPH_ERR_INPUT,
                         "'%s' is damaged: %" PRIu64 " channels of %" PRIu64 " bits in %ss of "
                         "%" PRIu64 "x%" PRIu64 " pixels",
                         file->path, layout->channels, layout->bits, layout->name,
                         layout->piece_width, layout->piece_height);
    layout->pieces = divide_up(layout->width, layout->piece_width) *
                     divide_up(layout->height, layout->piece_height) *
                     (layout->is_separate ? layout->channels : 1);
    if (layout->offsets->size > 0 && layout->offsets->count >= layout->pieces)
        return NEPH_OK;
    return neph_fail(file->diag, NEPH_ERR_INPUT,
                     "'%s' is damaged: %" PRIu64 "x%" PRIu64 " pixels need %" PRIu64
                     " %ss, and it has %" PRIu64,
                     file->path, layout->width, layout->height, layout->pieces, layout->name,
                     layout->offsets->size > 0 ? layout->offsets->count : 0);
}

/* Bytes of all pixels, without the padding of rows and tiles; chroma may be at a quarter. */
static double count_pixel_bytes(const struct layout *layout)
{
    const double channels = layout->colours == COLOURS_YCBCR ? 1.0 : (double)layout->channels;
    return (double)layout->width * (double)layout->height * channels * (double)layout->bits / 8.0;
}

static double find_ratio(const struct layout *layout)
{
    for (size_t i = 0; i < sizeof(ratios) / sizeof(ratios[0]); i++)
        if (ratios[i].compression == layout->compression)
            return ratios[i].ratio;
    return INFINITY;
}

static enum neph_status check_pieces(const struct tiff *tiff, const struct layout *layout)
{
    const struct file *file = tiff->file;
    double held = 0.0;
    for (uint64_t i = 0; i < layout->pieces; i++) {
        uint64_t at = 0, bytes = 0;
        char what[64];
        snprintf(what, sizeof(what), "%s %" PRIu64, layout->name, i);
        if (!get_value(tiff, layout->offsets, i, 0, &at) ||
            !get_value(tiff, layout->bytes, i, 0, &bytes))
            return fail_truncated(file, "its directory", layout->offsets->at);
        if (bytes > UINT64_MAX - at || at + bytes > file->size)
            return fail_truncated(file, what, bytes > UINT64_MAX - at ? UINT64_MAX : at + bytes);
        if (layout->bytes->size > 0 && bytes == 0)
            return neph_fail(file->diag, NEPH_ERR_INPUT, "'%s' has no pixels in %s", file->path,
                             what);
        held += (double)bytes;
    }
    const double needed = count_pixel_bytes(layout);
    if (layout->bytes->size == 0 || needed <= held * find_ratio(layout))
        return NEPH_OK;
    return neph_fail(file->diag, NEPH_ERR_INPUT,
                     "'%s' is damaged: %" PRIu64 "x%" PRIu64 " pixels are %.0f bytes, and its %ss "
                     "have %.0f, compression %" PRIu64,
                     file->path, layout->width, layout->height, needed, layout->name, held,
                     layout->compression);
}

/* Check the image of a directory; `*next` is the place of the next directory, or 0. */
static enum neph_status check_directory(const struct tiff *tiff, uint64_t at, uint64_t *next)
{
    const struct file *file = tiff->file;
    const size_t word = tiff->is_big ? 8 : 4, head = tiff->is_big ? 8 : 2, entry = 4 + 2 * word;
    struct block block = {.have = 0};
    struct field fields[TAG_COUNT] = {{.size = 0}};
    struct layout layout = {.width = 0};
    const unsigned char *bytes = get_bytes(file, &block, at, head);
    const uint64_t count = get_number(tiff, bytes, head);
    if (!bytes || count > file->size / entry ||
        !get_bytes(file, &block, at + head + count * entry, word))
        return fail_truncated(file, "its directory", at + head);
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t place = at + head + i * entry;
        bytes = get_bytes(file, &block, place, entry);
        if (bytes)
            add_field(tiff, bytes, place, fields);
    }
    *next = get_number(tiff, get_bytes(file, &block, at + head + count * entry, word), word);
    if (!find_layout(tiff, fields, &layout))
        return fail_truncated(file, "its directory", at + head);
    const enum neph_status status = check_size(file, &layout);
    return status ? status : check_pieces(tiff, &layout);
}

static enum neph_status check_tiff(const struct file *file, const unsigned char head[16])
{
    struct tiff tiff = {.file = file, .is_big_endian = head[0] == 'M'};
    tiff.is_big = get_number(&tiff, head + 2, 2) == 43;
    uint64_t at = tiff.is_big ? get_number(&tiff, head + 8, 8) : get_number(&tiff, head + 4, 4);
    enum neph_status status = NEPH_OK;
    for (int i = 0; !status && (at != 0 || i == 0) && i < DIRECTORIES_MAX; i++)
        status = check_directory(&tiff, at, &at);
    return status;
}

/* ---- JPEG ------------------------------------------------------------------------------------ */

enum {
    MARKER_END = 0xd9,
    MARKER_SCAN = 0xda,
    MARKER_RESTART = 0xd0,
    MARKER_START = 0xd8,
    MARKER_FRAME = 0xc0, /* and the next two: Huffman codes, which have a bit or more a block */
    BLOCK_PX = 8,
};

static enum neph_status check_frame(const struct file *file, struct block *block, uint64_t at)
{
    const unsigned char *bytes = get_bytes(file, block, at + 5, 4);
    const uint64_t height = bytes ? (uint64_t)(bytes[0] << 8 | bytes[1]) : 0;
    const uint64_t width = bytes ? (uint64_t)(bytes[2] << 8 | bytes[3]) : 0;
    const uint64_t blocks = divide_up(width, BLOCK_PX) * divide_up(height, BLOCK_PX);
    if (blocks <= 8 * file->size)
        return NEPH_OK;
    return neph_fail(file->diag, NEPH_ERR_INPUT,
                     "'%s' is truncated or damaged: %" PRIu64 "x%" PRIu64 " pixels in %" PRIu64
                     " bytes",
                     file->path, width, height, file->size);
}

/* After each marker but those of restarts, start and end: its length, with the length itself. */
static enum neph_status check_jpeg(const struct file *file)
{
    struct block block = {.have = 0};
    const unsigned char *bytes;
    bool has_scan = false;
    uint64_t at = 2;
    while ((bytes = get_bytes(file, &block, at, 2)) != NULL) {
        const int marker = bytes[1];
        if (bytes[0] != 0xff || marker == 0 || marker == 0xff ||
            (marker >= MARKER_RESTART && marker <= MARKER_START)) {
            at += bytes[0] == 0xff && marker != 0xff ? 2 : 1; /* compressed pixels */
            continue;
        }
        if (marker == MARKER_END && has_scan)
            return NEPH_OK;
        has_scan |= marker == MARKER_SCAN;
        const enum neph_status status = marker >= MARKER_FRAME && marker <= MARKER_FRAME + 2
                                            ? check_frame(file, &block, at)
                                            : NEPH_OK;
        if (status)
            return status;
        bytes = get_bytes(file, &block, at, 4);
        at += bytes ? 2 + (uint64_t)(bytes[2] << 8 | bytes[3]) : 4;
    }
    return neph_fail(file->diag, NEPH_ERR_INPUT,
                     "'%s' is truncated or damaged: its %" PRIu64 " bytes have no end-of-image "
                     "marker",
                     file->path, file->size);
}

enum neph_status neph_whole_check(const char *path, int fd, uint64_t size_bytes,
                                  struct neph_diag *diag)
{
    const struct file file = {.path = path, .diag = diag, .fd = fd, .size = size_bytes};
    static const char *const tiff[] = {"II*\0", "MM\0*", "II+\0", "MM\0+"};
    unsigned char head[16] = {0};
    const ssize_t got = pread(fd, head, sizeof(head), 0);
    if (got < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot read '%s'", path);
    for (size_t i = 0; i < sizeof(tiff) / sizeof(tiff[0]); i++)
        if (memcmp(head, tiff[i], 4) == 0)
            return check_tiff(&file, head);
    return memcmp(head, "\xff\xd8\xff", 3) == 0 ? check_jpeg(&file) : NEPH_OK;
}

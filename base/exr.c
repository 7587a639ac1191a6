/* SPDX-License-Identifier: MIT
 *
 * The library reads through pread() and writes into memory, both behind its stream callbacks. So
 * one place (base/files.h) knows how to put a file on disk safely, and the system's reason for a
 * failed read is not lost.
 */
#include "base/exr.h"

#include "base/exr_header.h"
#include "base/exr_labels.h"
#include "base/files.h"
#include "base/text.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <openexr.h>

enum {
    /* The first eight bytes of every file: magic number, version and feature flags. See "Magic
     * Number" and "Version Field" in https://openexr.com/en/latest/OpenEXRFileLayout.html */
    EXR_MAGIC = 20000630,
    EXR_FLAG_TILED = 0x200,
    EXR_FLAG_DEEP = 0x800,
    EXR_FLAG_MULTIPART = 0x1000,
    SHORT_NAME_MAX = 31, /* longer names need a flag in the file */
    CHANNEL_COUNT_MAX = 1024,
    ONLY_PART = 0,
    /* No compression that is read shrinks more: zeros by PXR24 come to 1376:1 at best (deflate's
     * 1032:1 of three bytes for four), all others to less. */
    SHRINK_MAX = 2048,
    FIRST_BUFFER_BYTES = 1 << 16,
};

/* What stands behind the library's callbacks. */
struct stream {
    int fd;              /* reading */
    uint64_t size_bytes; /* reading: of the file; writing: of what has been written */
    int io_error;        /* errno of a failed read, or ENOMEM of a failed write */
    char *data;          /* writing */
    size_t capacity;     /* writing */
    char complaint[256]; /* the library's last message */
    char *header;        /* reading: the bytes of the attributes; owned */
    size_t header_bytes;
};

static struct stream *stream_of(exr_const_context_t context)
{
    void *stream = NULL;
    if (!context || exr_get_user_data(context, &stream) != EXR_ERR_SUCCESS)
        return NULL;
    return stream;
}

static void keep_complaint(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)code;
    struct stream *stream = stream_of(context);
    if (stream)
        snprintf(stream->complaint, sizeof(stream->complaint), "%s", message);
}

/* The library's own words when it had any, else the meaning of its code. */
static const char *reason(const struct stream *stream, exr_result_t result)
{
    return stream->complaint[0] ? stream->complaint : exr_get_default_error_message(result);
}

/* ---- writing --------------------------------------------------------------------------------- */

static bool reserve(struct stream *stream, uint64_t needed_bytes)
{
    if (needed_bytes <= stream->capacity)
        return true;
    size_t capacity = stream->capacity ? stream->capacity : FIRST_BUFFER_BYTES;
    while (capacity < needed_bytes)
        capacity *= 2;
    char *grown = realloc(stream->data, capacity);
    if (!grown) {
        stream->io_error = ENOMEM;
        return false;
    }
    memset(grown + stream->capacity, 0, capacity - stream->capacity);
    stream->data = grown;
    stream->capacity = capacity;
    return true;
}

/* The library goes back to fill in the table of chunks, hence the offset. */
static int64_t write_bytes(exr_const_context_t context, void *userdata, const void *buffer,
                           uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    (void)context;
    (void)fail;
    struct stream *stream = userdata;
    if (!reserve(stream, offset + size))
        return -1;
    memcpy(stream->data + offset, buffer, size);
    if (offset + size > stream->size_bytes)
        stream->size_bytes = offset + size;
    return (int64_t)size;
}

static enum neph_status fail_write(const char *path, const struct stream *stream,
                                   exr_result_t result, struct neph_diag *diag)
{
    if (result == EXR_ERR_OUT_OF_MEMORY || stream->io_error == ENOMEM)
        return neph_fail_memory(diag);
    return neph_fail(diag, NEPH_ERR_INTERNAL, "cannot encode '%s': %s", path,
                     reason(stream, result));
}

static enum neph_status check_writable(const struct neph_image *image, const char *path,
                                       struct neph_diag *diag)
{
    if (image->channel_count < 1)
        return neph_fail(diag, NEPH_ERR_INPUT, "cannot write '%s': the image has no channels",
                         path);
    for (int i = 0; i < image->attribute_count; i++) {
        const char *name = image->attributes[i].name;
        if (name[0] == '\0' || neph_exr_is_reserved(name))
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "cannot write '%s': '%s' is not a free name for an attribute", path,
                             name);
    }
    return NEPH_OK;
}

/* Attributes that a file had and that are not text; an image may have none. */
static bool next_kept(const struct neph_image *image, size_t *at,
                      struct neph_exr_attribute *attribute)
{
    return image->header && neph_exr_next_attribute(image->header->attributes,
                                                    image->header->attribute_bytes, at, attribute);
}

static bool has_long_names(const struct neph_image *image)
{
    struct neph_exr_attribute kept;
    for (size_t at = 0; next_kept(image, &at, &kept);)
        if (strlen(kept.name) > SHORT_NAME_MAX || strlen(kept.type) > SHORT_NAME_MAX)
            return true;
    for (int i = 0; i < image->channel_count; i++)
        if (strlen(image->channels[i].name) > SHORT_NAME_MAX)
            return true;
    for (int i = 0; i < image->attribute_count; i++)
        if (strlen(image->attributes[i].name) > SHORT_NAME_MAX)
            return true;
    return false;
}

/* The row of the data window that row 0 of the image is. */
static int top_of(const struct neph_image *image)
{
    return image->header ? image->header->data_min_px[1] : 0;
}

static exr_result_t write_windows(exr_context_t context, const struct neph_image *image,
                                  exr_compression_t compression)
{
    const struct neph_file_header *header = image->header;
    if (!header)
        return exr_initialize_required_attr_simple(context, ONLY_PART, image->width_px,
                                                   image->height_px, compression);
    const int32_t *data = header->data_min_px, *display = header->display_min_px;
    exr_attr_box2i_t window, whole;
    exr_attr_v2f_t center;
    window.min.x = data[0];
    window.min.y = data[1];
    window.max.x = data[0] + image->width_px - 1;
    window.max.y = data[1] + image->height_px - 1;
    whole.min.x = display[0];
    whole.min.y = display[1];
    whole.max.x = (int32_t)((int64_t)display[0] + header->display_px[0] - 1);
    whole.max.y = (int32_t)((int64_t)display[1] + header->display_px[1] - 1);
    center.x = header->screen_center[0];
    center.y = header->screen_center[1];
    return exr_initialize_required_attr(context, ONLY_PART, &whole, &window, header->pixel_aspect,
                                        &center, header->screen_width, EXR_LINEORDER_INCREASING_Y,
                                        compression);
}

static exr_result_t write_header(exr_context_t context, const struct neph_image *image,
                                 exr_compression_t compression)
{
    int part = ONLY_PART;
    /* Some readers refuse the flag, so it is set only where it is needed. */
    exr_result_t result = exr_set_longname_support(context, has_long_names(image));
    if (!result)
        result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (!result)
        result = write_windows(context, image, compression);
    for (int i = 0; i < image->channel_count && !result; i++)
        result = exr_add_channel(context, part, image->channels[i].name, EXR_PIXEL_FLOAT,
                                 EXR_PERCEPTUALLY_LINEAR, 1, 1);
    for (int i = 0; i < image->attribute_count && !result; i++)
        if (!neph_exr_is_ours(image->attributes[i].name))
            result = exr_attr_set_string(context, part, image->attributes[i].name,
                                         image->attributes[i].value);
    return result ? result : exr_write_header(context);
}

/* Point the encoder at the rows of the chunk that starts at row y. The file keeps its channels in
 * alphabetical order, the image in the order of their making. */
static void set_sources(exr_encode_pipeline_t *encoder, const struct neph_image *image, int y)
{
    for (int c = 0; c < encoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &encoder->channels[c];
        const float *samples = neph_image_channel(image, channel->channel_name);
        channel->encode_from_ptr = (const uint8_t *)(samples + (size_t)y * (size_t)image->width_px);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = image->width_px * (int32_t)sizeof(float);
    }
}

/* What choose_default_routines() found; lives as long as the encoder. */
struct compressor {
    exr_result_t (*run)(exr_encode_pipeline_t *encoder);
};

/* A chunk that compresses to just its own size: OpenEXRCore 3.1.5 writes the compressed bytes,
 * which every reader takes for plain ones because the sizes are equal, and decodes to garbage
 * without an error. Write the plain bytes instead, as later versions do. */
static exr_result_t compress_or_keep_plain(exr_encode_pipeline_t *encoder)
{
    const struct compressor *compressor = encoder->encoding_user_data;
    exr_result_t result = compressor->run(encoder);
    if (!result && encoder->compressed_bytes == encoder->packed_bytes &&
        encoder->compressed_buffer != encoder->packed_buffer)
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes);
    return result;
}

static exr_result_t choose_routines(exr_context_t context, exr_encode_pipeline_t *encoder,
                                    struct compressor *compressor)
{
    exr_result_t result = exr_encoding_choose_default_routines(context, ONLY_PART, encoder);
    if (result || !encoder->compress_fn)
        return result;
    compressor->run = encoder->compress_fn;
    encoder->encoding_user_data = compressor;
    encoder->compress_fn = compress_or_keep_plain;
    return EXR_ERR_SUCCESS;
}

static exr_result_t write_chunk(exr_context_t context, exr_encode_pipeline_t *encoder,
                                struct compressor *compressor, const struct neph_image *image,
                                int y)
{
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(context, ONLY_PART, top_of(image) + y,
                                                        &chunk);
    if (result)
        return result;
    bool first = y == 0;
    result = first ? exr_encoding_initialize(context, ONLY_PART, &chunk, encoder)
                   : exr_encoding_update(context, ONLY_PART, &chunk, encoder);
    if (result)
        return result;
    set_sources(encoder, image, y);
    if (first)
        result = choose_routines(context, encoder, compressor);
    return result ? result : exr_encoding_run(context, ONLY_PART, encoder);
}

static exr_result_t write_pixels(exr_context_t context, const struct neph_image *image)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    struct compressor compressor = {NULL};
    int32_t rows_per_chunk = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(context, ONLY_PART, &rows_per_chunk);
    for (int y = 0; y < image->height_px && !result; y += rows_per_chunk)
        result = write_chunk(context, &encoder, &compressor, image, y);
    exr_encoding_destroy(context, &encoder);
    return result;
}

/* Attributes of other types than text go into the file as they are: the library has a function for
 * each type, and none for all. A text of the image takes the place of one of its name. */
static enum neph_status add_kept(struct stream *stream, const struct neph_image *image,
                                 exr_compression_t compression, struct neph_diag *diag)
{
    const int rows_per_chunk = compression == EXR_COMPRESSION_ZIP ? 16 : 1;
    const int64_t chunk_count = (image->height_px + rows_per_chunk - 1) / rows_per_chunk;
    struct neph_exr_attribute kept;
    enum neph_status status = NEPH_OK;
    for (size_t at = 0; !status && next_kept(image, &at, &kept);)
        if (!neph_image_attribute(image, kept.name))
            status = neph_exr_add_attributes(&stream->data, &stream->size_bytes, chunk_count,
                                             kept.start, kept.bytes, diag);
    return status;
}

static enum neph_status write_compressed(const char *path, const struct neph_image *image,
                                         exr_compression_t compression, struct neph_diag *diag)
{
    enum neph_status status = check_writable(image, path, diag);
    if (status)
        return status;
    struct stream stream = {.fd = -1};
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = keep_complaint;
    setup.user_data = &stream;
    setup.write_fn = write_bytes;

    exr_context_t context = NULL;
    exr_result_t result = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result)
        result = write_header(context, image, compression);
    if (!result)
        result = write_pixels(context, image);
    if (context) {
        /* Also after a failure, or the context leaks; it writes the table of chunks. */
        exr_result_t finished = exr_finish(&context);
        result = result ? result : finished;
    }
    status = result ? fail_write(path, &stream, result, diag)
                    : add_kept(&stream, image, compression, diag);
    if (!status)
        status = neph_file_write(path, stream.data, stream.size_bytes, diag);
    free(stream.data);
    return status;
}

enum neph_status neph_exr_write(const char *path, const struct neph_image *image,
                                struct neph_diag *diag)
{
    return write_compressed(path, image, EXR_COMPRESSION_ZIP, diag);
}

enum neph_status neph_exr_write_plain(const char *path, const struct neph_image *image,
                                      struct neph_diag *diag)
{
    return write_compressed(path, image, EXR_COMPRESSION_NONE, diag);
}

/* ---- reading --------------------------------------------------------------------------------- */

static int64_t read_bytes(exr_const_context_t context, void *userdata, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    (void)context;
    (void)fail;
    struct stream *stream = userdata;
    uint64_t done_bytes = 0;
    while (done_bytes < size) {
        ssize_t got = pread(stream->fd, (char *)buffer + done_bytes, size - done_bytes,
                            (off_t)(offset + done_bytes));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            stream->io_error = errno;
            return -1;
        }
        if (got == 0)
            break; /* the library reads ahead, so this says nothing yet */
        done_bytes += (uint64_t)got;
    }
    return (int64_t)done_bytes;
}

static int64_t file_size(exr_const_context_t context, void *userdata)
{
    (void)context;
    const struct stream *stream = userdata;
    return (int64_t)stream->size_bytes;
}

/* What went wrong inside the library, in the words of a person who has only the file. */
static enum neph_status fail_read(const char *path, const struct stream *stream,
                                  exr_result_t result, struct neph_diag *diag)
{
    if (result == EXR_ERR_OUT_OF_MEMORY)
        return neph_fail_memory(diag);
    if (stream->io_error)
        return neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path,
                         strerror(stream->io_error));
    enum neph_status status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is truncated or damaged: %s",
                                        path, reason(stream, result));
    neph_hint(diag, "was the program that wrote it interrupted? Make the file again");
    return status;
}

static enum neph_status refuse_kind(const char *path, const char *kind, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is a %s OpenEXR file; only flat scanlines are read", path,
              kind);
    neph_hint(diag, "write it as a single-part scanline image");
    return NEPH_ERR_INPUT;
}

/* Codes of the attribute `compression` that the library of today does not know; it takes an unknown
 * code for ZIP. Their names: https://openexr.com/en/latest/OpenEXRFileLayout.html. */
static const struct {
    int code;
    const char *name;
} new_compressions[] = {
    {10, "HTJ2K, 256 lines"},
    {11, "HTJ2K, 32 lines"},
};

static enum neph_status refuse_compression(const char *path, int code, struct neph_diag *diag)
{
    const char *name = NULL;
    for (size_t i = 0; i < sizeof(new_compressions) / sizeof(new_compressions[0]); i++)
        if (new_compressions[i].code == code)
            name = new_compressions[i].name;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has the compression %d%s%s%s, which is not read", path,
              code, name ? " (" : "", name ? name : "", name ? ")" : "");
    neph_hint(diag, "write it with ZIP compression");
    return NEPH_ERR_INPUT;
}

/* What the library would take for another, or for damage. */
static enum neph_status check_compression(const char *path, const char *header, size_t size,
                                          struct neph_diag *diag)
{
    struct neph_exr_attribute attribute;
    for (size_t at = 0; neph_exr_next_attribute(header, size, &at, &attribute);)
        if (strcmp(attribute.name, "compression") == 0 && attribute.value_bytes == 1 &&
            attribute.value[0] >= EXR_COMPRESSION_LAST_TYPE)
            return refuse_compression(path, attribute.value[0], diag);
    return NEPH_OK;
}

/* Refuse what is no business of ours before the library parses any of it. */
static enum neph_status check_prefix(const char *path, struct stream *stream,
                                     struct neph_diag *diag)
{
    unsigned char prefix[NEPH_EXR_PREFIX_BYTES];
    int64_t got = read_bytes(NULL, stream, prefix, sizeof(prefix), 0, NULL);
    if (got < 0)
        return fail_read(path, stream, EXR_ERR_READ_IO, diag);
    if (got < NEPH_EXR_PREFIX_BYTES || neph_exr_u32(prefix) != EXR_MAGIC)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not an OpenEXR file", path);
    uint32_t flags = neph_exr_u32(prefix + 4);
    if (flags & EXR_FLAG_MULTIPART)
        return refuse_kind(path, "multi-part", diag);
    if (flags & EXR_FLAG_DEEP)
        return refuse_kind(path, "deep", diag);
    if (flags & EXR_FLAG_TILED)
        return refuse_kind(path, "tiled", diag);
    return NEPH_OK;
}

static enum neph_status read_header(const char *path, struct stream *stream, struct neph_diag *diag)
{
    const enum neph_status status = neph_exr_read_header(
        stream->fd, stream->size_bytes, &stream->header, &stream->header_bytes, diag);
    if (status == NEPH_ERR_IO) {
        stream->io_error = errno;
        return fail_read(path, stream, EXR_ERR_READ_IO, diag);
    }
    return status ? status : check_compression(path, stream->header, stream->header_bytes, diag);
}

static enum neph_status open_stream(const char *path, struct stream *stream, struct neph_diag *diag)
{
    *stream = (struct stream){.fd = -1};
    enum neph_status status = neph_file_open(path, &stream->fd, &stream->size_bytes, diag);
    if (!status)
        status = check_prefix(path, stream, diag);
    return status ? status : read_header(path, stream, diag);
}

/* What the header says about the pixels. */
struct layout {
    exr_attr_box2i_t window;  /* of the pixels in the file */
    exr_attr_box2i_t display; /* of the picture that they are of */
    int width_px, height_px;
    int32_t rows_per_chunk;
    uint64_t row_bytes; /* of all channels, uncompressed */
    exr_compression_t compression;
    const exr_attr_chlist_t *channels;
};

static exr_result_t query_layout(exr_const_context_t context, struct layout *layout)
{
    exr_result_t result = exr_get_data_window(context, ONLY_PART, &layout->window);
    if (!result)
        result = exr_get_display_window(context, ONLY_PART, &layout->display);
    if (!result)
        result = exr_get_scanlines_per_chunk(context, ONLY_PART, &layout->rows_per_chunk);
    if (!result)
        result = exr_get_compression(context, ONLY_PART, &layout->compression);
    if (!result)
        result = exr_get_channels(context, ONLY_PART, &layout->channels);
    if (!result && layout->rows_per_chunk < 1)
        result = EXR_ERR_INVALID_ATTR;
    return result;
}

static enum neph_status check_size(const char *path, struct layout *layout, struct neph_diag *diag)
{
    int64_t width_px = (int64_t)layout->window.max.x - layout->window.min.x + 1;
    int64_t height_px = (int64_t)layout->window.max.y - layout->window.min.y + 1;
    if (width_px < 1 || height_px < 1 || width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' says that it is %lldx%lld pixels large; 1 to %d a side are read",
                         path, (long long)width_px, (long long)height_px, NEPH_IMAGE_SIDE_MAX_PX);
    layout->width_px = (int)width_px;
    layout->height_px = (int)height_px;
    return NEPH_OK;
}

static enum neph_status check_channels(const char *path, struct layout *layout,
                                       struct neph_diag *diag)
{
    int count = layout->channels->num_channels;
    if (count < 1 || count > CHANNEL_COUNT_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %d channels; 1 to %d are read", path,
                         count, CHANNEL_COUNT_MAX);
    for (int i = 0; i < count; i++) {
        const exr_attr_chlist_entry_t *channel = &layout->channels->entries[i];
        if (channel->x_sampling != 1 || channel->y_sampling != 1) {
            neph_fail(diag, NEPH_ERR_INPUT, "'%s': channel '%s' has not a sample per pixel", path,
                      channel->name.str);
            neph_hint(diag, "write luminance and chroma (Y, RY, BY) as R, G, B");
            return NEPH_ERR_INPUT;
        }
        size_t sample_bytes = channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        layout->row_bytes += sample_bytes * (uint64_t)layout->width_px;
    }
    return NEPH_OK;
}

static enum neph_status read_layout(exr_const_context_t context, const char *path,
                                    const struct stream *stream, struct layout *layout,
                                    struct neph_diag *diag)
{
    *layout = (struct layout){0};
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t result = exr_get_storage(context, ONLY_PART, &storage);
    if (result)
        return fail_read(path, stream, result, diag);
    if (storage != EXR_STORAGE_SCANLINE) /* the flags said otherwise */
        return refuse_kind(path, storage == EXR_STORAGE_TILED ? "tiled" : "deep", diag);
    result = query_layout(context, layout);
    if (result)
        return fail_read(path, stream, result, diag);
    if (layout->compression >= EXR_COMPRESSION_DWAA) {
        neph_fail(diag, NEPH_ERR_INPUT, "'%s' has DWA compression, which is lossy and not read",
                  path);
        neph_hint(diag, "write it with ZIP compression");
        return NEPH_ERR_INPUT;
    }
    enum neph_status status = check_size(path, layout, diag);
    return status ? status : check_channels(path, layout, diag);
}

/* The chunk that starts `row` rows below the top, held against what the header promises: the
 * decoders trust these sizes, and memory is asked for by them. */
static exr_result_t find_chunk(exr_const_context_t context, const struct layout *layout, int row,
                               exr_chunk_info_t *chunk)
{
    int y = layout->window.min.y + row;
    exr_result_t result = exr_read_scanline_chunk_info(context, ONLY_PART, y, chunk);
    if (result)
        return result;
    int rows_left = layout->height_px - row;
    int rows = rows_left < layout->rows_per_chunk ? rows_left : layout->rows_per_chunk;
    uint64_t expected_bytes = layout->row_bytes * (uint64_t)rows;
    bool packed = layout->compression != EXR_COMPRESSION_NONE;
    if (chunk->start_y != y || chunk->width != layout->width_px || chunk->height != rows ||
        chunk->unpacked_size != expected_bytes || chunk->packed_size < 1 ||
        chunk->packed_size > expected_bytes || chunk->packed_size < expected_bytes / SHRINK_MAX ||
        (!packed && chunk->packed_size != expected_bytes))
        return EXR_ERR_CORRUPT_CHUNK;
    return EXR_ERR_SUCCESS;
}

/* Before any pixel memory is asked for: a small broken file may promise gigabytes. */
static exr_result_t check_chunks(exr_const_context_t context, const struct layout *layout)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    for (int row = 0; row < layout->height_px && !result; row += layout->rows_per_chunk) {
        exr_chunk_info_t chunk;
        result = find_chunk(context, layout, row, &chunk);
    }
    return result;
}

static enum neph_status add_channels(struct neph_image *image, const struct layout *layout,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < layout->channels->num_channels && !status; i++) {
        /* Names are shown, in JSON too; what is in them is for whoever wrote the file to choose. */
        char *name = neph_text_clean_copy(layout->channels->entries[i].name.str);
        status = name ? neph_image_add_channel(image, name, NULL, diag) : neph_fail_memory(diag);
        free(name);
    }
    return status;
}

static enum neph_status add_attribute(struct neph_image *image, const char *path,
                                      const exr_attribute_t *attribute, struct neph_diag *diag)
{
    if (attribute->type != EXR_ATTR_STRING || neph_exr_is_reserved(attribute->name) ||
        neph_exr_is_ours(attribute->name))
        return NEPH_OK;
    if (strlen(attribute->name) >= NEPH_IMAGE_NAME_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s': the name of attribute '%s' is longer than %d bytes", path,
                         attribute->name, NEPH_IMAGE_NAME_MAX - 1);
    const exr_attr_string_t *text = attribute->string;
    return neph_image_set_attribute(image, attribute->name, diag, "%.*s", (int)text->length,
                                    text->str ? text->str : "");
}

static enum neph_status add_attributes(struct neph_image *image, const char *path,
                                       exr_const_context_t context, const struct stream *stream,
                                       struct neph_diag *diag)
{
    int32_t count = 0;
    exr_result_t result = exr_get_attribute_count(context, ONLY_PART, &count);
    enum neph_status status = NEPH_OK;
    for (int32_t i = 0; i < count && !result && !status; i++) {
        const exr_attribute_t *attribute = NULL;
        result = exr_get_attribute_by_index(context, ONLY_PART, EXR_ATTR_LIST_FILE_ORDER, i,
                                            &attribute);
        if (!result)
            status = add_attribute(image, path, attribute, diag);
    }
    return result ? fail_read(path, stream, result, diag) : status;
}

/* The image has its channels in the order of the file, see add_channels(). */
static void set_targets(exr_decode_pipeline_t *decoder, const struct neph_image *image, int row)
{
    for (int c = 0; c < decoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &decoder->channels[c];
        float *samples = image->channels[c].samples;
        channel->decode_to_ptr = (uint8_t *)(samples + (size_t)row * (size_t)image->width_px);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = image->width_px * (int32_t)sizeof(float);
    }
}

/* What choose_default_routines() found; lives as long as the decoder. */
struct decompressor {
    exr_result_t (*run)(exr_decode_pipeline_t *decoder);
};

/* A chunk that would not shrink lies in the file as it is, in every compression. OpenEXRCore 3.1.5
 * decompresses it all the same when it is B44 or B44A: floats and integers, which these leave as
 * they are, then come out channel by channel where they are line by line, without an error. */
static exr_result_t decompress_or_leave_plain(exr_decode_pipeline_t *decoder)
{
    const struct decompressor *decompressor = decoder->decoding_user_data;
    if (decoder->chunk.packed_size != decoder->chunk.unpacked_size)
        return decompressor->run(decoder);
    if (decoder->unpacked_buffer != decoder->packed_buffer)
        memcpy(decoder->unpacked_buffer, decoder->packed_buffer, decoder->chunk.packed_size);
    return EXR_ERR_SUCCESS;
}

static exr_result_t choose_decoding(exr_const_context_t context, exr_decode_pipeline_t *decoder,
                                    struct decompressor *decompressor)
{
    exr_result_t result = exr_decoding_choose_default_routines(context, ONLY_PART, decoder);
    if (result || !decoder->decompress_fn)
        return result;
    decompressor->run = decoder->decompress_fn;
    decoder->decoding_user_data = decompressor;
    decoder->decompress_fn = decompress_or_leave_plain;
    return EXR_ERR_SUCCESS;
}

static exr_result_t read_chunk(exr_const_context_t context, const struct layout *layout,
                               exr_decode_pipeline_t *decoder, struct decompressor *decompressor,
                               const struct neph_image *image, int row)
{
    exr_chunk_info_t chunk;
    exr_result_t result = find_chunk(context, layout, row, &chunk);
    if (result)
        return result;
    bool first = row == 0;
    result = first ? exr_decoding_initialize(context, ONLY_PART, &chunk, decoder)
                   : exr_decoding_update(context, ONLY_PART, &chunk, decoder);
    if (result)
        return result;
    set_targets(decoder, image, row);
    if (first)
        result = choose_decoding(context, decoder, decompressor);
    return result ? result : exr_decoding_run(context, ONLY_PART, decoder);
}

static exr_result_t read_pixels(exr_const_context_t context, const struct layout *layout,
                                const struct neph_image *image)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    struct decompressor decompressor = {NULL};
    exr_result_t result = EXR_ERR_SUCCESS;
    for (int row = 0; row < layout->height_px && !result; row += layout->rows_per_chunk)
        result = read_chunk(context, layout, &decoder, &decompressor, image, row);
    exr_decoding_destroy(context, &decoder);
    return result;
}

/* Two crops of one size are not of the same place. */
static enum neph_status add_crop(struct neph_image *image, const struct layout *layout,
                                 struct neph_diag *diag)
{
    const exr_attr_box2i_t *data = &layout->window, *display = &layout->display;
    if (data->min.x == display->min.x && data->min.y == display->min.y &&
        data->max.x == display->max.x && data->max.y == display->max.y)
        return NEPH_OK;
    return neph_image_set_attribute(
        image, "crop", diag, "(%lld, %lld) of %lldx%lld", (long long)data->min.x - display->min.x,
        (long long)data->min.y - display->min.y, (long long)display->max.x - display->min.x + 1,
        (long long)display->max.y - display->min.y + 1);
}

/* Without the attribute the primaries are those of Rec.709: "chromaticities" in
 * https://openexr.com/en/latest/TechnicalIntroduction.html. Its numbers have three digits. */
static enum neph_status add_primaries(struct neph_image *image, exr_const_context_t context,
                                      struct neph_diag *diag)
{
    static const float rec709[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    static const float rounding = 1e-3f;
    exr_attr_chromaticities_t found;
    if (exr_attr_get_chromaticities(context, ONLY_PART, "chromaticities", &found) !=
        EXR_ERR_SUCCESS)
        return NEPH_OK;
    const float given[8] = {found.red_x,  found.red_y,  found.green_x, found.green_y,
                            found.blue_x, found.blue_y, found.white_x, found.white_y};
    bool is_rec709 = true;
    for (int i = 0; i < 8; i++)
        is_rec709 &= fabsf(given[i] - rec709[i]) <= rounding; /* false of a NaN */
    if (is_rec709)
        return NEPH_OK;
    return neph_image_set_attribute(image, "primaries", diag,
                                    "red (%.4g, %.4g), green (%.4g, %.4g), blue (%.4g, %.4g), "
                                    "white (%.4g, %.4g)",
                                    (double)given[0], (double)given[1], (double)given[2],
                                    (double)given[3], (double)given[4], (double)given[5],
                                    (double)given[6], (double)given[7]);
}

static enum neph_status add_pixel_aspect(struct neph_image *image, exr_const_context_t context,
                                         struct neph_diag *diag)
{
    float aspect = 1.0f;
    if (exr_get_pixel_aspect_ratio(context, ONLY_PART, &aspect) != EXR_ERR_SUCCESS ||
        aspect == 1.0f)
        return NEPH_OK;
    return neph_image_set_attribute(image, "pixel_aspect", diag, "%.9g", (double)aspect);
}

static bool is_plain(const struct neph_file_header *header, const struct layout *layout)
{
    const int32_t *data = header->data_min_px, *display = header->display_min_px;
    return data[0] == 0 && data[1] == 0 && display[0] == 0 && display[1] == 0 &&
           header->display_px[0] == layout->width_px &&
           header->display_px[1] == layout->height_px && header->pixel_aspect == 1.0f &&
           header->screen_center[0] == 0.0f && header->screen_center[1] == 0.0f &&
           header->screen_width == 1.0f && header->attribute_bytes == 0;
}

/* Whether the library has found the same attributes: it takes those of a fixed size for as long as
 * that, whatever length the file gives them. */
static bool has_same_attributes(exr_const_context_t context, const struct stream *stream)
{
    struct neph_exr_attribute attribute;
    const exr_attribute_t *found = NULL;
    int32_t expected = -1, count = 0;
    exr_get_attribute_count(context, ONLY_PART, &expected);
    for (size_t at = 0;
         neph_exr_next_attribute(stream->header, stream->header_bytes, &at, &attribute); count++)
        if (exr_get_attribute_by_name(context, ONLY_PART, attribute.name, &found) !=
            EXR_ERR_SUCCESS)
            return false;
    return count == expected;
}

/* For when the image is written again. Most files have nothing for it. */
static enum neph_status add_header(struct neph_image *image, const struct layout *layout,
                                   exr_const_context_t context, const struct stream *stream,
                                   struct neph_diag *diag)
{
    const exr_attr_box2i_t *data = &layout->window, *display = &layout->display;
    const int64_t width_px = (int64_t)display->max.x - display->min.x + 1,
                  height_px = (int64_t)display->max.y - display->min.y + 1;
    exr_attr_v2f_t center;
    struct neph_file_header header = {.data_min_px = {data->min.x, data->min.y},
                                      .display_min_px = {display->min.x, display->min.y},
                                      .display_px = {(int32_t)width_px, (int32_t)height_px},
                                      .pixel_aspect = 1.0f,
                                      .screen_width = 1.0f};
    if (width_px > INT32_MAX || height_px > INT32_MAX)
        return NEPH_OK; /* no picture is as large */
    exr_get_pixel_aspect_ratio(context, ONLY_PART, &header.pixel_aspect);
    exr_get_screen_window_width(context, ONLY_PART, &header.screen_width);
    if (exr_get_screen_window_center(context, ONLY_PART, &center) == EXR_ERR_SUCCESS) {
        header.screen_center[0] = center.x;
        header.screen_center[1] = center.y;
    }
    header.attributes = malloc(stream->header_bytes + 1);
    image->header = malloc(sizeof(header));
    if (!header.attributes || !image->header) {
        free(header.attributes);
        free(image->header);
        image->header = NULL;
        return neph_fail_memory(diag);
    }
    if (has_same_attributes(context, stream))
        header.attribute_bytes = neph_exr_keep_attributes(stream->header, stream->header_bytes,
                                                          header.attributes);
    *image->header = header;
    if (is_plain(&header, layout)) {
        free(header.attributes);
        free(image->header);
        image->header = NULL;
    }
    return NEPH_OK;
}

static enum neph_status read_part(exr_const_context_t context, const char *path,
                                  const struct stream *stream, struct neph_image **image,
                                  struct neph_diag *diag)
{
    struct neph_image *created = NULL;
    struct layout layout;
    exr_result_t result = EXR_ERR_SUCCESS;
    enum neph_status status = read_layout(context, path, stream, &layout, diag);
    if (!status && (result = check_chunks(context, &layout)) != EXR_ERR_SUCCESS)
        status = fail_read(path, stream, result, diag);
    if (!status)
        status = neph_image_create(layout.width_px, layout.height_px, &created, diag);
    if (!status)
        status = add_channels(created, &layout, diag);
    if (!status)
        status = add_attributes(created, path, context, stream, diag);
    if (!status)
        status = add_crop(created, &layout, diag);
    if (!status)
        status = add_primaries(created, context, diag);
    if (!status)
        status = add_pixel_aspect(created, context, diag);
    if (!status)
        status = neph_exr_interpret_attributes(stream->header, stream->header_bytes, created, diag);
    if (!status)
        status = add_header(created, &layout, context, stream, diag);
    if (!status && (result = read_pixels(context, &layout, created)) != EXR_ERR_SUCCESS)
        status = fail_read(path, stream, result, diag);
    if (status)
        neph_image_destroy(created);
    else
        *image = created;
    return status;
}

enum neph_status neph_exr_read(const char *path, struct neph_image **image, struct neph_diag *diag)
{
    exr_context_t context = NULL;
    struct stream stream;
    enum neph_status status = open_stream(path, &stream, diag);
    if (status)
        goto done;

    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = keep_complaint;
    setup.user_data = &stream;
    setup.read_fn = read_bytes;
    setup.size_fn = file_size;
    /* A file with a hole is refused; the library would else search for chunks and leave zeros. */
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&context, path, &setup);
    status = result ? fail_read(path, &stream, result, diag)
                    : read_part(context, path, &stream, image, diag);
done:
    if (context)
        exr_finish(&context); /* also after a failure, or the context leaks */
    free(stream.header);
    if (stream.fd >= 0)
        close(stream.fd);
    return status;
}

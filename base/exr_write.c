/* SPDX-License-Identifier: MIT
 *
 * Writer of OpenEXR files. The library writes into memory through its stream callback; base/files.h
 * then writes the file safely.
 */
#include "base/exr.h"

#include "base/exr_header.h"
#include "base/exr_labels.h"
#include "base/exr_library.h"
#include "base/files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum {
    SHORT_NAME_MAX = 31, /* longer names need a flag in the file */
    FIRST_BUFFER_BYTES = 1 << 16,
};

/* User data of the library's callback. */
struct sink {
    struct neph_exr_trouble trouble;
    uint64_t size_bytes; /* bytes written */
    char *data;
    size_t capacity;
};

static bool reserve(struct sink *sink, uint64_t needed_bytes)
{
    if (needed_bytes <= sink->capacity)
        return true;
    size_t capacity = sink->capacity ? sink->capacity : FIRST_BUFFER_BYTES;
    while (capacity < needed_bytes)
        capacity *= 2;
    char *grown = realloc(sink->data, capacity);
    if (!grown) {
        sink->trouble.io_error = ENOMEM;
        return false;
    }
    memset(grown + sink->capacity, 0, capacity - sink->capacity);
    sink->data = grown;
    sink->capacity = capacity;
    return true;
}

/* The library returns to the table of chunks after the chunks, hence the offset. */
static int64_t write_bytes(exr_const_context_t context, void *userdata, const void *buffer,
                           uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t fail)
{
    (void)context;
    (void)fail;
    struct sink *sink = userdata;
    if (!reserve(sink, offset + size))
        return -1;
    memcpy(sink->data + offset, buffer, size);
    if (offset + size > sink->size_bytes)
        sink->size_bytes = offset + size;
    return (int64_t)size;
}

static enum neph_status fail_write(const char *path, const struct sink *sink, exr_result_t result,
                                   struct neph_diag *diag)
{
    if (result == EXR_ERR_OUT_OF_MEMORY || sink->trouble.io_error == ENOMEM)
        return neph_fail_memory(diag);
    return neph_fail(diag, NEPH_ERR_INTERNAL, "cannot encode '%s': %s", path,
                     neph_exr_reason(&sink->trouble, result));
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
                             "cannot write '%s': the attribute name '%s' is reserved", path, name);
    }
    return NEPH_OK;
}

/* The next attribute preserved from a file; false also when the image has none. */
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

/* The row of the data window that is row 0 of the image. */
static int top_of(const struct neph_image *image)
{
    return image->header ? image->header->data_min_px[1] : 0;
}

static exr_result_t write_windows(exr_context_t context, const struct neph_image *image,
                                  exr_compression_t compression)
{
    const struct neph_file_header *header = image->header;
    if (!header)
        return exr_initialize_required_attr_simple(context, NEPH_EXR_ONLY_PART, image->width_px,
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
    return exr_initialize_required_attr(context, NEPH_EXR_ONLY_PART, &whole, &window,
                                        header->pixel_aspect, &center, header->screen_width,
                                        EXR_LINEORDER_INCREASING_Y, compression);
}

static exr_result_t write_header(exr_context_t context, const struct neph_image *image,
                                 exr_compression_t compression)
{
    int part = NEPH_EXR_ONLY_PART;
    /* Some readers refuse the flag, so it is set only when necessary. */
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

/* Point the encoder at the rows of the chunk that starts at row y. The file has its channels in
 * alphabetical order, the image in the order of creation. */
static void set_sources(exr_encode_pipeline_t *encoder, const struct neph_image *image, int y)
{
    for (int c = 0; c < encoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &encoder->channels[c];
        const float *samples = neph_image_channel(image, channel->channel_name);
        channel->encode_from_ptr = (const uint8_t *)(samples + (size_t)y * (size_t)image->width_px);
        neph_exr_float_rows(channel, image->width_px);
    }
}

/* The library's own compression function; lives as long as the encoder. */
struct compressor {
    exr_result_t (*run)(exr_encode_pipeline_t *encoder);
};

/* Works around an error of OpenEXRCore 3.1.5: when compressed and uncompressed size are equal, it
 * writes the compressed bytes. Readers take a chunk of that size as uncompressed and return garbage
 * without an error. The uncompressed bytes are written instead, as by later versions. */
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
    exr_result_t result = exr_encoding_choose_default_routines(context, NEPH_EXR_ONLY_PART,
                                                               encoder);
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
    exr_result_t result = exr_write_scanline_chunk_info(context, NEPH_EXR_ONLY_PART,
                                                        top_of(image) + y, &chunk);
    if (result)
        return result;
    bool first = y == 0;
    result = first ? exr_encoding_initialize(context, NEPH_EXR_ONLY_PART, &chunk, encoder)
                   : exr_encoding_update(context, NEPH_EXR_ONLY_PART, &chunk, encoder);
    if (result)
        return result;
    set_sources(encoder, image, y);
    if (first)
        result = choose_routines(context, encoder, compressor);
    return result ? result : exr_encoding_run(context, NEPH_EXR_ONLY_PART, encoder);
}

static exr_result_t write_pixels(exr_context_t context, const struct neph_image *image)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    struct compressor compressor = {NULL};
    int32_t rows_per_chunk = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(context, NEPH_EXR_ONLY_PART, &rows_per_chunk);
    for (int y = 0; y < image->height_px && !result; y += rows_per_chunk)
        result = write_chunk(context, &encoder, &compressor, image, y);
    exr_encoding_destroy(context, &encoder);
    return result;
}

/* Append the preserved attributes as raw bytes: the library has one function for each type, and
 * none for unknown types. A text of the image replaces a preserved attribute of that name. */
static enum neph_status add_kept(struct sink *sink, const struct neph_image *image,
                                 exr_compression_t compression, struct neph_diag *diag)
{
    const int rows_per_chunk = compression == EXR_COMPRESSION_ZIP ? 16 : 1;
    const int64_t chunk_count = (image->height_px + rows_per_chunk - 1) / rows_per_chunk;
    struct neph_exr_attribute kept;
    enum neph_status status = NEPH_OK;
    for (size_t at = 0; !status && next_kept(image, &at, &kept);)
        if (!neph_image_attribute(image, kept.name))
            status = neph_exr_add_attributes(&sink->data, &sink->size_bytes, chunk_count,
                                             kept.start, kept.bytes, diag);
    return status;
}

static enum neph_status write_compressed(const char *path, const struct neph_image *image,
                                         exr_compression_t compression, struct neph_diag *diag)
{
    enum neph_status status = check_writable(image, path, diag);
    if (status)
        return status;
    struct sink sink = {.size_bytes = 0};
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = neph_exr_keep_complaint;
    setup.user_data = &sink;
    setup.write_fn = write_bytes;

    exr_context_t context = NULL;
    exr_result_t result = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result)
        result = write_header(context, image, compression);
    if (!result)
        result = write_pixels(context, image);
    if (context) {
        /* Also after a failure, else the context leaks; writes the table of chunks. */
        exr_result_t finished = exr_finish(&context);
        result = result ? result : finished;
    }
    status = result ? fail_write(path, &sink, result, diag)
                    : add_kept(&sink, image, compression, diag);
    if (!status)
        status = neph_file_write(path, sink.data, sink.size_bytes, diag);
    free(sink.data);
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

/* SPDX-License-Identifier: MIT
 *
 * Reader of OpenEXR files. The library reads through pread() in its stream callbacks, so that errno
 * of a failed read is known.
 */
#include "base/exr.h"

#include "base/exr_chroma.h"
#include "base/exr_header.h"
#include "base/exr_labels.h"
#include "base/exr_library.h"
#include "base/exr_parts.h"
#include "base/exr_pixels.h"
#include "base/files.h"
#include "base/oiio.h"
#include "base/text.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    EXR_MAGIC = 20000630, /* the first four bytes of every file */
    CHANNEL_COUNT_MAX = 1024,
};

/* User data of the library's callbacks. */
struct stream {
    struct neph_exr_error trouble;
    int fd;
    uint64_t size_bytes; /* of the file */
    char *headers;       /* of all parts; owned */
    size_t headers_bytes;
    bool has_deep;             /* one of the parts is deep */
    struct neph_exr_part part; /* the part that is read */
};

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
            stream->trouble.io_error = errno;
            return -1;
        }
        if (got == 0)
            break; /* not an error yet: the library reads ahead */
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

/* Report an error of the library, as the user can understand and correct it. */
static enum neph_status fail_read(const char *path, const struct stream *stream,
                                  exr_result_t result, struct neph_diag *diag)
{
    if (result == EXR_ERR_OUT_OF_MEMORY)
        return neph_fail_memory(diag);
    if (stream->trouble.io_error)
        return neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path,
                         strerror(stream->trouble.io_error));
    enum neph_status status = neph_fail(diag, NEPH_ERR_INPUT, "'%s' is truncated or damaged: %s",
                                        path, neph_exr_reason(&stream->trouble, result));
    neph_hint(diag, "write the file again: its writer may have been interrupted");
    return status;
}

static enum neph_status refuse_kind(const char *path, const char *kind, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is a %s OpenEXR file; only flat images are read", path,
              kind);
    neph_hint(diag, "write it as a flat image of one part");
    return NEPH_ERR_INPUT;
}

/* Codes of the attribute `compression` that are refused. OpenEXRCore 3.1.5 has no decoder of DWA
 * (EXR_ERR_FEATURE_NOT_IMPLEMENTED: only the C++ library has one, in neph-image), and reads a code
 * beyond DWAB as ZIP. Names: https://openexr.com/en/latest/OpenEXRFileLayout.html. */
static const struct {
    int code;
    const char *name, *why;
} unread_compressions[] = {
    {8, "DWAA", "neph reads only where it was built with OpenImageIO"},
    {9, "DWAB", "neph reads only where it was built with OpenImageIO"},
    {10, "HTJ2K", "OpenEXR 3.1 does not know"},
    {11, "HTJ2K of 32 lines", "OpenEXR 3.1 does not know"},
};

static bool is_dwa(int compression)
{
    return compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB;
}

static enum neph_status refuse_compression(const char *path, int code, struct neph_diag *diag)
{
    const char *name = "unknown", *why = "OpenEXR 3.1 does not know";
    for (size_t i = 0; i < sizeof(unread_compressions) / sizeof(unread_compressions[0]); i++)
        if (unread_compressions[i].code == code) {
            name = unread_compressions[i].name;
            why = unread_compressions[i].why;
        }
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has the compression %s (code %d), which %s", path, name,
              code, why);
    neph_hint(diag, "write it with ZIP compression%s",
              is_dwa(code) ? "; or install libopenimageio-dev and build neph again" : "");
    return NEPH_ERR_INPUT;
}

/* Whether there is a decoder: the C library, or the helper program for DWA. */
static bool is_decoded(int compression)
{
    return compression <= EXR_COMPRESSION_B44A || (is_dwa(compression) && neph_oiio_is_available());
}

/* Refuse compressions that the library would read as another one, or report as damage. */
static enum neph_status check_compression(const char *path, const char *header, size_t size,
                                          struct neph_diag *diag)
{
    struct neph_exr_attribute attribute;
    for (size_t at = 0; neph_exr_next_attribute(header, size, &at, &attribute);)
        if (strcmp(attribute.name, "compression") == 0 && attribute.value_bytes == 1 &&
            !is_decoded(attribute.value[0]))
            return refuse_compression(path, attribute.value[0], diag);
    return NEPH_OK;
}

/* Refuse other kinds of files before the library parses them. */
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
    stream->has_deep = flags & NEPH_EXR_FLAG_DEEP;
    if (stream->has_deep && !(flags & NEPH_EXR_FLAG_MULTIPART))
        return refuse_kind(path, "deep", diag);
    return NEPH_OK;
}

static enum neph_status read_headers(const char *path, struct stream *stream,
                                     struct neph_diag *diag)
{
    const enum neph_status status = neph_exr_read_headers(
        stream->fd, stream->size_bytes, &stream->headers, &stream->headers_bytes, diag);
    if (status == NEPH_ERR_IO) {
        stream->trouble.io_error = errno;
        return fail_read(path, stream, EXR_ERR_READ_IO, diag);
    }
    return status;
}

static enum neph_status choose_part(const char *path, const char *wanted, struct stream *stream,
                                    struct neph_diag *diag)
{
    struct neph_exr_part *part = &stream->part;
    const enum neph_status status = neph_exr_choose_part(path, stream->headers,
                                                         stream->headers_bytes, wanted, part, diag);
    if (status)
        return status;
    if (part->is_deep)
        return refuse_kind(path, "deep", diag);
    return check_compression(path, part->header, part->header_bytes, diag);
}

static enum neph_status open_stream(const char *path, const char *part, struct stream *stream,
                                    struct neph_diag *diag)
{
    *stream = (struct stream){.fd = -1};
    enum neph_status status = neph_file_open(path, &stream->fd, &stream->size_bytes, diag);
    if (!status)
        status = check_prefix(path, stream, diag);
    if (!status)
        status = read_headers(path, stream, diag);
    return status ? status : choose_part(path, part, stream, diag);
}

static exr_result_t query_blocks(exr_const_context_t context, struct neph_exr_layout *layout)
{
    exr_result_t result;
    if (layout->is_tiled) {
        uint32_t width_px = 0, height_px = 0;
        exr_tile_level_mode_t levels;
        exr_tile_round_mode_t rounding;
        result = exr_get_tile_descriptor(context, layout->part, &width_px, &height_px, &levels,
                                         &rounding);
        if (!result && (width_px < 1 || height_px < 1))
            result = EXR_ERR_INVALID_ATTR;
        layout->block_width_px = (int)(width_px < INT_MAX ? width_px : INT_MAX);
        layout->block_height_px = (int)(height_px < INT_MAX ? height_px : INT_MAX);
    } else {
        int32_t rows = 0;
        result = exr_get_scanlines_per_chunk(context, layout->part, &rows);
        if (!result && rows < 1)
            result = EXR_ERR_INVALID_ATTR;
        layout->block_width_px = INT_MAX;
        layout->block_height_px = rows;
    }
    return result;
}

static exr_result_t query_layout(exr_const_context_t context, struct neph_exr_layout *layout)
{
    exr_result_t result = exr_get_data_window(context, layout->part, &layout->window);
    if (!result)
        result = exr_get_display_window(context, layout->part, &layout->display);
    if (!result)
        result = query_blocks(context, layout);
    if (!result)
        result = exr_get_compression(context, layout->part, &layout->compression);
    if (!result)
        result = exr_get_channels(context, layout->part, &layout->channels);
    return result;
}

static enum neph_status check_size(const char *path, struct neph_exr_layout *layout,
                                   struct neph_diag *diag)
{
    int64_t width_px = (int64_t)layout->window.max.x - layout->window.min.x + 1;
    int64_t height_px = (int64_t)layout->window.max.y - layout->window.min.y + 1;
    if (width_px < 1 || height_px < 1 || width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' has a size of %lldx%lld pixels; allowed are 1 to %d per side", path,
                         (long long)width_px, (long long)height_px, NEPH_IMAGE_SIDE_MAX_PX);
    layout->width_px = (int)width_px;
    layout->height_px = (int)height_px;
    return NEPH_OK;
}

/* Whether the samples of a channel can be read: at each pixel, or at every second one. */
static bool is_sampled(const struct neph_exr_layout *layout, const exr_attr_chlist_entry_t *channel)
{
    const int step[2] = {channel->x_sampling, channel->y_sampling},
              corner[2] = {layout->window.min.x, layout->window.min.y},
              size[2] = {layout->width_px, layout->height_px};
    bool fits = true;
    for (int axis = 0; axis < 2; axis++)
        fits &= step[axis] == 1 || (step[axis] == 2 && !layout->is_tiled && corner[axis] % 2 == 0 &&
                                    size[axis] % 2 == 0);
    return fits;
}

static enum neph_status check_channels(const char *path, struct neph_exr_layout *layout,
                                       struct neph_diag *diag)
{
    int count = layout->channels->num_channels;
    if (count < 1 || count > CHANNEL_COUNT_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %d channels; allowed are 1 to %d", path,
                         count, CHANNEL_COUNT_MAX);
    for (int i = 0; i < count; i++) {
        const exr_attr_chlist_entry_t *channel = &layout->channels->entries[i];
        layout->is_subsampled |= channel->x_sampling != 1 || channel->y_sampling != 1;
        if (!is_sampled(layout, channel)) {
            neph_fail(
                diag, NEPH_ERR_INPUT,
                "'%s': channel '%s' is subsampled by %dx%d; in scanlines 1 or 2 is allowed, of "
                "which corner and size of the data window are multiples",
                path, channel->name.str, channel->x_sampling, channel->y_sampling);
            neph_hint(diag, "write the channel at full size");
            return NEPH_ERR_INPUT;
        }
    }
    return NEPH_OK;
}

/* Refuse an image that the machine has no memory for: allocations succeed until their pages are
 * used. */
static enum neph_status check_memory(const char *path, const struct neph_exr_layout *layout,
                                     struct neph_diag *diag)
{
    static const double gib = 1024.0 * 1024.0 * 1024.0;
    const double needed_gib = (double)layout->channels->num_channels * layout->width_px *
                              layout->height_px * sizeof(float) / gib;
    const double memory_gib = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / gib;
    if (needed_gib <= memory_gib)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_MEMORY,
              "'%s' needs %.0f GiB of memory (%dx%d pixels, %d channels); this machine has %.0f "
              "GiB",
              path, needed_gib, layout->width_px, layout->height_px, layout->channels->num_channels,
              memory_gib);
    neph_hint(diag, "write fewer channels or fewer pixels");
    return NEPH_ERR_MEMORY;
}

static enum neph_status read_layout(exr_const_context_t context, const char *path,
                                    const struct stream *stream, struct neph_exr_layout *layout,
                                    struct neph_diag *diag)
{
    *layout = (struct neph_exr_layout){.part = stream->part.index};
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t result = exr_get_storage(context, layout->part, &storage);
    if (result)
        return fail_read(path, stream, result, diag);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return refuse_kind(path, "deep", diag); /* the flags of the prefix did not say so */
    layout->is_tiled = storage == EXR_STORAGE_TILED;
    result = query_layout(context, layout);
    if (result)
        return fail_read(path, stream, result, diag);
    if (!is_decoded((int)layout->compression)) /* check_compression() did not see it */
        return refuse_compression(path, (int)layout->compression, diag);
    enum neph_status status = check_size(path, layout, diag);
    if (!status)
        status = check_channels(path, layout, diag);
    return status ? status : check_memory(path, layout, diag);
}

static enum neph_status add_channels(struct neph_image *image, const char *path,
                                     const struct neph_exr_layout *layout, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < layout->channels->num_channels && !status; i++) {
        /* Names are shown to users, also in JSON, and may contain any bytes. */
        char *name = neph_text_clean_copy(layout->channels->entries[i].name.str);
        status = name ? neph_image_add_channel(image, name, NULL, diag) : neph_fail_memory(diag);
        free(name);
    }
    if (status == NEPH_ERR_INPUT) /* duplicate, or too long with its escapes */
        neph_prefix(diag, "'%s': ", path);
    return status;
}

static enum neph_status add_attribute(struct neph_image *image, const char *path,
                                      const exr_attribute_t *attribute, struct neph_diag *diag)
{
    if (attribute->type != EXR_ATTR_STRING || neph_exr_is_reserved(attribute->name) ||
        neph_exr_is_derived(attribute->name))
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
    exr_result_t result = exr_get_attribute_count(context, stream->part.index, &count);
    enum neph_status status = NEPH_OK;
    for (int32_t i = 0; i < count && !result && !status; i++) {
        const exr_attribute_t *attribute = NULL;
        result = exr_get_attribute_by_index(context, stream->part.index, EXR_ATTR_LIST_FILE_ORDER,
                                            i, &attribute);
        if (!result)
            status = add_attribute(image, path, attribute, diag);
    }
    return result ? fail_read(path, stream, result, diag) : status;
}

/* Record the position of a crop: two crops of equal size may show different places. */
static enum neph_status add_crop(struct neph_image *image, const struct neph_exr_layout *layout,
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

/* Give subsampled channels all pixels. */
static enum neph_status upsample(struct neph_image *image, const struct neph_exr_layout *layout,
                                 struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int c = 0; c < image->channel_count && !status; c++) {
        const exr_attr_chlist_entry_t *entry = &layout->channels->entries[c];
        const int step[2] = {entry->x_sampling, entry->y_sampling};
        status = neph_exr_upsample(image, &image->channels[c], step, diag);
    }
    return status;
}

/* Primaries without the attribute: "chromaticities" in
 * https://openexr.com/en/latest/TechnicalIntroduction.html. */
static const float rec709[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};

static void read_primaries(exr_const_context_t context, int part, float primaries[8])
{
    exr_attr_chromaticities_t found;
    memcpy(primaries, rec709, sizeof(rec709));
    if (exr_attr_get_chromaticities(context, part, "chromaticities", &found) != EXR_ERR_SUCCESS)
        return;
    const float given[8] = {found.red_x,  found.red_y,  found.green_x, found.green_y,
                            found.blue_x, found.blue_y, found.white_x, found.white_y};
    memcpy(primaries, given, sizeof(given));
}

static enum neph_status convert_chroma(struct neph_image *image, const char *path,
                                       exr_const_context_t context, int part,
                                       struct neph_diag *diag)
{
    float primaries[8];
    read_primaries(context, part, primaries);
    const enum neph_status status = neph_exr_convert_chroma(image, primaries, diag);
    if (status)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

/* Record primaries other than Rec.709. Writers round the numbers to three digits. */
static enum neph_status add_primaries(struct neph_image *image, exr_const_context_t context,
                                      int part, struct neph_diag *diag)
{
    static const float rounding = 1e-3f;
    float given[8];
    read_primaries(context, part, given);
    bool is_rec709 = true;
    for (int i = 0; i < 8; i++)
        is_rec709 &= fabsf(given[i] - rec709[i]) <= rounding; /* false for NaN */
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
                                         int part, struct neph_diag *diag)
{
    float aspect = 1.0f;
    if (exr_get_pixel_aspect_ratio(context, part, &aspect) != EXR_ERR_SUCCESS || aspect == 1.0f)
        return NEPH_OK;
    return neph_image_set_attribute(image, "pixel_aspect", diag, "%.9g", (double)aspect);
}

static bool has_default_header(const struct neph_file_header *header,
                               const struct neph_exr_layout *layout)
{
    const int32_t *data = header->data_min_px, *display = header->display_min_px;
    return data[0] == 0 && data[1] == 0 && display[0] == 0 && display[1] == 0 &&
           header->display_px[0] == layout->width_px &&
           header->display_px[1] == layout->height_px && header->pixel_aspect == 1.0f &&
           header->screen_center[0] == 0.0f && header->screen_center[1] == 0.0f &&
           header->screen_width == 1.0f && header->attribute_bytes == 0;
}

/* Whether the library has read the same attributes as the raw header. For types of a fixed size it
 * uses that size, whatever length the file gives. */
static bool has_same_attributes(exr_const_context_t context, const struct stream *stream)
{
    struct neph_exr_attribute attribute;
    const exr_attribute_t *found = NULL;
    int32_t expected = -1, count = 0;
    exr_get_attribute_count(context, stream->part.index, &expected);
    for (size_t at = 0;
         neph_exr_next_attribute(stream->part.header, stream->part.header_bytes, &at, &attribute);
         count++)
        if (exr_get_attribute_by_name(context, stream->part.index, attribute.name, &found) !=
            EXR_ERR_SUCCESS)
            return false;
    return count == expected;
}

/* Keep the parts of the header needed to write the image again. Most files have none. */
static enum neph_status add_header(struct neph_image *image, const struct neph_exr_layout *layout,
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
        return NEPH_OK; /* larger than any valid display window */
    exr_get_pixel_aspect_ratio(context, layout->part, &header.pixel_aspect);
    exr_get_screen_window_width(context, layout->part, &header.screen_width);
    if (exr_get_screen_window_center(context, layout->part, &center) == EXR_ERR_SUCCESS) {
        header.screen_center[0] = center.x;
        header.screen_center[1] = center.y;
    }
    header.attributes = malloc(stream->part.header_bytes + 1);
    image->header = malloc(sizeof(header));
    if (!header.attributes || !image->header) {
        free(header.attributes);
        free(image->header);
        image->header = NULL;
        return neph_fail_memory(diag);
    }
    if (has_same_attributes(context, stream))
        header.attribute_bytes = neph_exr_copy_preserved(
            stream->part.header, stream->part.header_bytes, header.attributes);
    *image->header = header;
    if (has_default_header(&header, layout)) {
        free(header.attributes);
        free(image->header);
        image->header = NULL;
    }
    return NEPH_OK;
}

static enum neph_status read_chosen_part(exr_const_context_t context, const char *path,
                                         const struct stream *stream,
                                         struct neph_oiio_server *server, struct neph_image **image,
                                         struct neph_diag *diag)
{
    struct neph_image *created = NULL;
    struct neph_exr_layout layout;
    exr_result_t result = EXR_ERR_SUCCESS;
    enum neph_status status = read_layout(context, path, stream, &layout, diag);
    if (!status && (result = neph_exr_check_chunks(context, &layout)) != EXR_ERR_SUCCESS)
        status = fail_read(path, stream, result, diag);
    if (!status)
        status = neph_image_create(layout.width_px, layout.height_px, &created, diag);
    if (!status)
        status = add_channels(created, path, &layout, diag);
    if (!status)
        status = add_attributes(created, path, context, stream, diag);
    if (!status)
        status = add_crop(created, &layout, diag);
    if (!status)
        status = add_primaries(created, context, layout.part, diag);
    if (!status)
        status = add_pixel_aspect(created, context, layout.part, diag);
    if (!status)
        status = neph_exr_interpret_attributes(stream->part.header, stream->part.header_bytes,
                                               created, diag);
    if (!status)
        status = add_header(created, &layout, context, stream, diag);
    if (!status && is_dwa((int)layout.compression))
        status = neph_oiio_fill(path, layout.part, server, created, diag);
    else if (!status &&
             (result = neph_exr_read_pixels(context, &layout, created)) != EXR_ERR_SUCCESS)
        status = fail_read(path, stream, result, diag);
    if (!status)
        status = upsample(created, &layout, diag);
    if (!status)
        status = convert_chroma(created, path, context, layout.part, diag);
    if (status)
        neph_image_destroy(created);
    else
        *image = created;
    return status;
}

enum neph_status neph_exr_read(const char *path, struct neph_image **image, struct neph_diag *diag)
{
    return neph_exr_read_part(path, NULL, NULL, image, diag);
}

enum neph_status neph_exr_read_part(const char *path, const char *part,
                                    struct neph_oiio_server *server, struct neph_image **image,
                                    struct neph_diag *diag)
{
    exr_context_t context = NULL;
    struct stream stream;
    enum neph_status status = open_stream(path, part, &stream, diag);
    if (status)
        goto done;

    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = neph_exr_store_message;
    setup.user_data = &stream;
    setup.read_fn = read_bytes;
    setup.size_fn = file_size;
    /* A file with a missing chunk is refused; else the library would search for chunks and leave
     * zeros. */
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&context, path, &setup);
    if (result && stream.has_deep) /* OpenEXRCore 3.1.5 does not find the deep part's version */
        status = refuse_kind(path, "partly deep", diag);
    else
        status = result ? fail_read(path, &stream, result, diag)
                        : read_chosen_part(context, path, &stream, server, image, diag);
done:
    if (context)
        exr_finish(&context); /* also after a failure; else the context leaks */
    free(stream.headers);
    if (stream.fd >= 0)
        close(stream.fd);
    return status;
}

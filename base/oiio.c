/* SPDX-License-Identifier: MIT
 *
 * What neph-image returns of a file: every number is checked.
 */
#include "base/oiio.h"

#include "base/files.h"
#include "base/icc.h"
#include "base/image_window.h"
#include "base/oiio_stream.h"
#include "base/srgb.h"
#include "base/text.h"
#include "base/whole.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

/* Compressed files are decoded at 20 MB/s of pixels or more; ten times as long is hostile. */
static const double cpu_start_s = 10.0, bytes_per_s = 2e6;
static const double wall_per_cpu = 20.0; /* on a busy machine */

static const struct {
    const char *name;
    size_t at, size; /* place and length of the bytes that all files have */
    const char *bytes;
} formats[] = {
    {"TIFF", 0, 4, "II*\0"},
    {"TIFF", 0, 4, "MM\0*"},
    {"TIFF", 0, 4, "II+\0"},
    {"TIFF", 0, 4, "MM\0+"},
    {"Radiance HDR", 0, 10, "#?RADIANCE"},
    {"Radiance HDR", 0, 6, "#?RGBE"},
    {"PFM", 0, 2, "PF"},
    {"PFM", 0, 2, "Pf"},
    {"PPM", 0, 2, "P1"},
    {"PPM", 0, 2, "P2"},
    {"PPM", 0, 2, "P3"},
    {"PPM", 0, 2, "P4"},
    {"PPM", 0, 2, "P5"},
    {"PPM", 0, 2, "P6"},
    {"JPEG", 0, 3, "\xff\xd8\xff"},
    {"WebP", 8, 4, "WEBP"},
    {"DPX", 0, 4, "SDPX"},
    {"DPX", 0, 4, "XPDS"},
};

const char *neph_oiio_format(const void *bytes, size_t size)
{
    for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++)
        if (formats[i].at + formats[i].size <= size &&
            memcmp((const char *)bytes + formats[i].at, formats[i].bytes, formats[i].size) == 0)
            return formats[i].name;
    return NULL;
}

/* ---- the stream ------------------------------------------------------------------------------ */

/* The output of the program, and where its parts are. */
struct stream {
    const char *path;
    struct neph_oiio_head head;
    const char *names, *profile;
    const unsigned char *samples;
    const void *bytes; /* mapped */
    size_t size;
};

static enum neph_status fail_nonsense(const struct stream *stream, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_INPUT, "'%s': OpenImageIO read nonsense from it", stream->path);
}

static bool is_text(const char text[NEPH_OIIO_NAME_BYTES])
{
    return memchr(text, '\0', NEPH_OIIO_NAME_BYTES) != NULL;
}

static bool is_side(int32_t side)
{
    return side >= 1 && side <= NEPH_IMAGE_SIDE_MAX_PX;
}

static enum neph_status find_parts(struct stream *stream, struct neph_diag *diag)
{
    const struct neph_oiio_head *head = &stream->head;
    if (stream->size < sizeof(*head))
        return fail_nonsense(stream, diag);
    memcpy(&stream->head, stream->bytes, sizeof(*head));
    if (head->magic != NEPH_OIIO_MAGIC || !is_side(head->data_px[0]) ||
        !is_side(head->data_px[1]) || !is_side(head->display_px[0]) ||
        !is_side(head->display_px[1]) || head->channel_count < 1 ||
        head->channel_count > NEPH_OIIO_CHANNELS_MAX || !is_text(head->format) ||
        !is_text(head->colour_space))
        return fail_nonsense(stream, diag);
    const size_t names = (size_t)head->channel_count * NEPH_OIIO_NAME_BYTES;
    const size_t samples = (size_t)head->channel_count * (size_t)head->data_px[0] *
                           (size_t)head->data_px[1] * sizeof(float);
    if (stream->size != sizeof(*head) + names + head->profile_bytes + samples)
        return fail_nonsense(stream, diag);
    stream->names = (const char *)stream->bytes + sizeof(*head);
    stream->profile = stream->names + names;
    stream->samples = (const unsigned char *)stream->profile + head->profile_bytes;
    for (int c = 0; c < head->channel_count; c++)
        if (!is_text(stream->names + (size_t)c * NEPH_OIIO_NAME_BYTES))
            return fail_nonsense(stream, diag);
    return NEPH_OK;
}

/* ---- colour ---------------------------------------------------------------------------------- */

static bool list_has(const char *const *list, size_t count, const char *word)
{
    for (size_t i = 0; i < count; i++)
        if (strcasecmp(word, list[i]) == 0)
            return true;
    return false;
}

static enum neph_status refuse_space(const struct stream *stream, const char *what,
                                     struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is neither sRGB nor linear Rec.709: %s", stream->path,
              what);
    neph_hint(diag, "convert it to EXR with linear values, or to PNG in sRGB; if its values "
                    "already are sRGB, write them into a PNG");
    return NEPH_ERR_INPUT;
}

/* Whether the values are codes of sRGB, by the file's words, its profile and its type. */
static enum neph_status find_encoding(const struct stream *stream, bool *is_srgb,
                                      struct neph_diag *diag)
{
    static const char *const srgb[] = {"sRGB", "srgb_rec709_scene", "srgb_texture"},
                             *const linear[] = {"linear", "scene_linear", "lin_srgb", "lin_rec709",
                                                "lin_rec709_scene"};
    const struct neph_oiio_head *head = &stream->head;
    const char *space = head->colour_space;
    const bool is_pnm = strcmp(head->format, "pnm") == 0 && strcmp(space, "Rec709") == 0;
    const bool says_srgb = list_has(srgb, 3, space) || (is_pnm && head->integer_bits > 0);
    const bool says_linear = list_has(linear, 5, space) || (is_pnm && head->integer_bits == 0);
    char what[160];
    if (head->profile_bytes > 0 &&
        (head->integer_bits == 0 || !neph_icc_is_srgb(stream->profile, head->profile_bytes)))
        return refuse_space(stream, "it has a colour profile that is not that of sRGB", diag);
    *is_srgb = head->integer_bits > 0 &&
               (says_srgb || head->profile_bytes > 0 || (!space[0] && head->integer_bits <= 8));
    if (*is_srgb || says_linear || (!space[0] && head->integer_bits == 0))
        return NEPH_OK;
    if (space[0])
        snprintf(what, sizeof(what), "OpenImageIO says '%s'", space);
    else
        snprintf(what, sizeof(what), "integers of %d bits, and no word about their colour space",
                 head->integer_bits);
    for (char *c = what; *c; c++)
        *c = *c >= ' ' && *c <= '~' ? *c : '?';
    return refuse_space(stream, what, diag);
}

static enum neph_status drop_opaque_alpha(const struct stream *stream, struct neph_image *image,
                                          struct neph_diag *diag)
{
    const float *alpha = neph_image_channel(image, "A");
    for (size_t i = 0; alpha && i < neph_image_pixel_count(image); i++)
        if (alpha[i] != 1.0f) {
            neph_fail(diag, NEPH_ERR_INPUT,
                      "'%s' is translucent (first at pixel (%zu, %zu)); its background is unknown",
                      stream->path, i % (size_t)image->width_px, i / (size_t)image->width_px);
            neph_hint(diag, "flatten it onto its background");
            return NEPH_ERR_INPUT;
        }
    neph_image_remove_channel(image, "A");
    return NEPH_OK;
}

static enum neph_status decode_srgb(const struct stream *stream, struct neph_image *image,
                                    struct neph_diag *diag)
{
    const enum neph_status status = drop_opaque_alpha(stream, image, diag);
    for (int c = 0; c < image->channel_count && !status; c++)
        for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
            float *sample = &image->channels[c].samples[i];
            *sample = (float)neph_srgb_to_linear((double)*sample);
        }
    return status ? status : neph_image_set_attribute(image, "encoding", diag, "sRGB");
}

/* ---- the image ------------------------------------------------------------------------------- */

static enum neph_status add_channels(const struct stream *stream, struct neph_image *image,
                                     struct neph_diag *diag)
{
    const size_t count = neph_image_pixel_count(image);
    enum neph_status status = NEPH_OK;
    for (int c = 0; c < stream->head.channel_count && !status; c++) {
        float *samples = NULL;
        char *name = neph_text_clean_copy(stream->names + (size_t)c * NEPH_OIIO_NAME_BYTES);
        status = name ? neph_image_add_channel(image, name, &samples, diag)
                      : neph_fail_memory(diag);
        if (!status)
            memcpy(samples, stream->samples + (size_t)c * count * sizeof(float),
                   count * sizeof(float));
        free(name);
    }
    return status;
}

static enum neph_status add_labels(const struct neph_oiio_head *head, struct neph_image *image,
                                   struct neph_diag *diag)
{
    const struct neph_window window = {.min_px = {head->data_min_px[0], head->data_min_px[1]},
                                       .size_px = {head->data_px[0], head->data_px[1]},
                                       .display_px = {head->display_px[0], head->display_px[1]}};
    enum neph_status status = neph_image_set_window(image, &window, diag);
    if (!status && isfinite(head->frames_per_second) && head->frames_per_second > 0.0)
        status = neph_image_set_attribute(image, "frames_per_second", diag, "%.15g",
                                          head->frames_per_second);
    return status;
}

enum neph_status neph_oiio_image(const char *path, const void *bytes, size_t size,
                                 struct neph_image **image, struct neph_diag *diag)
{
    struct stream found = {.path = path, .bytes = bytes, .size = size};
    const struct stream *stream = &found;
    bool is_srgb = false;
    struct neph_image *made = NULL;
    enum neph_status status = find_parts(&found, diag);
    if (!status)
        status = find_encoding(stream, &is_srgb, diag);
    if (!status)
        status = neph_image_create(stream->head.data_px[0], stream->head.data_px[1], &made, diag);
    if (!status)
        status = add_channels(stream, made, diag);
    if (!status)
        status = add_labels(&stream->head, made, diag);
    if (!status && is_srgb)
        status = decode_srgb(stream, made, diag);
    if (status)
        neph_image_destroy(made);
    else
        *image = made;
    return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

static struct neph_oiio_request make_request(const char *path, int part, uint64_t file_bytes)
{
    const double memory_bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 2;
    const double cpu_s = cpu_start_s + (double)file_bytes / bytes_per_s;
    struct neph_oiio_request request = {.part = part,
                                        .side_max_px = NEPH_IMAGE_SIDE_MAX_PX,
                                        .cpu_limit_s = (uint32_t)fmin(cpu_s, 1e8),
                                        .wall_limit_s = (uint32_t)fmin(wall_per_cpu * cpu_s, 1e8),
                                        .memory_limit_bytes = (uint64_t)memory_bytes};
    snprintf(request.path, sizeof(request.path), "%s", path);
    return request;
}

/* Run neph-image on a part of a file (-1: the only one). `server` NULL: a process for this file. */
static enum neph_status run(struct neph_oiio_server *server, const char *path, int part,
                            uint64_t file_bytes, const struct neph_shared *memory,
                            struct neph_diag *diag)
{
    const struct neph_oiio_request request = make_request(path, part, file_bytes);
    struct neph_oiio_server *own = NULL;
    enum neph_status status = server ? NEPH_OK : neph_oiio_server_create(&own, diag);
    if (!status)
        status = neph_oiio_server_read(server ? server : own, &request, memory, diag);
    neph_oiio_server_destroy(own);
    if (status)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

static enum neph_status run_and_map(struct neph_oiio_server *server, const char *path, int part,
                                    struct neph_shared *memory, const void **bytes, size_t *size,
                                    struct neph_diag *diag)
{
    uint64_t file_bytes = 0;
    int fd;
    *memory = (struct neph_shared){.fd = -1};
    enum neph_status status = neph_file_open(path, &fd, &file_bytes, diag);
    if (status)
        return status;
    status = neph_whole_check(path, fd, file_bytes, diag);
    close(fd);
    if (!status)
        status = neph_shared_create("neph-image", memory, diag);
    if (!status)
        status = run(server, path, part, file_bytes, memory, diag);
    return status ? status : neph_shared_map(memory, bytes, size, diag);
}

static void unmap(struct neph_shared *memory, const void *bytes, size_t size)
{
    if (bytes)
        munmap((void *)bytes, size);
    neph_shared_destroy(memory);
}

enum neph_status neph_oiio_read_part(const char *path, const char *part,
                                     struct neph_oiio_server *server, struct neph_image **image,
                                     struct neph_diag *diag)
{
    struct neph_shared memory;
    const void *bytes = NULL;
    size_t size = 0;
    const bool is_number = part && part[0] && part[strspn(part, "0123456789")] == '\0';
    const double number = is_number ? strtod(part, NULL) : -1.0;
    if (part && (!is_number || number > INT_MAX))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "'%s' has no part '%s': its images are numbered from 0", path, part);
    enum neph_status status = run_and_map(server, path, (int)number, &memory, &bytes, &size, diag);
    if (!status)
        status = neph_oiio_image(path, bytes, size, image, diag);
    unmap(&memory, bytes, size);
    return status;
}

/* Copy the channel of that name. */
static bool copy_channel(const struct stream *stream, const struct neph_channel *channel,
                         size_t count)
{
    for (int c = 0; c < stream->head.channel_count; c++) {
        char *name = neph_text_clean_copy(stream->names + (size_t)c * NEPH_OIIO_NAME_BYTES);
        const bool is_same = name && strcmp(name, channel->name) == 0;
        free(name);
        if (!is_same)
            continue;
        memcpy(channel->samples, stream->samples + (size_t)c * count * sizeof(float),
               count * sizeof(float));
        return true;
    }
    return false;
}

enum neph_status neph_oiio_fill(const char *path, int part, struct neph_oiio_server *server,
                                struct neph_image *image, struct neph_diag *diag)
{
    struct stream stream = {.path = path};
    struct neph_shared memory;
    enum neph_status status = run_and_map(server, path, part, &memory, &stream.bytes, &stream.size,
                                          diag);
    if (!status)
        status = find_parts(&stream, diag);
    bool is_whole = !status && stream.head.data_px[0] == image->width_px &&
                    stream.head.data_px[1] == image->height_px;
    for (int c = 0; c < image->channel_count && is_whole; c++)
        is_whole = copy_channel(&stream, &image->channels[c], neph_image_pixel_count(image));
    if (!status && !is_whole)
        status = fail_nonsense(&stream, diag);
    unmap(&memory, stream.bytes, stream.size);
    return status;
}

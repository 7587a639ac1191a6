/* SPDX-License-Identifier: MIT */
#include "harness/compare/frame.h"

#include "base/colour_convert.h"
#include "base/colour_names.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/oiio.h"
#include "base/png.h"
#include "metrics/validity.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A PNG has no parts. */
static enum neph_status read_png(const char *path, const char *part,
                                 struct neph_oiio_server *server, struct neph_image **image,
                                 struct neph_diag *diag)
{
    (void)part;
    (void)server;
    return neph_png_read_image(path, image, diag);
}

static const struct format {
    const char *name;
    unsigned char magic[4]; /* first bytes of every file */
    enum neph_status (*read)(const char *path, const char *part, struct neph_oiio_server *server,
                             struct neph_image **image, struct neph_diag *diag);
} formats[] = {
    {"OpenEXR", {0x76, 0x2f, 0x31, 0x01}, neph_exr_read_part},
    {"PNG", {0x89, 'P', 'N', 'G'}, read_png},
};

static const struct format by_openimageio = {"others", {0}, neph_oiio_read_part};

static enum neph_status find_format(const char *path, const struct format **format,
                                    struct neph_diag *diag)
{
    unsigned char head[16] = {0};
    int fd;
    const enum neph_status status = neph_file_open(path, &fd, NULL, diag);
    if (status)
        return status;
    const ssize_t got = pread(fd, head, sizeof(head), 0);
    const int error = errno;
    close(fd);
    if (got < 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot read '%s': %s", path, strerror(error));
    for (size_t i = 0; i < sizeof(formats) / sizeof(formats[0]); i++)
        if (memcmp(head, formats[i].magic, sizeof(formats[i].magic)) == 0) {
            *format = &formats[i];
            return NEPH_OK;
        }
    if (neph_oiio_format(head, (size_t)got)) {
        *format = &by_openimageio;
        return NEPH_OK;
    }
    neph_fail(diag, NEPH_ERR_INPUT,
              "'%s' is no image: EXR, PNG, TIFF, HDR, PFM, PPM, JPEG, WebP and DPX are read", path);
    neph_hint(diag, got < 4 ? "it is empty or cut short" : "convert it to EXR or PNG");
    return NEPH_ERR_INPUT;
}

/* Read the image of a file, or a frame of a file with several. */
static enum neph_status read_image(const char *path, const struct neph_frame_choice *choice,
                                   struct neph_image **image, struct neph_diag *diag)
{
    struct neph_clips alone = {.used = 0};
    struct neph_path file;
    const struct format *format = NULL;
    int frame;
    if (!neph_clip_split(path, &file, &frame)) {
        const enum neph_status status = find_format(path, &format, diag);
        return status ? status
                      : format->read(path, choice ? choice->part : NULL,
                                     choice ? choice->server : NULL, image, diag);
    }
    const enum neph_status status = neph_clips_read(
        choice && choice->clips ? choice->clips : &alone, path, image, diag);
    neph_clips_close(&alone);
    return status;
}

static enum neph_status check(const char *path, const struct neph_image *image,
                              size_t negative_allowed, struct neph_diag *diag)
{
    struct neph_validity validity = {0};
    enum neph_status status = neph_validity_count(image, &validity, diag);
    for (int i = 0; i < validity.channel_count; i++) { /* values of unknown channels are not
                                                          checked */
        struct neph_validity_channel *channel = &validity.channels[i];
        if (neph_validity_has_rule(channel->name))
            continue;
        validity.non_finite_count -= channel->non_finite_count;
        channel->non_finite_count = 0;
    }
    if (!status)
        status = neph_validity_gate(&validity, negative_allowed, diag);
    if (status == NEPH_ERR_GATE) {
        neph_prefix(diag, "'%s': ", path);
        neph_hint(diag, validity.non_finite_count > 0
                            ? "such a frame is no measurement"
                            : "if a filter with negative lobes made them, say --negative-ok");
    }
    neph_validity_finish(&validity);
    return status;
}

/* Remove unknown channels that contain NaN or infinite values. */
static void remove_nonfinite_channels(struct neph_image *image)
{
    const size_t count = neph_image_pixel_count(image);
    for (int i = image->channel_count - 1; i >= 0; i--) {
        const struct neph_channel *channel = &image->channels[i];
        size_t k = neph_validity_has_rule(channel->name) ? count : 0;
        while (k < count && isfinite(channel->samples[k]))
            k++;
        if (k < count)
            neph_image_remove_channel(image, channel->name);
    }
}

static bool has_any(const struct neph_image *image, const char *const *names, int count)
{
    for (int i = 0; i < count; i++)
        if (neph_image_channel(image, names[i]))
            return true;
    return false;
}

static bool has_channel(const void *context, const char *name)
{
    return neph_image_channel(context, name) != NULL;
}

static const struct neph_colour_names *find_colour_names(const struct neph_image *image)
{
    const struct neph_colour_names *names = NULL;
    for (int i = 0; (names = neph_colour_names_at(i)) != NULL; i++)
        if (neph_colour_names_fit(names, has_channel, image))
            break;
    return names;
}

static const char *const rgb_names[] = {"R", "G", "B"};

static void rename_channel(struct neph_image *image, const char *from, const char *to)
{
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, from) == 0)
            snprintf(image->channels[i].name, sizeof(image->channels[i].name), "%s", to);
}

/* Give a colour of other names (base/colour_names.h) the names R, G and B. */
static void rename_colours(struct neph_image *image)
{
    const struct neph_colour_names *names = find_colour_names(image);
    for (int c = 0; names && !names->is_grey && c < 3; c++) {
        if (strcmp(names->names[c], rgb_names[c]) == 0)
            continue;
        neph_image_remove_channel(image, rgb_names[c]);
        rename_channel(image, names->names[c], rgb_names[c]);
    }
}

/* Copy a grey channel to those of R, G and B that are missing. */
static enum neph_status make_grey_rgb(struct neph_image *image, struct neph_diag *diag)
{
    const struct neph_colour_names *names = find_colour_names(image);
    enum neph_status status = NEPH_OK;
    for (int c = 0; names && names->is_grey && c < 3 && !status; c++) {
        float *samples;
        if (neph_image_channel(image, rgb_names[c]))
            continue;
        status = neph_image_add_channel(image, rgb_names[c], &samples, diag);
        if (!status)
            memcpy(samples, neph_image_channel(image, names->names[0]),
                   neph_image_pixel_count(image) * sizeof(*samples));
    }
    return status;
}

static bool is_in_layer(const char *name, const char *layer)
{
    const size_t length = strlen(layer);
    return strncmp(name, layer, length) == 0 && name[length] == '.';
}

/* Remove the colours without a layer prefix first, so that they cannot replace a colour that the
 * layer lacks. */
static enum neph_status take_layer(const char *path, struct neph_image *image, const char *layer,
                                   struct neph_diag *diag)
{
    static const char *const others[] = {"A", "X"};
    const struct neph_colour_names *names;
    for (size_t c = 0; c < sizeof(others) / sizeof(others[0]); c++)
        neph_image_remove_channel(image, others[c]);
    for (int i = 0; (names = neph_colour_names_at(i)) != NULL; i++)
        for (int c = 0; c < 3; c++)
            if (!is_in_layer(names->names[c], layer))
                neph_image_remove_channel(image, names->names[c]);
    enum neph_status status = neph_image_take_layer(image, layer, diag);
    if (status && diag)
        neph_locate(diag, path, 0, 0);
    return status;
}

/* The name of the chosen depth while layers and vectors are renamed. */
static const char set_aside[] = "neph depth";

static void set_depth_aside(struct neph_image *image, const char *name)
{
    if (name)
        rename_channel(image, name, set_aside);
}

static void list_channels(const struct neph_image *image, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int c = 0; c < image->channel_count && used < size; c++)
        used += (size_t)snprintf(text + used, size - used, " %s", image->channels[c].name);
}

static enum neph_status take_depth(const char *path, struct neph_image *image, const char *name,
                                   struct neph_diag *diag)
{
    char names[300];
    if (!name || (!neph_image_channel(image, set_aside) && neph_image_channel(image, "Z")))
        return NEPH_OK;
    if (neph_image_channel(image, set_aside)) {
        neph_image_remove_channel(image, "Z");
        rename_channel(image, set_aside, "Z");
        return NEPH_OK;
    }
    list_channels(image, names, sizeof(names));
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' has no channel '%s' for the depth, and no Z", path, name);
    neph_hint(diag, "its channels are%s", names);
    return NEPH_ERR_INPUT;
}

static enum neph_status check_primaries(const char *path, const struct neph_image *image,
                                        bool is_converted, struct neph_diag *diag)
{
    static const char *const colours[] = {"R", "G", "B", "Y"};
    const char *primaries = neph_image_attribute(image, "primaries");
    if (!primaries || is_converted || !has_any(image, colours, 4))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not in Rec.709: its chromaticities are %s", path,
              primaries);
    neph_hint(diag, "--convert converts it to linear Rec.709, white D65, which luminance and all "
                    "images assume");
    return NEPH_ERR_INPUT;
}

static enum neph_status convert(const char *path, struct neph_image *image,
                                const struct neph_colour_source *colours, struct neph_diag *diag)
{
    float *rgb[3];
    const enum neph_status status = neph_image_rgb(image, NULL, rgb)
                                        ? neph_colour_convert(image, colours, diag)
                                        : NEPH_OK;
    if (status)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

/* X Y Z together are one vector or one colour: then Z is not depth, and Y is not a grey image. A
 * colour that is to be converted is CIE XYZ with white D65, unless the file names another space. */
static enum neph_status set_vector_aside(const char *path, struct neph_image *image,
                                         bool is_converted, struct neph_diag *diag)
{
    static const char *const vector[] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; c++)
        if (!neph_image_channel(image, vector[c]))
            return NEPH_OK;
    if (!has_any(image, rgb_names, 3) && is_converted) {
        for (int c = 0; c < 3; c++)
            rename_channel(image, vector[c], rgb_names[c]);
        return neph_image_attribute(image, "colour_space")
                   ? NEPH_OK
                   : neph_image_set_attribute(image, "colour_space", diag, "lin_ciexyzd65_scene");
    }
    if (!has_any(image, rgb_names, 3)) {
        neph_fail(diag, NEPH_ERR_INPUT,
                  "'%s' has channels X Y Z and no R G B: CIE XYZ, or a vector, is neither radiance "
                  "nor depth",
                  path);
        neph_hint(diag, "--convert takes it for CIE XYZ with white D65 and converts it to linear "
                        "Rec.709; depth is a Z without X and Y");
        return NEPH_ERR_INPUT;
    }
    for (int i = 0; i < image->channel_count; i++)
        for (int c = 0; c < 3; c++)
            if (strcmp(image->channels[i].name, vector[c]) == 0)
                snprintf(image->channels[i].name, NEPH_IMAGE_NAME_MAX, "vector.%s", vector[c]);
    return NEPH_OK;
}

/* Convert the depths that renderers write for rays without a hit to infinity. No real surface has
 * exactly one of these depths: 0 (Mitsuba's aov integrator; nothing visible is at the eye), the
 * largest half and the largest 16-bit integer (clamped larger values), and 1e9. Blender's sky is at
 * 1e10; no scene uses units that small. NaN is unchanged. */
static void mark_sky(struct neph_image *image)
{
    static const float skies[] = {0.0f, 65504.0f, 65535.0f, 1e9f}, far = 1e10f;
    float *depth = neph_image_channel(image, "Z");
    for (size_t i = 0; depth && i < neph_image_pixel_count(image); i++) {
        bool is_sky = depth[i] >= far;
        for (size_t s = 0; s < sizeof(skies) / sizeof(skies[0]); s++)
            is_sky |= depth[i] == skies[s];
        depth[i] = is_sky ? INFINITY : depth[i];
    }
}

double neph_frame_rate_hz(const struct neph_image *image)
{
    static const char *const names[] = {NEPH_FRAME_RATE_ATTRIBUTE, "frames_per_second"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        const char *text = neph_image_attribute(image, names[i]);
        const double rate_hz = text ? strtod(text, NULL) : 0.0;
        if (isfinite(rate_hz) && rate_hz > 0.0)
            return rate_hz;
    }
    return NAN;
}

/* Give an image the channels of a frame, and check it. The image is consumed. */
static enum neph_status interpret(const char *path, struct neph_image *frame,
                                  const struct neph_frame_choice *choice, size_t negative_allowed,
                                  struct neph_image **image, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (choice)
        set_depth_aside(frame, choice->depth);
    if (choice && choice->layer)
        status = take_layer(path, frame, choice->layer, diag);
    if (!status)
        rename_colours(frame);
    if (!status)
        status = set_vector_aside(path, frame, choice && choice->convert, diag);
    if (!status)
        status = make_grey_rgb(frame, diag);
    if (!status && choice)
        status = take_depth(path, frame, choice->depth, diag);
    if (!status)
        status = check_primaries(path, frame, choice && choice->convert, diag);
    const char *display = status ? NULL : neph_image_attribute(frame, NEPH_DISPLAY_ATTRIBUTE);
    if (display) /* written by `neph post` for a display */
        status = neph_image_set_attribute(frame, "encoding", diag, "%s", display);
    if (!status)
        status = check(path, frame, negative_allowed, diag);
    if (!status && choice && choice->convert)
        status = convert(path, frame, choice->colours, diag);
    if (status)
        neph_image_destroy(frame);
    else
        *image = frame;
    return status;
}

enum neph_status neph_frame_read_as_written(const char *path,
                                            const struct neph_frame_choice *choice,
                                            size_t negative_allowed, struct neph_image **image,
                                            struct neph_diag *diag)
{
    struct neph_image *read = NULL;
    const enum neph_status status = read_image(path, choice, &read, diag);
    return status ? status : interpret(path, read, choice, negative_allowed, image, diag);
}

/* Values outside the data window: black, and without an object or a medium. */
static float value_outside(const char *channel)
{
    static const struct {
        const char *start; /* of the name; a layer ends with a dot */
        float value;
    } values[] = {
        {"Z", INFINITY},
        {"motion.depth", INFINITY},
        {"volume.distance", INFINITY},
        {"transmittance.", 1.0f},
    };
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
        const char *start = values[i].start;
        const size_t length = strlen(start);
        if (strncmp(channel, start, length) == 0 &&
            (start[length - 1] == '.' || channel[length] == '\0'))
            return values[i].value;
    }
    return 0.0f;
}

static enum neph_status place(const char *path, const struct neph_window *window,
                              struct neph_image *image, struct neph_diag *diag)
{
    const enum neph_status status = neph_image_place(image, window, value_outside, diag);
    if (status)
        neph_prefix(diag, "'%s': ", path);
    return status;
}

enum neph_status neph_frame_make(const char *path, struct neph_image *image,
                                 const struct neph_frame_choice *choice, size_t negative_allowed,
                                 struct neph_image **frame, struct neph_diag *diag)
{
    struct neph_image *made = NULL;
    enum neph_status status = interpret(path, image, choice, negative_allowed, &made, diag);
    if (status)
        return status;
    remove_nonfinite_channels(made);
    mark_sky(made);
    if (choice && choice->window.size_px[0] > 0)
        status = place(path, &choice->window, made, diag);
    if (status)
        neph_image_destroy(made);
    else
        *frame = made;
    return status;
}

enum neph_status neph_frame_read(const char *path, const struct neph_frame_choice *choice,
                                 size_t negative_allowed, struct neph_image **image,
                                 struct neph_diag *diag)
{
    struct neph_image *read = NULL;
    const enum neph_status status = read_image(path, choice, &read, diag);
    return status ? status : neph_frame_make(path, read, choice, negative_allowed, image, diag);
}

enum neph_status neph_frame_read_mask(const char *path, const struct neph_frame_choice *choice,
                                      struct neph_image **image, struct neph_diag *diag)
{
    const struct neph_frame_choice as_written = {.part = choice->part, .server = choice->server};
    struct neph_image *mask = NULL;
    enum neph_status status = neph_frame_read(path, &as_written, SIZE_MAX, &mask, diag);
    if (status)
        return status;
    const struct neph_window window = neph_image_window(mask), *wanted = &choice->window;
    if (wanted->size_px[0] > 0 && window.display_px[0] == wanted->display_px[0] &&
        window.display_px[1] == wanted->display_px[1])
        status = place(path, wanted, mask, diag);
    if (status)
        neph_image_destroy(mask);
    else
        *image = mask;
    return status;
}

/* ---- files as a source ----------------------------------------------------------------------- */

static enum neph_status read_file(const void *context, const char *path,
                                  const struct neph_frame_choice *choice, size_t negative_allowed,
                                  struct neph_image **image, struct neph_diag *diag)
{
    (void)context;
    return neph_frame_read(path, choice, negative_allowed, image, diag);
}

static enum neph_status read_mask_file(const void *context, const char *path,
                                       const struct neph_frame_choice *choice,
                                       struct neph_image **image, struct neph_diag *diag)
{
    (void)context;
    return neph_frame_read_mask(path, choice, image, diag);
}

const struct neph_frame_source neph_frame_files = {.read = read_file, .read_mask = read_mask_file};

/* SPDX-License-Identifier: MIT */
#include "base/image.h"

#include "base/heap.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum neph_status neph_image_create(int width_px, int height_px, struct neph_image **image,
                                   struct neph_diag *diag)
{
    if (width_px < 1 || height_px < 1 || width_px > NEPH_IMAGE_SIDE_MAX_PX ||
        height_px > NEPH_IMAGE_SIDE_MAX_PX)
        return neph_fail(diag, NEPH_ERR_INPUT, "image size %dx%d is outside 1..%d", width_px,
                         height_px, NEPH_IMAGE_SIDE_MAX_PX);
    struct neph_image *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    created->width_px = width_px;
    created->height_px = height_px;
    *image = created;
    return NEPH_OK;
}

void neph_image_destroy(struct neph_image *image)
{
    if (!image)
        return;
    for (int i = 0; i < image->channel_count; i++)
        free(image->channels[i].samples);
    for (int i = 0; i < image->attribute_count; i++)
        free(image->attributes[i].value);
    free(image->channels);
    free(image->attributes);
    if (image->header)
        free(image->header->attributes);
    free(image->header);
    free(image);
}

/* Planes are touched before they are read from a file, except beyond 1 GiB: a damaged file may
 * claim hundreds of channels. */
static float *allocate_samples(const struct neph_image *image)
{
    const size_t count = neph_image_pixel_count(image), limit = ((size_t)1 << 30) / sizeof(float);
    return count * ((size_t)image->channel_count + 1) <= limit
               ? neph_allocate_plane(count, sizeof(float))
               : calloc(count, sizeof(float));
}

enum neph_status neph_image_add_channel(struct neph_image *image, const char *name, float **samples,
                                        struct neph_diag *diag)
{
    if (strlen(name) >= NEPH_IMAGE_NAME_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "channel name '%s' is longer than %d bytes", name,
                         NEPH_IMAGE_NAME_MAX - 1);
    if (neph_image_channel(image, name))
        return neph_fail(diag, NEPH_ERR_INPUT, "the image already has a channel '%s'", name);
    size_t count = (size_t)image->channel_count + 1;
    struct neph_channel *grown = realloc(image->channels, count * sizeof(*grown));
    if (!grown)
        return neph_fail_memory(diag);
    image->channels = grown;
    struct neph_channel *channel = &grown[count - 1];
    channel->samples = allocate_samples(image);
    if (!channel->samples)
        return neph_fail_memory(diag);
    snprintf(channel->name, sizeof(channel->name), "%s", name);
    image->channel_count++;
    if (samples)
        *samples = channel->samples;
    return NEPH_OK;
}

static void format_channel_name(char name[NEPH_IMAGE_NAME_MAX], const char *layer, int component)
{
    const char letter = "RGB"[component];
    if (layer)
        snprintf(name, NEPH_IMAGE_NAME_MAX, "%s.%c", layer, letter);
    else
        snprintf(name, NEPH_IMAGE_NAME_MAX, "%c", letter);
}

enum neph_status neph_image_add_rgb(struct neph_image *image, const char *layer, float *samples[3],
                                    struct neph_diag *diag)
{
    for (int c = 0; c < 3; c++) {
        char name[NEPH_IMAGE_NAME_MAX];
        format_channel_name(name, layer, c);
        enum neph_status status = neph_image_add_channel(image, name, &samples[c], diag);
        if (status)
            return status;
    }
    return NEPH_OK;
}

/* The part of a channel name behind "<layer>.", or NULL when the channel is not of that layer. */
static const char *get_name_in_layer(const char *name, const char *layer)
{
    const size_t length = strlen(layer);
    return strncmp(name, layer, length) == 0 && name[length] == '.' ? name + length + 1 : NULL;
}

static enum neph_status fail_no_layer(const struct neph_image *image, const char *layer,
                                      struct neph_diag *diag)
{
    char known[256] = "";
    const char *last = "";
    size_t last_length = 0, used = 0;
    for (int i = 0; i < image->channel_count; i++) {
        const char *name = image->channels[i].name, *dot = strrchr(name, '.');
        const size_t length = dot ? (size_t)(dot - name) : 0;
        if (!dot || (length == last_length && strncmp(name, last, length) == 0))
            continue;
        last = name;
        last_length = length;
        if (used < sizeof(known))
            used += (size_t)snprintf(known + used, sizeof(known) - used, " %.*s", (int)length,
                                     name);
    }
    return neph_fail(diag, NEPH_ERR_INPUT, "there is no layer '%s'; the layers are:%s", layer,
                     known[0] ? known : " none");
}

void neph_image_remove_channel(struct neph_image *image, const char *name)
{
    for (int i = 0; i < image->channel_count; i++) {
        if (strcmp(image->channels[i].name, name) != 0)
            continue;
        free(image->channels[i].samples);
        image->channels[i] = image->channels[--image->channel_count];
        return;
    }
}

enum neph_status neph_image_take_layer(struct neph_image *image, const char *layer,
                                       struct neph_diag *diag)
{
    char names[64][NEPH_IMAGE_NAME_MAX];
    int count = 0;
    for (int i = 0; i < image->channel_count && count < 64; i++)
        if (get_name_in_layer(image->channels[i].name, layer))
            memcpy(names[count++], image->channels[i].name, NEPH_IMAGE_NAME_MAX);
    if (count == 0)
        return fail_no_layer(image, layer, diag);
    for (int n = 0; n < count; n++) {
        char rest[NEPH_IMAGE_NAME_MAX];
        snprintf(rest, sizeof(rest), "%s", get_name_in_layer(names[n], layer));
        neph_image_remove_channel(image, rest);
        for (int i = 0; i < image->channel_count; i++)
            if (strcmp(image->channels[i].name, names[n]) == 0)
                memcpy(image->channels[i].name, rest, sizeof(rest));
    }
    return NEPH_OK;
}

float *neph_image_channel(const struct neph_image *image, const char *name)
{
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0)
            return image->channels[i].samples;
    return NULL;
}

bool neph_image_rgb(const struct neph_image *image, const char *layer, float *samples[3])
{
    for (int c = 0; c < 3; c++) {
        char name[NEPH_IMAGE_NAME_MAX];
        format_channel_name(name, layer, c);
        samples[c] = neph_image_channel(image, name);
        if (!samples[c])
            return false;
    }
    return true;
}

static struct neph_attribute *find_attribute(const struct neph_image *image, const char *name)
{
    for (int i = 0; i < image->attribute_count; i++)
        if (strcmp(image->attributes[i].name, name) == 0)
            return &image->attributes[i];
    return NULL;
}

enum neph_status neph_image_set_attribute(struct neph_image *image, const char *name,
                                          struct neph_diag *diag, const char *format, ...)
{
    char *value = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&value, format, arguments);
    va_end(arguments);
    if (length < 0)
        return neph_fail_memory(diag);

    struct neph_attribute *attribute = find_attribute(image, name);
    if (attribute) {
        free(attribute->value);
        attribute->value = value;
        return NEPH_OK;
    }
    size_t count = (size_t)image->attribute_count + 1;
    struct neph_attribute *grown = realloc(image->attributes, count * sizeof(*grown));
    if (!grown) {
        free(value);
        return neph_fail_memory(diag);
    }
    image->attributes = grown;
    snprintf(grown[count - 1].name, NEPH_IMAGE_NAME_MAX, "%s", name);
    grown[count - 1].value = value;
    image->attribute_count++;
    return NEPH_OK;
}

const char *neph_image_attribute(const struct neph_image *image, const char *name)
{
    const struct neph_attribute *attribute = find_attribute(image, name);
    return attribute ? attribute->value : NULL;
}

void neph_image_remove_attribute(struct neph_image *image, const char *name)
{
    struct neph_attribute *attribute = find_attribute(image, name);
    if (!attribute)
        return;
    free(attribute->value);
    *attribute = image->attributes[--image->attribute_count];
}

/* ---- attributes and header of a file --------------------------------------------------------- */

/* Scale a position or length from an image of `from_px` pixels to one of `to_px`; false: no whole
 * number. */
static bool scale(int32_t *value_px, int from_px, int to_px)
{
    const int64_t scaled = (int64_t)*value_px * to_px;
    if (scaled % from_px != 0 || scaled / from_px > INT32_MAX || scaled / from_px < INT32_MIN)
        return false;
    *value_px = (int32_t)(scaled / from_px);
    return true;
}

static bool is_crop(const struct neph_image *image)
{
    const struct neph_file_header *header = image->header;
    return header->data_min_px[0] != header->display_min_px[0] ||
           header->data_min_px[1] != header->display_min_px[1] ||
           header->display_px[0] != image->width_px || header->display_px[1] != image->height_px;
}

static enum neph_status scale_windows(const struct neph_image *from, struct neph_image *to,
                                      struct neph_diag *diag)
{
    const int from_px[2] = {from->width_px, from->height_px},
              to_px[2] = {to->width_px, to->height_px};
    struct neph_file_header *header = to->header;
    bool fits = true;
    for (int axis = 0; axis < 2; axis++) {
        if (!is_crop(from)) {
            header->display_px[axis] = to_px[axis];
            continue;
        }
        fits &= scale(&header->data_min_px[axis], from_px[axis], to_px[axis]);
        fits &= scale(&header->display_min_px[axis], from_px[axis], to_px[axis]);
        fits &= scale(&header->display_px[axis], from_px[axis], to_px[axis]);
    }
    if (fits)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT,
              "a data window scaled from %dx%d to %dx%d pixels would not lie on whole pixels of "
              "its display window",
              from_px[0], from_px[1], to_px[0], to_px[1]);
    neph_hint(diag, "write a data window that is equal to the display window");
    return NEPH_ERR_INPUT;
}

static enum neph_status copy_header(const struct neph_image *from, struct neph_image *to,
                                    struct neph_diag *diag)
{
    struct neph_file_header *header = malloc(sizeof(*header));
    char *attributes = malloc(from->header->attribute_bytes + 1);
    if (!header || !attributes) {
        free(header);
        free(attributes);
        return neph_fail_memory(diag);
    }
    *header = *from->header;
    header->attributes = attributes;
    if (header->attribute_bytes > 0)
        memcpy(attributes, from->header->attributes, header->attribute_bytes);
    to->header = header;
    return scale_windows(from, to, diag);
}

enum neph_status neph_image_copy_labels(const struct neph_image *from, struct neph_image *to,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < from->attribute_count && !status; i++)
        status = neph_image_set_attribute(to, from->attributes[i].name, diag, "%s",
                                          from->attributes[i].value);
    return status || !from->header ? status : copy_header(from, to, diag);
}

/* SPDX-License-Identifier: MIT
 *
 * A float image: named planar channels of 32-bit floats, row 0 on top, and text attributes.
 *
 * A frame (the output of every engine) has the channels
 *
 *   R G B                        radiance of everything, scene-linear Rec.709 [W m^-2 sr^-1]
 *   volume.R volume.G volume.B   radiance that media scatter or emit
 *   transmittance.R .G .B        from the camera to the first solid or to infinity [1]
 *   Z                            linear eye depth along the camera axis [m], sky = +inf
 *
 * and may have further ones:
 *
 *   motion.x motion.y            previous minus current screen position of the visible point [px],
 *                                x to the right, y down; 1e6 where it was on no screen: behind the
 *                                camera, or before a cut
 *   motion.depth                 linear eye depth of that point in the previous frame [m],
 *                                sky = +inf, 0 where it was behind the camera or before a cut
 *   volume.distance              mean distance of the visible medium, weighted by contribution [m]
 *   normal.x normal.y normal.z   of the visible surface: unit, outward, in world axes; sky 0
 *   mask.NAME                    a mask of the scene, above 0.5 inside; NAME: cloud, fog, sun
 *
 * A channel that an engine cannot compute is absent; it is never filled with a substitute.
 */
#ifndef NEPH_BASE_IMAGE_H
#define NEPH_BASE_IMAGE_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define NEPH_IMAGE_NAME_MAX 256 /* OpenEXR names have at most 255 bytes */
#define NEPH_IMAGE_SIDE_MAX_PX 16384

struct neph_channel {
    char name[NEPH_IMAGE_NAME_MAX];
    float *samples; /* width * height, row-major; owned by the image */
};

struct neph_attribute {
    char name[NEPH_IMAGE_NAME_MAX];
    char *value; /* owned by the image */
};

/* The parts of an EXR header beside channels and texts, kept for writing the image again. */
struct neph_file_header {
    int32_t data_min_px[2];                   /* corner of the data window; its size is the image's
                                               */
    int32_t display_min_px[2], display_px[2]; /* display window: corner and size */
    float pixel_aspect, screen_center[2], screen_width;
    char *attributes; /* attributes that are not texts, as raw bytes of the file; owned */
    size_t attribute_bytes;
};

struct neph_image {
    int width_px, height_px;
    int channel_count;
    struct neph_channel *channels;
    int attribute_count;
    struct neph_attribute *attributes;
    struct neph_file_header *header; /* owned; NULL: data window and display window are the image,
                                        no attributes */
};

/* An image without channels. Sides must be 1..NEPH_IMAGE_SIDE_MAX_PX. Free with _destroy. */
enum neph_status neph_image_create(int width_px, int height_px, struct neph_image **image,
                                   struct neph_diag *diag);

/* NULL is fine. */
void neph_image_destroy(struct neph_image *image);

/* Add a channel, all zero; `*samples` points into the image. A duplicate name is an error. */
enum neph_status neph_image_add_channel(struct neph_image *image, const char *name, float **samples,
                                        struct neph_diag *diag);

/* Add the three channels "<layer>.R/G/B", or "R/G/B" when layer is NULL. */
enum neph_status neph_image_add_rgb(struct neph_image *image, const char *layer, float *samples[3],
                                    struct neph_diag *diag);

/* Remove a channel; a missing one is fine. */
void neph_image_remove_channel(struct neph_image *image, const char *name);

/* Rename the channels "<layer>.NAME" to NAME, in place of existing channels of that name; all
 * others stay. NEPH_ERR_INPUT: the image has no channel of that layer; the message lists the
 * layers. */
enum neph_status neph_image_take_layer(struct neph_image *image, const char *layer,
                                       struct neph_diag *diag);

/* The samples of a channel, or NULL when no channel has that name. */
float *neph_image_channel(const struct neph_image *image, const char *name);

/* The three channels of a layer (NULL layer: R, G, B). False when any of them is missing. */
bool neph_image_rgb(const struct neph_image *image, const char *layer, float *samples[3]);

/* Set (or replace) a text attribute. */
enum neph_status neph_image_set_attribute(struct neph_image *image, const char *name,
                                          struct neph_diag *diag, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The value of an attribute, or NULL. */
const char *neph_image_attribute(const struct neph_image *image, const char *name);

/* Remove an attribute; a missing one is fine. */
void neph_image_remove_attribute(struct neph_image *image, const char *name);

/* Copy the texts and the file header. If `to` has another size, data window and display window are
 * scaled by the ratio of the sizes. NEPH_ERR_INPUT: the scaled windows do not lie on whole pixels.
 */
enum neph_status neph_image_copy_labels(const struct neph_image *from, struct neph_image *to,
                                        struct neph_diag *diag);

static inline size_t neph_image_pixel_count(const struct neph_image *image)
{
    return (size_t)image->width_px * (size_t)image->height_px;
}

#endif

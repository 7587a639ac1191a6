/* SPDX-License-Identifier: MIT
 *
 * A float image: named planar channels of 32-bit floats, row 0 on top, plus text attributes.
 *
 * A frame (the unit every engine writes) has the channels
 *   R G B                    radiance with everything, scene-linear Rec.709 [W m^-2 sr^-1]
 *   volume.R volume.G volume.B   radiance scattered or emitted by media alone
 *   transmittance.R .G .B    camera to the first solid or to infinity [1]
 *   Z                        linear eye depth along the camera axis [m], sky = +inf
 * and may have further ones:
 *   motion.x motion.y        where that which is seen here was in the frame before, minus where it
 *                            is now [px], x to the right, y down; 1e6 where it was in no picture:
 *                            behind the camera, or before a cut
 *   motion.depth             its linear eye depth in the frame before [m], sky = +inf, 0 where it
 *                            was behind the camera or before a cut
 *   volume.distance          distance of what the medium shows, weighted by its contribution [m]
 *   normal.x normal.y normal.z   of the surface in view: unit, outward, in the world's axes; sky 0
 *   mask.NAME                a mask of the scene, above 0.5 inside: mask.cloud, mask.fog, mask.sun
 * A layer that an engine cannot give is absent, never filled in.
 */
#ifndef NEPH_BASE_IMAGE_H
#define NEPH_BASE_IMAGE_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define NEPH_IMAGE_NAME_MAX 64
#define NEPH_IMAGE_SIDE_MAX_PX 16384

struct neph_channel {
    char name[NEPH_IMAGE_NAME_MAX];
    float *samples; /* width * height, row-major; owned by the image */
};

struct neph_attribute {
    char name[NEPH_IMAGE_NAME_MAX];
    char *value; /* owned by the image */
};

/* What an EXR file has beside channels and texts, for when the image is written again. */
struct neph_file_header {
    int32_t data_min_px[2];                   /* where the image lies; its size is the image's */
    int32_t display_min_px[2], display_px[2]; /* the whole picture: corner and size */
    float pixel_aspect, screen_center[2], screen_width;
    char *attributes; /* of other types than text, as they stand in the file; owned */
    size_t attribute_bytes;
};

struct neph_image {
    int width_px, height_px;
    int channel_count;
    struct neph_channel *channels;
    int attribute_count;
    struct neph_attribute *attributes;
    struct neph_file_header *header; /* owned; NULL: the image is the whole picture, and no more */
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

/* Remove a channel; one that is not there is fine. */
void neph_image_remove_channel(struct neph_image *image, const char *name);

/* Take the channels "<layer>.NAME" for NAME, in place of those that have that name; all others
 * stay. NEPH_ERR_INPUT: there is no channel of that layer; the message lists the layers. */
enum neph_status neph_image_take_layer(struct neph_image *image, const char *layer,
                                       struct neph_diag *diag);

/* The samples of a channel, or NULL when there is none of that name. */
float *neph_image_channel(const struct neph_image *image, const char *name);

/* The three channels of a layer (NULL layer: R, G, B). False when any of them is missing. */
bool neph_image_rgb(const struct neph_image *image, const char *layer, float *samples[3]);

/* Set (or replace) a text attribute. */
enum neph_status neph_image_set_attribute(struct neph_image *image, const char *name,
                                          struct neph_diag *diag, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The value of an attribute, or NULL. */
const char *neph_image_attribute(const struct neph_image *image, const char *name);

/* Copy texts and header of a file. An image of another size lies where the first lies in a picture
 * that is enlarged or made smaller with it. NEPH_ERR_INPUT: that is between pixels. */
enum neph_status neph_image_copy_labels(const struct neph_image *from, struct neph_image *to,
                                        struct neph_diag *diag);

static inline size_t neph_image_pixel_count(const struct neph_image *image)
{
    return (size_t)image->width_px * (size_t)image->height_px;
}

#endif

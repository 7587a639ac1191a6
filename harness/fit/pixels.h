/* SPDX-License-Identifier: MIT
 *
 * The pixels of a frame that a fit of its medium uses: a regular grid of them, with their rays.
 */
#ifndef NEPH_HARNESS_FIT_PIXELS_H
#define NEPH_HARNESS_FIT_PIXELS_H

#include "base/image.h"
#include "scenes/scene.h"

/* Quantities of a frame. */
enum neph_fit_quantity {
    NEPH_FIT_RADIANCE,
    NEPH_FIT_TRANSMITTANCE,
    NEPH_FIT_QUANTITY_COUNT,
};

/* Values of a pixel: three channels of each quantity. */
enum { NEPH_FIT_VALUES = NEPH_FIT_QUANTITY_COUNT * 3 };

/* Errors are estimated from tiles of the frame: the residuals of neighbours are not independent. */
enum { NEPH_FIT_TILES = 8, NEPH_FIT_TILE_COUNT = NEPH_FIT_TILES * NEPH_FIT_TILES };

struct neph_fit_pixel {
    struct neph_pixel_ray ray;
    int tile;
    /* Per quantity and channel: the value, and 1 / (mean of 5 x 5 pixels + mean of the frame); 0
     * where there is no value. */
    double values[NEPH_FIT_VALUES], weights[NEPH_FIT_VALUES];
};

/* What to take of the frame. */
struct neph_fit_source {
    const struct neph_scene *scene; /* of this frame: neph_scene_at() */
    const struct neph_image *image;
    const char *transmittance; /* a channel, or the layer of three; "A": 1 - alpha, where no solid
                                  is; NULL: the layer "transmittance", if there is one */
    int count;                 /* about as many pixels */
};

/* Start from {0}; free with neph_fit_pixels_finish(). */
struct neph_fit_pixels {
    struct neph_fit_pixel *list; /* owned */
    int count;
    int frame_count;                         /* of the frame */
    bool has[NEPH_FIT_QUANTITY_COUNT];       /* some value of it */
    int edge_count;                          /* left out: a solid's edge is in the pixel */
    bool has_depth;                          /* the frame has Z, and it was compared */
    int depth_count;                         /* left out: another depth than in the scene */
    bool depth_is_distance;                  /* along the ray, not along the camera's axis */
    double depth_factor;                     /* by which the frame's depths are larger; NaN: none */
    char transmittance[NEPH_IMAGE_NAME_MAX]; /* the layer or channel; "": none */
};

/* NEPH_ERR_INPUT: no such channel; a transmittance above 1; pixels that are not square; the depths
 * are not those of the scene. NEPH_ERR_UNSUPPORTED: fewer than 16 pixels are left, or all values
 * are 0. */
enum neph_status neph_fit_pixels_take(const struct neph_fit_source *source,
                                      struct neph_fit_pixels *pixels, struct neph_diag *diag);
void neph_fit_pixels_finish(struct neph_fit_pixels *pixels);

#endif

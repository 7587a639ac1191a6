/* SPDX-License-Identifier: MIT
 *
 * The sky on a Vulkan device: the tables of renderer/sky/ made by kernels, and pictures from them,
 * in float32. The tables of the air are made in 1 + 2 `orders` dispatches, that of views in one, a
 * picture in one for each million pixels.
 */
#ifndef NEPH_RENDERER_SKY_DEVICE_H
#define NEPH_RENDERER_SKY_DEVICE_H

#include "base/image.h"
#include "renderer/sky/sky.h"
#include "renderer/vulkan.h"

struct neph_sky_stats {
    /* Device time; NaN: it has no clock. Of the tables of the air, made once; of the table of
     * views, where there is one, and of the picture. */
    double tables_s, view_s, picture_s;
};

/* False, with the reason in words: what neph_sky_air_of() refuses, an orthographic camera, the
 * closure, more loop turns than a dispatch may hold. */
bool neph_sky_device_can(const struct neph_scene *scene, const struct neph_sky_params *params,
                         char *reason, size_t reason_size);

/* A picture of the scene: R G B, volume.*, transmittance.* and Z of base/image.h, no attributes.
 * NEPH_ERR_UNSUPPORTED: neph_sky_device_can() says no. */
enum neph_status neph_sky_device_render(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_sky_params *params, double frame,
                                        int width_px, int height_px, struct neph_image **image,
                                        struct neph_sky_stats *stats, struct neph_diag *diag);

#endif

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
#include "renderer/sky/sky_times.h"
#include "renderer/vulkan.h"

struct neph_sky_stats {
    struct neph_sky_times tables;
    double picture_s; /* device time of the picture behind them; NaN: it has no clock */
};

/* False, with the reason in words: what neph_sky_air_of() refuses, an orthographic camera, the
 * closure, more loop turns than a dispatch may hold. */
bool neph_sky_device_can(const struct neph_scene *scene, const struct neph_sky_params *params,
                         char *reason, size_t reason_size);

/* Pictures of one scene and size: tables of its air stay on the device. For _destroy, of which NULL
 * is fine. NEPH_ERR_UNSUPPORTED: neph_sky_device_can() says no. */
struct neph_sky_pictures;
enum neph_status neph_sky_pictures_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_sky_params *params, int width_px,
                                          int height_px, struct neph_sky_pictures **pictures,
                                          struct neph_diag *diag);
void neph_sky_pictures_destroy(struct neph_sky_pictures *pictures);

/* One picture of the scene, which may have another sun since: R G B, volume.*, transmittance.* and
 * Z of base/image.h, no attributes.
 *
 * `image` NULL: the picture is on its way when this returns, nothing comes back of it and `stats`
 * is left alone; up to NEPH_IN_FLIGHT_FRAMES of them are in flight. */
enum neph_status neph_sky_pictures_frame(struct neph_sky_pictures *pictures,
                                         const struct neph_scene *scene, double frame,
                                         struct neph_image **image, struct neph_sky_stats *stats,
                                         struct neph_diag *diag);

/* What the oldest picture in flight took, waited for. NEPH_ERR_USAGE: none is. */
enum neph_status neph_sky_pictures_home(struct neph_sky_pictures *pictures,
                                        struct neph_sky_stats *stats, struct neph_diag *diag);

#endif

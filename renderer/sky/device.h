/* SPDX-License-Identifier: MIT
 *
 * The sky on a Vulkan device: the tables of renderer/sky/, filled by kernels, and frames rendered
 * from them, in float32. Dispatches: 1 + 2 `orders` for the tables of the air, one for the table of
 * views, one per million pixels of a frame.
 */
#ifndef NEPH_RENDERER_SKY_DEVICE_H
#define NEPH_RENDERER_SKY_DEVICE_H

#include "base/image.h"
#include "renderer/sky/sky.h"
#include "renderer/sky/sky_times.h"
#include "renderer/vulkan.h"

struct neph_sky_stats {
    struct neph_sky_times tables;
    double picture_s; /* device time of the frame after the tables; NaN: no clock */
};

/* False, with the reason as text: scenes that neph_sky_read_air() refuses, an orthographic camera,
 * the closure, more loop iterations than a dispatch may have. */
bool neph_sky_device_can_render(const struct neph_scene *scene,
                                const struct neph_sky_params *params, char *reason,
                                size_t reason_size);

/* Frames of one scene and size; the tables of its air stay on the device. Free with _destroy; NULL
 * is fine there. NEPH_ERR_UNSUPPORTED: neph_sky_device_can_render() is false. */
struct neph_sky_frames;
enum neph_status neph_sky_frames_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_sky_params *params, int width_px,
                                        int height_px, struct neph_sky_frames **pictures,
                                        struct neph_diag *diag);
void neph_sky_frames_destroy(struct neph_sky_frames *pictures);

/* Render a frame of the scene, which may have another sun: R G B, volume.*, transmittance.* and Z
 * of base/image.h, no attributes.
 *
 * With `image` NULL the frame is only submitted: no image is returned and `stats` is unchanged. Up
 * to NEPH_IN_FLIGHT_FRAMES frames are in flight. */
enum neph_status neph_sky_frames_render(struct neph_sky_frames *pictures,
                                        const struct neph_scene *scene, double frame,
                                        struct neph_image **image, struct neph_sky_stats *stats,
                                        struct neph_diag *diag);

/* Wait for the oldest frame in flight and return its times. NEPH_ERR_USAGE: none is in flight. */
enum neph_status neph_sky_frames_collect(struct neph_sky_frames *pictures,
                                         struct neph_sky_stats *stats, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Frames with the height fog of game engines, a non-physical model (formulas in truth/fog_look.h):
 * one ray a pixel through the solids, and the fog in closed form without sampling. Only the
 * transmittance is physical, and only while none of the model's controls is set.
 */
#ifndef NEPH_RENDERER_FOG_LOOK_H
#define NEPH_RENDERER_FOG_LOOK_H

#include "base/image.h"
#include "renderer/vulkan.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

struct neph_fog_look_params {
    int width_px, height_px;
    double frame;
    struct neph_fog_look look; /* replaces the scene's own */
    enum neph_fog_model model;
    bool sun_is_clear; /* solids are lit without attenuation by fog */
};

/* The fog parameters as the shader reads them. The scene must satisfy
 * neph_fog_look_can_model_fog_only(), or be a scene without its media. */
struct neph_gpu_fog_look neph_gpu_fog_pack(const struct neph_scene *scene,
                                           const struct neph_fog_look *look,
                                           enum neph_fog_model model, struct neph_vec3 camera_m);

/* Frames of one scene; its constant data stay on the device. Free with _destroy; NULL is fine
 * there. Errors as of neph_gpu_scene_create(). */
struct neph_fog_renderer;
enum neph_status neph_fog_renderer_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_fog_look_params *params,
                                          struct neph_fog_renderer **looks, struct neph_diag *diag);
void neph_fog_renderer_destroy(struct neph_fog_renderer *looks);

/* One frame of the scene, which may have another sun or moved solids; params.frame is ignored. The
 * image has R G B, volume.*, transmittance.*, Z as in base/image.h. `*gpu_s`: the frame's device
 * time, NaN without a clock.
 *
 * With `image` NULL the frame is only submitted: no image is returned and `gpu_s` is unchanged. Up
 * to NEPH_IN_FLIGHT_FRAMES frames are in flight. */
enum neph_status neph_fog_renderer_frame(struct neph_fog_renderer *looks,
                                         const struct neph_scene *scene, double frame,
                                         struct neph_image **image, double *gpu_s,
                                         struct neph_diag *diag);

/* Wait for the oldest frame in flight and return its device time. NEPH_ERR_USAGE: none is in
 * flight. */
enum neph_status neph_fog_renderer_collect(struct neph_fog_renderer *looks, double *gpu_s,
                                           struct neph_diag *diag);

#endif

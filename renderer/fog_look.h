/* SPDX-License-Identifier: MIT
 *
 * Pictures with the look of fog that game engines have (truth/fog_look.h has the formulas): one
 * ray a pixel through the solids, and the fog in closed form. Nothing is sampled, and nothing of
 * it is physics but its transmittance, as long as no control is set.
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
    struct neph_fog_look look; /* in place of the scene's own */
    enum neph_fog_model model;
    bool sun_is_clear; /* solids are lit as if there were no fog before the sun */
};

/* The look as the shader has it, of a scene that neph_fog_look_is_among() is content with, or one
 * that has lost its media. */
struct neph_gpu_fog_look neph_gpu_fog_look_from(const struct neph_scene *scene,
                                                const struct neph_fog_look *look,
                                                enum neph_fog_model model,
                                                struct neph_vec3 camera_m);

/* Pictures of one scene: what does not change of it stays on the device. For _destroy, of which
 * NULL is fine. Errors as of neph_gpu_scene_create(). */
struct neph_fog_looks;
enum neph_status neph_fog_looks_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_fog_look_params *params,
                                       struct neph_fog_looks **looks, struct neph_diag *diag);
void neph_fog_looks_destroy(struct neph_fog_looks *looks);

/* One picture of the scene, which may have another sun or its solids moved since; params.frame
 * counts no more. The image has R G B, volume.*, transmittance.*, Z as in base/image.h. `*gpu_s`:
 * the device's time for it, NaN without a clock.
 *
 * `image` NULL: the picture is on its way when this returns, nothing comes back of it and `gpu_s`
 * is left alone; up to NEPH_IN_FLIGHT_FRAMES of them are in flight. */
enum neph_status neph_fog_looks_frame(struct neph_fog_looks *looks, const struct neph_scene *scene,
                                      double frame, struct neph_image **image, double *gpu_s,
                                      struct neph_diag *diag);

/* The device's time for the oldest picture in flight, waited for. NEPH_ERR_USAGE: none is. */
enum neph_status neph_fog_looks_home(struct neph_fog_looks *looks, double *gpu_s,
                                     struct neph_diag *diag);

#endif

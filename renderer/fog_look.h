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

/* The look as the shader has it, of a scene that neph_fog_look_is_of() is content with, or one
 * that has lost its media. */
struct neph_gpu_fog_look neph_gpu_fog_look_from(const struct neph_scene *scene,
                                                const struct neph_fog_look *look,
                                                enum neph_fog_model model,
                                                struct neph_vec3 camera_m);

/* The image has R G B, volume.*, transmittance.*, Z as in base/image.h. `*gpu_s`: the device's
 * time for it, NaN without a clock. Errors as of neph_gpu_scene_create() and neph_kernel_run(). */
enum neph_status neph_fog_look_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                     const struct neph_fog_look_params *params,
                                     struct neph_image **image, double *gpu_s,
                                     struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Counts the frames in a row with the same content. When camera, sun, lights, media and solids have
 * been static for long enough, gradient samples (gradient/gradient.comp) give the same bits as the
 * frame before and older changes have decayed to 0: the gradient is 0 without being computed.
 */
#ifndef NEPH_RENDERER_REALTIME_STILLNESS_H
#define NEPH_RENDERER_REALTIME_STILLNESS_H

#include "renderer/gpu_scene.h"

/* The content of a frame: all parts of a scene that change its light. */
struct neph_rt_content {
    struct neph_sun sun;
    struct neph_rgb background_w_per_m2_sr;
    struct neph_light lights[NEPH_SCENE_LIGHTS_MAX];
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
};

struct neph_rt_static_content {
    struct neph_rt_content content; /* of the latest frame */
    struct neph_solid *solids;      /* owned; of the latest frame */
    int solid_count;
    uint32_t pictures; /* frames in a row before the latest one with the same content */
};

/* Compares the content of a frame with the latest one and stores it. The flag is true when the
 * frame directly follows the latest one, with the same camera. */
enum neph_status neph_rt_static_content_update(struct neph_rt_static_content *static_content,
                                               const struct neph_scene *static_scene, bool is_next,
                                               struct neph_diag *diag);

/* A zero-initialised structure is fine. */
void neph_rt_static_content_destroy(struct neph_rt_static_content *static_content);

/* Whether the gradient of a view is known to be 0, provided that rays see nothing beyond the stored
 * content. False with override_rest, because the two samples of a gradient then come from two
 * texels; false where tiles lack a second sample: fewer than 2x2 tiles, or partial tiles on both
 * sides. */
bool neph_rt_is_gradient_known_zero(const struct neph_rt_static_content *stillness,
                                    const struct neph_gpu_view *view);

#endif

/* SPDX-License-Identifier: MIT
 *
 * How long pictures have shown the same: where camera, sun, lights, media and solids have stood
 * still for long enough, rays that are marched a second time (gradient/gradient.comp) see what
 * they saw, to the last bit, and what they have seen before is forgotten. That is known without a
 * look.
 */
#ifndef NEPH_RENDERER_REALTIME_STILLNESS_H
#define NEPH_RENDERER_REALTIME_STILLNESS_H

#include "renderer/gpu_scene.h"

/* What a picture shows of a scene. */
struct neph_rt_content {
    struct neph_sun sun;
    struct neph_rgb background_w_per_m2_sr;
    struct neph_light lights[NEPH_SCENE_LIGHTS_MAX];
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX];
};

struct neph_rt_stillness {
    struct neph_rt_content content; /* of the latest picture */
    struct neph_solid *solids;      /* owned; of it */
    int solid_count;
    uint32_t pictures; /* in a row before the latest that showed the same */
};

/* Keep what a picture shows of a scene as it stands. `rests`: it is the next after the latest, and
 * its camera stands where that stood. */
enum neph_status neph_rt_stillness_keep(struct neph_rt_stillness *stillness,
                                        const struct neph_scene *still, bool rests,
                                        struct neph_diag *diag);

/* A zero one is fine. */
void neph_rt_stillness_destroy(struct neph_rt_stillness *stillness);

/* Whether the gradient of a view sees nothing and remembers nothing, if rays see nothing but what
 * is kept. Never where an override comes and goes (override_rest), since then two looks go through
 * two texels, nor where the picture's last tiles have no second look: less than 2x2 of them, or cut
 * on both sides. */
bool neph_rt_stillness_is_known(const struct neph_rt_stillness *stillness,
                                const struct neph_gpu_view *view);

#endif

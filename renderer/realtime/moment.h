/* SPDX-License-Identifier: MIT
 *
 * Where the camera is, was and how far the wind has blown: what a frame's view says of the moment.
 */
#ifndef NEPH_RENDERER_REALTIME_MOMENT_H
#define NEPH_RENDERER_REALTIME_MOMENT_H

#include "renderer/realtime/view.h"
#include "scenes/scene.h"

struct neph_rt_moment {
    struct neph_camera camera;
    struct neph_vec3 drift_m;  /* of the media */
    struct neph_vec3 origin_m; /* where the world lies, from where its file has it */
    int frame;                 /* of the scene's pictures */
    double exposure;           /* what colours are multiplied by */
    float jitter_px[2];
};

/* A picture of a scene over time, the `number`-th that is rendered; `moves_rays`: with the jitter
 * of the view's settings. Its camera is for the caller to set. */
struct neph_rt_moment neph_rt_moment_of(const struct neph_gpu_view *view,
                                        const struct neph_scene *scene, int frame, uint32_t number,
                                        bool moves_rays);

/* What a view says of the moment and of the one before it (NULL: there is none). */
void neph_rt_view_set_moment(struct neph_gpu_view *view, const struct neph_scene *scene,
                             const struct neph_rt_moment *now, const struct neph_rt_moment *before,
                             uint32_t number);

#endif

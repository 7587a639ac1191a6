/* SPDX-License-Identifier: MIT
 *
 * The transforms of a frame: camera, wind and jitter, now and in the frame before, for its view.
 */
#ifndef NEPH_RENDERER_REALTIME_MOMENT_H
#define NEPH_RENDERER_REALTIME_MOMENT_H

#include "renderer/realtime/view.h"
#include "scenes/scene.h"

struct neph_rt_transforms {
    struct neph_camera camera;
    struct neph_vec3 drift_m;  /* displacement of the media by the wind */
    struct neph_vec3 origin_m; /* offset of the world from the coordinates of the scene file */
    int frame;                 /* frame of the scene */
    double exposure;           /* factor on colours */
    float jitter_px[2];
};

/* The transforms of frame `frame` of a scene, the `number`-th that is rendered. `moves_rays`: with
 * the jitter of the view's settings. The caller sets the camera. */
struct neph_rt_transforms neph_rt_compute_transforms(const struct neph_gpu_view *view,
                                                     const struct neph_scene *scene, int frame,
                                                     uint32_t number, bool moves_rays);

/* Writes the transforms of this frame and of the one before (NULL: none) into a view. */
void neph_rt_view_set_transforms(struct neph_gpu_view *view, const struct neph_scene *scene,
                                 const struct neph_rt_transforms *now,
                                 const struct neph_rt_transforms *before, uint32_t number);

#endif

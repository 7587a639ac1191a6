/* SPDX-License-Identifier: MIT
 *
 * A scene for froxels near the camera, used when the height fog is a medium of the froxels up to a
 * distance (fog=unreal and the scene's volumetric_fog_distance_m). It is the scene of the ray
 * marcher, which has no fog, plus the fog as a medium. All data except the frame's are shared with
 * the ray marcher. Not for other folders.
 */
#ifndef NEPH_RENDERER_FROXEL_SCENE_H
#define NEPH_RENDERER_FROXEL_SCENE_H

#include "renderer/gpu_scene.h"
#include "renderer/in_flight.h"

/* Zero: the froxels use the scene of the ray marcher. */
struct neph_froxel_scene {
    struct neph_gpu_scene gpu;     /* borrows all buffers except the first */
    struct neph_buffer frame;      /* the first buffer */
    struct neph_buffer_ring turns; /* of frames in flight */
};

/* Zero-initialise `froxels`; free with _destroy, also after an error. */
enum neph_status neph_froxel_scene_create(const struct neph_vulkan *vulkan,
                                          const struct neph_gpu_scene *marched,
                                          struct neph_froxel_scene *froxels,
                                          struct neph_diag *diag);
void neph_froxel_scene_destroy(const struct neph_vulkan *vulkan, struct neph_froxel_scene *froxels);

/* Update from the current state of `marched` and add the whole height fog of `scene`. Does nothing
 * for a zero-initialised struct. */
void neph_froxel_scene_update(struct neph_froxel_scene *froxels, const struct neph_scene *scene,
                              double frame, const struct neph_gpu_scene *marched);

/* The scene for froxels: `marched` for a zero-initialised struct. */
const struct neph_gpu_scene *neph_froxel_scene_select(const struct neph_froxel_scene *froxels,
                                                      const struct neph_gpu_scene *marched);

#endif

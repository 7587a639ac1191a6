/* SPDX-License-Identifier: MIT
 *
 * A scene as near froxels see it where the look of a fog is handed over to them (fog=unreal and the
 * scene's volumetric_fog_distance_m): that of the march, which has no fog, with the fog among its
 * media. All but the frame is the march's own. Not for other folders.
 */
#ifndef NEPH_RENDERER_FROXEL_SCENE_H
#define NEPH_RENDERER_FROXEL_SCENE_H

#include "renderer/gpu_scene.h"
#include "renderer/in_flight.h"

/* Zero: nothing is handed over. */
struct neph_froxel_scene {
    struct neph_gpu_scene gpu; /* borrows all but its first buffer */
    struct neph_buffer frame;  /* that buffer */
    struct neph_turns turns;   /* which frames in flight take */
};

/* Zero-initialise `froxels`; free with _destroy, also after an error. */
enum neph_status neph_froxel_scene_create(const struct neph_vulkan *vulkan,
                                          const struct neph_gpu_scene *marched,
                                          struct neph_froxel_scene *froxels,
                                          struct neph_diag *diag);
void neph_froxel_scene_destroy(const struct neph_vulkan *vulkan, struct neph_froxel_scene *froxels);

/* `marched` as it is now, and the height fog of `scene`, the whole. Nothing for a zero one. */
void neph_froxel_scene_show(struct neph_froxel_scene *froxels, const struct neph_scene *scene,
                            double frame, const struct neph_gpu_scene *marched);

/* What froxels see: `marched` where nothing is handed over. */
const struct neph_gpu_scene *neph_froxel_scene_of(const struct neph_froxel_scene *froxels,
                                                  const struct neph_gpu_scene *marched);

#endif

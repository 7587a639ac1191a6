/* SPDX-License-Identifier: MIT */
#include "renderer/froxel_scene.h"

#include "scenes/fog_translation.h"

enum neph_status neph_froxel_scene_create(const struct neph_vulkan *vulkan,
                                          const struct neph_gpu_scene *marched,
                                          struct neph_froxel_scene *froxels, struct neph_diag *diag)
{
    const enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD,
                                                       sizeof(*marched->frame), "froxels' frame",
                                                       &froxels->frame, diag);
    return status ? status
                  : neph_buffer_ring_create(vulkan, &froxels->frame, "froxels' frame",
                                            &froxels->turns, diag);
}

void neph_froxel_scene_destroy(const struct neph_vulkan *vulkan, struct neph_froxel_scene *froxels)
{
    neph_buffer_ring_destroy(vulkan, &froxels->turns);
    neph_buffer_destroy(vulkan, &froxels->frame);
}

static bool is_zero(const struct neph_froxel_scene *froxels)
{
    return !froxels->frame.mapped;
}

void neph_froxel_scene_update(struct neph_froxel_scene *froxels, const struct neph_scene *scene,
                              double frame, const struct neph_gpu_scene *marched)
{
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    if (is_zero(froxels))
        return;
    neph_buffer_ring_advance(&froxels->turns, &froxels->frame);
    froxels->gpu = *marched;
    froxels->gpu.buffers[0] = froxels->frame;
    froxels->gpu.frame = froxels->frame.mapped;
    *froxels->gpu.frame = *marched->frame;
    if (fog)
        neph_gpu_scene_add_fog(&froxels->gpu, scene, fog, frame);
}

const struct neph_gpu_scene *neph_froxel_scene_select(const struct neph_froxel_scene *froxels,
                                                      const struct neph_gpu_scene *marched)
{
    return is_zero(froxels) ? marched : &froxels->gpu;
}

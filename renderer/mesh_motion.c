/* SPDX-License-Identifier: MIT */
#include "renderer/mesh_motion.h"

#include "renderer/gpu_meshes.h"

#include <stdlib.h>
#include <string.h>

static size_t count_solid_bytes(const struct neph_scene *scene)
{
    return (size_t)scene->solid_count * sizeof(*scene->solids);
}

enum neph_status neph_mesh_motion_create(const struct neph_scene *scene,
                                         struct neph_mesh_motion *motion, struct neph_diag *diag)
{
    if (neph_gpu_count_instances(scene) == 0)
        return NEPH_OK;
    motion->solids = malloc(count_solid_bytes(scene));
    if (!motion->solids)
        return neph_fail_memory(diag);
    memcpy(motion->solids, scene->solids, count_solid_bytes(scene));
    return NEPH_OK;
}

static void destroy_buffers(const struct neph_vulkan *vulkan, struct neph_mesh_motion *motion)
{
    neph_buffer_ring_destroy(vulkan, &motion->turns);
    neph_buffer_destroy(vulkan, &motion->places);
}

static enum neph_status create_buffers(const struct neph_vulkan *vulkan, size_t bytes,
                                       struct neph_mesh_motion *motion, struct neph_diag *diag)
{
    static const char name[] = "places of meshes";
    enum neph_status status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, bytes, name,
                                                 &motion->places, diag);
    if (!status)
        status = neph_buffer_ring_create(vulkan, &motion->places, name, &motion->turns, diag);
    if (status)
        destroy_buffers(vulkan, motion);
    return status;
}

/* By way of memory of the host: places are read while they are written, and a mapped buffer may be
 * slow to read. */
static enum neph_status write_places(const struct neph_scene *scene, struct neph_vec3 eye_m,
                                     const struct neph_buffer *places, struct neph_diag *diag)
{
    uint32_t(*words)[4] = calloc(neph_gpu_mesh_place_words(scene), sizeof(*words));
    if (!words)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_gpu_mesh_places_write(scene, eye_m, words, diag);
    if (!status)
        memcpy(places->mapped, words, neph_gpu_mesh_place_words(scene) * sizeof(*words));
    free(words);
    return status;
}

enum neph_status neph_mesh_motion_update(const struct neph_vulkan *vulkan,
                                         const struct neph_scene *scene, struct neph_vec3 eye_m,
                                         const struct neph_buffer *buffer,
                                         struct neph_mesh_motion *motion, double *gpu_s,
                                         struct neph_diag *diag)
{
    const size_t word_bytes = 4 * sizeof(uint32_t);
    const size_t bytes = neph_gpu_mesh_place_words(scene) * word_bytes;
    if (!motion->solids || memcmp(motion->solids, scene->solids, count_solid_bytes(scene)) == 0)
        return NEPH_OK;
    enum neph_status status = NEPH_OK;
    if (motion->places.mapped)
        neph_buffer_ring_advance(&motion->turns, &motion->places);
    else
        status = create_buffers(vulkan, bytes, motion, diag);
    if (!status)
        status = write_places(scene, eye_m, &motion->places, diag);
    if (!status)
        status = neph_copy_submit(vulkan, &motion->places, buffer,
                                  NEPH_GPU_MESH_PLACES_FIRST * word_bytes, bytes, gpu_s, diag);
    if (!status)
        memcpy(motion->solids, scene->solids, count_solid_bytes(scene));
    return status;
}

void neph_mesh_motion_destroy(const struct neph_vulkan *vulkan, struct neph_mesh_motion *motion)
{
    destroy_buffers(vulkan, motion);
    free(motion->solids);
    *motion = (struct neph_mesh_motion){.solids = NULL};
}

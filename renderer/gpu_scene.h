/* SPDX-License-Identifier: MIT
 *
 * A scene in the layout of shaders/frame.glsl, for the camera of one frame.
 *
 * Positions are relative to the camera (relative.h). Not for other folders.
 */
#ifndef NEPH_RENDERER_GPU_SCENE_H
#define NEPH_RENDERER_GPU_SCENE_H

#include "renderer/compute.h"
#include "renderer/gpu_meshes.h"
#include "renderer/mesh_motion.h"
#include "renderer/shaders/constants.h"
#include "renderer/solid_tree.h"
#include "renderer/sun_grid.h"
#include "scenes/scene.h"
#include "shaders/structs.h" /* struct neph_gpu_frame and its members, shared with the shaders */

#include <stdint.h>

_Static_assert(NEPH_SCENE_MEDIA_MAX == NEPH_GPU_MEDIA_MAX &&
                   NEPH_FOG_LAYERS_MAX == NEPH_GPU_LAYERS_MAX,
               "room in a frame");
_Static_assert(NEPH_SCENE_LIGHTS_MAX == NEPH_GPU_LAMPS_MAX, "room for lights");
_Static_assert(NEPH_SCENE_SOLIDS_MAX == NEPH_GPU_SOLIDS_MAX, "room for solids");
_Static_assert(NEPH_SOLID_BOX == 0 && NEPH_SOLID_SPHERE == 1 && NEPH_SOLID_KIND_COUNT == 3,
               "solids.glsl's kinds");

struct neph_gpu_solid neph_gpu_solid_pack(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m);

struct neph_gpu_lamp neph_gpu_lamp_pack(const struct neph_light *light,
                                        struct neph_vec3 camera_position_m);

/* Upper bound of loop iterations (compute.h) of one ray through all solids: the solids, the nodes
 * of their trees, and the end of each leaf. For meshes an estimate (gpu_meshes.h). */
static inline uint64_t neph_gpu_solid_iterations(const struct neph_scene *scene)
{
    const uint64_t count = (uint64_t)neph_gpu_count_plain_solids(scene);
    return count + 2 * (uint64_t)neph_solid_tree_nodes((size_t)count) + 1 +
           neph_gpu_mesh_iterations(scene);
}

/* The number of solids before one that are meshes, or that are none: its number on the device among
 * its like. */
uint32_t neph_gpu_solid_number(const struct neph_scene *scene, int solid, bool is_mesh);

/* A scene on the device, for one frame: the buffers at bindings 0 to 4 of every kernel that
 * includes shaders/scene.glsl. */
enum { NEPH_GPU_SCENE_BUFFERS = 5, NEPH_GPU_SCENE_UNIFORMS = 2, NEPH_GPU_SCENE_CONSTANTS = 2 };

/* The buffer with meshes, the grid across the sun, and textures of Horizon clouds. */
enum { NEPH_GPU_TEXELS_BUFFER = 4 };

/* The buffer with the values of grids. On a CPU a texel of it is a value and its successor
 * (NEPH_GPU_PAIRS). */
enum { NEPH_GPU_VALUES_BUFFER = 2 };

struct neph_gpu_scene {
    struct neph_gpu_frame *frame; /* in the mapped memory of buffers[0]; may be changed between
                                     dispatches. `steps` and `sun_steps` are left 0 */
    /* Frame, solids, values of grids, majorants, texels. */
    struct neph_buffer buffers[NEPH_GPU_SCENE_BUFFERS];
    struct neph_buffer pairs; /* the values of grids in pairs; two zeros without grids */
    /* One texture a medium, for kernels that sample grids by the texture unit (grid_textures.h),
     * and the one bound for media without a texture. */
    struct neph_texture textures[NEPH_GPU_MEDIA_MAX], no_texture;
    /* Specialization constants 0 and 1 of every such kernel: the kinds of media in the scene, and
     * further properties (NEPH_GPU_COLOURED and those after it in constants.h). */
    uint32_t constants[NEPH_GPU_SCENE_CONSTANTS];
    bool is_on_cpu, has_pairs;
    struct neph_buffer mesh_readback; /* on a CPU, with meshes */
    struct neph_mesh_motion mesh_motion;
    struct neph_sun_grid sun_grid; /* without limits: they are in the buffer of texels */
    size_t sun_grid_words;         /* of the grid in that buffer; of the scene at creation */
    /* The position of the majorants of each medium, if any; they move with the medium. */
    struct neph_gpu_majorants {
        uint32_t size[3], first;
    } majorants[NEPH_GPU_MEDIA_MAX];
    /* Upper bound of loop iterations (compute.h) of one exact optical depth through all media. */
    uint64_t optical_depth_iterations;
    uint64_t solid_iterations; /* neph_gpu_solid_iterations() */
};

/* Zero-initialise `gpu`; free with _destroy, also after an error. `with_majorants`: build majorant
 * grids for media whose free paths have no closed form; a single cell for Horizon clouds whose
 * noise moves with the wind. NEPH_ERR_UNSUPPORTED: a grid is larger than the device lets a kernel
 * bind; a medium needs majorants and is unbounded. */
enum neph_status neph_gpu_scene_create(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, bool with_majorants,
                                       struct neph_gpu_scene *gpu, struct neph_diag *diag);

/* Upload another frame of the scene, with another sun, moved media or solids (neph_scene_at()):
 * grids, textures and triangles stay unchanged on the device. `*gpu_s`: as
 * neph_mesh_motion_update(), whose errors this has. */
enum neph_status neph_gpu_scene_update(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, double *gpu_s, struct neph_diag *diag);

/* Add one medium, an unbounded fog without data of its own, to the frame in `gpu`. The frame's
 * memory must be readable, since its other media are kept. */
void neph_gpu_scene_add_fog(struct neph_gpu_scene *gpu, const struct neph_scene *scene,
                            const struct neph_medium *fog, double frame);

/* The media that have an effect, in the order of a frame. Returns their number. */
uint32_t neph_gpu_scene_list_media(const struct neph_scene *scene,
                                   const struct neph_medium *media[NEPH_GPU_MEDIA_MAX]);

/* These media in world positions; the entries after them are zero. Returns their number. */
uint32_t neph_gpu_scene_pack_media(const struct neph_scene *scene,
                                   struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]);

/* Whether two suns have the same direction. Transmittance towards the sun depends on the direction
 * but not on the irradiance. */
bool neph_gpu_is_same_sun(const struct neph_sun *a, const struct neph_sun *b);

/* The bounds of all bounded media (all except fogs); false when there is none. */
bool neph_find_media_bounds(const struct neph_scene *scene, struct neph_bounds *box);

/* For the end of a frame: neph_gpu_meshes_check() on a CPU device. Nothing else takes time. */
enum neph_status neph_gpu_scene_check(const struct neph_vulkan *vulkan,
                                      const struct neph_gpu_scene *gpu, struct neph_diag *diag);

void neph_gpu_scene_destroy(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu);

/* Set the first buffers and the images of a dispatch. */
void neph_gpu_scene_bind(const struct neph_gpu_scene *gpu, struct neph_dispatch *dispatch);

#endif

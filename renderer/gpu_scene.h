/* SPDX-License-Identifier: MIT
 *
 * A scene in the layout of shaders/frame.glsl, as seen by the camera of one frame.
 *
 * Positions are relative to the camera (relative.h). Not for other folders.
 */
#ifndef NEPH_RENDERER_GPU_SCENE_H
#define NEPH_RENDERER_GPU_SCENE_H

#include "renderer/compute.h"
#include "renderer/shaders/constants.h"
#include "scenes/scene.h"
#include "shaders/structs.h" /* struct neph_gpu_frame and what is in it, from the shaders */

#include <stdint.h>

_Static_assert(NEPH_SCENE_MEDIA_MAX == NEPH_GPU_MEDIA_MAX &&
                   NEPH_FOG_LAYERS_MAX == NEPH_GPU_LAYERS_MAX,
               "room in a frame");
_Static_assert(NEPH_SCENE_LIGHTS_MAX == NEPH_GPU_LAMPS_MAX, "room for lights");
_Static_assert(NEPH_SCENE_SOLIDS_MAX == NEPH_GPU_SOLIDS_MAX, "room for solids");
_Static_assert(NEPH_SOLID_BOX == 0 && NEPH_SOLID_SPHERE == 1 && NEPH_SOLID_KIND_COUNT == 2,
               "solids.glsl's kinds");

struct neph_gpu_solid neph_gpu_solid_from(const struct neph_solid *solid,
                                          struct neph_vec3 camera_position_m);

/* Loop turns (compute.h) of one ray through all solids, at most: a block is left by one more. */
static inline uint64_t neph_gpu_solid_turns(uint64_t solid_count)
{
    return solid_count + 2 * (solid_count / NEPH_GPU_BLOCK_SOLIDS + 1) + 1;
}

/* A scene on the device, for one frame: the buffers at bindings 0 to 4 of every kernel that
 * includes shaders/scene.glsl. */
enum { NEPH_GPU_SCENE_BUFFERS = 5, NEPH_GPU_SCENE_UNIFORMS = 2, NEPH_GPU_SCENE_CONSTANTS = 2 };

/* Which of them has the values of grids. A CPU sees as its texels each value and the one behind it
 * (NEPH_GPU_PAIRS). */
enum { NEPH_GPU_VALUES_BUFFER = 2 };

struct neph_gpu_scene {
    struct neph_gpu_frame *frame; /* in the mapped memory of buffers[0]; may be changed between
                                     dispatches. `steps` and `sun_steps` are left 0 */
    /* Frame, solids, values of grids, majorants, texels. */
    struct neph_buffer buffers[NEPH_GPU_SCENE_BUFFERS];
    struct neph_buffer pairs; /* of the values of grids; of two zeros where there are none */
    /* One for each medium, for kernels that sample them (grid_textures.h), and what stands for
     * those that have none. */
    struct neph_texture textures[NEPH_GPU_MEDIA_MAX], no_texture;
    /* Specialization constants 0 and 1 of every such kernel: the kinds of media that are there, and
     * what else is known of the scene (NEPH_GPU_COLOURED and what follows it in constants.h). */
    uint32_t constants[NEPH_GPU_SCENE_CONSTANTS];
    bool is_on_cpu, has_pairs;
    /* Where the majorants of each medium lie, if there are any; they go with it. */
    struct neph_gpu_majorants {
        uint32_t size[3], first;
    } majorants[NEPH_GPU_MEDIA_MAX];
    /* Loop turns (compute.h) of one exact optical depth through all media, at most. */
    uint64_t optical_depth_turns;
};

/* Zero-initialise `gpu`; free with _destroy, also after an error. `with_majorants`: build majorant
 * grids for the media that have no free path in closed form: one cell for Horizon clouds whose
 * noise the wind carries through their bounds. NEPH_ERR_UNSUPPORTED: a grid is larger
 * than the device lets a kernel see; a medium needs majorants and has no end. */
enum neph_status neph_gpu_scene_create(const struct neph_vulkan *vulkan,
                                       const struct neph_scene *scene, double frame, int width_px,
                                       int height_px, bool with_majorants,
                                       struct neph_gpu_scene *gpu, struct neph_diag *diag);

/* Upload the scene at another frame, with another sun or its media moved (neph_scene_at()): grids
 * and textures stay where they are on the device. */
void neph_gpu_scene_move(struct neph_gpu_scene *gpu, const struct neph_scene *scene, double frame,
                         int width_px, int height_px);

/* One more medium of the frame that `gpu` has, a fog without bounds, which has no data of its own:
 * of a scene whose other media are there already. The frame must be one that may be read. */
void neph_gpu_scene_add_fog(struct neph_gpu_scene *gpu, const struct neph_scene *scene,
                            const struct neph_medium *fog, double frame);

/* The media that do something, as a frame has them one after the other. Returns how many. */
uint32_t neph_gpu_scene_list(const struct neph_scene *scene,
                             const struct neph_medium *media[NEPH_GPU_MEDIA_MAX]);

/* The same in the world's places; zeros behind them. Returns how many. */
uint32_t neph_gpu_scene_media(const struct neph_scene *scene,
                              struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]);

/* Whether two suns stand in the same place: what light goes through on its way does not ask how
 * bright it is. */
bool neph_gpu_same_sun(const struct neph_sun *a, const struct neph_sun *b);

/* The box around all shapes (media but fogs) of them; false when there is none. */
bool neph_shapes_box(const struct neph_scene *scene, struct neph_bounds *box);

void neph_gpu_scene_destroy(const struct neph_vulkan *vulkan, struct neph_gpu_scene *gpu);

/* Fill in the first buffers of a dispatch, and its images. */
void neph_gpu_scene_bind(const struct neph_gpu_scene *gpu, struct neph_dispatch *dispatch);

#endif

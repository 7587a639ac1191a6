/* SPDX-License-Identifier: MIT
 *
 * Empty cells of a grid over all bounded media (all except fogs), skipped by the ray marcher. One
 * bit for each cell, from upper bounds of extinction like those of majorants (scenes/majorant.h);
 * read by shaders/shortcuts.glsl.
 */
#ifndef NEPH_RENDERER_SKIP_CELLS_H
#define NEPH_RENDERER_SKIP_CELLS_H

#include "renderer/gpu_scene.h"
#include "renderer/march_params.h"

/* Positions of the media when the cells were computed. */
struct neph_skip_positions {
    struct neph_vec3 corner_m[NEPH_SCENE_MEDIA_MAX]; /* of each medium's bounds */
    struct neph_vec3 noise_m; /* displacement of the noise of Horizon clouds by the wind */
};

struct neph_skip_cells {
    uint32_t size[3];         /* 0: no cells */
    struct neph_buffer cells; /* without memory if there are no cells */
    struct neph_skip_positions places;
    struct neph_vec3 box_min_m; /* minimum corner of the bounds at that time */
};

/* Create cells for a march with these parameters; none without skipping or bounded media.
 * Zero-initialise `skip`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a medium
 * that is not a fog has no finite bounds. */
enum neph_status neph_skip_cells_create(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene,
                                        const struct neph_march_params *params,
                                        struct neph_skip_cells *skip, struct neph_diag *diag);

/* Place the cells in a frame of the scene, after neph_gpu_scene_update(). NEPH_ERR_UNSUPPORTED: the
 * media have not all moved by the same offset since the cells were computed, for example because
 * the wind moves only some of them, or the noise of a Horizon cloud within its bounds. */
enum neph_status neph_skip_cells_place(const struct neph_skip_cells *skip,
                                       const struct neph_scene *scene, double frame,
                                       struct neph_gpu_frame *gpu, struct neph_diag *diag);

/* Bind the cells instead of the scene's majorants, if there are any. After neph_gpu_scene_bind().
 */
void neph_skip_cells_bind(const struct neph_skip_cells *skip, struct neph_dispatch *dispatch);

/* A zero-initialised struct is fine. */
void neph_skip_cells_destroy(const struct neph_vulkan *vulkan, struct neph_skip_cells *skip);

#endif

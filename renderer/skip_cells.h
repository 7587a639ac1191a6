/* SPDX-License-Identifier: MIT
 *
 * Which cells of a lattice over all shapes (media but fogs) are empty, for marches that pass them:
 * a bit for each, from upper bounds of the media's extinction as majorants are
 * (scenes/majorant.h), looked up by shaders/shortcuts.glsl.
 */
#ifndef NEPH_RENDERER_SKIP_CELLS_H
#define NEPH_RENDERER_SKIP_CELLS_H

#include "renderer/gpu_scene.h"
#include "renderer/march_params.h"

/* Where the media were when the cells were made. */
struct neph_skip_places {
    struct neph_vec3 corner_m[NEPH_SCENE_MEDIA_MAX]; /* of each medium's support */
    struct neph_vec3 noise_m; /* how far the wind had carried the noise of Horizon clouds */
};

struct neph_skip_cells {
    uint32_t size[3];         /* 0: there are none */
    struct neph_buffer cells; /* without memory where there are none */
    struct neph_skip_places places;
    struct neph_vec3 box_min_m; /* of all shapes, then */
};

/* Cells for a march with these parameters, none when they do not skip or there is no shape.
 * Zero-initialise `skip`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a shape
 * has no finite bounds. */
enum neph_status neph_skip_cells_create(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene,
                                        const struct neph_march_params *params,
                                        struct neph_skip_cells *skip, struct neph_diag *diag);

/* Place them in a frame of the scene, as neph_gpu_scene_move() has made it. NEPH_ERR_UNSUPPORTED:
 * the media have not moved all alike since they were made, as where wind carries some alone, or the
 * noise of a Horizon cloud within its bounds. */
enum neph_status neph_skip_cells_place(const struct neph_skip_cells *skip,
                                       const struct neph_scene *scene, double frame,
                                       struct neph_gpu_frame *gpu, struct neph_diag *diag);

/* Where there are cells, they take the place of the scene's majorants. After neph_gpu_scene_bind().
 */
void neph_skip_cells_bind(const struct neph_skip_cells *skip, struct neph_dispatch *dispatch);

/* A zero one is fine. */
void neph_skip_cells_destroy(const struct neph_vulkan *vulkan, struct neph_skip_cells *skip);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The voxel grids of a scene as textures (shaders/grid_texture.glsl), for kernels of the ray
 * marcher. Not for other folders.
 */
#ifndef NEPH_RENDERER_GRID_TEXTURES_H
#define NEPH_RENDERER_GRID_TEXTURES_H

#include "renderer/gpu_scene.h"
#include "renderer/march_params.h"

/* Create textures of all grids if `shortcuts` selects them, and a texture of one texel for all
 * other media, because every binding needs one. Owned by `gpu`, also after an error.
 * NEPH_ERR_UNSUPPORTED as of neph_texture_create(). */
enum neph_status neph_grid_textures_create(const struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_shortcuts *shortcuts,
                                           struct neph_gpu_scene *gpu, struct neph_diag *diag);

#endif

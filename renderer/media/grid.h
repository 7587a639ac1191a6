/* SPDX-License-Identifier: MIT
 *
 * A voxel grid as the device has it: with a layer of zeros on every side, or of what goes on there
 * (shaders/grid.glsl).
 * Private to renderer/.
 */
#ifndef NEPH_RENDERER_MEDIA_GRID_H
#define NEPH_RENDERER_MEDIA_GRID_H

#include "scenes/scene.h"

/* Nodes along x, y, z, the layers of zeros included. */
void neph_gpu_grid_size(const struct neph_grid *grid, int size[3]);

/* The densities of all nodes at one z of these, x fastest. */
void neph_gpu_grid_slab(const struct neph_medium *medium, int z, float *slab);

/* The largest of all. */
float neph_gpu_grid_full(const struct neph_medium *medium);

#endif

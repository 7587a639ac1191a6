/* SPDX-License-Identifier: MIT
 *
 * A voxel grid in the device's layout: padded on every side by zeros, or by its repetition along a
 * periodic axis (shaders/grid.glsl). Private to renderer/.
 */
#ifndef NEPH_RENDERER_MEDIA_GRID_H
#define NEPH_RENDERER_MEDIA_GRID_H

#include "scenes/scene.h"

/* Nodes along x, y, z, with the padding. */
void neph_gpu_grid_size(const struct neph_grid *grid, int size[3]);

/* The densities of all nodes of slab z, x fastest. */
void neph_gpu_grid_slab(const struct neph_medium *medium, int z, float *slab);

/* The largest density on the device. */
float neph_gpu_grid_maximum(const struct neph_medium *medium);

#endif

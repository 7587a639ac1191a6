/* SPDX-License-Identifier: MIT
 *
 * Trees of boxes around the solids of a scene, with which rays on the device leave out what they
 * pass far from (shaders/scene.glsl). The boxes of spheres and rotated boxes are larger by a margin
 * of rounding, because rays meet them by other formulas than boxes (meets_node() in
 * shaders/solids.glsl). A tree halves its solids at the median of their centres along
 * the axis on which these are spread most, down to leaves of NEPH_GPU_LEAF_SOLIDS. Private to
 * renderer/.
 */
#ifndef NEPH_RENDERER_SOLID_TREE_H
#define NEPH_RENDERER_SOLID_TREE_H

#include "renderer/shaders/constants.h"
#include "shaders/structs.h"

#include <stdbool.h>
#include <stddef.h>

/* Fill nodes and order for the first `count` solids. There are up to two trees, one behind the
 * other: of solids that are apart (sun_grid.h), and of all others. Returns the number of nodes of
 * the first tree. */
uint32_t neph_solid_tree_build(struct neph_gpu_solids *gpu, uint32_t count, const bool *is_apart);

/* Upper bound of the number of nodes, at most `count`. In a tree all leaves but one are full, and
 * its nodes are twice its leaves, less 1. */
static inline size_t neph_solid_tree_nodes(size_t count)
{
    const size_t trees = count < 2 ? count : 2, full = NEPH_GPU_LEAF_SOLIDS;
    const size_t leaves = (count + (full - 1) * trees) / full;
    return 2 * leaves > count ? count : leaves > 0 ? 2 * leaves - 1 : 0;
}

#endif

/* SPDX-License-Identifier: MIT
 *
 * A scene with its media resampled to voxel grids of a chosen size, to measure the cost over size.
 */
#ifndef NEPH_HARNESS_SWEEP_SCALED_H
#define NEPH_HARNESS_SWEEP_SCALED_H

#include "scenes/scene.h"

/* Resamples every medium except fog with `nodes` nodes along its longest side. `*count` is the
 * number of nodes of all grids. The scene gets its own hash and borrows large data from `scene`,
 * which must outlive it. Free with neph_scaled_destroy(). NEPH_ERR_UNSUPPORTED: the only medium is
 * fog, which has no voxels. */
enum neph_status neph_scaled_make(const struct neph_scene *scene, int nodes,
                                  struct neph_scene **made, double *count, struct neph_diag *diag);

/* NULL is allowed. */
void neph_scaled_destroy(struct neph_scene *made);

#endif

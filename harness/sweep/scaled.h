/* SPDX-License-Identifier: MIT
 *
 * A scene whose media are voxels, as many as one likes: what a volume of that size costs.
 */
#ifndef NEPH_HARNESS_SWEEP_SCALED_H
#define NEPH_HARNESS_SWEEP_SCALED_H

#include "scenes/scene.h"

/* Every medium but fog is sampled anew with so many nodes along its longest side; `*count` receives
 * how many there are in all. With a hash of its own. It borrows what else is large from `scene`,
 * which must outlive it. Free with neph_scaled_destroy(). NEPH_ERR_UNSUPPORTED: there is no medium
 * but fog, which has no voxels. */
enum neph_status neph_scaled_make(const struct neph_scene *scene, int nodes,
                                  struct neph_scene **made, double *count, struct neph_diag *diag);

/* NULL is fine. */
void neph_scaled_destroy(struct neph_scene *made);

#endif

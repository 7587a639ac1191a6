/* SPDX-License-Identifier: MIT
 *
 * A scene with other orders of scattering than its own: for a renderer that leaves some out, or
 * that has no others.
 */
#ifndef NEPH_SCENES_RESCATTER_H
#define NEPH_SCENES_RESCATTER_H

#include "scenes/scene.h"

/* The scene gets a hash of its own. It borrows all large data from `scene`, which must outlive it.
 * Free with neph_scene_destroy(). Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_scene_rescatter(const struct neph_scene *scene,
                                      enum neph_scattering scattering, struct neph_scene **made,
                                      struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Meshes for engines that write each mesh once, and each of its solids as a transform of it: other
 * programs, and the device.
 */
#ifndef NEPH_SCENES_MESH_PLACE_H
#define NEPH_SCENES_MESH_PLACE_H

#include "scenes/scene.h"

/* The index of a solid's mesh among those of its scene. */
int neph_mesh_index(const struct neph_scene *scene, const struct neph_solid *solid);

/* The unit vectors x, y, z of a solid's mesh in the world, of length 1: a point p of the mesh is at
 * center_m + scale_m (p.x axes[0] + p.y axes[1] + p.z axes[2]). */
void neph_mesh_axes(const struct neph_solid *solid, struct neph_vec3 axes[3]);

#endif

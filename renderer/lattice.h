/* SPDX-License-Identifier: MIT
 *
 * Regular grids over the bounds of all bounded media of a scene. Not for other folders.
 */
#ifndef NEPH_RENDERER_LATTICE_H
#define NEPH_RENDERER_LATTICE_H

#include "renderer/relative.h"
#include "scenes/scene.h"

/* The sides of a box along the axes [m]. */
void neph_lattice_sides_m(const struct neph_bounds *box, double sides_m[3]);

/* The number of nodes along each axis for cells as near to cubes as whole numbers allow: `most`
 * along the longest side. */
void neph_lattice_nodes(const struct neph_bounds *box, int most, uint32_t size[3]);

/* NEPH_ERR_UNSUPPORTED: the bounds have no finite volume above 0. The setting `wants`
 * ("skip=majorant") needs it; the message recommends `without` ("skip=off"). */
enum neph_status neph_lattice_check(const struct neph_bounds *box, const char *wants,
                                    const char *without, struct neph_diag *diag);

/* Place a grid relative to the camera. `size`: cells along each axis (`ends` 0), or nodes, of which
 * the last is the end of the last cell (`ends` 1). */
void neph_lattice_place(const struct neph_bounds *box, struct neph_vec3 camera_m,
                        const uint32_t size[3], uint32_t ends, struct neph_gpu_lattice *lattice);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Lattices over the box around all shapes of a scene. Not for other folders.
 */
#ifndef NEPH_RENDERER_LATTICE_H
#define NEPH_RENDERER_LATTICE_H

#include "renderer/relative.h"
#include "scenes/scene.h"

/* The sides of a box along the axes [m]. */
void neph_lattice_sides_m(const struct neph_bounds *box, double sides_m[3]);

/* Nodes of cubes, as near as whole numbers of them come to the box: `most` along its longest
 * side. */
void neph_lattice_nodes(const struct neph_bounds *box, int most, uint32_t size[3]);

/* NEPH_ERR_UNSUPPORTED: the box has no finite volume above 0, which the setting `wants`
 * ("skip=majorant") needs and `without` ("skip=off") does not. */
enum neph_status neph_lattice_check(const struct neph_bounds *box, const char *wants,
                                    const char *without, struct neph_diag *diag);

/* As a camera sees it. `size` is how many cells there are along each axis, or nodes, of which
 * `ends` = 1 is beyond the cells (0 for cells). */
void neph_lattice_place(const struct neph_bounds *box, struct neph_vec3 camera_m,
                        const uint32_t size[3], uint32_t ends, struct neph_gpu_lattice *lattice);

#endif

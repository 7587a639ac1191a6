/* SPDX-License-Identifier: MIT
 *
 * The optical depth along a line through the densest place of a medium, parallel to an axis of the
 * world: what people call the optical depth of a cloud or a layer.
 */
#ifndef NEPH_SCENES_COLUMN_H
#define NEPH_SCENES_COLUMN_H

#include "scenes/scene.h"

/* The optical depth of a medium in grey along axis 0 x, 1 y, 2 z, by the medium's closed form. The
 * line passes through
 * - homogeneous: any place within the bounds,
 * - fog: the bottom of its bounds; along y without such a bound, from the first layer's height up,
 * - Gaussian: its centre; plume: its foot,
 * - shell, tent: from the ground up, along any axis,
 * - grid: the column of nodes with the largest sum, of the nodes within the bounds,
 * - where that is outside of turned bounds: their middle.
 * INFINITY: the medium has no end along the axis. NAN: not computed (Horizon). */
double neph_medium_column_optical_depth(const struct neph_medium *medium, int axis);

/* Fog with only one of its layers. */
struct neph_medium neph_medium_of_layer(const struct neph_medium *medium, int layer);

#endif

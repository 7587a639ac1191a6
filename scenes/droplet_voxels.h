/* SPDX-License-Identifier: MIT
 *
 * Two grids of a simulation, water or droplets and their effective radius, as extinction in each
 * voxel. Private to scenes/.
 */
#ifndef NEPH_SCENES_DROPLET_VOXELS_H
#define NEPH_SCENES_DROPLET_VOXELS_H

#include "scenes/density_units.h"

#include <stddef.h>

struct neph_droplet_voxels {
    enum neph_density_unit unit; /* of the values: WATER in g/m3 or DROPLETS in 1/cm3 */
    double radius_unit_um;       /* of a radius of 1; 0: not given, 1 or the unit of the file */
    double effective_variance;   /* 0: assumed */
};

/* Replaces each value by its extinction [1/m] at the effective radius of its voxel
 * (scenes/density_units.h). Radii of voxels without water do not matter. NEPH_ERR_INPUT: another
 * radius is out of range; the message names the first such voxel, x fastest in `size`. */
enum neph_status neph_droplet_voxels_convert(const struct neph_droplet_voxels *droplets,
                                             const int size[3], float *values, const float *radii,
                                             struct neph_diag *diag);

#endif

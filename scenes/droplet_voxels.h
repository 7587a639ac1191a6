/* SPDX-License-Identifier: MIT
 *
 * Two grids of a simulation, water or droplets and their effective radius, as extinction in each
 * voxel. A medium has one phase function. Media of one file with a radius band each, which tile the
 * radii, are one cloud whose phase function in a voxel is that of the two nearest peaks,
 * interpolated linearly in the effective radius. Private to scenes/.
 */
#ifndef NEPH_SCENES_DROPLET_VOXELS_H
#define NEPH_SCENES_DROPLET_VOXELS_H

#include "scenes/density_units.h"
#include "scenes/grid.h"

#include <stddef.h>

/* Effective radii from `low` to `high`. The weight of a radius rises linearly from 0 at `low` to 1
 * at `peak` and falls to 0 at `high`. It is 1 below `peak`, if that is `low`, and above, if it is
 * `high`. The weights of bands, each from the peak of the band before to that of the next, sum to
 * 1. */
struct neph_radius_band {
    double low_um, peak_um, high_um;
};

double neph_radius_band_weight(const struct neph_radius_band *band, double radius_um);

struct neph_droplet_voxels {
    /* The values are WATER in g/m3 or DROPLETS in 1/cm3; with a band also EXTINCTION. */
    enum neph_density_unit unit;
    double radius_unit_um;     /* of a radius of 1; 0: not given, 1 or the unit of the file */
    double effective_variance; /* 0: assumed */
    const struct neph_radius_band *band; /* NULL: all radii */
};

/* Replaces each value by its extinction [1/m] at the effective radius of its voxel
 * (scenes/density_units.h), times its weight in the band, whose share of all is added to the note.
 * Radii of voxels without water do not matter. NEPH_ERR_INPUT: another radius is out of range; the
 * message names the first such voxel, x fastest in `size`. */
enum neph_status neph_droplet_voxels_convert(const struct neph_droplet_voxels *droplets,
                                             const int size[3], float *values, const float *radii,
                                             char note[NEPH_GRID_NOTE_SIZE],
                                             struct neph_diag *diag);

#endif

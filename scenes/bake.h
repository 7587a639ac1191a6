/* SPDX-License-Identifier: MIT
 *
 * Any medium as a grid, for engines that know no formulas, with the error that this costs.
 */
#ifndef NEPH_SCENES_BAKE_H
#define NEPH_SCENES_BAKE_H

#include "scenes/grid.h"

#define NEPH_BAKE_RESOLUTION_MIN 2
#define NEPH_BAKE_RESOLUTION_DEFAULT 64

/* How far the baked grid is from the medium, measured at random places and not derived. Relative
 * errors are 0 where the medium has no extinction at all. */
struct neph_bake_error {
    double extinction_rms_relative; /* rms difference / rms extinction */
    double extinction_max_relative; /* largest difference / largest extinction */
    /* Over random chords, against the medium's exact integral. Each runs through a place drawn in
     * proportion to the extinction. */
    double optical_depth_rms;
    double optical_depth_max;
    double optical_depth_mean; /* mean signed difference, baked - medium: the bias */
    double transmittance_max;  /* largest |e^-a - e^-b| over the chords */
    int point_count, chord_count;
    uint64_t seed;
};

struct neph_bake {
    struct neph_grid *grid;  /* owned, sealed */
    double extinction_per_m; /* of a density of 1 in the grid */
    bool is_copy; /* of the medium's own grid: nothing is lost, and all errors are exactly 0 */
    struct neph_bake_error error;
};

/* Is this a grid that its bounds do not cut? */
bool neph_medium_is_whole_grid(const struct neph_medium *medium);

/* Sample the medium's extinction at the nodes of a lattice over `box`, without margins that are
 * thinner than 1e-5 of the densest, and measure the error over all of it. The lattice has
 * `resolution` nodes on the longest side and about the same spacing on all; nodes sit in the
 * middles of equal cells, so that the ramp to 0 beyond the outermost (scenes/grid.h) holds as much
 * as the half cell that it leaves short: a sharp face of the medium costs no optical depth to first
 * order. A whole grid with `resolution` 0 is copied unchanged; for other media 0 is
 * NEPH_BAKE_RESOLUTION_DEFAULT. Density 1 is the medium's extinction_per_m (of fog, which has none:
 * its largest extinction in the box).
 *
 * NEPH_ERR_INPUT: the box is not finite or empty, or the lattice is too large, in words.
 * NEPH_ERR_INTERRUPTED. Finish the bake with neph_bake_finish(). */
enum neph_status neph_medium_bake(const struct neph_medium *medium, const struct neph_bounds *box,
                                  int resolution, struct neph_bake *bake, struct neph_diag *diag);

/* The same grid without a measurement of the error, which takes most of the time: errors are 0. For
 * whom the voxels are the medium. */
enum neph_status neph_medium_sample(const struct neph_medium *medium, const struct neph_bounds *box,
                                    int resolution, struct neph_bake *bake, struct neph_diag *diag);

void neph_bake_finish(struct neph_bake *bake);

/* A copy of `medium` with the same optical properties whose kind is GRID. The grid is borrowed. */
struct neph_medium neph_medium_from_bake(const struct neph_medium *medium,
                                         const struct neph_bake *bake);

#endif

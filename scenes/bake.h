/* SPDX-License-Identifier: MIT
 *
 * Any medium as a grid, for engines that know no formulas, with the error that this costs.
 */
#ifndef NEPH_SCENES_BAKE_H
#define NEPH_SCENES_BAKE_H

#include "scenes/grid.h"

/* What the baked grid differs from the medium, measured and not derived. */
struct neph_bake_error {
    double
        extinction_rms_relative; /* rms difference over random points in the box / rms extinction */
    double extinction_max_relative; /* largest difference / largest extinction */
    double optical_depth_rms;       /* over random chords of the box */
    double optical_depth_max;
    double optical_depth_mean; /* mean signed difference: the bias */
    double transmittance_max;  /* largest |e^-a - e^-b| over the chords */
    int point_count, chord_count;
    uint64_t seed;
};

/* Sample the medium's extinction / extinction_per_m at the nodes of a lattice over `box` (finite)
 * with about the same spacing on all axes and `resolution` nodes (2..NEPH_GRID_SIDE_MAX) on the
 * longest. The result is exact at the nodes. `error` may be NULL. A grid medium whose lattice is
 * asked for again (resolution equal to its longest side) is copied unchanged. */
enum neph_status neph_medium_bake(const struct neph_medium *medium, const struct neph_bounds *box,
                                  int resolution, struct neph_grid **grid,
                                  struct neph_bake_error *error, struct neph_diag *diag);

/* A copy of `medium` whose kind is GRID with the given grid (borrowed) and the same optical
 * properties. */
struct neph_medium neph_medium_from_grid(const struct neph_medium *medium, struct neph_grid *grid);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Any medium as a voxel grid, for engines without its formula, with the error of the voxels.
 */
#ifndef NEPH_SCENES_BAKE_H
#define NEPH_SCENES_BAKE_H

#include "scenes/grid.h"

#define NEPH_BAKE_RESOLUTION_MIN 2
#define NEPH_BAKE_RESOLUTION_DEFAULT 64

/* Error of the baked grid, measured at random places. Relative errors are 0 where the medium has no
 * extinction at all. */
struct neph_bake_error {
    double extinction_rms_relative; /* rms difference / rms extinction */
    double extinction_max_relative; /* largest difference / largest extinction */
    /* Over random chords, compared with the medium's exact integral. Each chord passes through a
     * point that is drawn in proportion to the extinction. */
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
    bool is_copy;            /* a copy of the medium's own grid: all errors are exactly 0 */
    struct neph_bake_error error;
};

/* Whether the medium is a grid that its bounds do not clip. */
bool neph_medium_is_whole_grid(const struct neph_medium *medium);

/* Samples the medium's extinction at the nodes of a lattice over `box`, and measures the error over
 * the whole box. Margins that are thinner than 1e-5 of the densest place are left out. The lattice
 * has `resolution` nodes on the longest side and about the same spacing on all sides. Nodes are at
 * the centres of equal cells: the ramp to 0 beyond the outermost nodes (scenes/grid.h) has the same
 * integral as the half cell that it replaces, so a sharp face of the medium loses no optical depth
 * to first order.
 *
 * `resolution` 0 copies a whole grid unchanged; for other media it is NEPH_BAKE_RESOLUTION_DEFAULT.
 * Density 1 is the medium's extinction_per_m (for fog, which has none, its largest extinction in
 * the box).
 *
 * Errors: NEPH_ERR_INPUT when the box is infinite or empty or the lattice is too large, with the
 * reason in `diag`; NEPH_ERR_INTERRUPTED. Finish the bake with neph_bake_finish(). */
enum neph_status neph_medium_bake(const struct neph_medium *medium, const struct neph_bounds *box,
                                  int resolution, struct neph_bake *bake, struct neph_diag *diag);

/* The same grid without measuring the error, which takes most of the time: errors are 0. For
 * callers to whom the voxels are the medium. */
enum neph_status neph_medium_sample(const struct neph_medium *medium, const struct neph_bounds *box,
                                    int resolution, struct neph_bake *bake, struct neph_diag *diag);

void neph_bake_finish(struct neph_bake *bake);

/* A copy of `medium` of kind GRID with the same optical properties. The grid is borrowed. */
struct neph_medium neph_medium_from_bake(const struct neph_medium *medium,
                                         const struct neph_bake *bake);

#endif

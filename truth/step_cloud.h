/* SPDX-License-Identifier: MIT
 *
 * Periodic clouds of homogeneous columns, like the step cloud of the Intercomparison of 3D
 * Radiation Codes (R. F. Cahalan et al., "The I3RC: bringing together the most advanced radiative
 * transfer tools for cloudy atmospheres", BAMS 86, 2005). Light enters the sides of a column, which
 * a slab cannot represent. Solved by a separate Monte Carlo: free paths by exact inversion from
 * column to column, without majorants, and light traced from the sun. It shares only the sampling
 * of phase functions with the path tracers that it tests.
 */
#ifndef NEPH_TRUTH_STEP_CLOUD_H
#define NEPH_TRUTH_STEP_CLOUD_H

#include "scenes/scene.h"

#include <stdint.h>

#define NEPH_STEP_CLOUD_COLUMNS_MAX 1024

/* Columns side by side along x, infinite along z, periodic. Black below; the sun is the only
 * light. */
struct neph_step_cloud_params {
    int column_count;             /* 1..NEPH_STEP_CLOUD_COLUMNS_MAX */
    const double *optical_depths; /* vertical, one per column, >= 0, finite */
    double column_width_m, thickness_m;
    double albedo; /* single scattering, 0..1 */
    struct neph_phase phase;
    double sun_cosine; /* (0, 1]; the sunlight travels towards +x and down */
    uint64_t seed;
    int64_t photons; /* >= NEPH_STEP_CLOUD_BATCHES */
};

/* Number of batches of photons; the standard error comes from their scatter. */
#define NEPH_STEP_CLOUD_BATCHES 64

struct neph_estimate {
    double mean, standard_error;
};

/* Means over the period. Fluxes / (sun_cosine * E); transmitted includes direct light. Absorbed
 * light is counted separately: the sum is 1 except for roulette. */
struct neph_step_cloud_fluxes {
    struct neph_estimate reflected, transmitted, absorbed;
};

/* Trace the photons, on all processors; the bits do not depend on their number. `nadir_per_sr`, if
 * not NULL, receives for each column the mean radiance / E leaving its top vertically (every
 * scattering adds its expected part). NEPH_ERR_INPUT: a parameter is out of range. */
enum neph_status neph_step_cloud_solve(const struct neph_step_cloud_params *params,
                                       struct neph_step_cloud_fluxes *fluxes,
                                       struct neph_estimate *nadir_per_sr, struct neph_diag *diag);

#endif

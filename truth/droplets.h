/* SPDX-License-Identifier: MIT
 *
 * Optics of a cloud of spherical droplets of many sizes: Mie theory (mie.h) over a distribution of
 * radii.
 *
 *   gamma       n(r) ~ r^((1 - 3 v) / v) exp(-r / (v r_e))
 *   log-normal  n(r) ~ exp(-ln(r / r_g)^2 / (2 s^2)) / r,  r_e = r_g exp(5/2 s^2), v = exp(s^2) - 1
 *
 * with effective radius r_e and effective variance v (J. E. Hansen, L. D. Travis, Space Sci. Rev.
 * 16, 1974, equations 2.53 to 2.61). Deirmendjian's cloud C.1, r^6 exp(-1.5 r / um), is the gamma
 * distribution r_e = 6 um, v = 1/9.
 */
#ifndef NEPH_TRUTH_DROPLETS_H
#define NEPH_TRUTH_DROPLETS_H

#include "base/status.h"

#include <complex.h>

enum neph_droplet_sizes {
    NEPH_DROPLETS_GAMMA,
    NEPH_DROPLETS_LOG_NORMAL,
    NEPH_DROPLETS_COUNT,
};

/* Bounds of the effective variance; the gamma distribution also needs v < 1/2, where it has a mean
 * area. */
#define NEPH_DROPLETS_VARIANCE_MIN 1e-4
#define NEPH_DROPLETS_VARIANCE_MAX 0.4

struct neph_droplets_params {
    enum neph_droplet_sizes sizes;
    double effective_radius_m, effective_variance;
    double wavelength_m;
    double complex index; /* n + i k, k >= 0 */
    double density_kg_per_m3;
    int angle_count;
    const double *cosines; /* of scattering angles, -1..1 */
};

struct neph_droplet_optics {
    double extinction_efficiency; /* mean cross section over the mean geometric one */
    double extinction_m2_per_kg;  /* per mass: times kg/m3 of liquid water gives 1/m */
    double albedo, asymmetry;
    double droplets_per_kg; /* times kg/m3 gives droplets per m3 */
    int sphere_count;       /* radii of the sums */
};

/* Computes the optics, and the phase function at each cosine in `phase_per_sr` (integral over the
 * sphere 1), on all processors; the bits do not depend on their number. The radii reach from where
 * the area distribution has begun to where less than 1e-8 of it is left, in steps of at most 0.1
 * of the size parameter. NEPH_ERR_INPUT: a parameter, or the size parameter of the largest droplet,
 * is out of its bounds. */
enum neph_status neph_droplets_compute(const struct neph_droplets_params *params,
                                       struct neph_droplet_optics *optics, double *phase_per_sr,
                                       struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The plane-parallel slab with all orders of scattering, solved without Monte Carlo: adding and
 * doubling in double precision (H. C. van de Hulst 1963; J. E. Hansen 1971; J. F. de Haan, P. B.
 * Bosma, J. W. Hovenier, A&A 183, 1987). Any vertical profile of one medium is equivalent to a slab
 * with its total vertical optical depth. Black below; the sun is the only light.
 *
 * The requested views are directions of the solution itself (with weight 0), so nothing is
 * interpolated. Singly scattered light is added from its closed form, with the phase function
 * itself instead of its Legendre series.
 */
#ifndef NEPH_TRUTH_SLAB_H
#define NEPH_TRUTH_SLAB_H

#include "scenes/scene.h"

#define NEPH_SLAB_COSINE_MIN 1e-4
/* At albedo 1, rounding absorbs 1e-16 per event, and light passes through after tau^2 events: a
 * loss of 1e-8 at this depth. */
#define NEPH_SLAB_OPTICAL_DEPTH_MAX 1e4
/* The largest |g| of Henyey-Greenstein for radiances; fluxes allow up to 0.999. */
#define NEPH_SLAB_RADIANCE_G_MAX 0.93

struct neph_slab;

struct neph_slab_params {
    double optical_depth; /* vertical, 0..NEPH_SLAB_OPTICAL_DEPTH_MAX */
    double albedo;        /* single scattering, 0..1 */
    struct neph_phase phase;
    double sun_cosine; /* cosine of the sun's angle to the vertical, NEPH_SLAB_COSINE_MIN..1 */
    /* Cosines to the vertical of the leaving directions, NEPH_SLAB_COSINE_MIN..1, in any order, for
     * radiances. None: only fluxes, which is much cheaper. Used only during neph_slab_create(). */
    int view_count;
    const double *view_cosines;
    int node_count; /* quadrature nodes per hemisphere, 2..512; 0: enough for 8 digits */
    /* Also radiances with a peak that the nodes do not resolve: delta-M moves its light straight
     * ahead, so that the light scattered more than once lacks it within a few degrees of the sun.
     */
    bool with_any_peak;
};

/* Solve, on all processors. Free with neph_slab_destroy(). NEPH_ERR_INPUT: a parameter is out of
 * range; NEPH_ERR_UNSUPPORTED: radiances with too sharp a phase function. */
enum neph_status neph_slab_create(const struct neph_slab_params *params, struct neph_slab **slab,
                                  struct neph_diag *diag);

/* `slab` may be NULL. */
void neph_slab_destroy(struct neph_slab *slab);

/* Diffuse fluxes / (sun_cosine * E): upwards at the top, downwards at the bottom, and the direct
 * part of the sunlight. Absorbed: 1 - R - T - direct. */
struct neph_slab_fluxes {
    double reflected, transmitted, direct;
};
struct neph_slab_fluxes neph_slab_fluxes(const struct neph_slab *slab);

/* Diffuse radiance / E [1/sr] leaving the top upwards (reflected) or the bottom downwards
 * (transmitted) with the cosine view_cosines[view]. `azimuth_rad` is the angle between the
 * horizontal directions of travel of the sunlight and of the leaving light: 0 is forward. */
double neph_slab_reflected_per_sr(const struct neph_slab *slab, int view, double azimuth_rad);
double neph_slab_transmitted_per_sr(const struct neph_slab *slab, int view, double azimuth_rad);

/* Chandrasekhar's H function for isotropic scattering ("Radiative Transfer", 1960): a half-space
 * reflects (albedo E / 4 pi) mu0 / (mu + mu0) H(mu) H(mu0). Albedo and cosine in 0..1, else NaN.
 * Relative error 1e-12. */
double neph_chandrasekhar_h(double albedo, double cosine);

#endif

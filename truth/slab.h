/* SPDX-License-Identifier: MIT
 *
 * The plane-parallel slab with all orders of scattering, solved without Monte Carlo: adding and
 * doubling in double precision (H. C. van de Hulst 1963; J. E. Hansen 1971; J. F. de Haan, P. B.
 * Bosma, J. W. Hovenier, A&A 183, 1987). Any vertical profile of one medium is a slab of its whole
 * vertical optical depth. Black below, no light but the sun.
 *
 * The wanted views are directions of the solution itself (with weight 0), so nothing is
 * interpolated; light that was scattered once is added from its closed form, with the phase
 * function itself and not its Legendre series.
 */
#ifndef NEPH_TRUTH_SLAB_H
#define NEPH_TRUTH_SLAB_H

#include "scenes/scene.h"

#define NEPH_SLAB_COSINE_MIN 1e-4
/* At albedo 1 rounding absorbs 1e-16 per event, and tau^2 events come before light gets through:
 * 1e-8 of it here. */
#define NEPH_SLAB_OPTICAL_DEPTH_MAX 1e4
/* The largest |g| of Henyey-Greenstein for radiances. Fluxes go to 0.999. */
#define NEPH_SLAB_RADIANCE_G_MAX 0.93

struct neph_slab;

struct neph_slab_params {
    double optical_depth; /* vertical, 0..NEPH_SLAB_OPTICAL_DEPTH_MAX */
    double albedo;        /* single scattering, 0..1 */
    struct neph_phase phase;
    double sun_cosine; /* cosine of the sun's angle to the vertical, NEPH_SLAB_COSINE_MIN..1 */
    /* Cosines to the vertical of the light that leaves, NEPH_SLAB_COSINE_MIN..1, in any order, for
     * radiances. None: fluxes alone, much cheaper. Read by neph_slab_create() alone. */
    int view_count;
    const double *view_cosines;
    int node_count; /* of the quadrature per hemisphere, 2..512; 0: enough for 8 digits */
};

/* Solve, on all processors. Free with neph_slab_destroy. NEPH_ERR_INPUT: a parameter is out of its
 * range; NEPH_ERR_UNSUPPORTED: radiances of too sharp a phase function. */
enum neph_status neph_slab_create(const struct neph_slab_params *params, struct neph_slab **slab,
                                  struct neph_diag *diag);

/* NULL is fine. */
void neph_slab_destroy(struct neph_slab *slab);

/* Diffuse fluxes / (sun_cosine * E): upwards at the top, downwards at the bottom, and the part of
 * the sun that comes straight through. Absorbed: 1 - R - T - direct. */
struct neph_slab_fluxes {
    double reflected, transmitted, direct;
};
struct neph_slab_fluxes neph_slab_fluxes(const struct neph_slab *slab);

/* Diffuse radiance / E [1/sr] that leaves the top upwards (reflected) or the bottom downwards
 * (transmitted) with the cosine view_cosines[view]; `azimuth_rad` between the horizontal directions
 * of travel of the sunlight and of the light that leaves: 0 is forward. */
double neph_slab_reflected_per_sr(const struct neph_slab *slab, int view, double azimuth_rad);
double neph_slab_transmitted_per_sr(const struct neph_slab *slab, int view, double azimuth_rad);

/* Chandrasekhar's H function of isotropic scattering ("Radiative Transfer", 1960): the half-space
 * reflects (albedo E / 4 pi) mu0 / (mu + mu0) H(mu) H(mu0). Albedo and cosine 0..1, else NaN. To a
 * relative 1e-12. */
double neph_chandrasekhar_h(double albedo, double cosine);

#endif

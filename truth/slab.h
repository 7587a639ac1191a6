/* SPDX-License-Identifier: MIT
 *
 * The plane-parallel slab with all orders of scattering, solved without Monte Carlo: adding and
 * doubling in double precision (H. C. van de Hulst 1963; J. E. Hansen 1971; J. F. de Haan, P. B.
 * Bosma, J. W. Hovenier, A&A 183, 1987). Any vertical profile of one medium is a slab of its whole
 * vertical optical depth. Black below, no light but the sun.
 */
#ifndef NEPH_TRUTH_SLAB_H
#define NEPH_TRUTH_SLAB_H

#include "scenes/scene.h"

struct neph_slab;

struct neph_slab_params {
    double optical_depth; /* vertical, >= 0 */
    double albedo;        /* single scattering, 0..1 */
    struct neph_phase phase;
    double sun_cosine; /* cosine of the sun's angle to the vertical, (0, 1] */
};

/* Solve; the cost grows with |g| (a second or so at 0.85). Free with neph_slab_destroy. */
enum neph_status neph_slab_create(const struct neph_slab_params *params, struct neph_slab **slab,
                                  struct neph_diag *diag);
void neph_slab_destroy(struct neph_slab *slab);

/* Diffuse fluxes / (sun_cosine * E): what goes up at the top, down at the bottom, and the part of
 * the sun that comes straight through. Absorbed: 1 - R - T - direct. */
struct neph_slab_fluxes {
    double reflected, transmitted, direct;
};
struct neph_slab_fluxes neph_slab_fluxes(const struct neph_slab *slab);

/* Diffuse radiance / E [1/sr] that leaves the top upwards (reflected) or the bottom downwards
 * (transmitted) with cosine `view_cosine` (0, 1] to the vertical; `azimuth_rad` between the
 * horizontal directions of travel of the sunlight and of the light that leaves: 0 is forward. */
double neph_slab_reflected_per_sr(const struct neph_slab *slab, double view_cosine,
                                  double azimuth_rad);
double neph_slab_transmitted_per_sr(const struct neph_slab *slab, double view_cosine,
                                    double azimuth_rad);

/* Chandrasekhar's H function of isotropic scattering ("Radiative Transfer", 1960): the half-space
 * reflects (albedo E / 4 pi) mu0 / (mu + mu0) H(mu) H(mu0). To a relative 1e-12. */
double neph_chandrasekhar_h(double albedo, double cosine);

#endif

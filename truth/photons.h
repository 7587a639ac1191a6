/* SPDX-License-Identifier: MIT
 *
 * Photons: light traced from the sun through a scene, for the fluxes of truth/fluxes.h.
 */
#ifndef NEPH_TRUTH_PHOTONS_H
#define NEPH_TRUTH_PHOTONS_H

#include "truth/flux_sums.h"
#include "truth/random.h"
#include "truth/tracking.h"

/* All pointers are borrowed. */
struct neph_photons {
    const struct neph_scene *scene; /* of neph_flux_scene() */
    const struct neph_tracker *tracker;
    struct neph_flux_domain domain;
    int channel_count;
    int launch_low[2], launch_high[2]; /* columns along x, z above which photons start; beyond the
                                        * domain where it is open, since sunlight enters there */
};

/* NEPH_ERR_INPUT: the sun is so low that its light enters an open domain from too far. */
enum neph_status neph_photons_init(struct neph_photons *photons, const struct neph_scene *scene,
                                   const struct neph_tracker *tracker,
                                   const struct neph_flux_domain *domain, int channel_count,
                                   struct neph_diag *diag);

/* Trace `paths` photons from each column; adds their parts to `values`, [flux][column][channel].
 * Stops early when interrupted. */
void neph_photons_trace(const struct neph_photons *photons, uint64_t seed, int batch, int paths,
                        double *values);

#endif

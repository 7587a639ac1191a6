/* SPDX-License-Identifier: MIT
 *
 * Fluxes of sunlight through the columns of a scene, the quantities of intercomparisons of
 * radiation codes (R. F. Cahalan et al., "The I3RC", BAMS 86, 2005). Other light is left out, and
 * all orders of scattering count. The domain is a box between two levels, divided into columns. All
 * values are divided by mu0 E, the sunlight on a level plane, and are means over a column.
 *
 * Fluxes are by photons, light traced from the sun: as many start above each column, free paths as
 * in truth/tracking.h, directions by the phase function. A photon leaves its weight at the levels
 * that it crosses, and at each collision its absorbed part, so no flux is computed from the others.
 * Its sunlight that reaches the bottom level unscattered is exact. Radiances are by the paths of
 * truth/oracle.h, which start on a level.
 *
 * Standard errors are from independent batches, each of all columns.
 */
#ifndef NEPH_TRUTH_FLUXES_H
#define NEPH_TRUTH_FLUXES_H

#include "truth/flux_sums.h"

/* Trace, in double precision on all processors; the bits do not depend on their number. `fluxes` is
 * set only on success. NEPH_ERR_INTERRUPTED; errors as of neph_flux_domain_find() and
 * neph_oracle_can_render(). */
enum neph_status neph_fluxes_trace(const struct neph_scene *scene,
                                   const struct neph_fluxes_params *params,
                                   struct neph_fluxes *fluxes, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Fills the table of moments. Each pass adds an order of scattering: light that arrives at a node
 * from all directions consists of sunlight, the field so far and light of the ground, scattered
 * once more.
 */
#ifndef NEPH_RENDERER_SKY_SOLVE_H
#define NEPH_RENDERER_SKY_SOLVE_H

#include "renderer/sky/walk.h"

enum { NEPH_SKY_DIRECTIONS_MAX = 64 }; /* limit of each of the counts below */

struct neph_sky_solve_params {
    int altitudes, suns, degree; /* of the field */
    int orders;                  /* passes: orders of scattering in the field, 1 or more */
    bool closure; /* isotropic, with Hillaire's series instead of orders; the degree is then 0 */
    int above, below, around; /* directions of a node: above its horizon, below it, and azimuths
                                 over half a turn */
    int steps;                /* along each direction */
};

/* Nodes and weights of Gauss-Legendre on [-1, 1]. */
void neph_sky_gauss(int count, double nodes[NEPH_SKY_DIRECTIONS_MAX],
                    double weights[NEPH_SKY_DIRECTIONS_MAX]);

/* Free the field with neph_sky_field_destroy(), also after an error. */
enum neph_status neph_sky_solve(const struct neph_sky_air *air,
                                const struct neph_sky_sun_table *sun,
                                const struct neph_sky_solve_params *params,
                                struct neph_sky_field *field, struct neph_diag *diag);

#endif

/* SPDX-License-Identifier: MIT
 *
 * What the line integral needs to know of the density of Horizon clouds. Private to
 * scenes/horizon*.c.
 */
#ifndef NEPH_SCENES_HORIZON_DENSITY_H
#define NEPH_SCENES_HORIZON_DENSITY_H

#include "base/vec3.h"

struct neph_horizon;
struct neph_horizon_params;

struct neph_horizon_sample {
    double density, without_detail;
    /* There is cloud where it is above 0. Elsewhere at least (and between clamps, smoothly) how far
     * base noise, coverage and detail are from making some. */
    double margin;
    /* One bit for each clamp and maximum of the formulas: which side of it counts. Between faces
     * of texels the density is smooth among points that agree on all bits. 0 where it is 0. */
    unsigned sides;
};

/* At a point of the layer; all 0 but for a margin of -1 outside. */
void neph_horizon_sample(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                         struct neph_horizon_sample *sample);

/* Above the bottom of the layer, negative below it; keeps its digits near it. */
double neph_horizon_altitude_m(const struct neph_horizon_params *params, struct neph_vec3 point_m);

#endif

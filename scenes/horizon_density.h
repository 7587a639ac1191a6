/* SPDX-License-Identifier: MIT
 *
 * Details of the density of Horizon clouds for their line integral. Private to scenes/horizon*.c.
 */
#ifndef NEPH_SCENES_HORIZON_DENSITY_H
#define NEPH_SCENES_HORIZON_DENSITY_H

#include "base/vec3.h"

struct neph_horizon;
struct neph_horizon_params;

struct neph_horizon_sample {
    double density, without_detail;
    /* Above 0 in a cloud. Elsewhere (smooth between clamps) a lower bound of the distance of base
     * noise, coverage and detail from making a cloud. */
    double margin;
    /* One bit for each clamp and maximum of the formulas: its active side. Between faces of texels
     * the density is smooth among points with equal bits. 0 where the density is 0. */
    unsigned sides;
};

/* Samples a point of the layer; outside all members are 0 except a margin of -1. */
void neph_horizon_sample(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                         struct neph_horizon_sample *sample);

/* Altitude above the bottom of the layer, negative below; precise near it. */
double neph_horizon_altitude_m(const struct neph_horizon_params *params, struct neph_vec3 point_m);

#endif

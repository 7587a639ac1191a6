/* SPDX-License-Identifier: MIT
 *
 * Places at which a ray is split, so that quadrature of the light scattered along it resolves all
 * features.
 */
#ifndef NEPH_SCENES_CUTS_H
#define NEPH_SCENES_CUTS_H

#include "scenes/scene.h"

/* A ray through one 1024^3 grid needs 3.1e3 cuts, the shadows of a fence 2e3. */
#define NEPH_CUTS_MAX 8192

struct neph_cuts {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    double t0_m, t1_m; /* of the ray; only cuts strictly inside are kept */
    int count;
    double at_m[NEPH_CUTS_MAX];
};

/* Adds a cut at t if it lies inside the ray; the last two places are kept for the ends. */
void neph_cuts_add(struct neph_cuts *cuts, double t_m);

/* The part of the ray inside the bounds; false when there is none. */
bool neph_cuts_clip(const struct neph_cuts *cuts, const struct neph_bounds *bounds, double *t0_m,
                    double *t1_m);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The pieces of a ray over which light is integrated, and the media before each. Private to truth/.
 */
#ifndef NEPH_TRUTH_PIECES_H
#define NEPH_TRUTH_PIECES_H

#include "scenes/cuts.h"
#include "scenes/quadrature.h"

struct neph_pieces {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    int count;
    struct neph_interval at_m[NEPH_CUTS_MAX];
    struct neph_rgb depth_before[NEPH_CUTS_MAX]; /* optical depth from the origin to its start */
};

/* Fill in `depth_before` once the rest is there. */
void neph_pieces_sum_depths(struct neph_pieces *pieces);

/* neph_integrate() of light in the media of a scene; where one has kinks inside its pieces,
 * neph_integrate_rough() to the tolerance. */
double neph_pieces_integrate(const struct neph_scene *scene, neph_integrand *integrand,
                             void *context, const struct neph_interval *pieces, int piece_count,
                             double rough_tolerance, double result[3]);

/* Optical depth from the origin to t, of which only the last piece is walked. */
struct neph_rgb neph_pieces_depth_to(const struct neph_pieces *pieces, double t_m);

#endif

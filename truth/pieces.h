/* SPDX-License-Identifier: MIT
 *
 * The pieces of a ray for integration, with the optical depths before them. Private to truth/.
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
    struct neph_rgb depth_before[NEPH_CUTS_MAX]; /* optical depth from the origin to the piece's
                                                  * start */
};

/* Set `depth_before`; the other members are set. */
void neph_pieces_sum_depths(struct neph_pieces *pieces);

/* neph_integrate() of light in the media of a scene; neph_integrate_rough() with this tolerance if
 * a medium has kinks inside the pieces. */
double neph_pieces_integrate(const struct neph_scene *scene, neph_integrand *integrand,
                             void *context, const struct neph_interval *pieces, int piece_count,
                             double rough_tolerance, double result[3]);

/* Optical depth from the origin to t; only the last piece is integrated. */
struct neph_rgb neph_pieces_depth_to(const struct neph_pieces *pieces, double t_m);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Divides a ray into pieces for the quadrature of the light scattered along it. It is cut at the
 * kinks of the integrand (faces of media, shadows of solids, cells of grids; cells last, because
 * not all may fit), and at the scale of every medium. Private to truth/.
 */
#ifndef NEPH_TRUTH_CUTS_H
#define NEPH_TRUTH_CUTS_H

#include "scenes/cuts.h"
#include "scenes/quadrature.h"

/* The sunlit pieces of t in [t0_m, t1_m] of origin + t direction, cut as above, ascending. Without
 * `scales`: cut only at kinks of homogeneous media and at shadows. `pieces` has space for
 * NEPH_CUTS_MAX. Returns their number. */
int neph_lit_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m, bool scales,
                    struct neph_interval *pieces);

/* The same, with scales, for a point light instead of the sun, and finite t1_m: also cut at the
 * light's foot and where the ray crosses the inner and outer cone of a spot. */
int neph_light_lit_pieces(const struct neph_scene *scene, const struct neph_light *light,
                          struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                          double t1_m, struct neph_interval *pieces);

/* All pieces of [t0_m, t1_m], without shadows. */
int neph_ray_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m,
                    struct neph_interval *pieces);

#endif

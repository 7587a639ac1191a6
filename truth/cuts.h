/* SPDX-License-Identifier: MIT
 *
 * The lit pieces of a ray, cut so that quadrature of the light scattered along it misses nothing:
 * at the kinks of the integrand (faces of media, shadows of solids, cells of grids, which come
 * last, for all of them may not fit), and at the scale of every medium. Private to truth/.
 */
#ifndef NEPH_TRUTH_CUTS_H
#define NEPH_TRUTH_CUTS_H

#include "scenes/cuts.h"
#include "scenes/quadrature.h"

/* The pieces of t in [t0_m, t1_m] of origin + t direction that no solid hides from the sun, cut as
 * said above, ascending; without `scales`, at kinks of homogeneous media and shadows alone.
 * `pieces` holds NEPH_CUTS_MAX. Returns their number. */
int neph_lit_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m, bool scales,
                    struct neph_interval *pieces);

/* As neph_lit_pieces() with scales, for a light in place of the sun, of t1_m that is finite: also
 * cut at its foot and where the ray passes the inner and outer cone of a spot. */
int neph_lamplit_pieces(const struct neph_scene *scene, const struct neph_light *light,
                        struct neph_vec3 origin_m, struct neph_vec3 direction, double t0_m,
                        double t1_m, struct neph_interval *pieces);

/* All of [t0_m, t1_m], for light that is not the sun's. */
int neph_ray_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m,
                    struct neph_interval *pieces);

#endif

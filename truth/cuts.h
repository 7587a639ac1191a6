/* SPDX-License-Identifier: MIT
 *
 * Where to cut a ray so that quadrature of the light scattered along it misses nothing: at the
 * kinks of the integrand (faces of media, cells of grids, shadows of solids), and at the scale of
 * every medium, on the ray itself and in the shadow that the medium throws on it. Private to
 * truth/.
 */
#ifndef NEPH_TRUTH_CUTS_H
#define NEPH_TRUTH_CUTS_H

#include "scenes/quadrature.h"
#include "scenes/scene.h"

/* A ray through one 1024^3 grid needs 3.1e3 cuts, the shadows of a fence 2e3. Cells of grids come
 * last: what does not fit is left to the halving of the quadrature. */
#define NEPH_CUTS_MAX 8192

/* The pieces of t in [t0_m, t1_m] of origin + t direction that no solid hides from the sun, cut as
 * said above, ascending; without `scales`, at kinks of homogeneous media and shadows alone.
 * `pieces` holds NEPH_CUTS_MAX. Returns their number. */
int neph_lit_pieces(const struct neph_scene *scene, struct neph_vec3 origin_m,
                    struct neph_vec3 direction, double t0_m, double t1_m, bool scales,
                    struct neph_interval *pieces);

#endif

/* SPDX-License-Identifier: MIT
 *
 * A straight line relative to a centre: r^2 = impact^2 + s^2, with s counted along the line from
 * its point nearest to the centre. All geometry that a density of r needs along a ray.
 *
 * In long double: the altitude r - R of a place on a planet and the impact of a ray from afar are
 * small differences of large numbers. Where long double is no wider than double, results stay
 * correct up to R / H roundings.
 */
#ifndef NEPH_SCENES_RADIAL_H
#define NEPH_SCENES_RADIAL_H

#include "base/vec3.h"

struct neph_radial_line {
    long double impact_m; /* smallest distance from the centre */
    long double s0_m, s1_m;
    long double length_m; /* s1 - s0, computed before either was rounded */
};

/* origin + t direction for t in [t0_m, t1_m]; t1_m may be +inf, and then s1_m is. The direction is
 * unit up to rounding, which is corrected. */
struct neph_radial_line neph_radial_line(struct neph_vec3 center_m, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction, double t0_m, double t1_m);

/* |point - center| [m]. */
long double neph_radial_distance_m(struct neph_vec3 center_m, struct neph_vec3 point_m);

#endif

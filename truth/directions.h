/* SPDX-License-Identifier: MIT
 *
 * Random directions: exact inversion of phase functions, and Lambert's cosine law.
 */
#ifndef NEPH_TRUTH_DIRECTIONS_H
#define NEPH_TRUTH_DIRECTIONS_H

#include "scenes/scene.h"
#include "truth/random.h"

/* Sample a direction after scattering: density neph_phase_per_sr() of the cosine. Unit. */
struct neph_vec3 neph_phase_sample(const struct neph_phase *phase, struct neph_vec3 direction,
                                   struct neph_random *random);

/* By channel, the density with which it would have drawn a direction, over that of the channel that
 * drew it. All 1 where the latter is 0, as rounding at the edge of a table can make it. */
void neph_direction_ratios(struct neph_rgb drawn_per_sr, int channel, double ratio[3]);

/* Sample a reflected direction of a Lambertian surface: density cos / pi on the side of the unit
 * normal. Unit. */
struct neph_vec3 neph_cosine_sample(struct neph_vec3 normal, struct neph_random *random);

/* Two unit vectors perpendicular to a unit vector (T. Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 6(1), 2017). */
void neph_basis(struct neph_vec3 n, struct neph_vec3 *a, struct neph_vec3 *b);

/* A direction at an angle from an axis (unit), at a random azimuth. */
struct neph_vec3 neph_direction_around(struct neph_vec3 axis, double angle_rad,
                                       struct neph_random *random);

#endif

/* SPDX-License-Identifier: MIT
 *
 * How paths sample point lights with finite variance. A light next to a collision contributes 1 /
 * d^2, and the square of that has no finite mean in space. So a point is sampled on each straight
 * segment of a path, and collisions themselves do not sample lights. Points come from a mixture:
 *
 *   1 / d^2  (equiangular: C. Kulla, M. Fajardo, "Importance Sampling Techniques for Path Tracing
 *            in Participating Media", EGSR 2012), for light through clear air;
 *   1 / d    equally many points in every octave of the distance d from the light. It finds the
 *            medium where the first one misses it: a light in an empty part of a grid, or one
 *            behind a solid, where the peak of 1 / d^2 contributes nothing.
 *
 * Both have limits without cancellation if the segment passes the light at a distance of 0, as long
 * as there is no medium; with a medium at the light the radiance is infinite (lamp_peak.h).
 *
 * Over directions, the 1 / h of a segment that passes a light at the distance h has no finite mean
 * square either (a logarithm diverges). So a few directions are sampled by 1 / sin of the angle
 * from a light, in a mixture with those of scattering.
 */
#ifndef NEPH_TRUTH_LAMP_DRAW_H
#define NEPH_TRUTH_LAMP_DRAW_H

#include "scenes/scene.h"
#include "truth/random.h"

/* The share of points sampled by 1 / d. It costs at most 1 / (1 - share) of the samples where 1 /
 * d^2 would suffice. */
#define NEPH_LIGHT_POINTS_BY_OCTAVE (1.0 / 4)

/* A point on a segment, and the sampled light. */
struct neph_light_point {
    const struct neph_light *light;
    double t_m;
    struct neph_vec3 to_light; /* unit */
    double distance_m;         /* to the light, from the triangle, to avoid cancellation */
    double density_per_m;      /* of this point and light; 0: no lit medium on the segment */
};

/* Sample a point on origin + t direction, t in [0, end_m] (may be +inf), inside media. */
struct neph_light_point neph_light_point_sample(const struct neph_scene *scene,
                                                struct neph_vec3 origin_m,
                                                struct neph_vec3 direction, double end_m,
                                                struct neph_random *random);

/* Choose a light for a surface, by its irradiance without cosine and occlusion; NULL: no light. */
const struct neph_light *neph_light_choose(const struct neph_scene *scene, struct neph_vec3 point_m,
                                           double *probability, struct neph_random *random);

/* The share of directions sampled by neph_light_direction_sample(). */
#define NEPH_LIGHT_DIRECTIONS (1.0 / 8)

/* Sample a direction by 1 / sin of its angle from a light, with equal weights of the lights; and
 * the density of any direction [1/sr]. */
struct neph_vec3 neph_light_direction_sample(const struct neph_scene *scene,
                                             struct neph_vec3 point_m, struct neph_random *random);
double neph_light_direction_per_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
                                   struct neph_vec3 direction);

#endif

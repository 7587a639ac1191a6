/* SPDX-License-Identifier: MIT
 *
 * How paths sample point lights, so that the variance stays finite. A light next to a collision
 * brings 1 / d^2. The square of that has no mean in space. So a place is drawn on each straight
 * segment of a path, and collisions themselves sample no light. Places are drawn by a mixture:
 *
 *   1 / d^2  (equiangular: C. Kulla, M. Fajardo, "Importance Sampling Techniques for Path Tracing
 *            in Participating Media", EGSR 2012), for light through clear air;
 *   1 / d    which has as many places in every octave of the distance d from the light. It finds
 *            the medium where the first misses it: a light in an empty part of a grid, or one
 *            behind a solid, where the peak of 1 / d^2 brings nothing.
 *
 * Both have limits without cancellation where the segment passes the light at a distance of 0, as
 * long as no medium is there; with a medium at the light the radiance is infinite (lamp_peak.h).
 *
 * Over directions 1 / h of a segment that passes a light at the distance h has no mean square
 * either, by a logarithm: so few of the directions are drawn by 1 / sin of the angle from a light,
 * in a mixture with those of scattering.
 */
#ifndef NEPH_TRUTH_LAMP_DRAW_H
#define NEPH_TRUTH_LAMP_DRAW_H

#include "scenes/scene.h"
#include "truth/random.h"

/* The part of places that are drawn by 1 / d. It costs at most 1 / (1 - part) of the samples where
 * 1 / d^2 is all that is needed. */
#define NEPH_LAMP_PLACES_BY_OCTAVE (1.0 / 4)

/* A place on a segment, and the light that is sampled from there. */
struct neph_lamp_place {
    const struct neph_light *light;
    double t_m;
    struct neph_vec3 to_light; /* unit */
    double distance_m;         /* to the light: from the triangle, so that it does not cancel */
    double density_per_m;      /* of this place and light; 0: no medium is lit on the segment */
};

/* Draw one from origin + t direction, t in [0, end_m] (may be +inf), where media are. */
struct neph_lamp_place neph_lamp_place_draw(const struct neph_scene *scene,
                                            struct neph_vec3 origin_m, struct neph_vec3 direction,
                                            double end_m, struct neph_random *random);

/* For a surface: a light by its irradiance without cosine and obstacles; NULL: none shines. */
const struct neph_light *neph_lamp_pick(const struct neph_scene *scene, struct neph_vec3 point_m,
                                        double *probability, struct neph_random *random);

/* The part of directions that are drawn by neph_lamp_direction_draw(). */
#define NEPH_LAMP_DIRECTIONS (1.0 / 8)

/* A direction by 1 / sin of its angle from a light, all lights being alike, and the density of
 * any [1/sr]. */
struct neph_vec3 neph_lamp_direction_draw(const struct neph_scene *scene, struct neph_vec3 point_m,
                                          struct neph_random *random);
double neph_lamp_direction_per_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
                                  struct neph_vec3 direction);

#endif

/* SPDX-License-Identifier: MIT
 *
 * How paths look for point lights, so that the variance stays finite. A light next to a collision
 * brings 1 / d^2, whose square has no mean in space. So on each straight segment of a path a place
 * is drawn whose density goes with 1 / d^2 (equiangular: C. Kulla, M. Fajardo, "Importance Sampling
 * Techniques for Path Tracing in Participating Media", EGSR 2012), and collisions themselves look
 * for no light. What is left, 1 / h of a segment that passes a light at the distance h, has no mean
 * square over directions either, by a logarithm: so few of the directions are drawn by 1 / sin of
 * the angle from a light, in a mixture with those of scattering.
 */
#ifndef NEPH_TRUTH_LAMP_DRAW_H
#define NEPH_TRUTH_LAMP_DRAW_H

#include "scenes/scene.h"
#include "truth/random.h"

/* A place on a segment, and the light that is looked for from there. */
struct neph_lamp_place {
    const struct neph_light *light;
    double t_m;
    double density_per_m; /* that of this place and light; 0: there is nothing to look for */
};

/* Draw one from origin + t direction, t in [t0_m, t1_m] (may be +inf): the light by what it would
 * bring through clear air. */
struct neph_lamp_place neph_lamp_place_draw(const struct neph_scene *scene,
                                            struct neph_vec3 origin_m, struct neph_vec3 direction,
                                            double t0_m, double t1_m, struct neph_random *random);

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

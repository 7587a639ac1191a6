/* SPDX-License-Identifier: MIT
 *
 * Lights: points of a radiant intensity, all around or in a cone. From the inner to the outer angle
 * of a cone the intensity falls as 3 x^2 - 2 x^3 of x = (cos - cos_outer) / (cos_inner -
 * cos_outer), the cosines being those of angles from the axis: smooth at both ends, and what Cycles
 * and POV-Ray have, too.
 */
#ifndef NEPH_SCENES_LIGHTS_H
#define NEPH_SCENES_LIGHTS_H

#include "scenes/scene.h"

/* The part of the intensity that goes into a direction (unit, from the light), 0..1. */
double neph_light_falloff(const struct neph_light *light, struct neph_vec3 direction);

/* What a light does at a point, if nothing is in its way. */
struct neph_lit {
    struct neph_vec3 direction; /* unit, from the point to the light */
    double distance_m;
    struct neph_rgb
        irradiance_w_per_m2; /* on a plane across the direction; at the light itself 0 */
};

struct neph_lit neph_light_at(const struct neph_light *light, struct neph_vec3 point_m);

/* Whether a spot shines behind itself: witnesses have no such cones. */
bool neph_scene_has_wide_spot(const struct neph_scene *scene);
extern const char neph_wide_spot_reason[];

/* For messages of engines that know no lights. */
extern const char neph_lights_reason[];

#endif

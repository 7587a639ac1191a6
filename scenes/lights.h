/* SPDX-License-Identifier: MIT
 *
 * Lights: points with a radiant intensity, in all directions or in a cone. Between the inner and
 * the outer angle of a cone the intensity falls as 3 x^2 - 2 x^3 with x = (cos - cos_outer) /
 * (cos_inner
 * - cos_outer), for cosines of angles from the axis: smooth at both ends, and the same law as in
 * Cycles and POV-Ray.
 */
#ifndef NEPH_SCENES_LIGHTS_H
#define NEPH_SCENES_LIGHTS_H

#include "scenes/scene.h"

/* The part of the intensity that goes into a direction (unit, from the light), 0..1. */
double neph_light_falloff(const struct neph_light *light, struct neph_vec3 direction);

/* The light at a point, without obstacles. */
struct neph_lit {
    struct neph_vec3 direction; /* unit, from the point to the light */
    double distance_m;
    /* on a plane perpendicular to the direction; 0 at the light */
    struct neph_rgb irradiance_w_per_m2;
};

struct neph_lit neph_light_at(const struct neph_light *light, struct neph_vec3 point_m);

/* Whether the cone of a spot exceeds a half-space, which external renderers do not support. */
bool neph_scene_has_wide_spot(const struct neph_scene *scene);
extern const char neph_wide_spot_reason[];

/* For messages of engines without lights. */
extern const char neph_lights_reason[];

#endif

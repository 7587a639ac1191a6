/* SPDX-License-Identifier: MIT
 *
 * Parts of a scene as JSON, for other programs. Every function returns a new reference, or NULL for
 * a number that is not finite.
 */
#ifndef NEPH_HARNESS_ENGINES_SCENE_JSON_H
#define NEPH_HARNESS_ENGINES_SCENE_JSON_H

#include "harness/json.h"
#include "scenes/scene.h"

json_t *neph_vector_json(struct neph_vec3 v);
json_t *neph_colour_json(struct neph_rgb c);

/* {direction, irradiance_w_per_m2}; null: no sun. */
json_t *neph_sun_json(const struct neph_sun *sun);

/* The lights of a frame: [{position_m, intensity_w_per_sr, cone}, ..]; a cone is null, or its axis
 * and the cosines of its angles. */
json_t *neph_lights_json(const struct neph_scene *scene, double frame);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Places as the device sees them: relative to the camera, subtracted in double and then rounded. A
 * float32 at 1000 km from the world's origin moves in steps of 6 cm, at 1 km from the camera in
 * steps of 0.06 mm. Not for other folders.
 */
#ifndef NEPH_RENDERER_RELATIVE_H
#define NEPH_RENDERER_RELATIVE_H

#include "base/vec3.h"
#include "renderer/shaders/constants.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* No float32 leaves the shaders' finite world. */
float neph_relative_m(double position_m, double camera_m);
void neph_relative_position(float out[3], struct neph_vec3 position_m, struct neph_vec3 camera_m);

/* A direction, or a way from place to place: rounded as it is. */
void neph_gpu_direction(float out[3], struct neph_vec3 direction);

/* A sphere as large as a planet, as seen from the camera. */
struct neph_gpu_globe neph_gpu_globe_from(struct neph_vec3 center_m, double radius_m,
                                          struct neph_vec3 camera_position_m);

/* From a point to the nearest place of a box [m]; 0 inside. */
double neph_box_distance_m(const struct neph_bounds *box, struct neph_vec3 point_m);

#endif

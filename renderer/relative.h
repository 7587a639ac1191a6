/* SPDX-License-Identifier: MIT
 *
 * Positions for the device: relative to the camera, subtracted in double and then rounded. A
 * float32 at 1000 km from the world's origin has steps of 6 cm, at 1 km from the camera steps of
 * 0.06 mm. Not for other folders.
 */
#ifndef NEPH_RENDERER_RELATIVE_H
#define NEPH_RENDERER_RELATIVE_H

#include "base/vec3.h"
#include "renderer/shaders/constants.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* A camera-relative coordinate, clamped to the finite range of the shaders. */
float neph_relative_m(double position_m, double camera_m);
void neph_relative_position(float out[3], struct neph_vec3 position_m, struct neph_vec3 camera_m);

/* A direction or a difference of positions, rounded. */
void neph_gpu_direction(float out[3], struct neph_vec3 direction);

/* A sphere of the size of a planet, relative to the camera. */
struct neph_gpu_globe neph_gpu_globe_from(struct neph_vec3 center_m, double radius_m,
                                          struct neph_vec3 camera_position_m);

/* Distance from a point to the box [m]; 0 inside. */
double neph_box_distance_m(const struct neph_bounds *box, struct neph_vec3 point_m);

#endif

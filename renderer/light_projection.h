/* SPDX-License-Identifier: MIT
 *
 * Positions of the scene's lights in a frame, in double precision. The distance between a light and
 * a pixel's ray is lost in float32 where the ray passes the light closely
 * (shaders/tracer_lamps.glsl). Not for other folders.
 */
#ifndef NEPH_RENDERER_LIGHT_PROJECTION_H
#define NEPH_RENDERER_LIGHT_PROJECTION_H

#include "scenes/scene.h"
#include "shaders/structs.h"

/* The position of a light in camera space. depth_m is 0 for a light behind the camera, or farther
 * from its axis than all rays of the frame: float32 is then sufficient. */
struct neph_gpu_lamp_sight neph_project_light(const struct neph_camera *camera, int width_px,
                                              int height_px, struct neph_vec3 position_m);

#endif

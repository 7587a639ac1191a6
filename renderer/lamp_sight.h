/* SPDX-License-Identifier: MIT
 *
 * Where a frame has the scene's lights, in double precision: how far a light is from a pixel's ray
 * is lost in float32 where the ray passes it closely (shaders/tracer_lamps.glsl). Not for other
 * folders.
 */
#ifndef NEPH_RENDERER_LAMP_SIGHT_H
#define NEPH_RENDERER_LAMP_SIGHT_H

#include "scenes/scene.h"
#include "shaders/structs.h"

/* A light farther from the camera's axis than this tangent, or behind the camera, has depth_m 0:
 * no ray of the frame passes it so closely that float32 does not do. */
struct neph_gpu_lamp_sight neph_lamp_sight(const struct neph_camera *camera, int width_px,
                                           int height_px, struct neph_vec3 position_m);

#endif

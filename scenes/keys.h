/* SPDX-License-Identifier: MIT
 *
 * Keyframes of a scene: of its camera, sun, lights, wind and solids. Maps frames to frames of the
 * keys, and interpolates between keys.
 */
#ifndef NEPH_SCENES_KEYS_H
#define NEPH_SCENES_KEYS_H

#include "scenes/scene.h"

#include <stddef.h>

/* The frame of the keys that a frame shows. With a pause of 60 at key frame 10, frames 10 to 70
 * show key frame 10 and frame 71 shows key frame 11. */
double neph_scene_time_frame(const struct neph_scene *scene, double frame);

/* The keys before and after a frame, and its place between them: 0..1. */
struct neph_span {
    int from, to;
    double part;
};

/* `keys` is an array of structures of `size` bytes that begin with their frame, in ascending order.
 * Before the first and after the last key that key is used. */
struct neph_span neph_span_at(const void *keys, size_t size, int count, double frame);

/* Linear interpolation from a (part 0) to b (part 1). */
struct neph_vec3 neph_mix(struct neph_vec3 a, struct neph_vec3 b, double part);

/* Position and target of the camera at a frame of the keys. */
struct neph_camera_key neph_camera_key_at(const struct neph_scene *scene, double key_frame);

#endif

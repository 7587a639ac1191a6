/* SPDX-License-Identifier: MIT
 *
 * Instances of meshes that move from frame to frame: their places on the device (gpu_meshes.h) are
 * replaced before a frame whose solids differ from those of the frame before. The copy is submitted
 * in order with the frames, so a frame in flight keeps its places. Private to renderer/.
 */
#ifndef NEPH_RENDERER_MESH_MOTION_H
#define NEPH_RENDERER_MESH_MOTION_H

#include "renderer/in_flight.h"
#include "scenes/scene.h"

struct neph_mesh_motion {
    struct neph_solid *solids; /* the scene's solids, as the device has them; NULL: no meshes */
    struct neph_buffer places; /* of the latest frame whose solids moved; none before it */
    struct neph_buffer_ring turns;
};

/* For a scene whose meshes are on the device. Zero-initialise `motion`; free with _destroy, also
 * after an error. */
enum neph_status neph_mesh_motion_create(const struct neph_scene *scene,
                                         struct neph_mesh_motion *motion, struct neph_diag *diag);

/* Replace the places in `buffer` by those of another frame, after neph_in_flight_begin(), above all
 * for rays of `eye_m`. The time of the copy is added to `*gpu_s`; NULL: not reported. */
enum neph_status neph_mesh_motion_update(const struct neph_vulkan *vulkan,
                                         const struct neph_scene *scene, struct neph_vec3 eye_m,
                                         const struct neph_buffer *buffer,
                                         struct neph_mesh_motion *motion, double *gpu_s,
                                         struct neph_diag *diag);

void neph_mesh_motion_destroy(const struct neph_vulkan *vulkan, struct neph_mesh_motion *motion);

#endif

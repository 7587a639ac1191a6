/* SPDX-License-Identifier: MIT
 *
 * The triangle meshes of a scene in the layout of shaders/mesh_data.glsl. Each mesh is there once;
 * its instances have places relative to the middle of all of them, so that nothing changes with the
 * camera. Places of instances that move are written again for each frame (mesh_motion.h). Private
 * to renderer/.
 */
#ifndef NEPH_RENDERER_GPU_MESHES_H
#define NEPH_RENDERER_GPU_MESHES_H

#include "renderer/compute.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* The number of a scene's solids that are meshes, whether one of these moves, and the number of all
 * others. */
int neph_gpu_count_instances(const struct neph_scene *scene);
bool neph_gpu_meshes_move(const struct neph_scene *scene);
int neph_gpu_count_plain_solids(const struct neph_scene *scene);

/* The number of triangles of all instances. */
double neph_gpu_count_triangles(const struct neph_scene *scene);

/* The number of words of four that the meshes take; 0 without meshes. */
size_t neph_gpu_mesh_words(const struct neph_scene *scene);

/* The words with the places of all instances begin at this index, and this is their number. */
enum { NEPH_GPU_MESH_PLACES_FIRST = 1 };
size_t neph_gpu_mesh_place_words(const struct neph_scene *scene);

/* Loop iterations (compute.h) of one ray through all meshes: not a bound, because a bound would be
 * the number of all nodes, but more than most rays need. Where a ray needs more, the frame fails
 * (neph_gpu_meshes_check()). 0 without meshes. */
uint64_t neph_gpu_mesh_iterations(const struct neph_scene *scene);

/* Write the meshes to the start of a buffer that has room for them, above all for rays of `eye_m`.
 * NEPH_ERR_UNSUPPORTED: all instances have more triangles than hits have numbers for. */
enum neph_status neph_gpu_meshes_upload(const struct neph_vulkan *vulkan,
                                        const struct neph_scene *scene, struct neph_vec3 eye_m,
                                        const struct neph_buffer *buffer, struct neph_diag *diag);

/* Write the places of all instances, above all for rays of `eye_m`, to memory for
 * neph_gpu_mesh_place_words(). */
enum neph_status neph_gpu_mesh_places_write(const struct neph_scene *scene, struct neph_vec3 eye_m,
                                            uint32_t (*to)[4], struct neph_diag *diag);

/* The member of a frame, for a camera. */
struct neph_gpu_meshes neph_gpu_meshes_place(const struct neph_scene *scene,
                                             struct neph_vec3 camera_m);

/* NEPH_ERR_UNSUPPORTED: since the upload a device has left a loop over meshes before its end, as
 * lavapipe does after NEPH_KERNEL_LOOP_ITERATIONS_MAX. `readback` has at least 4 bytes.
 * Waits for submitted work. */
enum neph_status neph_gpu_meshes_check(const struct neph_vulkan *vulkan,
                                       const struct neph_buffer *buffer,
                                       const struct neph_buffer *readback, struct neph_diag *diag);

#endif

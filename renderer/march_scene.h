/* SPDX-License-Identifier: MIT
 *
 * The device data of a scene that a march reads: the scene of one frame, in memory with one copy
 * for each frame in flight, and the tables of its real-time methods. Not for other folders.
 */
#ifndef NEPH_RENDERER_MARCH_SCENE_H
#define NEPH_RENDERER_MARCH_SCENE_H

#include "renderer/cloud_shadow.h"
#include "renderer/diffused_light.h"
#include "renderer/froxel_scene.h"
#include "renderer/gpu_scene.h"
#include "renderer/in_flight.h"
#include "renderer/skip_cells.h"
#include "renderer/sky/split.h"
#include "renderer/sky/tables.h"
#include "renderer/sky_shade.h"
#include "renderer/slab_light.h"
#include "renderer/sun_cache.h"
#include "renderer/traced_light.h"

struct neph_march_scene {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_gpu_scene gpu;
    struct neph_buffer_ring frame_ring, solid_ring;
    struct neph_skip_cells skip_cells;
    struct neph_sun_cache sun_cache;
    struct neph_cloud_shadow cloud_shadow;
    struct neph_traced_light traced_light;
    struct neph_diffused_light diffused_light;
    struct neph_slab_light slab_light;
    struct neph_froxel_scene froxels;
    bool has_sky, has_fog_look;
    struct neph_sky_split split; /* of the air, if the scene has one */
    struct neph_sky_tables sky;
    struct neph_sky_shade sky_shade;
    struct neph_buffer no_sky;
};

/* Create the data for a march with these parameters, at their frame. Zero-initialise `scene`; free
 * with _destroy, also after an error. Errors as of neph_gpu_scene_create() and of the _create
 * functions of the tables. */
enum neph_status neph_march_scene_create(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                         const struct neph_march_params *params,
                                         struct neph_march_scene *scene, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_march_scene_destroy(const struct neph_vulkan *vulkan, struct neph_march_scene *scene);

/* Device times of a frame's work before its march, set when the frame is collected; borrowed until
 * then. */
struct neph_march_scene_cost {
    struct neph_sun_fill_cost *fill;
    double *places_gpu_s;       /* of the places of meshes that move */
    double *light_gpu_s;        /* of traced or diffused light */
    struct neph_sky_times *sky; /* added to; NULL: no sky */
};

/* Update to another frame, after neph_in_flight_begin(), in memory that no other frame reads.
 * Errors as of neph_march_frame(). */
enum neph_status neph_march_scene_update(const struct neph_scene *from,
                                         const struct neph_march_params *params, double frame,
                                         const struct neph_march_frame_state *moment,
                                         struct neph_march_scene *scene,
                                         struct neph_march_scene_cost *cost,
                                         struct neph_diag *diag);

/* Set the buffers of shaders/march_run.glsl, except the march's own at NEPH_GPU_SCENE_BUFFERS and
 * the next binding. */
void neph_march_scene_bind(const struct neph_march_scene *scene, struct neph_dispatch *dispatch);

/* As neph_march_scene_bind(), with the scene of froxels (froxel_scene.h). */
void neph_march_scene_bind_froxels(const struct neph_march_scene *scene,
                                   struct neph_dispatch *dispatch);

#endif

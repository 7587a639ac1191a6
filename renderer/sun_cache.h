/* SPDX-License-Identifier: MIT
 *
 * Optical depth of shapes (all media but fogs) towards the sun at the nodes of a lattice over their
 * bounds, on the device: shaders/sun_cache.glsl looks it up, shaders/sun_cache.comp fills it, when
 * sun or media have moved; at once, or a part of it in each of the next pictures, while the rest
 * still has the depths of before. The nodes belong to the world: a camera that moves keeps them.
 *
 * Method: A. Schneider, "Nubis Cubed" (Advances in Real-Time Rendering, SIGGRAPH 2023), whose grid
 * of densities summed towards the sun has 256 x 256 x 32 cells; here the lattice is of cubes.
 */
#ifndef NEPH_RENDERER_SUN_CACHE_H
#define NEPH_RENDERER_SUN_CACHE_H

#include "renderer/sun_fill.h"

struct neph_sun_cache {
    struct neph_vulkan *vulkan; /* borrowed */
    uint32_t size[3];           /* nodes; 0: there is no lattice */
    size_t value_count;         /* of the lattice, at the beginning of `nodes` */
    /* At binding 7 of a march, whether there is a lattice or not. Behind the lattice there is room
     * for what else goes by the sun (cloud_shadow.h): ray passes have no binding left. */
    struct neph_buffer nodes;
    struct neph_sun_fill fill;
};

/* An empty cache for a march with these parameters; without a lattice when they want none, or there
 * is no shape. `values_behind` floats lie behind it. Zero-initialise `cache`; free with _destroy,
 * also after an error. NEPH_ERR_UNSUPPORTED: a shape has no finite bounds; a lattice larger than
 * the device allows. */
enum neph_status neph_sun_cache_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, size_t values_behind,
                                       struct neph_sun_cache *cache, struct neph_diag *diag);

/* Place the lattice in a frame of the scene, as neph_gpu_scene_move() has made it, and send what is
 * stale of it, or the part whose turn it is, on its way to be filled, before the frame's own
 * passes. `cost` is borrowed until the frame is home. Errors as of neph_march_frame(). */
enum neph_status neph_sun_cache_fill(struct neph_sun_cache *cache, const struct neph_scene *scene,
                                     double frame, const struct neph_gpu_scene *gpu,
                                     const struct neph_skip_cells *skip,
                                     struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero cache is fine. */
void neph_sun_cache_destroy(struct neph_sun_cache *cache);

#endif

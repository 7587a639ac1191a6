/* SPDX-License-Identifier: MIT
 *
 * The light grid: optical depth of bounded media (all except fogs) towards the sun, at the nodes of
 * a grid over their bounds, on the device. shaders/sun_cache.comp fills it and
 * shaders/sun_cache.glsl samples it. After a change of sun or media it is filled at once, or in
 * parts over several frames, with old depths in the other parts. Nodes are in world space: camera
 * motion does not invalidate them.
 *
 * Method: A. Schneider, "Nubis Cubed" (Advances in Real-Time Rendering, SIGGRAPH 2023), which sums
 * densities towards the sun in a grid of 256 x 256 x 32 cells; this grid has cubic cells.
 */
#ifndef NEPH_RENDERER_SUN_CACHE_H
#define NEPH_RENDERER_SUN_CACHE_H

#include "renderer/sun_fill.h"

struct neph_sun_cache {
    struct neph_vulkan *vulkan; /* borrowed */
    uint32_t size[3];           /* nodes; 0: no grid */
    size_t value_count;         /* size of the grid, at the start of `nodes` */
    /* At binding 7 of a march, with or without a grid. Other tables that depend on the sun follow
     * the grid (cloud_shadow.h), because ray passes have no free binding. */
    struct neph_buffer nodes;
    struct neph_sun_fill fill;
};

/* Create an empty cache for a march with these parameters; without a grid if they select none, or
 * there is no bounded medium. `values_behind` floats follow it. Zero-initialise `cache`; free with
 * _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a medium that is not a fog has no finite
 * bounds; a grid larger than the device allows. */
enum neph_status neph_sun_cache_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params, size_t values_behind,
                                       struct neph_sun_cache *cache, struct neph_diag *diag);

/* Place the grid in a frame of the scene, after neph_gpu_scene_update(), and submit the filling of
 * its stale nodes or of the next part, before the frame's own passes. `cost` is borrowed until the
 * frame is collected. Errors as of neph_march_frame(). */
enum neph_status neph_sun_cache_fill(struct neph_sun_cache *cache, const struct neph_scene *scene,
                                     double frame, const struct neph_gpu_scene *gpu,
                                     const struct neph_skip_cells *skip,
                                     struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero-initialised cache is fine. */
void neph_sun_cache_destroy(struct neph_sun_cache *cache);

#endif

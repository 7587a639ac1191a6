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

#include "renderer/in_flight.h"
#include "renderer/march_cut.h"
#include "renderer/skip_cells.h"

struct neph_sun_cache {
    struct neph_vulkan *vulkan; /* borrowed */
    struct neph_march_params params;
    uint32_t size[3];            /* nodes; 0: there is no lattice */
    struct neph_buffer nodes;    /* at binding 7 of a march, whether there is a lattice or not */
    struct neph_buffer counters; /* of the newest filling */
    struct neph_turns counter_turns;
    struct neph_march_cut cut; /* of all nodes */
    bool is_filled;
    int part, stale_parts; /* which is filled next; how many are of an older sun or medium */
    struct neph_sun sun;   /* what it was filled for last */
    struct neph_gpu_medium media[NEPH_GPU_MEDIA_MAX]; /* in the world */
};

/* What a filling costs, known when the frame that it is for is home; zeros when nothing was to be
 * done. */
struct neph_sun_cache_cost {
    double gpu_s;                                 /* NaN when the device has no clock */
    const struct neph_gpu_sun_counters *counters; /* borrowed from the cache; NULL: all are 0 */
    int dispatches;
};

/* An empty cache for a march with these parameters; without a lattice when they want none, or there
 * is no shape. Zero-initialise `cache`; free with _destroy, also after an error.
 * NEPH_ERR_UNSUPPORTED: a shape has no finite bounds; a lattice larger than the device allows. */
enum neph_status neph_sun_cache_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const struct neph_gpu_scene *gpu,
                                       const struct neph_march_params *params,
                                       struct neph_sun_cache *cache, struct neph_diag *diag);

/* Place the lattice in a frame of the scene, as neph_gpu_scene_move() has made it, and send what is
 * stale of it, or the part whose turn it is, on its way to be filled, before the frame's own
 * passes. `cost` is borrowed until the frame is home. Errors as of neph_march_frame(). */
enum neph_status neph_sun_cache_fill(struct neph_sun_cache *cache, const struct neph_scene *scene,
                                     double frame, const struct neph_gpu_scene *gpu,
                                     const struct neph_skip_cells *skip,
                                     struct neph_sun_cache_cost *cost, struct neph_diag *diag);

/* What has been counted, once that is home. */
void neph_sun_cache_counts(const struct neph_sun_cache_cost *cost, uint64_t *density_evaluations,
                           uint64_t *closed_forms);

/* A zero cache is fine. */
void neph_sun_cache_destroy(struct neph_sun_cache *cache);

#endif

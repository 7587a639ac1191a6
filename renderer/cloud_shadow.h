/* SPDX-License-Identifier: MIT
 *
 * The shadow map of clouds: transmittance of the sunlight through all bounded media (all media
 * except fogs) at the texels of a plane. Solids and the air between clouds are lit by it.
 * shaders/cloud_shadow.comp fills the map; shaders/cloud_shadow.glsl samples it.
 *
 * Method: the Beer shadow map of S. Hillaire, "Physically Based Sky, Atmosphere and Cloud Rendering
 * in Frostbite" (SIGGRAPH 2016 course): a front depth and a slope of optical depth per texel. More
 * depths per texel refine it as in T. Lokovic and E. Veach, "Deep Shadow Maps" (SIGGRAPH 2000).
 *
 * Measures against shimmering shadows:
 *
 * - With NEPH_SHADOW_LEVEL texels are columns of air at the height of the clouds and move with them
 *   in the wind. A moving sun only slants the columns. So the errors of a shadow move together with
 *   the shadow.
 * - Texel sizes are multiples of an eighth of an octave, so they seldom change as the sun moves.
 * - Maps around the camera move by whole texels.
 */
#ifndef NEPH_RENDERER_CLOUD_SHADOW_H
#define NEPH_RENDERER_CLOUD_SHADOW_H

#include "renderer/sun_cache.h"
#include "renderer/sun_fill.h"

/* The transform from world to light space: a point `p` has the coordinates dot(p - origin_m,
 * across[i]) on the plane, and the distance dot(p - origin_m, along) from it along its sun ray. */
struct neph_shadow_space {
    struct neph_vec3 side[2]; /* unit vectors in the plane */
    struct neph_vec3 across[2], along;
    struct neph_vec3 origin_m;
    double start_m;            /* beyond all clouds towards the sun */
    struct neph_shadow_level { /* texel i along a side is at low_m + i texel_m */
        double texel_m[2], low_m[2];
    } levels[NEPH_GPU_SHADOW_LEVELS_MAX]; /* each inside the next; unused levels are zero */
};

/* The light space of a scene with a sun and bounded media, in one frame. */
struct neph_shadow_space neph_shadow_space_compute(const struct neph_shadow_map *map,
                                                   const struct neph_scene *scene,
                                                   struct neph_vec3 camera_m);

struct neph_cloud_shadow {
    struct neph_shadow_map map;
    size_t texel_values; /* 0: the scene has no map */
    struct neph_sun_fill fill;
    struct neph_shadow_level levels[NEPH_GPU_SHADOW_LEVELS_MAX]; /* at the last filling */
};

/* Create an empty map for a march with these parameters. No map is created when they have none, or
 * the scene has no bounded medium. Zero-initialise `shadow`; free with _destroy, also after an
 * error. NEPH_ERR_UNSUPPORTED: a medium that is not a fog has no finite bounds; one texel needs
 * more rays than a dispatch may have. */
enum neph_status neph_cloud_shadow_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_cloud_shadow *shadow, struct neph_diag *diag);

/* Size of the map, which is stored behind the nodes of the sun cache [floats]. */
size_t neph_cloud_shadow_values(const struct neph_cloud_shadow *shadow);

/* Place the map for a frame and submit the filling of its stale texels; of all texels after a move
 * by a texel or more. Errors as of neph_sun_cache_fill(). */
enum neph_status neph_cloud_shadow_fill(struct neph_cloud_shadow *shadow,
                                        const struct neph_scene *scene, double frame,
                                        const struct neph_gpu_scene *gpu,
                                        const struct neph_skip_cells *skip,
                                        const struct neph_sun_cache *cache,
                                        struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero-initialised map is fine. */
void neph_cloud_shadow_destroy(struct neph_cloud_shadow *shadow);

#endif

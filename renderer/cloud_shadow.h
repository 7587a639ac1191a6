/* SPDX-License-Identifier: MIT
 *
 * The shadow map of clouds: of the sunlight, what has come through all shapes (all media but fogs),
 * at the texels of a plane, for solids and for what lies between clouds; shaders/cloud_shadow.glsl
 * looks it up, shaders/cloud_shadow.comp fills it.
 *
 * Method: the beer shadow map of S. Hillaire, "Physically Based Sky, Atmosphere and Cloud Rendering
 * in Frostbite" (SIGGRAPH 2016 course), a front and a slope of optical depth per texel, which more
 * depths per texel refine as in T. Lokovic and E. Veach, "Deep Shadow Maps" (SIGGRAPH 2000).
 *
 * What keeps it from crawling: with NEPH_SHADOW_LEVEL texels are columns of air at the height of
 * the clouds, and go with these in the wind; a sun that moves only slants them, and so a shadow on
 * the ground moves with all its errors, and does not pass over them. Sizes of texels are steps of
 * an eighth of an octave, so that they seldom change with the sun; maps around the camera move by
 * whole texels.
 */
#ifndef NEPH_RENDERER_CLOUD_SHADOW_H
#define NEPH_RENDERER_CLOUD_SHADOW_H

#include "renderer/sun_cache.h"
#include "renderer/sun_fill.h"

/* Light space in the world: a point `p` has the places dot(p - origin_m, across[i]) on the plane,
 * and lies dot(p - origin_m, along) from it, along its sun ray. */
struct neph_shadow_space {
    struct neph_vec3 side[2]; /* unit vectors of the plane */
    struct neph_vec3 across[2], along;
    struct neph_vec3 origin_m;
    double start_m;            /* no cloud lies farther from the sun */
    struct neph_shadow_level { /* texel i along a side lies at low_m + i texel_m */
        double texel_m[2], low_m[2];
    } levels[NEPH_GPU_SHADOW_LEVELS_MAX]; /* each within the next; those not asked for are zeros */
};

/* For a scene with a sun and with shapes, at one moment. */
struct neph_shadow_space neph_shadow_space_of(const struct neph_shadow_map *map,
                                              const struct neph_scene *scene,
                                              struct neph_vec3 camera_m);

struct neph_cloud_shadow {
    struct neph_shadow_map map;
    size_t texel_values; /* 0: there is no map */
    struct neph_sun_fill fill;
    struct neph_shadow_level levels[NEPH_GPU_SHADOW_LEVELS_MAX]; /* when it was filled last */
};

/* An empty map for a march with these parameters; none when they want none, or there is no shape.
 * Zero-initialise `shadow`; free with _destroy, also after an error. NEPH_ERR_UNSUPPORTED: a shape
 * has no finite bounds; a texel's rays are more than a dispatch may hold. */
enum neph_status neph_cloud_shadow_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_cloud_shadow *shadow, struct neph_diag *diag);

/* Room that the map takes behind the nodes of the sun cache [floats]. */
size_t neph_cloud_shadow_values(const struct neph_cloud_shadow *shadow);

/* Place the map in a frame, and send what is stale of it on its way to be filled; all of it where
 * it has moved by a texel or more. As neph_sun_cache_fill(). */
enum neph_status neph_cloud_shadow_fill(struct neph_cloud_shadow *shadow,
                                        const struct neph_scene *scene, double frame,
                                        const struct neph_gpu_scene *gpu,
                                        const struct neph_skip_cells *skip,
                                        const struct neph_sun_cache *cache,
                                        struct neph_sun_fill_cost *cost, struct neph_diag *diag);

/* A zero one is fine. */
void neph_cloud_shadow_destroy(struct neph_cloud_shadow *shadow);

#endif

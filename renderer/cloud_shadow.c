/* SPDX-License-Identifier: MIT */
#include "renderer/cloud_shadow.h"

#include "renderer/lattice.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "scenes/motion.h"

#include <math.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SHADOW_PLANE_COUNT == 2, "a new kind");
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

static const uint32_t cloud_shadow_code[] = {
#include "shaders/cloud_shadow.comp.inc"
};

/* Below this sine of the sun's altitude a horizontal plane would be stretched too much; the plane
 * is then perpendicular to the sunlight. */
static const double level_least = 0.02;

/* Ratio of the width of a level to the next finer one. */
static const double level_ratio = 4.0;

/* Maps around the camera move in steps of this part of their width. */
static const double stride_part = 1.0 / 16.0;

/* --- light space ----------------------------------------------------------------------------- */

/* The reference point of the texels: the displacement of the noise of Horizon clouds, which the
 * wind moves within their bounds; for other media a corner of the bounds, which moves with the
 * wind. */
static struct neph_vec3 find_anchor(const struct neph_scene *scene, const struct neph_bounds *box)
{
    for (int i = 0; i < scene->medium_count; i++)
        if (scene->media[i].kind == NEPH_MEDIUM_HORIZON)
            return scene->media[i].horizon->params.wind_m;
    return box->min_m;
}

static void set_level_plane(struct neph_vec3 sun, struct neph_shadow_space *space)
{
    const struct neph_vec3 up = {0.0, 1.0, 0.0};
    space->side[0] = (struct neph_vec3){1.0, 0.0, 0.0};
    space->side[1] = (struct neph_vec3){0.0, 0.0, 1.0};
    space->along = neph_vec3_scale(up, 1.0 / sun.y);
    for (int i = 0; i < 2; i++)
        space->across[i] = neph_vec3_along(space->side[i], up,
                                           -neph_vec3_dot(space->side[i], sun) / sun.y);
}

static void set_sun_plane(struct neph_vec3 sun, struct neph_shadow_space *space)
{
    const struct neph_vec3 up = {0.0, 1.0, 0.0}, east = {1.0, 0.0, 0.0};
    space->side[0] = neph_vec3_normalize(neph_vec3_cross(fabs(sun.y) < 0.99 ? up : east, sun));
    space->side[1] = neph_vec3_cross(sun, space->side[0]);
    space->along = sun;
    memcpy(space->across, space->side, sizeof(space->across));
}

/* To light space: both coordinates on the plane, and the distance along the sun ray. */
static void project(const struct neph_shadow_space *space, struct neph_vec3 point_m, double out[3])
{
    const struct neph_vec3 from_m = neph_vec3_sub(point_m, space->origin_m);
    out[0] = neph_vec3_dot(from_m, space->across[0]);
    out[1] = neph_vec3_dot(from_m, space->across[1]);
    out[2] = neph_vec3_dot(from_m, space->along);
}

static void project_box(const struct neph_shadow_space *space, const struct neph_bounds *box,
                        double low[3], double high[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double at[3];
        project(space,
                (struct neph_vec3){corner & 1 ? box->max_m.x : box->min_m.x,
                                   corner & 2 ? box->max_m.y : box->min_m.y,
                                   corner & 4 ? box->max_m.z : box->min_m.z},
                at);
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], at[i]);
            high[i] = fmax(high[i], at[i]);
        }
    }
}

/* --- maps ------------------------------------------------------------------------------------ */

static double round_up_texel_size(double size_m)
{
    return exp2(ceil(8.0 * log2(size_m)) / 8.0);
}

/* Cover an interval, centred on its middle. On a horizontal plane the texels then stay in place
 * under any sun. */
static void cover_interval(const struct neph_shadow_map *map, int axis, double low_m, double high_m,
                           struct neph_shadow_level *level)
{
    const double texel_m = round_up_texel_size((high_m - low_m) / (map->texels - 2));
    const double middle = 0.5 * (low_m + high_m) / texel_m;
    level->texel_m[axis] = texel_m;
    level->low_m[axis] = texel_m * round(middle - 0.5 * (map->texels - 1));
}

/* Place a side of length `side_m` around a position, in steps of the stride. */
static void place_around(const struct neph_shadow_map *map, int axis, double place_m, double side_m,
                         struct neph_shadow_level *level)
{
    const double texel_m = side_m / (map->texels - 1);
    const double stride_m = texel_m * ceil(stride_part * map->texels);
    level->texel_m[axis] = texel_m;
    level->low_m[axis] = stride_m * round((place_m - 0.5 * side_m) / stride_m);
}

static void set_maps(const struct neph_shadow_map *map, const double low[3], const double high[3],
                     const double camera[3], struct neph_shadow_space *space)
{
    struct neph_shadow_level *widest = &space->levels[map->levels - 1];
    for (int axis = 0; axis < 2; axis++) {
        if (map->extent_m > 0.0)
            place_around(map, axis, camera[axis], map->extent_m, widest);
        else
            cover_interval(map, axis, low[axis], high[axis], widest);
        double side_m = widest->texel_m[axis] * (map->texels - 1);
        for (int level = map->levels - 2; level >= 0; level--) {
            side_m /= level_ratio;
            place_around(map, axis, camera[axis], side_m, &space->levels[level]);
        }
    }
}

struct neph_shadow_space neph_shadow_space_compute(const struct neph_shadow_map *map,
                                                   const struct neph_scene *scene,
                                                   struct neph_vec3 camera_m)
{
    const struct neph_vec3 sun = scene->sun.direction;
    struct neph_shadow_space space = {.start_m = 0.0};
    struct neph_bounds box = {0};
    double low[3], high[3], camera[3];
    neph_find_media_bounds(scene, &box);
    space.origin_m = find_anchor(scene, &box);
    if (map->plane == NEPH_SHADOW_LEVEL && fabs(sun.y) >= level_least) {
        space.origin_m.y = 0.5 * (box.min_m.y + box.max_m.y);
        set_level_plane(sun, &space);
    } else {
        set_sun_plane(sun, &space);
    }
    project_box(&space, &box, low, high);
    project(&space, camera_m, camera);
    space.start_m = low[2] - 1e-3 * (high[2] - low[2]); /* still outside after rounding to float32
                                                         */
    set_maps(map, low, high, camera, &space);
    return space;
}

/* --- creation -------------------------------------------------------------------------------- */

static uint64_t texel_count(const struct neph_shadow_map *map)
{
    return (uint64_t)map->texels * (uint64_t)map->texels * (uint64_t)map->levels;
}

/* The ray of a texel passes through all media and has one sun ray for each depth. */
static enum neph_status
plan_map_dispatches(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                    const struct neph_gpu_scene *gpu, const struct neph_march_params *params,
                    struct neph_cloud_shadow *shadow, struct neph_diag *diag)
{
    static const struct neph_sun_fill_shader shader = {"cloud_shadow", cloud_shadow_code,
                                                       sizeof(cloud_shadow_code), NEPH_SUN_MAP};
    struct neph_march_split cut;
    const uint64_t layers = (uint64_t)shadow->map.layers;
    const enum neph_status status = neph_march_split_make_whole(
        vulkan, scene, gpu, params, NEPH_GPU_SHADOW_SAMPLES + 1, layers + 1,
        texel_count(&shadow->map), &cut, diag);
    return status ? status
                  : neph_sun_fill_create(vulkan, &shader, params, shadow->map.frames, &cut,
                                         &shadow->fill, diag);
}

enum neph_status neph_cloud_shadow_create(struct neph_vulkan *vulkan,
                                          const struct neph_scene *scene,
                                          const struct neph_gpu_scene *gpu,
                                          const struct neph_march_params *params,
                                          struct neph_cloud_shadow *shadow, struct neph_diag *diag)
{
    struct neph_bounds box;
    if (!params->shortcuts.cloud_shadow || !neph_find_media_bounds(scene, &box))
        return NEPH_OK;
    enum neph_status status = neph_lattice_check(&box, "cloud_shadow=map", "cloud_shadow=off",
                                                 diag);
    if (status)
        return status;
    const size_t channels = gpu->constants[1] & NEPH_GPU_COLOURED ? 3 : 1;
    shadow->map = params->shortcuts.shadow;
    shadow->texel_values = 2 + channels * (size_t)shadow->map.layers;
    return plan_map_dispatches(vulkan, scene, gpu, params, shadow, diag);
}

size_t neph_cloud_shadow_values(const struct neph_cloud_shadow *shadow)
{
    return shadow->texel_values * texel_count(&shadow->map);
}

void neph_cloud_shadow_destroy(struct neph_cloud_shadow *shadow)
{
    neph_sun_fill_destroy(&shadow->fill);
    *shadow = (struct neph_cloud_shadow){.texel_values = 0};
}

/* --- frames ---------------------------------------------------------------------------------- */

static void pack_shadow_map(const struct neph_shadow_space *space,
                            const struct neph_shadow_map *map, struct neph_vec3 camera_m,
                            size_t first, struct neph_gpu_shadow_map *gpu)
{
    double camera[3];
    project(space, camera_m, camera);
    neph_gpu_direction(gpu->across_u, space->across[0]);
    neph_gpu_direction(gpu->across_v, space->across[1]);
    neph_gpu_direction(gpu->along, space->along);
    gpu->across_u_m = (float)camera[0];
    gpu->across_v_m = (float)camera[1];
    gpu->along_m = (float)camera[2];
    neph_gpu_direction(gpu->side_u, space->side[0]);
    neph_gpu_direction(gpu->side_v, space->side[1]);
    neph_relative_position(gpu->plane_m, space->origin_m, camera_m);
    gpu->start_m = (float)space->start_m;
    gpu->texels = (uint32_t)map->texels;
    gpu->layers = (uint32_t)map->layers;
    gpu->level_count = (uint32_t)map->levels;
    gpu->first = (uint32_t)first;
    for (int level = 0; level < map->levels; level++)
        for (int axis = 0; axis < 2; axis++) {
            gpu->levels[level].low_m[axis] = (float)space->levels[level].low_m[axis];
            gpu->levels[level].per_m[axis] = (float)(1.0 / space->levels[level].texel_m[axis]);
        }
}

static bool is_lit(const struct neph_scene *scene)
{
    const struct neph_rgb sun = scene->sun.irradiance_w_per_m2;
    return scene->sun.present && (sun.r > 0.0 || sun.g > 0.0 || sun.b > 0.0);
}

enum neph_status neph_cloud_shadow_fill(struct neph_cloud_shadow *shadow,
                                        const struct neph_scene *scene, double frame,
                                        const struct neph_gpu_scene *gpu,
                                        const struct neph_skip_cells *skip,
                                        const struct neph_sun_cache *cache,
                                        struct neph_sun_fill_cost *cost, struct neph_diag *diag)
{
    struct neph_bounds box;
    if (shadow->texel_values == 0 || !is_lit(scene) || !neph_find_media_bounds(scene, &box))
        return NEPH_OK;
    const struct neph_vec3 camera_m = neph_scene_camera(scene, frame).position_m;
    const struct neph_shadow_space space = neph_shadow_space_compute(&shadow->map, scene, camera_m);
    pack_shadow_map(&space, &shadow->map, camera_m, cache->value_count, &gpu->frame->shadow);
    const bool has_moved = memcmp(shadow->levels, space.levels, sizeof(space.levels)) != 0;
    memcpy(shadow->levels, space.levels, sizeof(space.levels));
    return neph_sun_fill_run(&shadow->fill, scene, gpu, skip, &cache->nodes, has_moved, cost, diag);
}

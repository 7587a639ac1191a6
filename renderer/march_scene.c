/* SPDX-License-Identifier: MIT */
#include "renderer/march_scene.h"

#include "renderer/fog_look.h"
#include "renderer/grid_textures.h"
#include "renderer/march_split.h"
#include "scenes/fog_translation.h"
#include "scenes/motion.h"

/* Does not compile with a new lighting: this file then needs a change. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");

static enum neph_status create_buffer_rings(const struct neph_vulkan *vulkan,
                                            struct neph_march_scene *scene, struct neph_diag *diag)
{
    const enum neph_status status = neph_buffer_ring_create(
        vulkan, &scene->gpu.buffers[0], "scene frame", &scene->frame_ring, diag);
    return status ? status
                  : neph_buffer_ring_create(vulkan, &scene->gpu.buffers[1], "scene solids",
                                            &scene->solid_ring, diag);
}

/* The scene without its veils: air that is rendered from tables, and fog that is rendered by a
 * model. Uses `rest` as storage if there is a veil. */
static const struct neph_scene *get_marched_scene(const struct neph_march_scene *scene,
                                                  const struct neph_scene *from,
                                                  struct neph_scene *rest)
{
    if (!scene->has_sky && !scene->has_fog_look)
        return from;
    *rest = *from;
    rest->borrows = true;
    if (scene->has_sky)
        *rest = neph_sky_remove_air(from, &scene->split);
    if (scene->has_fog_look)
        *rest = neph_fog_look_remove_fog(rest);
    return rest;
}

static enum neph_status create_sky(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                   const struct neph_march_params *params,
                                   struct neph_march_scene *scene, struct neph_diag *diag)
{
    char reason[256];
    scene->has_sky = params->sky.is_on;
    scene->has_fog_look = params->fog.is_look;
    if (!scene->has_sky)
        return neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, 4 * sizeof(float), "no sky",
                                  &scene->no_sky, diag);
    if (!neph_sky_split(from, &scene->split, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "march: sky=tables: cannot: %s", reason);
    return neph_sky_tables_create(vulkan, &scene->split.air, from->scattering, &params->sky.tables,
                                  &scene->sky, diag);
}

static enum neph_status create_marched(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                       const struct neph_march_params *params,
                                       struct neph_march_scene *scene, struct neph_diag *diag)
{
    const bool traces = params->lighting == NEPH_MARCH_TRACED;
    enum neph_status status = neph_gpu_scene_create(vulkan, from, params->frame, params->width_px,
                                                    params->height_px, traces, &scene->gpu, diag);
    if (!status)
        status = neph_grid_textures_create(vulkan, from, &params->shortcuts, &scene->gpu, diag);
    if (!status)
        status = create_buffer_rings(vulkan, scene, diag);
    if (!status)
        status = neph_skip_cells_create(vulkan, from, params, &scene->skip_cells, diag);
    if (!status)
        status = neph_cloud_shadow_create(vulkan, from, &scene->gpu, params, &scene->cloud_shadow,
                                          diag);
    if (!status)
        status = neph_sun_cache_create(vulkan, from, &scene->gpu, params,
                                       neph_cloud_shadow_values(&scene->cloud_shadow),
                                       &scene->sun_cache, diag);
    if (!status)
        status = neph_traced_light_create(vulkan, from, &scene->gpu, params, &scene->traced_light,
                                          diag);
    if (!status)
        status = neph_diffused_light_create(vulkan, from, &scene->gpu, params,
                                            &scene->diffused_light, diag);
    if (!status)
        status = neph_slab_light_create(vulkan, from, params, &scene->slab_light, diag);
    if (!status && scene->has_sky)
        status = neph_sky_shade_create(vulkan, from, &scene->gpu, params, &scene->sky_shade, diag);
    return status || !params->fog.is_handed_over
               ? status
               : neph_froxel_scene_create(vulkan, &scene->gpu, &scene->froxels, diag);
}

enum neph_status neph_march_scene_create(struct neph_vulkan *vulkan, const struct neph_scene *from,
                                         const struct neph_march_params *params,
                                         struct neph_march_scene *scene, struct neph_diag *diag)
{
    struct neph_scene rest;
    scene->vulkan = vulkan;
    enum neph_status status = create_sky(vulkan, from, params, scene, diag);
    if (!status)
        status = create_marched(vulkan, get_marched_scene(scene, from, &rest), params, scene, diag);
    if (!status)
        neph_froxel_scene_update(&scene->froxels, from, params->frame, &scene->gpu);
    return status;
}

void neph_march_scene_destroy(const struct neph_vulkan *vulkan, struct neph_march_scene *scene)
{
    neph_froxel_scene_destroy(vulkan, &scene->froxels);
    neph_buffer_destroy(vulkan, &scene->no_sky);
    neph_sky_shade_destroy(&scene->sky_shade);
    neph_sky_tables_destroy(&scene->sky);
    neph_slab_light_destroy(&scene->slab_light);
    neph_diffused_light_destroy(&scene->diffused_light);
    neph_traced_light_destroy(&scene->traced_light);
    neph_cloud_shadow_destroy(&scene->cloud_shadow);
    neph_sun_cache_destroy(&scene->sun_cache);
    neph_skip_cells_destroy(vulkan, &scene->skip_cells);
    neph_buffer_ring_destroy(vulkan, &scene->solid_ring);
    neph_buffer_ring_destroy(vulkan, &scene->frame_ring);
    neph_gpu_scene_destroy(vulkan, &scene->gpu);
}

/* Update the scene itself. */
static enum neph_status update_scene_buffers(const struct neph_scene *from,
                                             const struct neph_march_params *params, double frame,
                                             struct neph_march_scene *scene, double *gpu_s,
                                             struct neph_diag *diag)
{
    neph_buffer_ring_advance(&scene->frame_ring, &scene->gpu.buffers[0]);
    neph_buffer_ring_advance(&scene->solid_ring, &scene->gpu.buffers[1]);
    scene->gpu.frame = scene->gpu.buffers[0].mapped;
    const enum neph_status status = neph_gpu_scene_update(
        scene->vulkan, &scene->gpu, from, frame, params->width_px, params->height_px, gpu_s, diag);
    neph_march_set_frame(from, params, scene->gpu.frame);
    return status;
}

/* Update the fog model. With froxels it begins where they end; without froxels it covers all
 * distances. */
static void update_fog_model(const struct neph_scene *from, const struct neph_march_params *params,
                             double frame, struct neph_march_scene *scene)
{
    const struct neph_vec3 camera_m = neph_scene_camera(from, frame).position_m;
    struct neph_gpu_fog_look *shown = &scene->gpu.frame->fog_look;
    struct neph_fog_look look = from->fog_look;
    if (!scene->has_fog_look)
        return;
    look.volumetric_fog_distance_m = 0.0;
    *shown = neph_gpu_fog_pack(from, &look, params->fog.model, camera_m);
    if (params->fog.is_handed_over)
        shown->hand_over_m = (float)from->fog_look.volumetric_fog_distance_m;
}

static bool has_diffusion(const struct neph_march_scene *scene)
{
    return scene->diffused_light.level_count > 0;
}

/* Solve diffused light, for rendering or as the estimate of unfinished paths. If that estimate is
 * corrected later, the solution does not change the mean (light_walk.comp) and is computed only for
 * the first frame of a sequence. */
static enum neph_status solve_diffusion(const struct neph_scene *from, double frame,
                                        const struct neph_march_frame_state *moment,
                                        struct neph_march_scene *scene, struct neph_dispatch bound,
                                        double *gpu_s, struct neph_diag *diag)
{
    struct neph_diffused_light *light = &scene->diffused_light;
    const struct neph_light_paths *paths = &scene->traced_light.params.light;
    if (paths->looks_ahead && !paths->ends_ahead && moment->continues && light->is_filled) {
        neph_diffused_light_place(light, from, frame, &scene->gpu);
        return NEPH_OK;
    }
    neph_skip_cells_bind(&scene->skip_cells, &bound);
    return neph_diffused_light_solve(light, from, frame, &scene->gpu, &bound, moment->continues,
                                     scene->sun_cache.fill.stale_parts > 0, gpu_s, diag);
}

static void bind_sky(const struct neph_march_scene *scene, struct neph_dispatch *dispatch)
{
    const int first = NEPH_MARCH_BUFFERS - NEPH_SKY_BUFFERS;
    dispatch->buffers[first] = scene->has_sky ? &scene->sky.told : &scene->no_sky;
    dispatch->buffers[first + 1] = scene->has_sky ? &scene->sky.nodes : &scene->no_sky;
}

/* The point at which the sky lights media: the centre of the bounded media. */
static struct neph_vec3 find_lit_position_m(const struct neph_scene *rest, double frame)
{
    struct neph_bounds box;
    if (!neph_find_media_bounds(rest, &box))
        return neph_scene_camera(rest, frame).position_m;
    return neph_vec3_scale(neph_vec3_add(box.min_m, box.max_m), 0.5);
}

/* Update the sky as seen from the camera, and from the media that it lights. */
static enum neph_status update_sky_tables(const struct neph_scene *from,
                                          const struct neph_scene *rest,
                                          const struct neph_march_params *params, double frame,
                                          struct neph_march_scene *scene,
                                          struct neph_sky_times *times, struct neph_diag *diag)
{
    struct neph_sky_table_view look = {.scene = from,
                                       .frame = frame,
                                       .width_px = params->width_px,
                                       .height_px = params->height_px,
                                       .lights = neph_march_has_sky_light(params),
                                       .is_shaded = scene->sky_shade.vulkan};
    if (look.lights)
        look.place_m = find_lit_position_m(rest, frame);
    return scene->has_sky ? neph_sky_tables_update(&scene->sky, &look, times, diag) : NEPH_OK;
}

/* Update multiple scattering of the selected method. Paths use majorants instead of empty cells. */
static enum neph_status update_scattered_light(const struct neph_scene *from, double frame,
                                               const struct neph_march_frame_state *moment,
                                               struct neph_march_scene *scene, double *gpu_s,
                                               struct neph_diag *diag)
{
    struct neph_dispatch bound = {.group_count = 0};
    const struct neph_traced_light_view view = {neph_scene_camera(from, frame), moment->drift_m,
                                                scene->gpu.frame->half_width};
    neph_gpu_scene_bind(&scene->gpu, &bound);
    bound.buffers[NEPH_GPU_SCENE_BUFFERS + 2] = &scene->sun_cache.nodes;
    bound.buffers[NEPH_GPU_SCENE_BUFFERS + 3] = has_diffusion(scene)
                                                    ? &scene->diffused_light.field
                                                    : &scene->traced_light.smoothed;
    bind_sky(scene, &bound);
    const enum neph_status status = solve_diffusion(from, frame, moment, scene, bound, gpu_s, diag);
    return status ? status
                  : neph_traced_light_trace(&scene->traced_light, from, &scene->gpu, &bound, &view,
                                            moment->continues, gpu_s, diag);
}

static enum neph_status update_marched(const struct neph_scene *from,
                                       const struct neph_scene *whole,
                                       const struct neph_march_params *params, double frame,
                                       const struct neph_march_frame_state *moment,
                                       struct neph_march_scene *scene,
                                       struct neph_march_scene_cost *cost, struct neph_diag *diag)
{
    *cost->fill = (struct neph_sun_fill_cost){.dispatches = 0};
    enum neph_status status = update_scene_buffers(from, params, frame, scene, cost->places_gpu_s,
                                                   diag);
    update_fog_model(whole, params, frame, scene);
    if (!status)
        status = neph_skip_cells_place(&scene->skip_cells, from, frame, scene->gpu.frame, diag);
    if (!status)
        status = neph_sun_cache_fill(&scene->sun_cache, from, frame, &scene->gpu,
                                     &scene->skip_cells, cost->fill, diag);
    if (!status)
        status = neph_cloud_shadow_fill(&scene->cloud_shadow, from, frame, &scene->gpu,
                                        &scene->skip_cells, &scene->sun_cache, cost->fill, diag);
    return status ? status
                  : update_scattered_light(from, frame, moment, scene, cost->light_gpu_s, diag);
}

/* Update the air in front of the camera and the shadows on it. */
static enum neph_status update_aerial_table(const struct neph_scene *rest,
                                            struct neph_march_scene *scene,
                                            struct neph_march_scene_cost *cost,
                                            struct neph_diag *diag)
{
    struct neph_dispatch bound = {.group_count = 0};
    neph_march_scene_bind(scene, &bound);
    const enum neph_status status = neph_sky_shade_fill(&scene->sky_shade, rest, &scene->gpu,
                                                        &bound, &scene->sky, cost->fill,
                                                        &cost->sky->shade_s, diag);
    return status ? status : neph_sky_tables_update_aerial(&scene->sky, cost->sky, diag);
}

enum neph_status neph_march_scene_update(const struct neph_scene *from,
                                         const struct neph_march_params *params, double frame,
                                         const struct neph_march_frame_state *moment,
                                         struct neph_march_scene *scene,
                                         struct neph_march_scene_cost *cost, struct neph_diag *diag)
{
    struct neph_scene rest;
    const struct neph_scene *shown = get_marched_scene(scene, from, &rest);
    enum neph_status status = update_sky_tables(from, shown, params, frame, scene, cost->sky, diag);
    if (!status)
        status = update_marched(shown, from, params, frame, moment, scene, cost, diag);
    if (!status && scene->has_sky)
        status = update_aerial_table(shown, scene, cost, diag);
    if (!status)
        neph_froxel_scene_update(&scene->froxels, from, frame, &scene->gpu);
    return status;
}

static const struct neph_buffer *get_higher_orders_buffer(const struct neph_march_scene *scene)
{
    if (has_diffusion(scene) && scene->diffused_light.is_shown)
        return &scene->diffused_light.field;
    return scene->slab_light.vulkan ? &scene->slab_light.table : &scene->traced_light.smoothed;
}

void neph_march_scene_bind(const struct neph_march_scene *scene, struct neph_dispatch *dispatch)
{
    neph_gpu_scene_bind(&scene->gpu, dispatch);
    neph_skip_cells_bind(&scene->skip_cells, dispatch);
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 2] = &scene->sun_cache.nodes;
    dispatch->buffers[NEPH_GPU_SCENE_BUFFERS + 3] = get_higher_orders_buffer(scene);
    bind_sky(scene, dispatch);
}

void neph_march_scene_bind_froxels(const struct neph_march_scene *scene,
                                   struct neph_dispatch *dispatch)
{
    neph_march_scene_bind(scene, dispatch);
    dispatch->buffers[0] = &neph_froxel_scene_select(&scene->froxels, &scene->gpu)->buffers[0];
}

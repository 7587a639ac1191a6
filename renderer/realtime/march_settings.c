/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/march_settings.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");

/* Light of higher orders is found over many frames: a round of paths and two cycles of diffusion in
 * each, and paths of the last 32. */
enum { LIGHT_TEXEL_PX = 8, LIGHT_ROUNDS = 1, LIGHT_MEMORY = 32, DIFFUSION_CYCLES = 2 };
static const double light_blur_texels = 1.0;

bool neph_rt_is_upsampled(const struct neph_settings *settings)
{
    return settings->values[RT_SCREEN_PERCENT] < 100.0;
}

bool neph_rt_is_handed_over(const struct neph_scene *scene, const struct neph_settings *settings)
{
    const struct neph_march_fog fog = neph_fog_for_march((int)settings->values[RT_FOG]);
    return fog.is_look && fog.model == NEPH_FOG_UNREAL &&
           settings->values[RT_FROXEL_VOLUME] != 0.0 &&
           settings->values[RT_SPLIT] != RT_SPLIT_NONE &&
           scene->fog_look.volumetric_fog_distance_m > 0.0;
}

struct neph_march_params neph_rt_march_params(const struct neph_scene *scene,
                                              const struct neph_settings *settings, int width_px,
                                              int height_px, uint32_t seed)
{
    const double *values = settings->values;
    struct neph_march_fog fog = neph_fog_for_march((int)values[RT_FOG]);
    fog.is_handed_over = neph_rt_is_handed_over(scene, settings);
    return (struct neph_march_params){
        .width_px = width_px,
        .height_px = height_px,
        .steps = (int)values[RT_STEPS],
        .transmittance = (enum neph_march_mode)(int)values[RT_TRANSMITTANCE],
        .sun = (enum neph_march_mode)(int)values[RT_SUN],
        .lighting = (enum neph_march_lighting)(int)values[RT_LIGHTING],
        .sun_steps = (int)values[RT_SUN_STEPS],
        .shortcuts = {.sun_cache = values[RT_SUN_CACHE] != 0.0,
                      .sun_cache_voxels = (int)values[RT_SUN_CACHE_VOXELS],
                      .sun_cache_frames = (int)values[RT_SUN_CACHE_FRAMES],
                      .skip = values[RT_SKIP] != 0.0,
                      .early_out = values[RT_EARLY_OUT],
                      .step_growth = values[RT_STEP_GROWTH],
                      .depth_growth = values[RT_DEPTH_GROWTH],
                      .sun_growth = values[RT_SUN_GROWTH],
                      .sun_cone = values[RT_SUN_CONE],
                      .grid_texture = values[RT_GRID_SAMPLING] != 0.0,
                      .grid_format = (enum neph_texel_format)(int)values[RT_GRID_FORMAT],
                      .cloud_shadow = values[RT_CLOUD_SHADOW] != 0.0,
                      .shadow = {.texels = (int)values[RT_CLOUD_SHADOW_TEXELS],
                                 .layers = (int)values[RT_CLOUD_SHADOW_LAYERS],
                                 .levels = (int)values[RT_CLOUD_SHADOW_LEVELS],
                                 .extent_m = values[RT_CLOUD_SHADOW_EXTENT_M],
                                 .plane = (enum neph_shadow_plane)(
                                     int)values[RT_CLOUD_SHADOW_PLANE],
                                 .frames = (int)values[RT_SUN_CACHE_FRAMES]}},
        .light = {.texel_px = LIGHT_TEXEL_PX,
                  .paths = (int)values[RT_LIGHT_PATHS],
                  .rounds = LIGHT_ROUNDS,
                  .memory = LIGHT_MEMORY,
                  .blur_texels = light_blur_texels,
                  .similar = values[RT_LIGHT_SIMILAR],
                  .looks_ahead = values[RT_LIGHT_AHEAD] != 0.0,
                  .ends_ahead = values[RT_LIGHT_AHEAD] == 2.0,
                  .seed = seed},
        .diffusion = {.cells = (int)values[RT_DIFFUSION_CELLS], .cycles = DIFFUSION_CYCLES},
        .sky = neph_sky_for_march(
            (struct neph_march_sky_choices){.is_on = values[RT_SKY] != 0.0,
                                            .has_shadows = values[RT_SKY_SHADOWS] != 0.0,
                                            .columns = (int)values[RT_SKY_COLUMNS],
                                            .rows = (int)values[RT_SKY_ROWS],
                                            .slices = (int)values[RT_SKY_SLICES],
                                            .far_m = values[RT_SKY_FAR_M],
                                            .refill = (int)values[RT_SKY_REFILL]}),
        .fog = fog,
    };
}

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/march_settings.h"

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FOG_MODEL_COUNT == 2, "a new kind");

/* Light of higher orders is accumulated over frames: each adds one round of paths and two cycles of
 * diffusion; paths of the last 32 frames count. */
enum { LIGHT_TEXEL_PX = 8, LIGHT_ROUNDS = 1, LIGHT_MEMORY = 32, DIFFUSION_CYCLES = 2 };
static const double light_blur_texels = 1.0;

#include "settings/realtime_march.inc"

bool neph_rt_is_fog_split_at_froxels(const struct neph_scene *scene,
                                     const struct neph_settings *settings)
{
    const struct neph_march_fog fog = neph_march_fog_choose((int)settings->values[RT_FOG]);
    const struct neph_rt_settings of_passes = neph_rt_group_settings(settings);
    return fog.is_look && fog.model == NEPH_FOG_UNREAL && of_passes.froxels.is_on &&
           of_passes.shared.split != RT_SPLIT_NONE &&
           scene->fog_look.volumetric_fog_distance_m > 0.0;
}

struct neph_march_params neph_rt_march_params(const struct neph_scene *scene,
                                              const struct neph_settings *settings, int width_px,
                                              int height_px, uint32_t seed)
{
    struct neph_march_params params = {
        .width_px = width_px,
        .height_px = height_px,
        .light = {.texel_px = LIGHT_TEXEL_PX,
                  .rounds = LIGHT_ROUNDS,
                  .memory = LIGHT_MEMORY,
                  .blur_texels = light_blur_texels,
                  .seed = seed},
        .diffusion = {.cycles = DIFFUSION_CYCLES},
    };
    read_march(settings->values, &params);
    params.fog.is_handed_over = neph_rt_is_fog_split_at_froxels(scene, settings);
    return params;
}

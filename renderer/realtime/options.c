/* SPDX-License-Identifier: MIT
 *
 * The settings from the files settings.toml (renderer/settings.py), and messages for removed ones.
 * "The article" in their texts is the article on the frame split: the weather of Red Dead
 * Redemption 2 after F. Bauer, SIGGRAPH 2019, written down for Unreal Engine 4.24. A tile is 2x2
 * half-resolution texels, or 4x4 pixels; its slots are these texels in the order in which they are
 * marched. docs/realtime.md lists the article's steps and faults with their settings.
 */
#include "renderer/realtime/options.h"

#include "base/option_rows.h"
#include "renderer/march_params.h"
#include "renderer/realtime/light_history.h"

/* The upper limit of override_wake (tile_index/settings.toml). */
_Static_assert(NEPH_RT_LIGHT_HISTORY_MAX == 64, "override_wake");

/* Removed on 2026-11-29; these messages go with the next release. */
static const char *const gone[] = {
    "override_depth",
    "it was 0.25 in every preset",
    "override_sky_m",
    "it was 1e6 in every preset",
    "depth_format",
    "target_format is the format of all images",
    "color_format",
    "target_format is the format of all images",
    "taa_format",
    "target_format is the format of all images",
    "history_filter",
    "it was bilinear in every preset",
    "box_sigma",
    "it was 1 in every preset",
    "box_least",
    "it was 0 in every preset",
    "reproject_least_m",
    "it was 0 in every preset",
    "reject_scene_m",
    "it was 0 in every preset; reject_depth is left",
    "reject_within_m",
    "it belonged to reject_scene_m, which was 0 in every preset",
    "reject_nearest_m",
    "it was 0 in every preset; reject_depth is left",
    "upscale_sky_m",
    "it was 1e6 in every preset",
    "taa_alpha_moving",
    "it was 0.2 in every preset",
    "taa_velocity_px",
    "it was 20 in every preset",
    "taa_rest_px",
    "it was 0.02 in every preset",
    "taa_antighost",
    "it was off in every preset; solid_motion and the neighbourhood clamp are left",
    "sharpen_amount",
    "it was 0.5 in every preset",
    "light_texel_px",
    "it was 8 in every preset; engine march_traced has it",
    "light_rounds",
    "it was 1 in every preset; engine march_traced has it",
    "light_memory",
    "it was 32 in every preset",
    "light_blur",
    "it was 1 in every preset; engine march_traced has it",
    "diffusion_cycles",
    "it was 2 in every preset; engine march_diffused has it",
    "cloud_shadow_frames",
    "sun_cache_frames is of the shadow map of clouds, too",
    "lock_ratio",
    "it was 1.05 in every preset",
    "lock_separation",
    "it was 0.02 in every preset",
    "atrous_sigma",
    "it was 4 in every preset",
    "atrous_depth",
    "it was 0.1 in every preset",
    "composition",
    "the pipeline chooses it; all of its values gave the same bits",
    "depth_map_pass",
    "the pipeline chooses it; all of its values gave the same bits",
    "change_pass",
    "the pipeline chooses it; all of its values gave the same bits",
    "steady",
    "the pipeline chooses it; all of its values gave the same bits",
    NULL,
};

#include "settings/realtime_table.inc"

bool neph_rt_has_oracle(const struct neph_rt_settings *settings)
{
    return settings->oracle.rays || settings->oracle.motion || settings->oracle.depth ||
           settings->oracle.upscale;
}

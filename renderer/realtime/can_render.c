/* SPDX-License-Identifier: MIT
 *
 * neph_realtime_can_render() of pipeline.h: the scenes that each set of settings supports.
 */
#include "renderer/march.h"
#include "renderer/realtime/march_settings.h"
#include "renderer/realtime/pipeline.h"
#include "scenes/emission.h"
#include "scenes/fog_translation.h"
#include "scenes/injection.h"
#include "scenes/media.h"

#include <stdio.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_MARCH_LIGHTING_COUNT == 8, "a new kind");

/* False, with the reason, where a frame with fewer rendered pixels cannot be upsampled. */
static bool can_upsample(const struct neph_scene *scene, const struct neph_rt_settings *settings,
                         char *reason, size_t reason_size)
{
    const struct neph_injected_view *around = &neph_scene_injections(scene)->view;
    if (settings->anti_aliasing.kind == RT_TAA_OFF) {
        snprintf(reason, reason_size,
                 "fewer rendered pixels without anti-aliasing, which upsamples them: set taa=on or "
                 "screen_percent=100");
        return false;
    }
    if (around->left_px + around->top_px + around->right_px + around->bottom_px == 0)
        return true;
    snprintf(reason, reason_size,
             "fewer rendered pixels within larger buffers (inject.view): set screen_percent=100");
    return false;
}

/* Fog that is a medium as well is marched in froxels. Its phase function has no table there,
 * because tables are those of the media that are marched. */
static bool can_march_near_fog(const struct neph_scene *scene, struct neph_march_veils veils,
                               enum neph_march_lighting lighting, char *reason, size_t reason_size)
{
    const struct neph_medium *fog = neph_fog_look_find_medium(scene);
    if (fog && !neph_phase_is_in_shaders(fog->phase.kind)) {
        snprintf(reason, reason_size,
                 "the phase function %s of fog in froxels, which need isotropic, "
                 "henyey_greenstein or rayleigh: set froxels=off",
                 neph_phase_words[fog->phase.kind]);
        return false;
    }
    veils.fog.is_look = false;
    return neph_march_can_render_with(scene, veils, lighting, reason, reason_size);
}

/* False, with the reason, where a change of the light would count fully before it counts at all.
 * Shaders have both limits in float32. */
static bool has_ordered_changes(const struct neph_rt_settings *settings, char *reason,
                                size_t reason_size)
{
    const double least = settings->anti_aliasing.change, full = settings->anti_aliasing.change_full;
    if (full == 0.0 || (float)full > (float)least)
        return true;
    snprintf(reason, reason_size,
             "taa_change_full=%g, which is not above taa_change=%g: set taa_change_full above "
             "taa_change, or 0 for twice taa_change",
             full, least);
    return false;
}

bool neph_realtime_can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                              char *reason, size_t reason_size)
{
    const struct neph_march_veils veils = {settings->values[RT_SKY] != 0.0,
                                           neph_march_fog_choose((int)settings->values[RT_FOG])};
    const struct neph_rt_settings of_passes = neph_rt_group_settings(settings);
    struct neph_scene rest;
    if (!neph_march_remove_veils(scene, veils, &rest, reason, reason_size) ||
        (of_passes.shared.screen_percent < 100 &&
         !can_upsample(scene, &of_passes, reason, reason_size)))
        return false;
    for (int i = 0; i < rest.medium_count; i++) {
        if (!neph_medium_is_coloured(&rest.media[i]))
            continue;
        snprintf(reason, reason_size,
                 "extinction that differs between the channels: rays and histories have one "
                 "transmittance%s",
                 veils.sky ? "" : " (with sky=tables a planet's air may differ)");
        return false;
    }
    if (neph_scene_emits(&rest)) {
        snprintf(reason, reason_size, "%s", neph_emission_reason);
        return false;
    }
    if (!has_ordered_changes(&of_passes, reason, reason_size))
        return false;
    if (of_passes.atrous.is_on && of_passes.gradient.is_on) {
        snprintf(reason, reason_size,
                 "gradient=on and atrous=on, which share memory: switch one of them off");
        return false;
    }
    if (neph_rt_has_oracle(&of_passes) &&
        (of_passes.shared.split == RT_SPLIT_NONE || of_passes.atrous.is_on)) {
        snprintf(reason, reason_size,
                 "an oracle (oracle_rays, oracle_motion, oracle_depth, oracle_upscale) without the "
                 "split frame or with atrous=on: set split=four and atrous=off");
        return false;
    }
    const enum neph_march_lighting lighting = (enum neph_march_lighting)(
                                                  int)settings->values[RT_LIGHTING];
    if (of_passes.froxels.is_on && lighting != NEPH_MARCH_SINGLE &&
        lighting != NEPH_MARCH_OCTAVES) {
        snprintf(reason, reason_size,
                 "this lighting in froxels, which support single and octaves: set froxels=off");
        return false;
    }
    return neph_march_can_render_with(scene, veils, lighting, reason, reason_size) &&
           (!neph_rt_is_fog_split_at_froxels(scene, settings) ||
            can_march_near_fog(scene, veils, lighting, reason, reason_size));
}

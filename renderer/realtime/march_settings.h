/* SPDX-License-Identifier: MIT
 *
 * Parameters of the ray marcher from the settings of the pipeline. Internal to this folder.
 */
#ifndef NEPH_RENDERER_REALTIME_MARCH_SETTINGS_H
#define NEPH_RENDERER_REALTIME_MARCH_SETTINGS_H

#include "renderer/march_params.h"
#include "renderer/realtime/options.h"

/* Whether froxels carry the fog up to Unreal's view distance of volumetric fog, and the
 * non-physical fog model begins there. */
bool neph_rt_is_fog_split_at_froxels(const struct neph_scene *scene,
                                     const struct neph_settings *settings);

/* Parameters of the march of `width_px` x `height_px` pixels in this scene. */
struct neph_march_params neph_rt_march_params(const struct neph_scene *scene,
                                              const struct neph_settings *settings, int width_px,
                                              int height_px, uint32_t seed);

#endif

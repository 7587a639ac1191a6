/* SPDX-License-Identifier: MIT
 *
 * What the pipeline's settings say of the rays that it marches. Not for other folders.
 */
#ifndef NEPH_RENDERER_REALTIME_MARCH_SETTINGS_H
#define NEPH_RENDERER_REALTIME_MARCH_SETTINGS_H

#include "renderer/march_params.h"
#include "renderer/realtime/options.h"

/* Whether froxels have the fog up to Unreal's view distance of its volumetric fog, and the look
 * begins there. */
bool neph_rt_is_handed_over(const struct neph_scene *scene, const struct neph_settings *settings);

/* The march of a picture of so many pixels, as the settings want it in this scene. */
struct neph_march_params neph_rt_march_params(const struct neph_scene *scene,
                                              const struct neph_settings *settings, int width_px,
                                              int height_px, uint32_t seed);

#endif

/* SPDX-License-Identifier: MIT
 *
 * The compiled passes, for the pipeline and for tests that run one alone.
 */
#ifndef NEPH_RENDERER_REALTIME_SHADERS_H
#define NEPH_RENDERER_REALTIME_SHADERS_H

#include "renderer/realtime/device.h"

extern const struct neph_rt_shader neph_rt_shader_min_max;
extern const struct neph_rt_shader neph_rt_shader_tile_index;
extern const struct neph_rt_shader neph_rt_shader_reconstruct;
extern const struct neph_rt_shader neph_rt_shader_upscale;
extern const struct neph_rt_shader neph_rt_shader_compose;
extern const struct neph_rt_shader neph_rt_shader_taa;

#endif

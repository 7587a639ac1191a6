/* SPDX-License-Identifier: MIT
 *
 * The view: the parameters of one frame for all passes, buffer View of realtime/shared/view.glsl.
 * Also the formats of the elements of targets.
 */
#ifndef NEPH_RENDERER_REALTIME_VIEW_H
#define NEPH_RENDERER_REALTIME_VIEW_H

#include "renderer/realtime/shared/names.h"
#include "renderer/shaders/constants.h" /* NEPH_GPU_FAR_M: depth of the sky in targets [m] */
#include "shaders/structs.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Number of 32-bit words of an element. */
uint32_t neph_rt_format_words(uint32_t format);

/* Bytes of an element in a texture of that format on a GPU. */
uint32_t neph_rt_format_bytes(uint32_t format);

/* The nearest half, ties to even; beyond 65504 infinite from 65520 on; NaN stays NaN (0x7e00 with
 * the sign). The same rule as to_half() of shaders/halves.glsl, which does not trust the driver's
 * packHalf2x16: Vulkan leaves its rounding open. */
uint16_t neph_rt_to_half(float value);

/* Converts element `index` of a target from or to its words; absent channels are read as 0. */
void neph_rt_load(const struct neph_gpu_target *target, const uint32_t *words, size_t index,
                  float value[4]);
void neph_rt_store(const struct neph_gpu_target *target, uint32_t *words, size_t index,
                   const float value[4]);

/* Whether the medium (as far as settings follow it), or all solids that may move, have not moved
 * since the frame before. */
bool neph_rt_is_medium_static(const struct neph_gpu_view *view);
bool neph_rt_are_movers_static(const struct neph_gpu_view *view);

/* Whether camera and air are static and solids need no motion vectors. */
bool neph_rt_is_view_static(const struct neph_gpu_view *view);

#endif

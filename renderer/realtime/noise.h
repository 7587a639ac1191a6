/* SPDX-License-Identifier: MIT
 *
 * The noise of the real-time renderer: both blue masks as the shaders read them, and how soon the
 * dither of each kind comes again.
 */
#ifndef NEPH_RENDERER_REALTIME_NOISE_H
#define NEPH_RENDERER_REALTIME_NOISE_H

#include "base/status.h"
#include "renderer/realtime/device.h"

/* Ranks of the spatial mask of this seed and then of the spatiotemporal one, from the folder or,
 * the first time, made and kept there: errors of neph_blue_noise_load(). */
enum neph_status neph_rt_noise_ranks(uint32_t seed, const char *cache_folder,
                                     uint32_t ranks[NEPH_RT_NOISE_COUNT], struct neph_diag *diag);

/* After how many frames the numbers of a pixel come again; 0: never, or they do not change. `kind`:
 * RT_DITHER_*. */
int neph_rt_dither_period(int kind);

#endif

/* SPDX-License-Identifier: MIT
 *
 * Tiles of 2x2 half-pixels on the CPU: shaders/realtime_slots.glsl once more, for the oracle.
 */
#ifndef NEPH_RENDERER_REALTIME_SLOTS_H
#define NEPH_RENDERER_REALTIME_SLOTS_H

#include "renderer/realtime/view.h"

/* What RT_TILE's depths are counted in [m]; the largest half, also the largest such count. */
#define NEPH_RT_TILE_UNIT_M 1e4f
#define NEPH_RT_HALF_MAX 65504.0f

/* Where in its tile a slot 0..3 lies, in half-pixels: x, y. */
const int *neph_rt_slot_place(const struct neph_rt_view *view, int slot);

/* The slot of a half-pixel in its tile. */
int neph_rt_slot_of(const struct neph_rt_view *view, int half_x, int half_y);

/* The slot whose turn it is (A4). */
int neph_rt_default_slot(const struct neph_rt_view *view, int tile_x, int tile_y);

/* A depth with the sky at `sky_m` and solids before ray_depth_max_m [m]. */
float neph_rt_limited_depth_m(const struct neph_rt_view *view, float depth_m, float sky_m);

/* The depth that a ray which ends at `depth_m` is stored with (A6) [m]. */
float neph_rt_stored_depth_m(const struct neph_rt_view *view, float depth_m);

#endif

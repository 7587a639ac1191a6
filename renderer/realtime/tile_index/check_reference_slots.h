/* SPDX-License-Identifier: MIT
 *
 * The CPU reference of slots.glsl: tiles of 2x2 half-resolution texels.
 */
#ifndef NEPH_CHECK_REFERENCE_SLOTS_H
#define NEPH_CHECK_REFERENCE_SLOTS_H

#include "renderer/realtime/view.h"

#include <stdbool.h>

/* Unit of RT_TILE's depths [m]; the largest half, which limits their count. */
#define CPU_TILE_UNIT_M 1e4f
#define CPU_HALF_MAX 65504.0f

/* The place of a slot 0..3 in its tile, in half-resolution texels: x, y. */
const int *cpu_slot_place(const struct neph_gpu_view *view, int slot);

/* The slot of a half-resolution texel in its tile. */
int cpu_find_slot(const struct neph_gpu_view *view, int half_x, int half_y);

/* The scheduled slot of a tile. */
int cpu_default_slot(const struct neph_gpu_view *view, int tile_x, int tile_y);

/* With gradient=on: whether a tile's ray repeats the ray_dither number of four frames before. */
bool cpu_repeats_ray(const struct neph_gpu_view *view, int tile_x, int tile_y);

/* A depth limited to ray_depth_max_m for solids, with the sky at `sky_m` [m]. */
float cpu_limited_depth_m(const struct neph_gpu_view *view, float depth_m, float sky_m);

/* The depth that is stored with a ray that ends at `depth_m` [m]. */
float cpu_stored_depth_m(const struct neph_gpu_view *view, float depth_m);

#endif

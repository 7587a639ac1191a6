/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/tile_index/check_reference_slots.h"

#include <math.h>

const int *cpu_slot_place(const struct neph_gpu_view *view, int slot)
{
    static const int places[4][4][2] = {
        [RT_SLOT_ORDER_CLOCKWISE] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
        [RT_SLOT_ORDER_RASTER] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}},
        [RT_SLOT_ORDER_DIAGONAL] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}},
        [RT_SLOT_ORDER_ANTICLOCKWISE] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}},
    };
    return places[(int)view->settings[RT_SLOT_ORDER]][slot];
}

int cpu_find_slot(const struct neph_gpu_view *view, int half_x, int half_y)
{
    for (int slot = 0; slot < 3; slot++) {
        const int *place = cpu_slot_place(view, slot);
        if (place[0] == half_x % 2 && place[1] == half_y % 2)
            return slot;
    }
    return 3;
}

int cpu_default_slot(const struct neph_gpu_view *view, int tile_x, int tile_y)
{
    const int ahead = view->settings[RT_SLOT_CHECKERBOARD] != 0.0f && tile_x % 2 == tile_y % 2;
    return (int)(view->frame % 4 + (uint32_t)ahead) % 4;
}

bool cpu_repeats_ray(const struct neph_gpu_view *view, int tile_x, int tile_y)
{
    const uint32_t turn = view->frame / 4; /* cycles of four frames */
    return turn % 2 != (uint32_t)(tile_x % 2 != tile_y % 2);
}

float cpu_limited_depth_m(const struct neph_gpu_view *view, float depth_m, float sky_m)
{
    const float limited_m = depth_m >= NEPH_GPU_FAR_M
                                ? sky_m
                                : fminf(depth_m, view->settings[RT_RAY_DEPTH_MAX_M]);
    return fminf(limited_m, CPU_HALF_MAX * CPU_TILE_UNIT_M);
}

float cpu_stored_depth_m(const struct neph_gpu_view *view, float depth_m)
{
    return cpu_limited_depth_m(view, depth_m, view->settings[RT_SKY_M]);
}

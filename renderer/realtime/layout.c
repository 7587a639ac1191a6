/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/layout.h"

#include <stdbool.h>
#include <string.h>

enum { FULL = 1, HALF = 2, QUARTER = 4 };

/* Which setting chooses between the two formats; -1: the first always. */
static const struct {
    int divisor;
    int setting;
    enum neph_rt_format half, single;
} layouts[RT_TARGET_COUNT] = {
    [RT_DEPTH] = {FULL, -1, NEPH_RT_R32F, NEPH_RT_R32F},
    [RT_BEHIND] = {FULL, -1, NEPH_RT_RGBA32F, NEPH_RT_RGBA32F},
    [RT_STEADY_DEPTH] = {FULL, -1, NEPH_RT_R32F, NEPH_RT_R32F},
    [RT_HALF_DEPTH] = {HALF, -1, NEPH_RT_R32F, NEPH_RT_R32F},
    [RT_HALF_DEPTH_BEFORE] = {HALF, -1, NEPH_RT_R32F, NEPH_RT_R32F},
    [RT_HISTORY] = {HALF, RT_COLOR_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
    [RT_HISTORY_BEFORE] = {HALF, RT_COLOR_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
    [RT_HISTORY_STATE] = {HALF, RT_DEPTH_FORMAT, NEPH_RT_RG16F, NEPH_RT_RG32F},
    [RT_HISTORY_STATE_BEFORE] = {HALF, RT_DEPTH_FORMAT, NEPH_RT_RG16F, NEPH_RT_RG32F},
    [RT_TILE] = {QUARTER, RT_DEPTH_FORMAT, NEPH_RT_RG16F, NEPH_RT_RG32F},
    [RT_RAY] = {QUARTER, RT_COLOR_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
    [RT_RAY_DISTANCE] = {QUARTER, RT_DEPTH_FORMAT, NEPH_RT_R16F, NEPH_RT_R32F},
    [RT_VOLUME] = {FULL, RT_COLOR_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
    [RT_VOLUME_DISTANCE] = {FULL, RT_DEPTH_FORMAT, NEPH_RT_R16F, NEPH_RT_R32F},
    [RT_COLOR] = {FULL, -1, NEPH_RT_RGBA32F, NEPH_RT_RGBA32F},
    [RT_TAA_OUT] = {FULL, RT_TAA_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
    [RT_TAA_BEFORE] = {FULL, RT_TAA_FORMAT, NEPH_RT_RGBA16F, NEPH_RT_RGBA32F},
};

static uint32_t divide_up(int value, int divisor)
{
    return (uint32_t)((value + divisor - 1) / divisor);
}

void neph_rt_view_init(struct neph_rt_view *view, const struct neph_settings *settings,
                       const int size_px[2], const int origin_px[2], const int buffer_px[2])
{
    memset(view, 0, sizeof(*view));
    for (int s = 0; s < RT_SETTING_COUNT; s++)
        view->settings[s] = (float)settings->values[s];
    for (int axis = 0; axis < 2; axis++) {
        view->origin_px[axis] = (uint32_t)origin_px[axis];
        view->size_px[axis] = (uint32_t)size_px[axis];
        view->half_size_px[axis] = divide_up(size_px[axis], HALF);
        view->tile_count[axis] = divide_up(size_px[axis], QUARTER);
    }
    for (int t = 0; t < RT_TARGET_COUNT; t++) {
        const bool single = layouts[t].setting >= 0 &&
                            view->settings[layouts[t].setting] == RT_FORMAT_FLOAT;
        view->targets[t] = (struct neph_rt_target){
            .format = single ? layouts[t].single : layouts[t].half,
            .width = divide_up(buffer_px[0], layouts[t].divisor),
            .height = divide_up(buffer_px[1], layouts[t].divisor),
        };
    }
}

uint64_t neph_rt_target_bytes(const struct neph_rt_view *view, int target)
{
    const struct neph_rt_target *shape = &view->targets[target];
    return (uint64_t)shape->width * shape->height * neph_rt_format_bytes(shape->format);
}

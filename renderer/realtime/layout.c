/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/layout.h"

#include <stdbool.h>
#include <string.h>

/* struct TargetRow of shaders/realtime.glsl */
static const struct {
    int resolution, setting, half_format, float_format;
} rows[RT_TARGET_COUNT] = {RT_TARGETS};

static uint32_t divide_up(int value, int divisor)
{
    return (uint32_t)((value + divisor - 1) / divisor);
}

static struct neph_gpu_target shape_of(const struct neph_gpu_view *view, int target,
                                       const int buffer_px[2])
{
    const int setting = rows[target].setting, resolution = rows[target].resolution;
    const bool is_half = setting == RT_FIXED || view->settings[setting] == RT_FORMAT_HALF;
    return (struct neph_gpu_target){
        .format = (uint32_t)(is_half ? rows[target].half_format : rows[target].float_format),
        .width = divide_up(buffer_px[0], resolution),
        .height = divide_up(buffer_px[1], resolution),
    };
}

void neph_rt_view_init(struct neph_gpu_view *view, const struct neph_settings *settings,
                       const int size_px[2], const int origin_px[2], const int buffer_px[2])
{
    memset(view, 0, sizeof(*view));
    for (int s = 0; s < RT_SETTING_COUNT; s++)
        view->settings[s] = (float)settings->values[s];
    if (view->settings[RT_SPLIT] == (float)RT_SPLIT_NONE)
        view->settings[RT_GRADIENT] = 0.0f; /* no tiles, no rays of theirs to be marched twice */
    for (int axis = 0; axis < 2; axis++) {
        view->origin_px[axis] = (uint32_t)origin_px[axis];
        view->size_px[axis] = (uint32_t)size_px[axis];
        view->half_size_px[axis] = divide_up(size_px[axis], RT_HALF);
        view->tile_count[axis] = divide_up(size_px[axis], RT_QUARTER);
    }
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        view->targets[t] = shape_of(view, t, buffer_px);
}

uint64_t neph_rt_target_bytes(const struct neph_gpu_view *view, int target)
{
    const struct neph_gpu_target *shape = &view->targets[target];
    return (uint64_t)shape->width * shape->height * neph_rt_format_bytes(shape->format);
}

uint32_t neph_rt_target_side_px(int target)
{
    return (uint32_t)rows[target].resolution;
}

uint64_t neph_rt_texel_count(const struct neph_gpu_view *view, int resolution)
{
    return (uint64_t)divide_up((int)view->size_px[0], resolution) *
           divide_up((int)view->size_px[1], resolution);
}

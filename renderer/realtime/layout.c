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

static uint32_t whole(const struct neph_gpu_view *view, int setting)
{
    return (uint32_t)view->settings[setting];
}

static uint32_t froxel_columns(const struct neph_gpu_view *view, int axis)
{
    return divide_up((int)view->size_px[axis], (int)view->settings[RT_FROXEL_PX]);
}

/* One, for nobody, where there are none. */
static struct neph_gpu_target froxels_of(const struct neph_gpu_view *view, uint32_t format)
{
    const bool any = view->settings[RT_FROXEL_VOLUME] != 0.0f;
    return (struct neph_gpu_target){
        .format = format,
        .width = any ? froxel_columns(view, 0) : 1,
        .height = any ? RT_FROXEL_SECTIONS * froxel_columns(view, 1) * whole(view, RT_FROXEL_SLICES)
                      : 1,
    };
}

static struct neph_gpu_target shape_of(const struct neph_gpu_view *view, int target,
                                       const int buffer_px[2])
{
    const int setting = rows[target].setting, resolution = rows[target].resolution;
    const bool is_half = setting == RT_FIXED || view->settings[setting] == RT_FORMAT_HALF;
    if (resolution == RT_FROXEL)
        return froxels_of(view, (uint32_t)rows[target].float_format);
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
    /* No tiles, no rays of theirs to be marched twice, or from the end of froxels on. */
    if (view->settings[RT_SPLIT] == (float)RT_SPLIT_NONE)
        view->settings[RT_GRADIENT] = view->settings[RT_FROXEL_VOLUME] = 0.0f;
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

struct neph_rt_rectangle neph_rt_view_texels(const struct neph_gpu_view *view, int target)
{
    const struct neph_gpu_target *shape = &view->targets[target];
    const uint32_t side_px = (uint32_t)rows[target].resolution;
    if (rows[target].resolution == RT_FROXEL)
        return (struct neph_rt_rectangle){0, 0, shape->width, shape->height};
    return (struct neph_rt_rectangle){
        .left = view->origin_px[0] / side_px,
        .top = view->origin_px[1] / side_px,
        .width = divide_up((int)view->size_px[0], (int)side_px),
        .height = divide_up((int)view->size_px[1], (int)side_px),
    };
}

uint64_t neph_rt_texel_count(const struct neph_gpu_view *view, int resolution)
{
    const uint64_t columns = (uint64_t)froxel_columns(view, 0) * froxel_columns(view, 1);
    if (resolution == RT_FROXEL_COLUMN)
        return columns;
    if (resolution == RT_FROXEL)
        return columns * whole(view, RT_FROXEL_SLICES);
    return (uint64_t)divide_up((int)view->size_px[0], resolution) *
           divide_up((int)view->size_px[1], resolution);
}

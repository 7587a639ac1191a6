/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/layout.h"

#include <math.h>
#include <string.h>

/* struct TargetRow of realtime/shared/view.glsl */
static const struct {
    int resolution, half_format, float_format;
} rows[RT_TARGET_COUNT] = {RT_TARGETS};

static uint32_t divide_up(int value, int divisor)
{
    return (uint32_t)((value + divisor - 1) / divisor);
}

static uint32_t read_whole_setting(const struct neph_gpu_view *view, int setting)
{
    return (uint32_t)view->settings[setting];
}

int neph_rt_rendered_px(int picture_px, int percent)
{
    return (int)divide_up(picture_px * percent, 100);
}

/* Size of the output, or of the view. */
static const uint32_t *get_pixel_size(const struct neph_gpu_view *view, int resolution)
{
    return resolution == RT_OUTPUT ? view->picture_px : view->size_px;
}

/* Pixels along a side of a texel. */
static int texel_px(int resolution)
{
    return resolution == RT_OUTPUT ? 1 : resolution;
}

static uint32_t froxel_columns(const struct neph_gpu_view *view, int axis)
{
    return divide_up((int)view->size_px[axis], (int)view->settings[RT_FROXEL_PX]);
}

/* Without froxels a target of one element, which no pass reads. */
static struct neph_gpu_target make_froxel_target(const struct neph_gpu_view *view, uint32_t format)
{
    const bool any = view->settings[RT_FROXEL_VOLUME] != 0.0f;
    return (struct neph_gpu_target){
        .format = format,
        .width = any ? froxel_columns(view, 0) : 1,
        .height = any ? RT_FROXEL_SECTIONS * froxel_columns(view, 1) *
                            read_whole_setting(view, RT_FROXEL_SLICES)
                      : 1,
    };
}

static struct neph_gpu_target make_target_shape(const struct neph_gpu_view *view, int target,
                                                const int buffer_px[2])
{
    const int resolution = rows[target].resolution;
    const int percent = resolution == RT_OUTPUT ? 100 : (int)view->settings[RT_SCREEN_PERCENT];
    const bool is_half = view->settings[RT_TARGET_FORMAT] == RT_FORMAT_HALF;
    if (resolution == RT_FROXEL)
        return make_froxel_target(view, (uint32_t)rows[target].float_format);
    return (struct neph_gpu_target){
        .format = (uint32_t)(is_half ? rows[target].half_format : rows[target].float_format),
        .width = divide_up(neph_rt_rendered_px(buffer_px[0], percent), texel_px(resolution)),
        .height = divide_up(neph_rt_rendered_px(buffer_px[1], percent), texel_px(resolution)),
    };
}

int neph_rt_jitter_length(int length, int percent)
{
    const int grown = (int)lround(length * 1e4 / ((double)percent * percent));
    return grown + (length % 2 == 1 && grown % 2 == 0);
}

/* With fewer rendered pixels the anti-aliasing also upsamples. Its jitter is longer and covers the
 * whole pixel, and its neighbourhood clamp takes rays by distance, as in Unreal. */
static void set_upsampling(struct neph_gpu_view *view)
{
    float *settings = view->settings;
    const int percent = (int)settings[RT_SCREEN_PERCENT];
    if (percent < 100 && settings[RT_TAA] == (float)RT_TAA_ON)
        settings[RT_TAA] = RT_TAA_UPSAMPLING;
    if (percent < 100 && settings[RT_TAA_JITTER] == (float)RT_JITTER_UE)
        settings[RT_TAA_JITTER] = RT_JITTER_HALTON;
    if (percent < 100 && settings[RT_TAA] == (float)RT_TAA_UPSAMPLING &&
        settings[RT_TAA_BOX] == (float)RT_BOX_MIN_MAX)
        settings[RT_TAA_BOX] = RT_BOX_DISTANCE;
    settings[RT_TAA_JITTER_LENGTH] = (float)neph_rt_jitter_length(
        (int)settings[RT_TAA_JITTER_LENGTH], percent);
}

/* froxel_px=0: 12 pixels at a width of 1920, and as many columns at other widths. */
enum { FROXEL_COLUMNS = 160 };

void neph_rt_view_init(struct neph_gpu_view *view, const struct neph_settings *settings,
                       const int picture_px[2], const int origin_px[2], const int buffer_px[2])
{
    memset(view, 0, sizeof(*view));
    for (int s = 0; s < RT_SETTING_COUNT; s++)
        view->settings[s] = (float)settings->values[s];
    set_upsampling(view);
    view->exposure = view->exposure_before = 1.0f;
    /* Without split there are no tiles, so no gradient samples, no froxels and no volume. */
    if (view->settings[RT_SPLIT] == (float)RT_SPLIT_NONE)
        view->settings[RT_GRADIENT] = view->settings[RT_FROXEL_VOLUME] =
            view->settings[RT_TAA_RESPONSIVE] = view->settings[RT_ATROUS] = 0.0f;
    if (view->settings[RT_FROXEL_VOLUME] == 0.0f)
        view->settings[RT_LAMP_PEAKS] = 0.0f;
    if (view->settings[RT_FROXEL_PX] == 0.0f)
        view->settings[RT_FROXEL_PX] = (float)divide_up(
            neph_rt_rendered_px(picture_px[0], (int)view->settings[RT_SCREEN_PERCENT]),
            FROXEL_COLUMNS);
    for (int axis = 0; axis < 2; axis++) {
        const int size_px = neph_rt_rendered_px(picture_px[axis],
                                                (int)view->settings[RT_SCREEN_PERCENT]);
        view->picture_px[axis] = (uint32_t)picture_px[axis];
        view->origin_px[axis] = (uint32_t)origin_px[axis];
        view->size_px[axis] = (uint32_t)size_px;
        view->rendered_per_px[axis] = (float)size_px / (float)picture_px[axis];
        view->half_size_px[axis] = divide_up(size_px, RT_HALF);
        view->tile_count[axis] = divide_up(size_px, RT_QUARTER);
    }
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        view->targets[t] = make_target_shape(view, t, buffer_px);
}

uint64_t neph_rt_target_bytes(const struct neph_gpu_view *view, int target)
{
    const struct neph_gpu_target *shape = &view->targets[target];
    return (uint64_t)shape->width * shape->height * neph_rt_format_bytes(shape->format);
}

struct neph_rt_rectangle neph_rt_view_texels(const struct neph_gpu_view *view, int target)
{
    const struct neph_gpu_target *shape = &view->targets[target];
    const uint32_t *pixels = get_pixel_size(view, rows[target].resolution);
    const int side_px = texel_px(rows[target].resolution);
    if (rows[target].resolution == RT_FROXEL)
        return (struct neph_rt_rectangle){0, 0, shape->width, shape->height};
    return (struct neph_rt_rectangle){
        .left = view->origin_px[0] / (uint32_t)side_px,
        .top = view->origin_px[1] / (uint32_t)side_px,
        .width = divide_up((int)pixels[0], side_px),
        .height = divide_up((int)pixels[1], side_px),
    };
}

uint64_t neph_rt_texel_count(const struct neph_gpu_view *view, int resolution)
{
    const uint64_t columns = (uint64_t)froxel_columns(view, 0) * froxel_columns(view, 1);
    if (resolution == RT_FROXEL_COLUMN)
        return columns;
    if (resolution == RT_FROXEL)
        return columns * read_whole_setting(view, RT_FROXEL_SLICES);
    const uint32_t *pixels = get_pixel_size(view, resolution);
    return (uint64_t)divide_up((int)pixels[0], texel_px(resolution)) *
           divide_up((int)pixels[1], texel_px(resolution));
}

bool neph_rt_has_output_size(int target)
{
    return rows[target].resolution == RT_OUTPUT;
}

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

#include "renderer/realtime/unread.h"

#include <string.h>

static const uint32_t scene_code[] = {
#include "shaders/rt_scene.comp.inc"
};
static const uint32_t min_max_code[] = {
#include "shaders/rt_min_max.comp.inc"
};
static const uint32_t tile_index_code[] = {
#include "shaders/rt_tile_index.comp.inc"
};
static const uint32_t march_code[] = {
#include "shaders/rt_march.comp.inc"
};
static const uint32_t gradient_code[] = {
#include "shaders/rt_gradient.comp.inc"
};
static const uint32_t change_code[] = {
#include "shaders/rt_change.comp.inc"
};
static const uint32_t reconstruct_code[] = {
#include "shaders/rt_reconstruct.comp.inc"
};
static const uint32_t atrous_1_code[] = {
#include "shaders/rt_atrous_1.comp.inc"
};
static const uint32_t atrous_2_code[] = {
#include "shaders/rt_atrous_2.comp.inc"
};
static const uint32_t atrous_4_code[] = {
#include "shaders/rt_atrous_4.comp.inc"
};
static const uint32_t upscale_code[] = {
#include "shaders/rt_upscale.comp.inc"
};
static const uint32_t compose_code[] = {
#include "shaders/rt_compose.comp.inc"
};
static const uint32_t motion_code[] = {
#include "shaders/rt_motion.comp.inc"
};
static const uint32_t taa_code[] = {
#include "shaders/rt_taa.comp.inc"
};
static const uint32_t taau_code[] = {
#include "shaders/rt_taau.comp.inc"
};
static const uint32_t locks_code[] = {
#include "shaders/rt_locks.comp.inc"
};
static const uint32_t sharpen_code[] = {
#include "shaders/rt_sharpen.comp.inc"
};
static const uint32_t froxel_light_code[] = {
#include "shaders/rt_froxel_light.comp.inc"
};
static const uint32_t froxel_sum_code[] = {
#include "shaders/rt_froxel_sum.comp.inc"
};
static const uint32_t froxel_apply_code[] = {
#include "shaders/rt_froxel_apply.comp.inc"
};
static const uint32_t lamp_peaks_code[] = {
#include "shaders/rt_lamp_peaks.comp.inc"
};

#define BIT NEPH_RT_BIT

#define ATROUS_READS BIT(RT_HALF_DEPTH) | BIT(RT_HISTORY_STATE)

/* And what has changed around a tile. */
#define CHANGE_READS                                                                               \
    BIT(RT_LOOK_NOW) | BIT(RT_LOOK_THEN) | BIT(RT_LOOK_BEHIND_NOW) | BIT(RT_LOOK_BEHIND_THEN) |    \
        BIT(RT_CHANGE_BEHIND)

/* What anti-aliasing and upsampling are bound to. */
#define TAA_READS                                                                                  \
    BIT(RT_COLOR) | BIT(RT_DEPTH) | BIT(RT_TAA_BEFORE) | BIT(RT_VOLUME) | BIT(RT_BEHIND) |         \
        BIT(RT_VOLUME_DISTANCE) | BIT(RT_CHANGE) | BIT(RT_CHANGE_BEHIND) | BIT(RT_MOVED)
#define TAA_SPARED                                                                                 \
    {                                                                                              \
        {{{RT_COMPOSITION, RT_COMPOSITION_AUTO},                                                   \
          {RT_COMPOSITION, RT_COMPOSITION_PASS},                                                   \
          {RT_COMPOSITION, RT_COMPOSITION_UPSCALE}},                                               \
         BIT(RT_COLOR)},                                                                           \
            {{{RT_COMPOSITION, RT_COMPOSITION_TAA}}, BIT(RT_BEHIND)},                              \
            {{{RT_TAA_MEDIUM, 1}}, BIT(RT_VOLUME_DISTANCE)},                                       \
            {{{RT_TAA_MEDIUM, 1},                                                                  \
              {RT_GRADIENT, 1},                                                                    \
              {RT_COMPOSITION, RT_COMPOSITION_TAA},                                                \
              {RT_TAA_RESPONSIVE, RT_RESPONSIVE_MEDIUM}},                                          \
             BIT(RT_VOLUME)},                                                                      \
            {{{RT_GRADIENT, 1}}, BIT(RT_CHANGE) | BIT(RT_CHANGE_BEHIND)},                          \
            {{{RT_SOLID_MOTION, 1}}, BIT(RT_MOVED)},                                               \
    }

const struct neph_rt_pass neph_rt_passes[] = {
    {
        .name = "scene",
        .note = "depth and radiance of what is behind all media, a ray per pixel",
        .shader = {"rt_scene", scene_code, sizeof(scene_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .resolution = RT_FULL,
        .rays = NEPH_RT_RAYS_TO_SOLIDS,
        .writes = BIT(RT_DEPTH) | BIT(RT_BEHIND) | BIT(RT_STEADY_DEPTH),
    },
    {
        .name = "depth map",
        .note = "one of 2x2 depths",
        .shader = {"rt_min_max", min_max_code, sizeof(min_max_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .done_by_other = {{RT_DEPTH_MAP_PASS, RT_DEPTH_MAP_PASS_TILE_INDEX}},
        .resolution = RT_HALF,
        .reads = BIT(RT_STEADY_DEPTH),
        .writes = BIT(RT_HALF_DEPTH),
        .histories = {{RT_HALF_DEPTH, RT_HALF_DEPTH_BEFORE}},
    },
    {
        .name = "froxel light",
        .note = "what media near the camera scatter and extinguish, a froxel at a time",
        .shader = {"rt_froxel_light", froxel_light_code, sizeof(froxel_light_code)},
        .condition = {RT_FROXEL_VOLUME, 1},
        .resolution = RT_FROXEL,
        .rays = NEPH_RT_POINTS_IN_MEDIA,
        .reads = BIT(RT_STEADY_DEPTH) | BIT(RT_FROXELS),
        .writes = BIT(RT_FROXELS),
    },
    {
        .name = "froxel sum",
        .note = "front to back, what lies before each slice",
        .shader = {"rt_froxel_sum", froxel_sum_code, sizeof(froxel_sum_code)},
        .condition = {RT_FROXEL_VOLUME, 1},
        .resolution = RT_FROXEL_COLUMN,
        .reads = BIT(RT_FROXELS),
        .writes = BIT(RT_FROXELS),
    },
    {
        .name = "tile index",
        .note = "which of its 2x2 half-resolution texels a tile marches",
        .shader = {"rt_tile_index", tile_index_code, sizeof(tile_index_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .resolution = RT_QUARTER,
        .block = {RT_COLOUR_BLOCK, RT_COLOUR_BLOCK},
        .in_colours = &(const struct neph_rt_condition){RT_OVERRIDE, RT_OVERRIDE_SEQUENTIAL},
        .reads = BIT(RT_STEADY_DEPTH) | BIT(RT_HALF_DEPTH) | BIT(RT_TILE),
        .spared = {{{{RT_DEPTH_MAP_PASS, RT_DEPTH_MAP_PASS_TILE_INDEX}}, BIT(RT_STEADY_DEPTH)}},
        .writes = BIT(RT_HALF_DEPTH) | BIT(RT_TILE),
    },
    {
        .name = "march",
        .note = "a ray per tile through the media",
        .shader = {"rt_march", march_code, sizeof(march_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .resolution = RT_QUARTER,
        .block = {RT_MARCH_BLOCK, RT_MARCH_BLOCK},
        .rays = NEPH_RT_RAYS_THROUGH_MEDIA,
        .reads = BIT(RT_TILE) | BIT(RT_HALF_DEPTH),
        .writes = BIT(RT_RAY) | BIT(RT_RAY_DISTANCE),
    },
    {
        .name = "gradient",
        .note = "what the same rays see that were marched before",
        .shader = {"rt_gradient", gradient_code, sizeof(gradient_code)},
        .condition = {RT_GRADIENT, 1},
        .done_by_other = {{RT_STEADY, RT_STEADY_KNOWN}, {RT_STEADY, RT_STEADY_UNREAD}},
        .resolution = RT_QUARTER,
        .reads = BIT(RT_RAY) | BIT(RT_BEHIND) | BIT(RT_KEPT_RAY) | BIT(RT_KEPT_BEHIND) |
                 BIT(RT_HALF_DEPTH) | BIT(RT_HALF_DEPTH_BEFORE),
        .writes = BIT(RT_KEPT_RAY) | BIT(RT_KEPT_BEHIND) | BIT(RT_LOOK_NOW) | BIT(RT_LOOK_THEN) |
                  BIT(RT_LOOK_BEHIND_NOW) | BIT(RT_LOOK_BEHIND_THEN),
    },
    {
        .name = "change",
        .note = "what has changed around a tile",
        .shader = {"rt_change", change_code, sizeof(change_code)},
        .condition = {RT_GRADIENT, 1},
        .done_by_other = {{RT_CHANGE_PASS, RT_CHANGE_PASS_RECONSTRUCTION},
                          {RT_STEADY, RT_STEADY_KNOWN},
                          {RT_STEADY, RT_STEADY_UNREAD}},
        .resolution = RT_QUARTER,
        .reads = CHANGE_READS | BIT(RT_CHANGE),
        .writes = BIT(RT_CHANGE) | BIT(RT_CHANGE_BEHIND),
    },
    {
        .name = "reconstruction",
        .note = "rays and the reprojected history at half resolution",
        .shader = {"rt_reconstruct", reconstruct_code, sizeof(reconstruct_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .resolution = RT_HALF,
        .unread_resolution = RT_QUARTER,
        .block = {RT_TEXEL_BLOCK_WIDTH, RT_TEXEL_BLOCK_HEIGHT},
        .reads = BIT(RT_TILE) | BIT(RT_RAY) | BIT(RT_RAY_DISTANCE) | BIT(RT_HALF_DEPTH) |
                 BIT(RT_HALF_DEPTH_BEFORE) | BIT(RT_HISTORY_BEFORE) | BIT(RT_HISTORY_STATE_BEFORE) |
                 BIT(RT_CHANGE) | CHANGE_READS,
        .spared = {{{{RT_GRADIENT, 1}}, BIT(RT_CHANGE)},
                   {{{RT_CHANGE_PASS, RT_CHANGE_PASS_RECONSTRUCTION}}, CHANGE_READS},
                   {{{RT_STEADY, RT_STEADY_KNOWN}, {RT_STEADY, RT_STEADY_UNREAD}},
                    BIT(RT_KEPT_RAY)}},
        .writes = BIT(RT_HISTORY) | BIT(RT_HISTORY_STATE) | BIT(RT_CHANGE) | BIT(RT_CHANGE_BEHIND) |
                  BIT(RT_KEPT_RAY),
        .histories = {{RT_HISTORY, RT_HISTORY_BEFORE}, {RT_HISTORY_STATE, RT_HISTORY_STATE_BEFORE}},
    },
    {
        .name = "a-trous 1",
        .note = "the volume filtered by depth and luma",
        .shader = {"rt_atrous_1", atrous_1_code, sizeof(atrous_1_code)},
        .condition = {RT_ATROUS, 1},
        .resolution = RT_HALF,
        .reads = BIT(RT_HISTORY) | ATROUS_READS,
        .writes = BIT(RT_HISTORY_BEFORE),
    },
    {
        .name = "a-trous 2",
        .note = "the same of texels two apart",
        .shader = {"rt_atrous_2", atrous_2_code, sizeof(atrous_2_code)},
        .condition = {RT_ATROUS, 1},
        .resolution = RT_HALF,
        .reads = BIT(RT_HISTORY_BEFORE) | ATROUS_READS,
        .writes = BIT(RT_KEPT_RAY),
    },
    {
        .name = "a-trous 4",
        .note = "the same of texels four apart",
        .shader = {"rt_atrous_4", atrous_4_code, sizeof(atrous_4_code)},
        .condition = {RT_ATROUS, 1},
        .resolution = RT_HALF,
        .reads = BIT(RT_KEPT_RAY) | ATROUS_READS,
        .writes = BIT(RT_HISTORY_BEFORE),
    },
    {
        .name = "upscale",
        .note = "the volume at full resolution, guided by depth",
        .shader = {"rt_upscale", upscale_code, sizeof(upscale_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .resolution = RT_FULL,
        .in_quads = true,
        .reads = BIT(RT_DEPTH) | BIT(RT_HALF_DEPTH) | BIT(RT_HISTORY) | BIT(RT_HISTORY_BEFORE) |
                 BIT(RT_HISTORY_STATE) | BIT(RT_BEHIND),
        .spared = {{{{RT_ATROUS, 0}}, BIT(RT_HISTORY)},
                   {{{RT_ATROUS, 1}}, BIT(RT_HISTORY_BEFORE)},
                   {{{RT_COMPOSITION, RT_COMPOSITION_UPSCALE}}, BIT(RT_BEHIND) | BIT(RT_COLOR)},
                   {{{RT_STEADY, RT_STEADY_AUTO},
                     {RT_STEADY, RT_STEADY_UNASKED},
                     {RT_STEADY, RT_STEADY_KNOWN}},
                    BIT(RT_VOLUME) | BIT(RT_VOLUME_DISTANCE)}},
        .writes = BIT(RT_VOLUME) | BIT(RT_VOLUME_DISTANCE) | BIT(RT_COLOR),
        .picture = RT_COLOR,
    },
    {
        .name = "froxel composition",
        .note = "the froxels before the volume that was marched behind them",
        .shader = {"rt_froxel_apply", froxel_apply_code, sizeof(froxel_apply_code)},
        .condition = {RT_FROXEL_VOLUME, 1},
        .resolution = RT_FULL,
        .reads = BIT(RT_FROXELS) | BIT(RT_DEPTH) | BIT(RT_VOLUME),
        .writes = BIT(RT_VOLUME),
    },
    {
        .name = "lamp peaks",
        .note = "what froxels leave out around each lamp, a ray per pixel",
        .shader = {"rt_lamp_peaks", lamp_peaks_code, sizeof(lamp_peaks_code)},
        .condition = {RT_LAMP_PEAKS, 1},
        .resolution = RT_FULL,
        .rays = NEPH_RT_POINTS_IN_MEDIA,
        .reads = BIT(RT_FROXELS) | BIT(RT_DEPTH) | BIT(RT_VOLUME),
        .writes = BIT(RT_VOLUME),
    },
    {
        .name = "composition",
        .note = "the volume over what is behind it",
        .shader = {"rt_compose", compose_code, sizeof(compose_code)},
        .condition = {RT_SPLIT, RT_SPLIT_FOUR},
        .done_by_other = {{RT_COMPOSITION, RT_COMPOSITION_TAA},
                          {RT_COMPOSITION, RT_COMPOSITION_UPSCALE}},
        .resolution = RT_FULL,
        .reads = BIT(RT_VOLUME) | BIT(RT_BEHIND),
        .writes = BIT(RT_COLOR),
        .picture = RT_COLOR,
    },
    {
        .name = "motion",
        .note = "how far solids that move have come, a ray per pixel",
        .shader = {"rt_motion", motion_code, sizeof(motion_code)},
        .condition = {RT_SOLID_MOTION, 1},
        .resolution = RT_FULL,
        .rays = NEPH_RT_RAYS_TO_SOLIDS,
        .writes = BIT(RT_MOVED),
    },
    {
        .name = "anti-aliasing",
        .note = "the mean over jittered frames, held in a neighbourhood clamp",
        .shader = {"rt_taa", taa_code, sizeof(taa_code)},
        .condition = {RT_TAA, RT_TAA_ON},
        .resolution = RT_PICTURE,
        .column = RT_TAA_COLUMN,
        .block = {RT_TAA_BLOCK_WIDTH, RT_TAA_BLOCK_HEIGHT},
        .reads = TAA_READS,
        .spared = TAA_SPARED,
        .writes = BIT(RT_TAA_OUT),
        .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}},
        .picture = RT_TAA_OUT,
    },
    {
        .name = "upsampling",
        .note = "anti-aliasing to a picture of more pixels than are rendered",
        .shader = {"rt_taau", taau_code, sizeof(taau_code)},
        .condition = {RT_TAA, RT_TAA_UPSAMPLING},
        .resolution = RT_PICTURE,
        .reads = TAA_READS,
        .spared = TAA_SPARED,
        .writes = BIT(RT_TAA_OUT),
        .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}},
        .picture = RT_TAA_OUT,
    },
    {
        .name = "locks",
        .note = "upsampling with locks on thin features, after FSR 2",
        .shader = {"rt_locks", locks_code, sizeof(locks_code)},
        .condition = {RT_TAA, RT_TAA_LOCKS},
        .resolution = RT_PICTURE,
        .reads = TAA_READS | BIT(RT_TAA_STATE_BEFORE),
        .spared = TAA_SPARED,
        .writes = BIT(RT_TAA_OUT) | BIT(RT_TAA_STATE),
        .histories = {{RT_TAA_OUT, RT_TAA_BEFORE}, {RT_TAA_STATE, RT_TAA_STATE_BEFORE}},
        .picture = RT_TAA_OUT,
    },
    {
        .name = "sharpening",
        .note = "against the blur of anti-aliasing",
        .shader = {"rt_sharpen", sharpen_code, sizeof(sharpen_code)},
        .condition = {RT_SHARPEN, 1},
        .resolution = RT_PICTURE,
        .reads = BIT(RT_COLOR) | BIT(RT_TAA_OUT),
        .writes = BIT(RT_SHARPENED),
        .picture = RT_SHARPENED,
    },
    {.name = NULL},
};
_Static_assert(sizeof(neph_rt_passes) / sizeof(neph_rt_passes[0]) <= NEPH_RT_PASSES_MAX + 1,
               "room for every pass in the statistics");

static const char *const target_names[RT_TARGET_COUNT] = {
    [RT_DEPTH] = "depth",
    [RT_BEHIND] = "radiance behind",
    [RT_STEADY_DEPTH] = "steady depth",
    [RT_HALF_DEPTH] = "half depth",
    [RT_HALF_DEPTH_BEFORE] = "half depth before",
    [RT_HISTORY] = "history",
    [RT_HISTORY_BEFORE] = "history before",
    [RT_HISTORY_STATE] = "history state",
    [RT_HISTORY_STATE_BEFORE] = "history state before",
    [RT_TILE] = "tile",
    [RT_RAY] = "ray",
    [RT_RAY_DISTANCE] = "ray distance",
    [RT_VOLUME] = "volume",
    [RT_VOLUME_DISTANCE] = "volume distance",
    [RT_COLOR] = "colour",
    [RT_TAA_OUT] = "anti-aliased",
    [RT_TAA_BEFORE] = "anti-aliased before",
    [RT_SHARPENED] = "sharpened",
    [RT_KEPT_RAY] = "kept ray",
    [RT_KEPT_BEHIND] = "kept radiance behind",
    [RT_CHANGE] = "change",
    [RT_CHANGE_BEHIND] = "change behind",
    [RT_LOOK_NOW] = "look now",
    [RT_LOOK_THEN] = "look then",
    [RT_LOOK_BEHIND_NOW] = "look behind now",
    [RT_LOOK_BEHIND_THEN] = "look behind then",
    [RT_MOVED] = "moved",
    [RT_FROXELS] = "froxels",
    [RT_TAA_STATE] = "locks",
    [RT_TAA_STATE_BEFORE] = "locks before",
};

const char *neph_rt_target_name(int target)
{
    return target_names[target];
}

const struct neph_rt_pass *neph_rt_pass_named(const char *name)
{
    for (const struct neph_rt_pass *pass = neph_rt_passes; pass->name; pass++)
        if (strcmp(pass->name, name) == 0)
            return pass;
    return NULL;
}

bool neph_rt_holds(const struct neph_gpu_view *view, struct neph_rt_condition condition)
{
    return (int)view->settings[condition.setting] == condition.choice;
}

static bool spares(const struct neph_gpu_view *view, const struct neph_rt_spared *spared)
{
    for (int i = 0; i < NEPH_RT_UNLESS_MAX; i++)
        if (neph_rt_holds(view, spared->unless[i]))
            return false;
    return true;
}

uint32_t neph_rt_targets_touched(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    uint32_t touched = pass->reads | pass->writes;
    for (int i = 0; i < NEPH_RT_SPARED_MAX && pass->spared[i].targets; i++)
        if (spares(view, &pass->spared[i]))
            touched &= ~pass->spared[i].targets;
    return touched;
}

bool neph_rt_is_done_by_other(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    bool is_done = false;
    for (int i = 0; i < NEPH_RT_OTHERS_MAX; i++)
        is_done |= neph_rt_holds(view, pass->done_by_other[i]);
    return is_done;
}

uint32_t neph_rt_targets_used(const struct neph_gpu_view *view)
{
    uint32_t used = 0;
    for (const struct neph_rt_pass *pass = neph_rt_passes; pass->name; pass++)
        if (neph_rt_holds(view, pass->condition) && !neph_rt_is_done_by_other(view, pass))
            used |= neph_rt_targets_touched(view, pass);
    return used;
}

uint32_t neph_rt_targets_before(const struct neph_rt_pass *pass)
{
    uint32_t before = 0;
    for (int i = 0; i < NEPH_RT_HISTORIES_MAX && pass->histories[i].before; i++)
        before |= BIT(pass->histories[i].before);
    return before;
}

static bool takes_turns(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    return pass->in_colours && neph_rt_holds(view, *pass->in_colours);
}

static uint64_t quotient_up(uint64_t a, uint64_t b)
{
    return (a + b - 1) / b;
}

enum { GROUP_THREADS = 64 };

static int resolution_of(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    return pass->unread_resolution && neph_rt_is_unread(view) ? pass->unread_resolution
                                                              : pass->resolution;
}

uint64_t neph_rt_thread_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              bool on_gpu)
{
    const int resolution = resolution_of(view, pass);
    const uint64_t column = pass->column ? (uint64_t)pass->column : 1;
    if (resolution == RT_FROXEL || resolution == RT_FROXEL_COLUMN)
        return neph_rt_texel_count(view, resolution);
    const bool is_picture = resolution == RT_PICTURE;
    const uint64_t width = is_picture ? view->picture_px[0]
                                      : quotient_up(view->size_px[0], (uint64_t)resolution);
    const uint64_t height = neph_rt_texel_count(view, resolution) / width;
    const bool in_blocks = takes_turns(view, pass) || !pass->in_colours;
    if (!on_gpu && takes_turns(view, pass)) /* a dispatch for each colour */
        return quotient_up(width, 2) * quotient_up(height, 2);
    if (pass->in_quads)
        return (width / 2 + 1) * (height / 2 + 1);
    if ((on_gpu || pass->rays) && in_blocks && pass->block[0] > 0)
        return GROUP_THREADS * quotient_up(width, (uint64_t)pass->block[0]) *
               quotient_up(height, (uint64_t)pass->block[1]);
    return width * quotient_up(height, column);
}

uint32_t neph_rt_colour_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              bool on_gpu)
{
    return !on_gpu && takes_turns(view, pass) ? 4 : 1;
}

/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/passes.h"

#include "renderer/realtime/output_elision.h"

#include <string.h>

const struct neph_rt_pass *const neph_rt_passes[] = {
    &neph_rt_scene_rays,
    &neph_rt_depth_map,
    &neph_rt_froxel_light,
    &neph_rt_froxel_sum,
    &neph_rt_tile_index,
    &neph_rt_ray_march,
    &neph_rt_oracle_texels,
    &neph_rt_oracle_spread,
    &neph_rt_oracle_pixels,
    &neph_rt_gradient,
    &neph_rt_change,
    &neph_rt_reconstruct,
    &neph_rt_atrous_1,
    &neph_rt_atrous_2,
    &neph_rt_atrous_4,
    &neph_rt_upscale,
    &neph_rt_froxel_apply,
    &neph_rt_lamp_peaks,
    &neph_rt_compose,
    &neph_rt_solid_motion,
    &neph_rt_taa,
    &neph_rt_taau,
    &neph_rt_locks,
    &neph_rt_sharpen,
    NULL,
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
    [RT_SAMPLE_NOW] = "sample now",
    [RT_SAMPLE_THEN] = "sample then",
    [RT_SAMPLE_BEHIND_NOW] = "sample behind now",
    [RT_SAMPLE_BEHIND_THEN] = "sample behind then",
    [RT_MOVED] = "moved",
    [RT_FROXELS] = "froxels",
    [RT_TAA_STATE] = "locks",
    [RT_TAA_STATE_BEFORE] = "locks before",
};

const char *neph_rt_target_name(int target)
{
    return target_names[target];
}

int neph_rt_pass_index(const char *name)
{
    for (int i = 0; neph_rt_passes[i]; i++)
        if (strcmp(neph_rt_passes[i]->name, name) == 0)
            return i;
    return -1;
}

bool neph_rt_is_condition_met(const struct neph_gpu_view *view, struct neph_rt_condition condition)
{
    return (int)view->settings[condition.setting] == condition.choice;
}

static bool is_target_spared(const struct neph_gpu_view *view,
                             const struct neph_rt_unused_targets *spared)
{
    for (int i = 0; i < NEPH_RT_UNLESS_MAX; i++)
        if (neph_rt_is_condition_met(view, spared->unless[i]))
            return false;
    return true;
}

uint32_t neph_rt_targets_touched(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    uint32_t touched = pass->reads | pass->writes;
    for (int i = 0; i < NEPH_RT_UNUSED_MAX && pass->spared[i].targets; i++)
        if (is_target_spared(view, &pass->spared[i]))
            touched &= ~pass->spared[i].targets;
    return touched;
}

bool neph_rt_is_pass_skipped(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    bool is_done = false;
    for (int i = 0; i < NEPH_RT_OTHERS_MAX; i++)
        is_done |= neph_rt_is_condition_met(view, pass->done_by_other[i]);
    return is_done;
}

uint32_t neph_rt_targets_used(const struct neph_gpu_view *view)
{
    uint32_t used = 0;
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (neph_rt_is_condition_met(view, pass->condition) && !neph_rt_is_pass_skipped(view, pass))
            used |= neph_rt_targets_touched(view, pass);
    }
    return used;
}

uint32_t neph_rt_targets_before(const struct neph_rt_pass *pass)
{
    uint32_t before = 0;
    for (int i = 0; i < NEPH_RT_HISTORIES_MAX && pass->histories[i].before; i++)
        before |= NEPH_RT_BIT(pass->histories[i].before);
    return before;
}

static bool has_colour_phases(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    return pass->in_colours && neph_rt_is_condition_met(view, *pass->in_colours);
}

static uint64_t quotient_up(uint64_t a, uint64_t b)
{
    return (a + b - 1) / b;
}

enum { GROUP_THREADS = 64 };

static int find_resolution(const struct neph_gpu_view *view, const struct neph_rt_pass *pass)
{
    return pass->unread_resolution && neph_rt_is_output_elided(view) ? pass->unread_resolution
                                                                     : pass->resolution;
}

static bool can_run(const struct neph_gpu_view *view, const struct neph_rt_shader *variant)
{
    bool can = variant->code;
    for (int i = 0; i < NEPH_RT_NEEDS_MAX && variant->needs[i].setting; i++)
        can &= neph_rt_is_condition_met(view, variant->needs[i]);
    return can;
}

const struct neph_rt_shader *neph_rt_shader_for(const struct neph_gpu_view *view,
                                                const struct neph_rt_pass *pass,
                                                enum neph_rt_device_kind kind)
{
    return can_run(view, &pass->variants[kind]) ? &pass->variants[kind] : &pass->shader;
}

void neph_rt_absorb_passes(struct neph_gpu_view *view, enum neph_rt_device_kind kind,
                           bool has_variants)
{
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_shader *variant = &neph_rt_passes[p]->variants[kind];
        if (!variant->absorbs)
            continue;
        const struct neph_rt_condition other = variant->absorbs->done_by_other[0];
        const bool absorbs = has_variants && can_run(view, variant) &&
                             neph_rt_is_condition_met(view, neph_rt_passes[p]->condition) &&
                             neph_rt_is_condition_met(view, variant->absorbs->condition);
        view->settings[other.setting] = absorbs ? (float)other.choice : 0.0f;
    }
}

uint64_t neph_rt_thread_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader)
{
    const int resolution = find_resolution(view, pass);
    const uint64_t column = shader->column ? (uint64_t)shader->column : 1;
    const uint64_t block[2] = {(uint64_t)shader->block[0], (uint64_t)shader->block[1]};
    if (resolution == RT_FROXEL || resolution == RT_FROXEL_COLUMN)
        return neph_rt_texel_count(view, resolution);
    const bool is_picture = resolution == RT_OUTPUT;
    const uint64_t width = is_picture ? view->picture_px[0]
                                      : quotient_up(view->size_px[0], (uint64_t)resolution);
    const uint64_t height = neph_rt_texel_count(view, resolution) / width;
    if (block[0] > 0)
        return GROUP_THREADS * quotient_up(width, block[0]) * quotient_up(height, block[1]);
    if (has_colour_phases(view, pass)) /* a dispatch for each colour */
        return quotient_up(width, 2) * quotient_up(height, 2);
    if (pass->in_quads)
        return (width / 2 + 1) * (height / 2 + 1);
    return width * quotient_up(height, column);
}

uint32_t neph_rt_colour_count(const struct neph_gpu_view *view, const struct neph_rt_pass *pass,
                              const struct neph_rt_shader *shader)
{
    return has_colour_phases(view, pass) && shader->block[0] == 0 ? 4 : 1;
}

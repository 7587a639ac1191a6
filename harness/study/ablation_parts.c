/* SPDX-License-Identifier: MIT
 *
 * The parts of the real-time renderer for ablations.
 *
 * "The article" describes the frame split of Red Dead Redemption 2 (docs/realtime.md), after F.
 * Bauer, SIGGRAPH 2019. A plain value is the article's value, or the one that switches a part off.
 */
#include "harness/study/ablation_parts.h"

#include "harness/engines/engines.h"

#include <stdio.h>
#include <string.h>

/* Fails to compile when a kind is added, as neph_ablation_part_values() prints each kind. */
_Static_assert(NEPH_OPTION_KIND_COUNT == 3, "a new kind");

const struct neph_ablation_part neph_ablation_parts[] = {
    {"split", "one ray per 4x4 pixels and frame; four frames cover a tile",
     "F. Bauer, SIGGRAPH 2019: a sixteenth of the rays", "split=none", .stays = true},
    {"min_max", "half-resolution depth alternates between nearest and farthest, in a checkerboard",
     "the article: foreground and background both get rays", .off = "depth_map=nearest"},
    {"slot_order", "the slots of a tile are marched clockwise instead of row by row",
     "the article: every frame has near and far depths", .off = "slot_order=raster"},
    {"tiles_ahead", "every second tile is one slot ahead",
     "the article: every frame has near and far depths", .off = "slot_checkerboard=off"},
    {"override", "a tile marches the slot whose depth no ray nearby represents",
     "the article, for all tiles at once; in four passes that use each other's results: ours",
     .off = "override=none"},
    {"steady_depth", "the depth map does not follow the jitter of the anti-aliasing",
     "ours: the choice of slots is static; the article's moves with the jitter",
     "jittered_depth=on+reproject_jitter=on", .needs = "taa_jitter"},
    {"far_depths", "depths beyond 10 km are distinct from the sky",
     "ours: far walls do not count as sky; the article's do",
     .off = "clamp_pixel_depth=off+sky_m=20000+ray_depth_max_m=10000"},
    {"ray_dither", "noise shifts the start of a ray's steps",
     "the article: grain, which averages out, instead of bands", .off = "ray_dither_amount=0"},
    {"blue_noise", "that noise is blue, in space and time",
     "the article: filters remove blue noise better than white noise", "ray_dither=white",
     .needs = "ray_dither"},
    {"history", "a texel without a ray keeps its history from earlier frames",
     "the article: four frames complete a tile", .off = "history_weight=0"},
    {"lookup", "history is reprojected with the ray nearest in depth, by distance along the ray",
     "ours: correct at depth edges; the article uses the tile's ray and its eye depth",
     "reproject_depth=tile+reproject_measure=eye", .needs = "history"},
    {"wind", "reprojection follows the wind", "c52e/SkyRendering; the article has none", "wind=off",
     .needs = "history"},
    {"cut", "a camera cut invalidates the history", "Unreal Engine; the article has none",
     "cut_reset=off", .needs = "history"},
    {"disocclusion", "history is invalid where the geometry has changed",
     "Unreal Engine 5 and HDRP; the article has none", "reject_depth=0", .needs = "history"},
    {"box", "history is clamped to the range of neighbouring rays of similar depth",
     "the article, after B. Karis, SIGGRAPH 2014: no ghosts of old light", "box=none",
     .needs = "history"},
    {"own_ray", "that range includes the tile's own ray", "ours; the article excludes it",
     "box_centre=off", .needs = "box"},
    {"gradients", "static pixels in unchanged light are not clamped",
     "after C. Schied, C. Peters, C. Dachsbacher, HPG 2018: no flicker from the clamp",
     "box_motion_px=0+box_change=0", .needs = "box"},
    {"depth_upscale", "at depth differences a pixel takes the texel nearest in depth",
     "the article: clouds do not bleed over edges", .off = "upscale=bilinear"},
    {"upscale_dither", "noise shifts the taps of the upscale",
     "the article: grain, which averages out, instead of half-resolution texels",
     .off = "upscale_dither=none+upscale_pair=shared"},
    {"taa", "temporal anti-aliasing of the whole frame",
     "B. Karis, SIGGRAPH 2014; Unreal Engine 4.26", .off = "taa=off"},
    {"taa_jitter", "each frame's rays pass through different sub-pixel positions",
     "B. Karis, SIGGRAPH 2014: frames average to smooth edges", "taa_jitter=none", .needs = "taa"},
    {"jitter_7", "a jitter of 7 positions, coprime to the four slots",
     "ours: each slot gets all positions; with Unreal's 8 each gets the same two",
     "taa_jitter_length=8", .needs = "taa_jitter"},
    {"taa_filter", "a frame is filtered around the pixel centre, without jitter",
     "Unreal Engine 4.26", "taa_filter=off", .needs = "taa"},
    {"taa_cross", "motion is taken from the nearest of five depths", "Unreal Engine 4.26",
     "taa_motion=centre", .needs = "taa"},
    {"taa_cubic", "history is sampled with Catmull-Rom instead of bilinearly",
     "Unreal Engine 4.26: history stays sharp", "taa_history=bilinear", .needs = "taa"},
    {"taa_box", "history is clamped to the range of neighbouring pixels",
     "B. Karis, SIGGRAPH 2014: no ghosts", "taa_box=none", .needs = "taa", .stays = true},
    {"taa_variance", "that range is mean and deviation instead of minimum and maximum",
     "M. Salvi, GDC 2016: a tighter range", "taa_box=min_max+taa_sigma=1.25", .needs = "taa"},
    {"taa_ycocg", "that range is in luminance and two chromas",
     "B. Karis, SIGGRAPH 2014: a tighter range", "taa_space=linear", .needs = "taa"},
    {"taa_hdr", "bright values weigh less", "B. Karis, SIGGRAPH 2014: no fireflies",
     "taa_hdr_weight=off", .needs = "taa"},
    {"taa_contrast", "a frame's weight rises as its difference from the history falls",
     "Unreal Engine 4.26", "taa_contrast=0", .needs = "taa"},
    {"taa_rounding", "history is rounded to its format stochastically",
     "Unreal Engine 4.26: averages do not stop short", "taa_rounding=nearest", .needs = "taa"},
    {"taa_quick", "a frame has a weight of 0.1 instead of 0.04",
     "ours: changing light is followed faster", "taa_alpha=0.04", .needs = "taa"},
    {"true_gradient", "changes are detected by rays that are marched twice with the same noise",
     "after C. Schied, C. Peters, C. Dachsbacher, HPG 2018: noise does not count as change",
     "gradient=off", .needs = "taa"},
    {"rest", "static pixels in unchanged light are the mean of all their frames",
     "ours, second generation: a static frame converges", "taa_age_max=0+taa_change=0.02",
     .needs = "true_gradient"},
    {"kept_frames", "after motion or a change of light the mean still counts 19 frames",
     "ours, third generation: edges in front of drifting clouds do not blink", "taa_age_least=0",
     .needs = "rest"},
    {"wide_change", "a change of the light counts in proportion from 0.1 to 0.6",
     "ours, third generation: the clamp does not switch on and off", "taa_change_full=0",
     .needs = "rest"},
    {"relight", "static history is scaled with slowly changing light",
     "ours, second generation: a sinking sun scales the history instead of invalidating it",
     "relight=0", .needs = "true_gradient"},
    {"change_memory", "a change counts until every position has been sampled again",
     "ours, second generation: changing pixels do not alternate with static ones", "change_hold=0",
     .needs = "true_gradient"},
    {"own_depth", "static history is invalid only where the depth of its own texel has changed",
     "ours, second generation: no rim at disocclusions", "reject_around=on",
     .needs = "disocclusion"},
    {"medium_motion", "the anti-aliasing follows the wind, at the medium's distance",
     "ours, second generation: clouds do not move with the sky", "taa_medium=off", .needs = "taa"},
    {"stand_in", "without history a texel is the mean of nine rays, weighted by position and depth",
     "Unity HDRP: no single-ray noise where a cloud comes into view",
     .off = "fallback=nearest+fallback_rejected=nearest"},
    {"running_mean", "a texel is the mean of its rays while its light is constant",
     "Unity HDRP, Photon: noise is averaged before the upscale", "history_age_max=0+box_age=1",
     .needs = "history"},
    {"froxels", "media near the camera are in froxels; rays are marched from their end on",
     "B. Wronski, SIGGRAPH 2014; F. Bauer, SIGGRAPH 2019: near fog gets its own samples",
     .off = "froxels=off"},
    {"froxel_jitter", "froxels are sampled at a different position in each frame",
     "S. Hillaire, SIGGRAPH 2015: slices average to a smooth depth", "froxel_jitter=off",
     .needs = "froxels"},
    {"froxel_history", "a froxel keeps the history of its position",
     "S. Hillaire, SIGGRAPH 2015: the jitter averages out", "froxel_history=0", .needs = "froxels"},
    {"froxel_hold", "a froxel that intersects a surface is sampled in front of it",
     "ours: no light of the room behind a wall", "froxel_hold=off", .needs = "froxels"},
    {"cloud_map", "a shadow map of the clouds for points outside of them",
     "S. Hillaire, SIGGRAPH 2016: a look-up instead of a sun ray", .off = "cloud_shadow=off"},
    {"map_columns", "its texels are vertical columns instead of sun rays",
     "ours: a moving sun does not shift the texels", "cloud_shadow_plane=sun",
     .needs = "cloud_map"},
    {.name = NULL},
};
_Static_assert(sizeof(neph_ablation_parts) / sizeof(neph_ablation_parts[0]) <=
                   (size_t)NEPH_ABLATION_PARTS_MAX,
               "parts");

const struct neph_ablation_exception neph_ablation_exceptions[] = {
    {"validity",
     "a guard, not a part: without it a NaN stays, and the first frames show uninitialised memory"},
    {"edge_tiles", "has an effect only for sizes that are no multiple of 4"},
    {"gather", "has an effect only for sizes of 4 n + 1"},
    {"tile_origin", "has an effect only in split views"},
    {"override_wake", "has an effect only where the sun jumps"},
    {"change_strobe",
     "has an effect only where the sun flashes with the period of two gradient samples"},
    {"taa_pre_exposure",
     "has an effect only where the camera's exposure changes (inject.exposures)"},
    {.option = NULL},
};

int neph_ablation_part_count(void)
{
    int count = 0;
    while (neph_ablation_parts[count].name)
        count++;
    return count;
}

int neph_ablation_part_find(const char *name)
{
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (strcmp(neph_ablation_parts[i].name, name) == 0)
            return i;
    return -1;
}

neph_ablation_set neph_ablation_with_needs(int part)
{
    const char *needs = neph_ablation_parts[part].needs;
    const int needed = needs ? neph_ablation_part_find(needs) : -1;
    const neph_ablation_set own = (neph_ablation_set)1 << part;
    return needed < 0 ? own : own | neph_ablation_with_needs(needed);
}

/* ---- settings -------------------------------------------------------------------------------- */

static const struct neph_engine *realtime(void)
{
    return neph_engine_find("realtime");
}

static enum neph_status parse_settings(const char *words, struct neph_settings *settings,
                                       struct neph_diag *diag)
{
    return neph_settings_parse_words(realtime(), words, "steps=64", settings, diag);
}

/* Writes the option indices of a part, in the order of its words; returns their number. */
static int list_part_options(const struct neph_ablation_part *part, int *indices, int most)
{
    char name[64];
    int count = 0;
    for (const char *word = part->off; word && count < most; count++) {
        snprintf(name, sizeof(name), "%.*s", (int)strcspn(word, "="), word);
        indices[count] = neph_option_find(realtime()->options, name);
        word = strchr(word, '+');
        word = word ? word + 1 : NULL;
    }
    return count;
}

static enum neph_status has_setting(const char *preset, int part, bool *has, struct neph_diag *diag)
{
    struct neph_arena arena = {.last = NULL};
    struct neph_settings with, without;
    int option;
    list_part_options(&neph_ablation_parts[part], &option, 1);
    const char *words = neph_ablation_words(&arena, preset, (neph_ablation_set)1 << part);
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = parse_settings(preset, &with, diag);
    if (!status)
        status = parse_settings(words, &without, diag);
    neph_arena_finish(&arena);
    if (!status)
        *has = with.values[option] != without.values[option];
    return status;
}

enum neph_status neph_ablation_find_parts(const char *preset, neph_ablation_set *parts,
                                          struct neph_diag *diag)
{
    neph_ablation_set set = 0, all = 0;
    for (int i = 0; neph_ablation_parts[i].name; i++) {
        bool has = false;
        const enum neph_status status = has_setting(preset, i, &has, diag);
        if (status)
            return status;
        set |= (neph_ablation_set)has << i;
    }
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if ((neph_ablation_with_needs(i) & ~set) == 0)
            all |= (neph_ablation_set)1 << i;
    *parts = all;
    return NEPH_OK;
}

const char *neph_ablation_words(struct neph_arena *arena, const char *preset,
                                neph_ablation_set without)
{
    const char *words = neph_arena_copy_text(arena, preset);
    for (int i = 0; neph_ablation_parts[i].name; i++)
        if (without >> i & 1)
            words = neph_arena_format(arena, "%s+%s", words, neph_ablation_parts[i].off);
    return words;
}

enum { OPTIONS_MAX = 8 };

enum neph_status neph_ablation_part_values(struct neph_arena *arena, const char *preset, int part,
                                           const char **text, struct neph_diag *diag)
{
    struct neph_settings settings;
    int options[OPTIONS_MAX];
    const int count = list_part_options(&neph_ablation_parts[part], options, OPTIONS_MAX);
    const enum neph_status status = parse_settings(preset, &settings, diag);
    const char *values = "";
    for (int i = 0; i < count && !status; i++) {
        const struct neph_option *option = &realtime()->options[options[i]];
        const double value = settings.values[options[i]];
        const char *blank = i > 0 ? " " : "";
        values = option->kind == NEPH_OPTION_CHOICE
                     ? neph_arena_format(arena, "%s%s%s=%s", values, blank, option->name,
                                         option->choices[(int)value])
                     : neph_arena_format(arena, "%s%s%s=%.15g", values, blank, option->name, value);
    }
    *text = values;
    return status ? status : neph_arena_check(arena, diag);
}

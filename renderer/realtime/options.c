/* SPDX-License-Identifier: MIT
 *
 * The settings in the order of the passes. "The article" is the one on the frame split: the weather
 * of Red Dead Redemption 2 after F. Bauer, SIGGRAPH 2019, written down for Unreal Engine 4.24. A
 * tile is 2x2 half-resolution texels, 4x4 pixels; its slots are these texels in the order in which
 * they are marched. docs/realtime.md lists the article's steps and faults with their settings.
 */
#include "renderer/realtime/options.h"

#include "base/option_rows.h"
#include "renderer/march.h"
#include "renderer/realtime/suns.h"
#include "renderer/shortcuts.h"

static const char *const modes[] = {"exact", "marched", NULL};
static const char *const lightings[] = {"single",         "octaves", "horizon",
                                        "octaves_fitted", "traced",  "diffused",
                                        "similarity",     "slab",    NULL};
static const char *const switches[] = {"off", "on", NULL};
static const char *const splits[] = {"none", "four", NULL};
static const char *const depth_maps[] = {"checkerboard", "nearest", "farthest", "reversed", NULL};
static const char *const slot_orders[] = {"clockwise", "raster", "diagonal", "anticlockwise", NULL};
static const char *const overrides[] = {"none", "parallel", "sequential", NULL};
static const char *const fars[] = {"finite", "infinite", NULL};
static const char *const formats[] = {"half", "float", NULL};
static const char *const edge_tiles[] = {"kept", "dropped", NULL};
static const char *const gathers[] = {"texel", "normalised", NULL};
static const char *const tile_origins[] = {"view", "buffer", NULL};
static const char *const dithers[] = {"none",           "white", "interleaved", "blue",
                                      "spatiotemporal", "slice", NULL};
static const char *const filters[] = {"nearest", "bilinear", "catmull_rom", NULL};
static const char *const boxes[] = {"none", "min_max", "variance", NULL};
static const char *const spaces[] = {"linear", "reinhard", "ycocg", "channels", NULL};
static const char *const fallbacks[] = {"nearest", "around", "tile", "bilinear", "bilateral", NULL};
static const char *const contrasts[] = {"transmittance", "opacity", NULL};
static const char *const holds[] = {"clamp", "clip", NULL};
static const char *const reprojections[] = {"tile", "pixel", NULL};
static const char *const measures[] = {"eye", "radial", NULL};
static const char *const upscales[] = {"nearest", "bilinear", "mean", "bilateral",
                                       "inverse", "square",   NULL};
static const char *const laws[] = {"constant", "opacity", NULL};
static const char *const pairs[] = {"shared", "independent", NULL};
static const char *const responsives[] = {"off", "medium", NULL};
static const char *const taas[] = {"off", "on", "upsampling", "locks", NULL};
static const char *const jitters[] = {"none", "ue", "halton", NULL};
static const char *const arounds[] = {"off", "on", "moved", NULL};
static const char *const motions[] = {"centre", "cross", "square", NULL};
static const char *const taa_spaces[] = {"linear", "reinhard", "ycocg", NULL};
static const char *const taa_boxes[] = {"none", "min_max", "variance", "distance", NULL};
static const char *const roundings[] = {"nearest", "stochastic", NULL};

/* Gone on 2026-11-29; their words go with the next release. */
static const char *const gone[] = {
    "override_depth",
    "it was 0.25 in every preset",
    "override_sky_m",
    "it was 1e6 in every preset",
    "depth_format",
    "target_format is the format of all images",
    "color_format",
    "target_format is the format of all images",
    "taa_format",
    "target_format is the format of all images",
    "history_filter",
    "it was bilinear in every preset",
    "box_sigma",
    "it was 1 in every preset",
    "box_least",
    "it was 0 in every preset",
    "reproject_least_m",
    "it was 0 in every preset",
    "reject_scene_m",
    "it was 0 in every preset; reject_depth is left",
    "reject_within_m",
    "it belonged to reject_scene_m, which was 0 in every preset",
    "reject_nearest_m",
    "it was 0 in every preset; reject_depth is left",
    "upscale_sky_m",
    "it was 1e6 in every preset",
    "taa_alpha_moving",
    "it was 0.2 in every preset",
    "taa_velocity_px",
    "it was 20 in every preset",
    "taa_rest_px",
    "it was 0.02 in every preset",
    "taa_antighost",
    "it was off in every preset; solid_motion and the neighbourhood clamp are left",
    "sharpen_amount",
    "it was 0.5 in every preset",
    "light_texel_px",
    "it was 8 in every preset; engine march_traced has it",
    "light_rounds",
    "it was 1 in every preset; engine march_traced has it",
    "light_memory",
    "it was 32 in every preset",
    "light_blur",
    "it was 1 in every preset; engine march_traced has it",
    "diffusion_cycles",
    "it was 2 in every preset; engine march_diffused has it",
    "cloud_shadow_frames",
    "sun_cache_frames is of the shadow map of clouds, too",
    "lock_ratio",
    "it was 1.05 in every preset",
    "lock_separation",
    "it was 0.02 in every preset",
    "atrous_sigma",
    "it was 4 in every preset",
    "atrous_depth",
    "it was 0.1 in every preset",
    "composition",
    "the pipeline chooses it; all of its values gave the same bits",
    "depth_map_pass",
    "the pipeline chooses it; all of its values gave the same bits",
    "change_pass",
    "the pipeline chooses it; all of its values gave the same bits",
    "steady",
    "the pipeline chooses it; all of its values gave the same bits",
    NULL,
};

_Static_assert(RT_SETTING_COUNT < NEPH_OPTIONS_MAX, "room for every setting");

const struct neph_option neph_rt_options[RT_SETTING_COUNT + 1] = {
    [RT_STEPS] = WHOLE("steps", 64, 1, NEPH_MARCH_STEPS_MAX, "steps per view ray"),
    [RT_SUN_STEPS] = WHOLE("sun_steps", 16, 1, NEPH_MARCH_STEPS_MAX, "steps per marched sun ray"),
    [RT_TRANSMITTANCE] = CHOICE("transmittance", 0, modes,
                                "optical depth of view rays: closed form, or summed over the "
                                "steps"),
    [RT_SUN] = CHOICE("sun", 0, modes, "optical depth towards the sun: closed form, or marched"),
    [RT_LIGHTING] = CHOICE("lighting", 0, lightings,
                           "sunlight scattered once, or the light of the engine march_WORD"),

    [RT_SPLIT] = CHOICE("split", RT_SPLIT_FOUR, splits,
                        "none: every pixel every frame; four: one ray per 4x4 pixels, four frames "
                        "for a whole"),
    [RT_DEPTH_MAP] = CHOICE("depth_map", RT_DEPTH_MAP_CHECKERBOARD, depth_maps,
                            "which of 2x2 depths a half-resolution texel takes: nearest and "
                            "farthest in a checkerboard, the nearest where x % 2 == y % 2; or, "
                            "reversed, the farthest there, as the minimum that the article takes "
                            "of a reversed depth buffer is; or the nearest or farthest everywhere"),
    [RT_SLOT_ORDER] = CHOICE(
        "slot_order", RT_SLOT_ORDER_CLOCKWISE, slot_orders,
        "order in which the four half-resolution texels of a tile are marched; in raster order two "
        "frames of four have no ray at the nearest depths around, or none at the farthest"),
    [RT_SLOT_CHECKERBOARD] = CHOICE("slot_checkerboard", 1, switches,
                                    "tiles with x % 2 == y % 2 are one slot ahead, so that nearest "
                                    "and farthest depths have a ray nearby in every frame"),
    [RT_OVERRIDE] = CHOICE(
        "override", RT_OVERRIDE_SEQUENTIAL, overrides,
        "a tile may march another slot than the one whose turn it is, so that the depths around "
        "have a ray: all tiles at once, each taking its neighbours to keep their turn (bars as "
        "wide apart as tiles then flash), or in four passes that see what others chose"),
    [RT_OVERRIDE_REST] = WHOLE("override_rest", 0, 0, 64,
                               "every Nth cycle of four frames is without override, so that no "
                               "slot goes without rays for ever; 0: none is"),
    [RT_FAR] = CHOICE("far", RT_FAR_FINITE, fars,
                      "depth of the sky in the override: override_sky_m, or infinity (reversed "
                      "depth without far plane), where tiles of sky march slot 0 for ever"),
    [RT_SKY_M] = REAL(
        "sky_m", 1e6, 1, 1e15,
        "depth of the sky as stored with rays and in the reconstruction [m]; with the article's "
        "20000, and its 10000 as ray_depth_max_m, solids beyond 15 km pass for sky"),
    [RT_RAY_DEPTH_MAX_M] = REAL(
        "ray_depth_max_m", 1e15, 1, 1e15,
        "largest depth that a ray of a solid is stored with [m]; the article has 10000"),
    [RT_CLAMP_PIXEL_DEPTH] = CHOICE(
        "clamp_pixel_depth", 1, switches,
        "sky_m and ray_depth_max_m limit the depth of a half-resolution texel as they do those of "
        "rays; off: a solid beyond halfway between both takes the sky's clouds"),
    [RT_TARGET_FORMAT] = CHOICE(
        "target_format", RT_FORMAT_HALF, formats,
        "format of the images that passes hand on: tile depths, cloud distances, rays, histories, "
        "the upscaled volume, the history of the anti-aliasing"),
    [RT_EDGE_TILES] = CHOICE(
        "edge_tiles", RT_EDGE_TILES_KEPT, edge_tiles,
        "the last, cut row and column of tiles as neighbours in the reconstruction; dropped: "
        "neighbours end one tile early in sizes that are no multiple of 4"),
    [RT_GATHER] = CHOICE("gather", RT_GATHER_TEXEL, gathers,
                         "how a tile finds its half-resolution texels, and these the depths of the "
                         "rays around: by texel number, or by normalised coordinates, which in "
                         "sizes of 4 n + 1 drift to the next tile"),
    [RT_TILE_ORIGIN] = CHOICE(
        "tile_origin", RT_TILE_ORIGIN_VIEW, tile_origins,
        "where the override looks up the tile's own depths in a view that does not start at the "
        "corner of its buffer; buffer: those of the view that does"),
    [RT_JITTERED_DEPTH] = CHOICE("jittered_depth", 0, switches,
                                 "depth map and rays follow the jitter of TAA; on: the choice of "
                                 "slots flickers before a camera at rest"),
    [RT_RAY_DITHER] = CHOICE("ray_dither", 4, dithers,
                             "noise that shifts the start of the steps along a ray"),
    [RT_RAY_DITHER_AMOUNT] = REAL("ray_dither_amount", 1, 0, 1,
                                  "range of the shift by ray_dither, in steps"),

    [RT_FRESH_WEIGHT] = REAL("fresh_weight", 1, 0, 1,
                             "weight of this frame's ray against the history of its place; the "
                             "article has 1 (its 0.5 stands behind a return and is never reached)"),
    [RT_FRESH_SPACE] = CHOICE(
        "fresh_space", RT_SPACE_LINEAR, spaces,
        "colour space in which a ray is blended with the history of its place"),
    [RT_HISTORY_WEIGHT] = REAL("history_weight", 1, 0, 1,
                               "weight of the history at places without a ray in this frame; the "
                               "rest is the ray nearest in depth"),
    [RT_HISTORY_AGE_MAX] = WHOLE(
        "history_age_max", 0, 0,
        255, "fresh rays weigh 1 / (their number so far, at most this); 0: fresh_weight"),
    [RT_HISTORY_FADE] = REAL(
        "history_fade", 1, 0, 1,
        "with history_age_max, factor of the history's weight beside a fresh ray"),
    [RT_FALLBACK] = CHOICE(
        "fallback", RT_FALLBACK_NEAREST, fallbacks,
        "what a half-resolution texel without ray and history takes: of the nine tiles around the "
        "ray nearest in depth; of the eight but its own; its own tile's; the mean of four by "
        "place; the mean of nine by place and depth, with upscale_tolerance_m, sky from sky alone"),
    [RT_FALLBACK_REJECTED] = CHOICE("fallback_rejected", RT_FALLBACK_NEAREST, fallbacks,
                                    "what a half-resolution texel takes where its history is void "
                                    "because the scene behind has changed (reject_*)"),
    [RT_BOX] = CHOICE("box", RT_BOX_MIN_MAX, boxes,
                      "neighbourhood box that the history is held in: none, the accepted rays' "
                      "extremes, or mean +- box_sigma of them"),
    [RT_BOX_DEPTH] = REAL(
        "box_depth", 0.1,
        0, 1e6, "relative difference of depth up to which a ray is accepted into the box"),
    [RT_BOX_TRANSMITTANCE] = REAL("box_transmittance", 0, 0, 1,
                                  "difference of transmittance from the ray nearest in depth up to "
                                  "which a ray is accepted, too; 0: never"),
    [RT_CONTRAST] = CHOICE("contrast", RT_CONTRAST_TRANSMITTANCE, contrasts,
                           "box_transmittance is a difference of transmittances and "
                           "upscale_contrast a part of the largest; or both are parts of the "
                           "opacity, the smaller of two rays', the largest of the taps'"),
    [RT_BOX_SAME_KIND] = CHOICE("box_same_kind", 0, switches,
                                "in the box only rays that end as the half-resolution texel does, "
                                "in the sky or on a solid"),
    [RT_BOX_SPACE] = CHOICE("box_space", RT_SPACE_LINEAR, spaces,
                            "colour space of the box: reinhard divides by 1 + luminance, channels "
                            "each channel by 1 + itself"),
    [RT_BOX_HOLD] = CHOICE(
        "box_hold", RT_HOLD_CLAMP, holds,
        "how history is held in the box: each channel clamped, or colour clipped towards the "
        "middle of the box until it is inside (not of box=none)"),
    [RT_BOX_AGE] = REAL("box_age", 1, 0, 1,
                        "part of its age that history keeps where the box has moved its colour; "
                        "counts with history_age_max"),
    [RT_BOX_CENTRE] = CHOICE("box_centre", 1, switches,
                             "the tile's own ray may be in the box; off: it is left out of it "
                             "unless it is the nearest in depth"),
    [RT_BOX_MOTION_PX] = REAL(
        "box_motion_px", 0, 0, 100,
        "history that has moved by less than this and whose nearest ray sees what its place "
        "remembers is not held in the box; full at twice this [px per frame]; 0: always held"),
    [RT_BOX_CHANGE] = REAL("box_change", 0, 0, 1,
                           "relative change seen by the ray nearest in depth from which on history "
                           "at rest is held in the box, too; full at twice this; 0: always held"),

    [RT_REPROJECT_DEPTH] = CHOICE(
        "reproject_depth", RT_REPROJECT_PIXEL, reprojections,
        "cloud distance to look up the history by: that of the tile's own ray, which is wrong at "
        "depth edges, or that of the ray nearest in depth"),
    [RT_REPROJECT_MEASURE] = CHOICE("reproject_measure", RT_MEASURE_RADIAL, measures,
                                    "cloud distance taken as eye depth, too far towards the sides "
                                    "of the picture, or along the ray"),
    [RT_REPROJECT_JITTER] = CHOICE(
        "reproject_jitter", 0, switches,
        "history is looked up by the rays of both frames and not by the centres of half-resolution "
        "texels; counts with jittered_depth=on"),
    [RT_WIND] = CHOICE(
        "wind", 1, switches,
        "history follows the wind; off: it is looked up as if the medium stood still"),
    [RT_VALIDITY] = CHOICE("validity", 1, switches,
                           "history and rays that are void, not finite or negative are not used; "
                           "off: the first frame shows what the memory holds, and a NaN stays"),
    [RT_CUT_RESET] = CHOICE("cut_reset", 1, switches, "a camera cut voids the history"),
    [RT_REJECT_DEPTH] = REAL("reject_depth", 0, 0, 10,
                             "relative change of the scene's depth behind a half-resolution texel "
                             "from which its history is void (disocclusion); 0: never"),

    [RT_REJECT_AROUND] = CHOICE(
        "reject_around", RT_AROUND_ON, arounds,
        "history is kept if one of the 3x3 half-resolution texels about its place passes "
        "reject_depth and reject_scene_m; off: its own alone decides; moved: its own where history "
        "has moved by less than an eighth of a pixel, and so is of that very texel"),

    [RT_UPSCALE] = CHOICE(
        "upscale", RT_UPSCALE_MEAN, upscales,
        "how a pixel is made of half-resolution texels: nearest in depth; bilinear; mean of four, "
        "or nearest where depths differ; weights of place and depth; bilinear, or 1 / (difference "
        "of depth + upscale_tolerance_m) of four where depths differ; that times exp(-d^2) of the "
        "distance in place, of 3x3"),
    [RT_UPSCALE_DEPTH] = REAL("upscale_depth", 0.25, 0, 10,
                              "relative difference of depth up to which four taps are averaged"),
    [RT_UPSCALE_CONTRAST] = REAL(
        "upscale_contrast", 0, 0, 1,
        "least contrast of transmittance for which depth matters; 0: always"),
    [RT_UPSCALE_TOLERANCE_M] = REAL(
        "upscale_tolerance_m", 1, 1e-6, 1e6,
        "depth added to each difference in upscale=inverse and square [m]"),
    [RT_UPSCALE_SAME_KIND] = CHOICE("upscale_same_kind", 0, switches,
                                    "sky is made of half-resolution texels of sky alone, solids of "
                                    "solids alone, where there are any"),
    [RT_UPSCALE_DITHER] = CHOICE("upscale_dither", 4, dithers,
                                 "noise that shifts the place of the taps"),
    [RT_UPSCALE_AMOUNT_PX] = REAL(
        "upscale_amount_px", 1, 0, 4,
        "largest shift of the taps to either side [half-resolution texels]"),
    [RT_UPSCALE_LAW] = CHOICE(
        "upscale_law", RT_LAW_OPACITY, laws,
        "how far the taps are shifted: everywhere the same, or times (1 - T) max(0, 1 - distance / "
        "4 km), large in near dense fog and small on far clouds; the article has no formula"),
    [RT_UPSCALE_PAIR] = CHOICE(
        "upscale_pair", RT_PAIR_INDEPENDENT, pairs,
        "x and y of the taps' shift from one number, that of the pixel and of its mirror (all "
        "shifts of a pixel then lie on one line), or from two"),

    [RT_TAA] = CHOICE("taa", RT_TAA_ON, taas,
                      "temporal anti-aliasing of the composed frame; upsampling: by the rays "
                      "nearest to each pixel of the picture, which `on` becomes with "
                      "screen_percent below 100; locks: upsampling after AMD's FSR 2, where a "
                      "history counts by what has gone into it, at most taa_age_max frames, and is "
                      "not held where a thin feature is locked"),
    [RT_TAA_JITTER] = CHOICE("taa_jitter", RT_JITTER_UE, jitters,
                             "sub-pixel places of the rays: Halton with Gaussian warp, or plain"),
    [RT_TAA_JITTER_LENGTH] =
        WHOLE("taa_jitter_length", 7, 1, 64,
              "sub-pixel places until they repeat; 8 is twice the period of the slots, so that "
              "each slot sees the same two for ever; 7 has no factor with it: each sees all, and "
              "pictures repeat after 28 frames"),
    [RT_TAA_MOTION] = CHOICE("taa_motion", RT_MOTION_CROSS, motions,
                             "motion for the anti-aliasing, by the depth of the pixel or of the "
                             "nearest of it and four at +-2 px, or of 3x3"),
    [RT_TAA_SPACE] = CHOICE("taa_space", RT_SPACE_YCOCG, taa_spaces,
                            "colour space of the box of the anti-aliasing"),
    [RT_TAA_HDR_WEIGHT] = CHOICE("taa_hdr_weight", 1, switches,
                                 "frame and history are blended with weights 1 / (Y + 4)"),
    [RT_TAA_FILTER] = CHOICE(
        "taa_filter", 1, switches,
        "the frame is filtered by Gaussian weights about the unjittered place"),
    [RT_TAA_BOX] = CHOICE(
        "taa_box", RT_BOX_MIN_MAX, taa_boxes,
        "neighbourhood box that the history of the anti-aliasing is held in: none, mean of the "
        "plus' and the square's extremes, mean +- taa_sigma, extremes within 1.51 px"),
    [RT_TAA_SIGMA] = REAL("taa_sigma", 1.25, 0, 10,
                          "half width of the variance box, in standard deviations"),
    [RT_TAA_HISTORY] = CHOICE("taa_history", RT_FILTER_CATMULL_ROM, filters,
                              "how the history of the anti-aliasing is sampled"),
    [RT_TAA_ALPHA] = REAL("taa_alpha", 0.04, 0, 1, "weight of the frame against the history"),
    [RT_TAA_CONTRAST] = REAL("taa_contrast", 0.01, 0, 1,
                             "least weight of the frame is this times Y of the history over the "
                             "difference of both; 0: off"),
    [RT_TAA_ROUNDING] = CHOICE("taa_rounding", RT_ROUNDING_STOCHASTIC, roundings,
                               "how the history of the anti-aliasing is rounded to its format"),
    [RT_TAA_GUARD] = CHOICE("taa_guard", 1, switches,
                            "what is not finite is left out, colours are held to 0 .. 65504, and "
                            "0 / 0 of the contrast law counts as 0"),

    [RT_WARM_UP] = WHOLE("warm_up", 16, 0, 1024,
                         "pictures that are rendered and not kept before the first, as if the "
                         "sequence had begun earlier"),

    [RT_SHARPEN] = CHOICE("sharpen", 0, switches,
                          "the finished picture away from the mean of its four neighbours, held "
                          "between the least and the largest of the five"),

    [RT_SUN_CACHE] = NEPH_OPTION_SUN_CACHE,
    [RT_SUN_CACHE_VOXELS] = NEPH_OPTION_SUN_CACHE_VOXELS,
    [RT_SUN_CACHE_FRAMES] = WHOLE("sun_cache_frames", 1, 1, NEPH_SUN_CACHE_FRAMES_MAX,
                                  "pictures that it takes to fill that lattice, or the shadow map "
                                  "of clouds, anew, a part of it in each; 1: all of it in each, "
                                  "so that light never lags"),
    [RT_SKIP] = NEPH_OPTION_SKIP,
    [RT_EARLY_OUT] = NEPH_OPTION_EARLY_OUT,
    [RT_STEP_GROWTH] = NEPH_OPTION_STEP_GROWTH,
    [RT_GRID_SAMPLING] = NEPH_OPTION_GRID_SAMPLING,
    [RT_GRID_FORMAT] = NEPH_OPTION_GRID_FORMAT,

    [RT_LIGHT_PATHS] = NEPH_OPTION_LIGHT_PATHS(2),

    [RT_GRADIENT] = CHOICE(
        "gradient", 0, switches,
        "each number of ray_dither serves two turns of the slots, tiles of a checkerboard by "
        "turns: what differs the second time is light that has changed, not noise. box_change and "
        "taa_change go by it; counts with split=four and jittered_depth=off"),
    [RT_TAA_MEDIUM] = CHOICE(
        "taa_medium", 0, switches,
        "where the wind blows history of the anti-aliasing follows the medium, "
        "by its distance, before the sky and where it hides more than half of "
        "what is behind, and where it changes; off: it follows the scene"),
    [RT_TAA_AGE_MAX] = WHOLE(
        "taa_age_max", 0, 0,
        2048,
        "where nothing moves and, by gradient=on, nothing changes a pixel is the mean of its "
        "frames, at most so many and as many as are alike but for taa_change, without box and "
        "contrast law; 0: taa_alpha, as elsewhere"),
    [RT_TAA_CHANGE] = REAL("taa_change", 0.02, 0, 1,
                           "with taa_age_max, relative change of the light, by gradient=on, from "
                           "which a pixel is no longer at rest; full at twice this"),

    [RT_DIFFUSION_CELLS] = NEPH_OPTION_DIFFUSION_CELLS,

    [RT_SOLID_MOTION] = CHOICE(
        "solid_motion", 1, switches,
        "with split=four the anti-aliasing follows solids that move; off: as "
        "if they stood still"),
    [RT_ORIGIN_SHIFT] = CHOICE("origin_shift", 1, switches,
                               "history follows where the world's origin is moved (inject.origin); "
                               "off: as if the camera had gone so far"),
    [RT_LIGHT_AHEAD] = NEPH_OPTION_LIGHT_AHEAD,
    [RT_LIGHT_SIMILAR] = NEPH_OPTION_LIGHT_SIMILAR,

    [RT_CLOUD_SHADOW] = NEPH_OPTION_CLOUD_SHADOW,
    [RT_CLOUD_SHADOW_TEXELS] = NEPH_OPTION_CLOUD_SHADOW_TEXELS,
    [RT_CLOUD_SHADOW_LAYERS] = NEPH_OPTION_CLOUD_SHADOW_LAYERS,
    [RT_CLOUD_SHADOW_LEVELS] = NEPH_OPTION_CLOUD_SHADOW_LEVELS,
    [RT_CLOUD_SHADOW_EXTENT_M] = NEPH_OPTION_CLOUD_SHADOW_EXTENT,
    [RT_CLOUD_SHADOW_PLANE] = NEPH_OPTION_CLOUD_SHADOW_PLANE,
    [RT_RELIGHT] = REAL(
        "relight", 0, 0, 0.5,
        "history at rest takes the change of light along that 3x3 tiles have in common, by "
        "gradient=on, up to this part of it between two looks: what it explains is no change"),
    [RT_CHANGE_HOLD] = REAL(
        "change_hold", 0, 0, 0.99,
        "part of a change, by gradient=on, that still counts in the next frame: not every place is "
        "looked at in every frame"),

    [RT_FROXEL_VOLUME] = CHOICE(
        "froxels", 0, switches,
        "media near the camera in froxels, a volume of columns, rows and slices of the view; the "
        "march begins at its end. Counts with split=four; knows lighting single and octaves"),
    [RT_FROXEL_PX] = WHOLE("froxel_px", 0, 0, 256,
                           "pixels along a side of a froxel; 0: as many as make 160 columns of the "
                           "picture, 12 at 1920x1080"),
    [RT_FROXEL_SLICES] = WHOLE("froxel_slices", 64, 1, 256, "froxels along the depth"),
    [RT_FROXEL_NEAR_M] = REAL("froxel_near_m", 4, 0.01, 1e4,
                              "depth up to which slices are about even; they grow with depth from "
                              "there on [m]"),
    [RT_FROXEL_END_M] = REAL("froxel_end_m", 64, 0.1, 1e5,
                             "depth at which froxels end and the march begins [m]; with fog=unreal "
                             "that is the scene's fog_look.volumetric_fog_distance_m, if it has "
                             "one: nearer fog is a medium of froxels, its look begins behind them"),
    [RT_FROXEL_JITTER] = CHOICE("froxel_jitter", 1, switches,
                                "froxels are looked at in another place in each picture; off: in "
                                "the middle"),
    [RT_FROXEL_HISTORY] = REAL("froxel_history", 0.9, 0, 0.99,
                               "part of a froxel's light that is that of the picture before, "
                               "reprojected; 0: none"),
    [RT_FROXEL_HOLD] = CHOICE("froxel_hold", 1, switches,
                              "a froxel with a surface in it is looked at before that; off: light "
                              "leaks through from behind"),

    [RT_SCREEN_PERCENT] = WHOLE(
        "screen_percent", 100, 50, 100,
        "side of what is rendered, in percent of the picture's, rounded up; the anti-aliasing "
        "makes the picture of it. Below 100 there are 1 / percent^2 times as many places of the "
        "jitter, taa_jitter=ue is plain Halton, and taa_box=min_max is distance, within 1.51 px, "
        "1.3 at 50 %, as in Unreal"),

    [RT_TAA_RESPONSIVE] = CHOICE(
        "taa_responsive", RT_RESPONSIVE_OFF, responsives,
        "where the media hide more than half of what is behind them the frame weighs a quarter or "
        "more: they have no motion vectors; counts with split=four"),
    [RT_TAA_PRE_EXPOSURE] = CHOICE(
        "taa_pre_exposure", 0, switches,
        "where the camera's exposure changes (inject.exposures), history is multiplied by as much; "
        "off: it keeps that of its own frame"),
    [RT_LAMP_PEAKS] = CHOICE(
        "lamp_peaks", 1, switches,
        "near a lamp, where its light is sharper than froxels are, it is found "
        "a pixel at a time; off: in froxels, too. Counts with froxels=on"),
    [RT_SKY] = NEPH_OPTION_SKY,
    [RT_SKY_COLUMNS] = NEPH_OPTION_SKY_COLUMNS,
    [RT_SKY_ROWS] = NEPH_OPTION_SKY_ROWS,
    [RT_SKY_SLICES] = NEPH_OPTION_SKY_SLICES,
    [RT_SKY_FAR_M] = NEPH_OPTION_SKY_FAR,
    [RT_SKY_SHADOWS] = NEPH_OPTION_SKY_SHADOWS,

    [RT_ATROUS] = CHOICE(
        "atrous", 0, switches,
        "the volume at half resolution is filtered three times, over 5x5 texels 1, "
        "2 and 4 apart, by place, depth and luma against its deviation, as in "
        "SVGF; needs split=four and gradient=off"),
    [RT_SKY_REFILL] = NEPH_OPTION_SKY_REFILL,
    [RT_CHANGE_STROBE] = CHOICE(
        "change_strobe", 0, switches,
        "a sun that flashes with the period of two looks of gradient=on, four frames or the places "
        "of the jitter, is a change everywhere; off: both looks see the same, and it rests"),
    [RT_OVERRIDE_WAKE] = WHOLE(
        "override_wake", 0, 0,
        NEPH_RT_SUNS_MAX - 1,
        "frames, after the sun has jumped by a tenth from one to the next, in which every second "
        "cycle of four has no override: what it keeps from being marched sees the new light, too"),
    [RT_SUN_GROWTH] = NEPH_OPTION_SUN_GROWTH,
    [RT_SUN_CONE] = NEPH_OPTION_SUN_CONE,
    [RT_FOG] = NEPH_OPTION_FOG,
    [RT_DEPTH_GROWTH] = NEPH_OPTION_DEPTH_GROWTH,
    {.choices = gone},
};

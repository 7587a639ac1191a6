/* SPDX-License-Identifier: MIT
 *
 * The numbers A.., X.. are those of the feature table and the list of faults of the article on the
 * frame split ("the article": the weather of Red Dead Redemption 2 after F. Bauer, SIGGRAPH 2019,
 * written down for Unreal Engine 4.24).
 */
#include "renderer/realtime/options.h"

#include "renderer/march.h"

static const char *const modes[] = {"exact", "marched", NULL};
static const char *const lightings[] = {"single", "octaves", "horizon", NULL};
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
static const char *const jitters[] = {"none", "ue", "halton", NULL};
static const char *const motions[] = {"centre", "cross", NULL};
static const char *const taa_spaces[] = {"linear", "reinhard", "ycocg", NULL};
static const char *const taa_boxes[] = {"none", "min_max", "variance", "distance", NULL};
static const char *const roundings[] = {"nearest", "stochastic", NULL};

#define CHOICE(name, value, words, help)                                                           \
    {                                                                                              \
        name, NEPH_OPTION_CHOICE, value, 0, 0, words, help                                         \
    }
#define REAL(name, value, least, most, help)                                                       \
    {                                                                                              \
        name, NEPH_OPTION_REAL, value, least, most, NULL, help                                     \
    }
#define WHOLE(name, value, least, most, help)                                                      \
    {                                                                                              \
        name, NEPH_OPTION_INTEGER, value, least, most, NULL, help                                  \
    }

const struct neph_option neph_rt_options[RT_SETTING_COUNT + 1] = {
    [RT_STEPS] = WHOLE("steps", 64, 1, NEPH_MARCH_STEPS_MAX, "steps per view ray"),
    [RT_SUN_STEPS] = WHOLE("sun_steps", 16, 1, NEPH_MARCH_STEPS_MAX, "steps per marched sun ray"),
    [RT_TRANSMITTANCE] = CHOICE("transmittance", 0, modes,
                                "optical depth of view rays: closed form, or summed over the "
                                "steps"),
    [RT_SUN] = CHOICE("sun", 0, modes, "optical depth towards the sun: closed form, or marched"),
    [RT_LIGHTING] = CHOICE("lighting", 0, lightings,
                           "sunlight scattered once, or one of the looks of march_octaves and "
                           "march_horizon"),

    [RT_SPLIT] = CHOICE("split", RT_SPLIT_FOUR, splits,
                        "none: every pixel every frame; four: one ray per 4x4 pixels, four frames "
                        "for a whole"),
    [RT_DEPTH_MAP] = CHOICE(
        "depth_map", RT_DEPTH_MAP_CHECKERBOARD, depth_maps,
        "which of 2x2 depths a half-pixel takes: the nearest and the farthest by "
        "turns, the nearest where x % 2 == y % 2 or, reversed, the farthest "
        "there, as the article's minimum of a reversed depth buffer is (A2)"),
    [RT_SLOT_ORDER] = CHOICE("slot_order", RT_SLOT_ORDER_CLOCKWISE, slot_orders,
                             "places of the slots 0 1 2 3 in a tile (A4, X2)"),
    [RT_SLOT_CHECKERBOARD] = CHOICE("slot_checkerboard", 1, switches,
                                    "tiles with x % 2 == y % 2 are one slot ahead (A4)"),
    [RT_OVERRIDE] = CHOICE("override", RT_OVERRIDE_SEQUENTIAL, overrides,
                           "tiles may march another slot to cover the depths around (A5): all at "
                           "once (X11), or in four passes that see what others chose"),
    [RT_OVERRIDE_DEPTH] = REAL("override_depth", 0.25, 0, 10,
                               "relative difference up to which a ray covers a depth (A5)"),
    [RT_OVERRIDE_SKY_M] = REAL("override_sky_m", 1e6, 1, 1e15,
                               "depth of the sky in the override (A5; the article's is that of an "
                               "Unreal depth buffer's 0, 1e6) [m]"),
    [RT_OVERRIDE_REST] = WHOLE("override_rest", 0, 0, 64,
                               "every Nth cycle of four frames is without override, so that no "
                               "slot starves; 0: none is"),
    [RT_FAR] = CHOICE("far", RT_FAR_FINITE, fars,
                      "depth of the sky in the override: override_sky_m, or infinity (reversed Z "
                      "without far plane)"),
    [RT_SKY_M] = REAL("sky_m", 1e6, 1, 1e15,
                      "depth of the sky as stored with rays and in the reconstruction [m] (A6: "
                      "20000, so that ridges beyond 15 km pass for sky)"),
    [RT_RAY_DEPTH_MAX_M] = REAL("ray_depth_max_m", 1e15, 1, 1e15,
                                "depth that a ray of a solid is stored with at most [m] (A6: "
                                "10000)"),
    [RT_CLAMP_PIXEL_DEPTH] = CHOICE("clamp_pixel_depth", 1, switches,
                                    "the same limits for the pixel's own depth (off: X8)"),
    [RT_DEPTH_FORMAT] = CHOICE("depth_format", RT_FORMAT_HALF, formats,
                               "of tile depths, cloud distances and history states"),
    [RT_COLOR_FORMAT] = CHOICE("color_format", RT_FORMAT_HALF, formats,
                               "of rays, histories and the upscaled volume"),
    [RT_EDGE_TILES] = CHOICE("edge_tiles", RT_EDGE_TILES_KEPT, edge_tiles,
                             "the last, cut row and column of tiles as a neighbour in the "
                             "reconstruction (dropped: X4)"),
    [RT_GATHER] = CHOICE("gather", RT_GATHER_TEXEL, gathers,
                         "how a tile finds its half-pixels, and a half-pixel the depths of the "
                         "rays around: by number, or by normalised coordinates, which drift in "
                         "sizes of 4 n + 1 (X6)"),
    [RT_TILE_ORIGIN] = CHOICE("tile_origin", RT_TILE_ORIGIN_VIEW, tile_origins,
                              "where the centre tile of the override looks in a view that does not "
                              "start at the corner of its buffer (buffer: X5)"),
    [RT_JITTERED_DEPTH] = CHOICE("jittered_depth", 0, switches,
                                 "depth map and rays follow the jitter of TAA (on: X15)"),
    [RT_RAY_DITHER] = CHOICE("ray_dither", 4, dithers, "start of the steps along a ray (A7)"),
    [RT_RAY_DITHER_AMOUNT] = REAL("ray_dither_amount", 1, 0, 1, "of a step"),

    [RT_FRESH_WEIGHT] = REAL("fresh_weight", 1, 0, 1,
                             "of this frame's ray at its own place (A8, X1)"),
    [RT_FRESH_SPACE] = CHOICE("fresh_space", RT_SPACE_LINEAR, spaces,
                              "where a ray is blended with the history of its place"),
    [RT_HISTORY_WEIGHT] = REAL("history_weight", 1, 0, 1,
                               "of the history elsewhere; the rest is the ray nearest in depth "
                               "(A12)"),
    [RT_HISTORY_AGE_MAX] = WHOLE("history_age_max", 0, 0, 255,
                                 "fresh rays weigh 1 / (their number so far, at most this); 0: "
                                 "fresh_weight"),
    [RT_HISTORY_FADE] = REAL("history_fade", 1, 0, 1,
                             "with history_age_max, the history's part beside a fresh ray times "
                             "this"),
    [RT_HISTORY_FILTER] = CHOICE("history_filter", RT_FILTER_BILINEAR, filters,
                                 "of the reprojected history"),
    [RT_FALLBACK] = CHOICE(
        "fallback", RT_FALLBACK_NEAREST, fallbacks,
        "what a half-pixel without ray and history takes: of the tiles around and its own the ray "
        "nearest in depth; of the eight around alone; the own tile's; the mean of four by place; "
        "of nine by place and depth, with upscale_tolerance_m, sky from sky alone"),
    [RT_FALLBACK_REJECTED] = CHOICE("fallback_rejected", RT_FALLBACK_NEAREST, fallbacks,
                                    "the same where its history is void because the scene behind "
                                    "has changed (reject_*)"),
    [RT_BOX] = CHOICE("box", RT_BOX_MIN_MAX, boxes,
                      "what the history is held in: nothing, the accepted rays' extremes, or mean "
                      "+- box_sigma of them (A10)"),
    [RT_BOX_DEPTH] = REAL("box_depth", 0.1, 0, 1e6,
                          "relative difference of depth up to which a ray is accepted (A10)"),
    [RT_BOX_TRANSMITTANCE] = REAL("box_transmittance", 0, 0, 1,
                                  "or of transmittance from the nearest ray's; 0: never"),
    [RT_CONTRAST] = CHOICE("contrast", RT_CONTRAST_TRANSMITTANCE, contrasts,
                           "box_transmittance is a difference of transmittances and "
                           "upscale_contrast a part of the largest; or both are parts of the "
                           "opacity, the smaller of two rays', the largest of the taps'"),
    [RT_BOX_SAME_KIND] = CHOICE("box_same_kind", 0, switches,
                                "in the box only rays that end as the half-pixel does, in the sky "
                                "or on a solid"),
    [RT_BOX_SIGMA] = REAL("box_sigma", 1, 0, 10, "half width of the variance box"),
    [RT_BOX_SPACE] = CHOICE("box_space", RT_SPACE_LINEAR, spaces,
                            "where the box is taken: reinhard divides by 1 + luminance, channels "
                            "each channel by 1 + itself"),
    [RT_BOX_HOLD] = CHOICE("box_hold", RT_HOLD_CLAMP, holds,
                           "how: each channel for itself, or colour towards the middle of the box "
                           "until it is inside (not of box=none)"),
    [RT_BOX_AGE] = REAL("box_age", 1, 0, 1,
                        "part of its age that history keeps where the box has moved its colour; "
                        "counts with history_age_max"),
    [RT_BOX_CENTRE] = CHOICE("box_centre", 1, switches,
                             "the tile's own ray may be in the box (off: X3)"),
    [RT_BOX_LEAST] = WHOLE("box_least", 0, 0, 9,
                           "with fewer accepted rays all nine make the box; a box of one ray would "
                           "erase the history (X3)"),
    [RT_BOX_MOTION_PX] = REAL("box_motion_px", 0, 0, 100,
                              "history that has moved by less than this and whose nearest ray sees "
                              "what its place remembers is not held in the box; full at twice this "
                              "[px per frame]; 0: always held"),
    [RT_BOX_CHANGE] = REAL(
        "box_change", 0, 0, 1,
        "relative change of that ray since, from which on the box counts all the "
        "same; full at twice this; 0: always held"),

    [RT_REPROJECT_DEPTH] = CHOICE("reproject_depth", RT_REPROJECT_PIXEL, reprojections,
                                  "cloud distance of the tile's own ray (A11, X9), or of the ray "
                                  "nearest in depth"),
    [RT_REPROJECT_MEASURE] = CHOICE("reproject_measure", RT_MEASURE_RADIAL, measures,
                                    "cloud distance taken as eye depth (X9), or along the ray"),
    [RT_REPROJECT_JITTER] = CHOICE("reproject_jitter", 0, switches,
                                   "history is looked up by the rays of both frames and not by "
                                   "the centres of half-pixels; counts with jittered_depth=on"),
    [RT_REPROJECT_LEAST_M] = REAL("reproject_least_m", 0, 0, 1e6,
                                  "a medium nearer than this has no history [m]"),
    [RT_WIND] = CHOICE("wind", 1, switches, "history follows the wind (off: X10)"),
    [RT_VALIDITY] = CHOICE("validity", 1, switches,
                           "history and rays that are void, not finite or negative are not used "
                           "(off: X10)"),
    [RT_CUT_RESET] = CHOICE("cut_reset", 1, switches, "a camera cut voids the history"),
    [RT_REJECT_DEPTH] = REAL("reject_depth", 0, 0, 10,
                             "relative change of the half-pixel's scene depth from which its "
                             "history is void; 0: never"),
    [RT_REJECT_SCENE_M] = REAL("reject_scene_m", 0, 0, 1e6,
                               "the same as a distance [m], where the scene is or was nearer than "
                               "reject_within_m; 0: never"),
    [RT_REJECT_WITHIN_M] = REAL("reject_within_m", 5000, 0, 1e6,
                                "how near the scene must be, then or now, for reject_scene_m [m]"),

    [RT_REJECT_NEAREST_M] = REAL("reject_nearest_m", 0, 0, 1e6,
                                 "change of the nearest depth of its tile beyond which a "
                                 "half-pixel's history is void [m]; 0: never"),
    [RT_REJECT_AROUND] = CHOICE("reject_around", 1, switches,
                                "reject_depth and reject_scene_m are content with one of the 3x3 "
                                "half-pixels about that place (off: its own alone)"),

    [RT_UPSCALE] = CHOICE("upscale", RT_UPSCALE_MEAN, upscales,
                          "nearest in depth; bilinear; mean of four or nearest in depth (A14); "
                          "weights of place and depth; bilinear, or 1 / (difference of depth + "
                          "upscale_tolerance_m) of four where depths differ; that times exp(-d^2) "
                          "of the distance in place, of 3x3"),
    [RT_UPSCALE_DEPTH] = REAL("upscale_depth", 0.25, 0, 10,
                              "relative difference of depth up to which four taps are averaged "
                              "(A14)"),
    [RT_UPSCALE_SKY_M] = REAL("upscale_sky_m", 1e6, 1, 1e15, "depth of the sky in the upscale [m]"),
    [RT_UPSCALE_CONTRAST] = REAL("upscale_contrast", 0, 0, 1,
                                 "least contrast of transmittance for which depth matters; 0: "
                                 "always"),
    [RT_UPSCALE_TOLERANCE_M] = REAL("upscale_tolerance_m", 1, 1e-6, 1e6,
                                    "of upscale=inverse and square [m]"),
    [RT_UPSCALE_SAME_KIND] = CHOICE("upscale_same_kind", 0, switches,
                                    "sky is made of half-pixels of sky alone, solids of solids "
                                    "alone, where there are any"),
    [RT_UPSCALE_DITHER] = CHOICE("upscale_dither", 4, dithers, "of the taps' place (A13)"),
    [RT_UPSCALE_AMOUNT_PX] = REAL("upscale_amount_px", 1, 0, 4,
                                  "largest shift to either side [half-resolution px]"),
    [RT_UPSCALE_LAW] = CHOICE("upscale_law", RT_LAW_OPACITY, laws,
                              "of the shift: everywhere the same, or times (1 - T) max(0, 1 - "
                              "distance / 4 km), large in near dense fog and small on far clouds "
                              "(A13)"),
    [RT_UPSCALE_PAIR] = CHOICE(
        "upscale_pair", RT_PAIR_INDEPENDENT, pairs,
        "x and y of the shift from one number, of the pixel and of its mirror "
        "(X13), or from two"),

    [RT_TAA] = CHOICE("taa", 1, switches, "temporal anti-aliasing of the composed frame (A16)"),
    [RT_TAA_JITTER] = CHOICE("taa_jitter", RT_JITTER_UE, jitters,
                             "sub-pixel places of the rays: Halton with Gaussian warp, or plain"),
    [RT_TAA_JITTER_LENGTH] =
        WHOLE("taa_jitter_length", 7, 1, 64,
              "places until they repeat; 8 is twice the period of the slots, so that "
              "each slot sees the same two; 7 has no factor with it, so that "
              "pictures repeat after 28 frames (X14)"),
    [RT_TAA_MOTION] = CHOICE("taa_motion", RT_MOTION_CROSS, motions,
                             "motion of the pixel, or of the nearest of it and four at +-2 px"),
    [RT_TAA_SPACE] = CHOICE("taa_space", RT_SPACE_YCOCG, taa_spaces, "where the box is taken"),
    [RT_TAA_HDR_WEIGHT] = CHOICE("taa_hdr_weight", 1, switches, "blend with weights 1 / (Y + 4)"),
    [RT_TAA_FILTER] = CHOICE("taa_filter", 1, switches,
                             "filter the frame by Gaussian weights about the unjittered place"),
    [RT_TAA_BOX] = CHOICE("taa_box", RT_BOX_MIN_MAX, taa_boxes,
                          "what the history is held in: mean of the plus' and the square's "
                          "extremes, mean +- taa_sigma, extremes within 1.51 px"),
    [RT_TAA_SIGMA] = REAL("taa_sigma", 1.25, 0, 10, "half width of the variance box"),
    [RT_TAA_HISTORY] = CHOICE("taa_history", RT_FILTER_CATMULL_ROM, filters, "of the history"),
    [RT_TAA_ALPHA] = REAL("taa_alpha", 0.04, 0, 1, "weight of the frame"),
    [RT_TAA_ALPHA_MOVING] = REAL("taa_alpha_moving", 0.2, 0, 1,
                                 "the same at taa_velocity_px and above"),
    [RT_TAA_VELOCITY_PX] = REAL("taa_velocity_px", 20, 0.01, 1000,
                                "[px per frame]; Unreal counts half-pixels: its 40 are 20"),
    [RT_TAA_CONTRAST] = REAL("taa_contrast", 0.01, 0, 1,
                             "least weight of the frame is this times Y of the history over the "
                             "difference of both; 0: off"),
    [RT_TAA_FORMAT] = CHOICE("taa_format", RT_FORMAT_HALF, formats, "of the history"),
    [RT_TAA_ROUNDING] = CHOICE("taa_rounding", RT_ROUNDING_STOCHASTIC, roundings,
                               "of the history to its format"),
    [RT_TAA_GUARD] = CHOICE("taa_guard", 1, switches,
                            "what is not finite is left out, colours are held to 0 .. 65504, and "
                            "0 / 0 of the contrast law counts as 0"),

    [RT_WARM_UP] = WHOLE("warm_up", 16, 0, 1024,
                         "pictures that are rendered and not kept before the first, as if the "
                         "sequence had begun earlier"),
    {.name = NULL},
};

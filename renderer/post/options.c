/* SPDX-License-Identifier: MIT
 *
 * The table of settings, in the order of the stages. Defaults within a stage are Unreal Engine
 * 4.26's where the article on its post-processing documents them; automatic exposure and bloom have
 * later ones, and HDR displays ITU-R's.
 */
#include "renderer/post/options.h"

#include "base/option_rows.h"

#include <stddef.h>

static const char *const switches[] = {"off", "on", NULL};
static const char *const maps[] = {"none",    "reinhard", "narkowicz", "unreal",
                                   "neutral", "agx",      "bt2390",    NULL};
static const char *const encodings[] = {"linear", "srgb", "pq", NULL};
static const char *const fxaas[] = {"off",        "console",    "quality_12",
                                    "quality_29", "quality_39", NULL};
static const char *const sharpenings[] = {"off", "cas", "rcas", NULL};
static const char *const filters[] = {"off",         "nearest", "bilinear", "directional",
                                      "catmull_rom", "lanczos", "gaussian", "smoothstep",
                                      "easu",        NULL};

static const char *const targets[] = {"float32", "float16", "unorm10", NULL};
static const char *const blooms[] = {"off", "conserving", "additive", NULL};

_Static_assert(POST_SETTING_COUNT <= NEPH_OPTIONS_MAX, "LONGEST_OTHER of renderer/settings.py");

const struct neph_option neph_post_options[POST_SETTING_COUNT + 1] = {
    [POST_AUTO_EXPOSURE] = CHOICE(
        "auto_exposure", 0, switches,
        "automatic exposure: the adapted luminance is shown as 0.18 times 2^exposure_ev"),
    [POST_METER_LOW_PERCENT] = REAL(
        "meter_low_percent", 10, 0, 100,
        "fraction of the pixels, the darkest, that metering ignores [%]"),
    [POST_METER_HIGH_PERCENT] = REAL(
        "meter_high_percent", 90, 0, 100,
        "pixels brighter than this fraction of all are ignored as well [%]"),
    [POST_EXPOSURE_MIN_EV] = REAL("exposure_min_ev", -10, -16, 16,
                                  "log2 of the lowest luminance of adaptation"),
    [POST_EXPOSURE_MAX_EV] = REAL("exposure_max_ev", 10, -16, 16,
                                  "log2 of the highest luminance of adaptation"),
    [POST_ADAPT_UP] = REAL("adapt_up_ev_per_s", 3, 0, 1000,
                           "speed of adaptation to brighter light"),
    [POST_ADAPT_DOWN] = REAL("adapt_down_ev_per_s", 1, 0, 1000,
                             "speed of adaptation to darker light"),
    [POST_ADAPT_NEAR_EV] = REAL(
        "adapt_near_ev", 1.5, 0.01, 32,
        "below this difference adaptation is exponential, with the rate speed / this per second"),

    [POST_BLOOM] = CHOICE("bloom", POST_BLOOM_OFF, blooms,
                          "light scattered by the lens: conserving moves light from a pixel to "
                          "others; additive adds light of pixels above a threshold"),
    [POST_BLOOM_SCATTERED] = REAL("bloom_scattered", 0.05, 0, 1,
                                  "conserving: scattered fraction of the light"),
    [POST_BLOOM_INTENSITY] = REAL("bloom_intensity", 0.675, 0, 8,
                                  "additive: factor of the scattered light; Unreal Engine: 0.675"),
    [POST_BLOOM_THRESHOLD] = REAL("bloom_threshold", -1, -1, 65504,
                                  "additive: threshold of exposed luminance; all light from 2 "
                                  "above the threshold; -1: no threshold"),
    [POST_BLOOM_SPREAD] = REAL("bloom_spread", 0.7, 0, 1,
                               "fraction of coarser levels at each level of the pyramid"),
    [POST_BLOOM_LEVELS] = {"bloom_levels", NEPH_OPTION_INTEGER, 6, 1, POST_LEVELS_MAX, NULL,
                           "levels of the pyramid: the radius is about 2^levels pixels"},

    [POST_TONE] = CHOICE("tone", 0, switches, "tone mapping, with exposure, vignette and grain"),
    [POST_TONE_MAP] = CHOICE(
        "tone_map", POST_MAP_UNREAL, maps,
        "curve: none (clamped to 1), Reinhard 2002, Narkowicz's fit of ACES, Unreal's film curve, "
        "Khronos PBR Neutral, AgX, the roll-off of ITU-R BT.2390 to the display's peak"),
    [POST_EXPOSURE_EV] = REAL("exposure_ev", 0, -32, 32, "radiance is multiplied by 2^EV"),
    [POST_WHITE_TEMPERATURE_K] = REAL(
        "white_temperature_k", 6504, 1700, 25000,
        "light of this temperature is shown white [K]; 6504, the white of Rec.709, is neutral"),
    [POST_VIGNETTE] = REAL("vignette", 0, 0, 4,
                           "tangent of the view angle at the corners, darkened by its cos^4; "
                           "Unreal Engine: 0.4 times sqrt(2)"),
    [POST_FILM_SLOPE] = REAL("film_slope", 0.88, 0.01, 2, "slope of the straight part, over log10"),
    [POST_FILM_TOE] = REAL("film_toe", 0.55, 0, 0.99, "length of the toe"),
    [POST_FILM_SHOULDER] = REAL("film_shoulder", 0.26, 0, 0.99, "length of the shoulder"),
    [POST_FILM_BLACK_CLIP] = REAL("film_black_clip", 0, 0, 1,
                                  "distance below 0 at which the toe ends"),
    [POST_FILM_WHITE_CLIP] = REAL("film_white_clip", 0.04, 0, 1,
                                  "distance above 1 at which the shoulder ends"),
    [POST_LUT] = CHOICE("lut", 0, switches,
                        "map colours by a table of 32^3 logarithmic steps, filled for each frame, "
                        "instead of the formula"),
    [POST_GRAIN] = REAL(
        "grain", 0, 0, 64,
        "range of the noise in 8-bit steps; Unreal Engine has about 1, against banding"),
    [POST_ENCODE] = CHOICE("encode", POST_ENCODE_SRGB, encodings,
                           "encoding of stages after tone mapping and of PNG files: for an sRGB "
                           "display, or BT.2020 with ST 2084 (PQ) for an HDR display"),
    [POST_WHITE_NITS] = REAL(
        "white_nits", 203, 1, 10000,
        "luminance of the value 1 [cd/m^2]; 203: graphics white of ITU-R BT.2408"),
    [POST_PEAK_NITS] = REAL("peak_nits", 1000, 1, 10000,
                            "peak luminance of the HDR display [cd/m^2]"),

    [POST_FXAA] = CHOICE("fxaa", POST_FXAA_OFF, fxaas,
                         "FXAA 3.11: four samples of the console version, or a search along the "
                         "edge with the steps of a quality preset"),
    [POST_FXAA_SUBPIXEL] = REAL("fxaa_subpixel", 0.75, 0, 1,
                                "quality: blur of pixels that differ from their eight neighbours"),
    [POST_FXAA_THRESHOLD] = REAL(
        "fxaa_threshold", 0.166,
        0.063, 1, "quality: edge threshold of luma contrast, relative to the largest luma around"),
    [POST_FXAA_THRESHOLD_MIN] = REAL("fxaa_threshold_min", 0.0833, 0, 1,
                                     "quality: minimum of the edge threshold"),

    [POST_UPSCALE] = CHOICE("upscale", POST_UPSCALE_OFF, filters,
                            "filter from the rendered size to the display's"),
    [POST_SCREEN_PERCENT] = REAL("screen_percent", 50, 12.5, 100,
                                 "rendered size relative to the display's, per side [%]"),
    [POST_UPSCALE_SOFTNESS] = REAL("upscale_softness", 0.3, 0, 1,
                                   "gaussian: strength of its unsharp mask (r.Upscale.Softness)"),
    [POST_LANCZOS_GUARD] = CHOICE(
        "lanczos_guard", 1, switches,
        "off: the weights of lanczos are 0 / 0 at texel centres, as in the article"),
    [POST_SHARPEN] = CHOICE(
        "sharpen", POST_SHARPEN_OFF, sharpenings,
        "AMD's contrast-adaptive sharpening (2019), or FSR1's robust variant (2021)"),
    [POST_SHARPEN_AMOUNT] = REAL(
        "sharpen_amount", 0.5, 0, 1,
        "cas: its sharpness; rcas: relative strength, from 2^-2 at 0 to its maximum at 1"),
    [POST_SECONDARY_UPSCALE] = CHOICE(
        "secondary_upscale", POST_UPSCALE_OFF, filters,
        "filter from the chain's size to the window's; Unreal Engine: nearest"),
    [POST_SECONDARY_PERCENT] = REAL("secondary_percent", 50, 12.5, 100,
                                    "input size relative to the window's, per side [%]"),
    [POST_TARGETS] = CHOICE("targets", POST_FLOAT32, targets,
                            "precision of images between stages; unorm10: 10 bits of 0..1 from "
                            "tone mapping on, float16 before (it needs no less memory here)"),
    {.name = NULL},
};

const struct neph_preset neph_post_presets[] = {
    {"off", "nothing", "", 0},
    {"unreal", "Unreal Engine 4.26 by default: film curve by table, vignette, grain",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1", 0},
    {"uncharted", "the same with its film curve Uncharted",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.63 film_toe=0.55 "
     "film_shoulder=0.47 film_black_clip=0 film_white_clip=0.01",
     0},
    {"hp", "the same with the article's film curve HP",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.65 film_toe=0.63 "
     "film_shoulder=0.45 film_black_clip=0 film_white_clip=0",
     0},
    {"legacy", "the same with its film curve Legacy",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.98 film_toe=0.3 "
     "film_shoulder=0.22 film_black_clip=0 film_white_clip=0.025",
     0},
    {"aces", "the same with its film curve ACES",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.91 film_toe=0.53 "
     "film_shoulder=0.23 film_black_clip=0 film_white_clip=0.035",
     0},
    {"agx", "T. Sobotka's AgX, by formula", "tone=on tone_map=agx", 0},
    {"hdr", "an HDR display of 1000 cd/m^2: PQ, BT.2020, highlights rolled off by BT.2390",
     "tone=on tone_map=bt2390 encode=pq", 0},
    {"plain", "clamped to 1 and encoded for an sRGB display, by formula", "tone=on tone_map=none",
     0},
    {.name = NULL},
};

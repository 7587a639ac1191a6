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
    [POST_AUTO_EXPOSURE] = CHOICE("auto_exposure", 0, switches,
                                  "the eye adapts to the frames: what it is adapted to is shown as "
                                  "0.18 times 2^exposure_ev"),
    [POST_METER_LOW_PERCENT] = REAL("meter_low_percent", 10, 0, 100,
                                    "this part of the pixels, the darkest, is not looked at [%]"),
    [POST_METER_HIGH_PERCENT] = REAL("meter_high_percent", 90, 0, 100,
                                     "nor is what is brighter than this part of them [%]"),
    [POST_EXPOSURE_MIN_EV] = REAL("exposure_min_ev", -10, -16, 16,
                                  "log2 of the least luminance that the eye adapts to"),
    [POST_EXPOSURE_MAX_EV] = REAL("exposure_max_ev", 10, -16, 16, "and of the largest"),
    [POST_ADAPT_UP] = REAL("adapt_up_ev_per_s", 3, 0, 1000, "speed towards brighter light"),
    [POST_ADAPT_DOWN] = REAL("adapt_down_ev_per_s", 1, 0, 1000, "speed towards darker light"),
    [POST_ADAPT_NEAR_EV] = REAL("adapt_near_ev", 1.5, 0.01, 32,
                                "nearer than this the speed falls with the distance: an "
                                "exponential approach at speed / this a second"),

    [POST_BLOOM] = CHOICE(
        "bloom", POST_BLOOM_OFF, blooms,
        "light that the lens spreads: conserving takes from a pixel what it gives "
        "to others; additive adds, from what is above a threshold"),
    [POST_BLOOM_SCATTERED] = REAL("bloom_scattered", 0.05, 0, 1,
                                  "conserving: the part of the light that is spread"),
    [POST_BLOOM_INTENSITY] = REAL("bloom_intensity", 0.675, 0, 8,
                                  "additive: times the spread light; 0.675 is Unreal's"),
    [POST_BLOOM_THRESHOLD] = REAL("bloom_threshold", -1, -1, 65504,
                                  "additive: exposed luminance from which light is spread, all of "
                                  "it from 2 above; -1: all light"),
    [POST_BLOOM_SPREAD] = REAL(
        "bloom_spread", 0.7, 0, 1,
        "at each level of the pyramid, the part that comes from coarser ones"),
    [POST_BLOOM_LEVELS] = {"bloom_levels", NEPH_OPTION_INTEGER, 6, 1, POST_LEVELS_MAX, NULL,
                           "how often the picture is halved: light goes some 2^this pixels far"},

    [POST_TONE] = CHOICE("tone", 0, switches, "tone mapping, with exposure, vignette and grain"),
    [POST_TONE_MAP] = CHOICE(
        "tone_map", POST_MAP_UNREAL, maps,
        "curve: none (held to 1), Reinhard 2002, Narkowicz's fit of ACES, "
        "Unreal's film curve, Khronos PBR Neutral, AgX, the roll-off of ITU-R BT.2390 "
        "to the display's peak"),
    [POST_EXPOSURE_EV] = REAL("exposure_ev", 0, -32, 32, "radiance times 2^EV is what is mapped"),
    [POST_WHITE_TEMPERATURE_K] = REAL("white_temperature_k", 6504, 1700, 25000,
                                      "light of this temperature is shown white [K]; 6504, that of "
                                      "Rec.709, changes nothing"),
    [POST_VIGNETTE] = REAL("vignette", 0, 0, 4,
                           "tangent of the angle that the corners are darkened for by cos^4; "
                           "Unreal has 0.4 times sqrt(2)"),
    [POST_FILM_SLOPE] = REAL("film_slope", 0.88, 0.01, 2, "of the straight part, over log10"),
    [POST_FILM_TOE] = REAL("film_toe", 0.55, 0, 0.99, "how far the toe reaches"),
    [POST_FILM_SHOULDER] = REAL("film_shoulder", 0.26, 0, 0.99, "how far the shoulder reaches"),
    [POST_FILM_BLACK_CLIP] = REAL("film_black_clip", 0, 0, 1, "how far below 0 the toe ends"),
    [POST_FILM_WHITE_CLIP] = REAL("film_white_clip", 0.04, 0, 1,
                                  "how far above 1 the shoulder ends"),
    [POST_LUT] = CHOICE(
        "lut", 0, switches,
        "take colours from a table of 32^3 at steps of the logarithm, made anew for "
        "each picture, in place of the formula"),
    [POST_GRAIN] = REAL("grain", 0, 0, 64,
                        "range of the noise in steps of 8 bits; Unreal has about 1, so that "
                        "gradients do not band"),
    [POST_ENCODE] = CHOICE(
        "encode", POST_ENCODE_SRGB, encodings,
        "what stages after tone mapping work on, and a PNG holds: for an sRGB display, "
        "or in BT.2020 by ST 2084 (PQ) for an HDR display"),
    [POST_WHITE_NITS] = REAL("white_nits", 203, 1, 10000,
                             "what 1 is shown as [cd/m^2]; 203: ITU-R BT.2408's white of graphics"),
    [POST_PEAK_NITS] = REAL("peak_nits", 1000, 1, 10000,
                            "the most that an HDR display shows [cd/m^2]"),

    [POST_FXAA] = CHOICE("fxaa", POST_FXAA_OFF, fxaas,
                         "FXAA 3.11: the console's four samples, or a walk along the edge by the "
                         "steps of a quality preset"),
    [POST_FXAA_SUBPIXEL] = REAL("fxaa_subpixel", 0.75, 0, 1,
                                "quality: how much of what stands out from eight neighbours is "
                                "blurred"),
    [POST_FXAA_THRESHOLD] = REAL("fxaa_threshold", 0.166, 0.063, 1,
                                 "quality: contrast of luma, over the largest around, that is an "
                                 "edge"),
    [POST_FXAA_THRESHOLD_MIN] = REAL("fxaa_threshold_min", 0.0833, 0, 1,
                                     "quality: and at least this much"),

    [POST_UPSCALE] = CHOICE("upscale", POST_UPSCALE_OFF, filters,
                            "filter from the rendered size to the display's"),
    [POST_SCREEN_PERCENT] = REAL("screen_percent", 50, 12.5, 100,
                                 "the rendered size over the display's, of a side [%]"),
    [POST_UPSCALE_SOFTNESS] = REAL("upscale_softness", 0.3, 0, 1,
                                   "of the gaussian's unsharp mask: r.Upscale.Softness"),
    [POST_LANCZOS_GUARD] = CHOICE("lanczos_guard", 1, switches,
                                  "off: at texels' centres the weights of lanczos are 0 / 0, as in "
                                  "the article"),
    [POST_SHARPEN] = CHOICE("sharpen", POST_SHARPEN_OFF, sharpenings,
                            "AMD's contrast-adaptive sharpening (2019), or the robust one of FSR1 "
                            "(2021)"),
    [POST_SHARPEN_AMOUNT] = REAL("sharpen_amount", 0.5, 0, 1,
                                 "cas: its sharpness; rcas: 2^-2 at 0 to 1 at 1, the strength that "
                                 "goes to the limit"),
    [POST_SECONDARY_UPSCALE] = CHOICE("secondary_upscale", POST_UPSCALE_OFF, filters,
                                      "filter from the size that the chain works at to the "
                                      "window's; Unreal has nearest"),
    [POST_SECONDARY_PERCENT] = REAL("secondary_percent", 50, 12.5, 100,
                                    "the size before it over the window's, of a side [%]"),
    [POST_TARGETS] = CHOICE("targets", POST_FLOAT32, targets,
                            "what a stage hands on is rounded to: floats of 32 bits, or halves; "
                            "unorm10: from tone mapping on to 10 bits of 0..1, before it to halves "
                            "(it takes no less memory here)"),
    {.name = NULL},
};

const struct neph_preset neph_post_presets[] = {
    {"off", "nothing", "", 0},
    {"unreal", "Unreal Engine 4.26 by default: film curve by table, vignette, grain",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1", 0},
    {"uncharted", "the same with the film curve that it calls Uncharted",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.63 film_toe=0.55 "
     "film_shoulder=0.47 film_black_clip=0 film_white_clip=0.01",
     0},
    {"hp", "the same with the film curve that the article calls HP",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.65 film_toe=0.63 "
     "film_shoulder=0.45 film_black_clip=0 film_white_clip=0",
     0},
    {"legacy", "the same with the film curve that it calls Legacy",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.98 film_toe=0.3 "
     "film_shoulder=0.22 film_black_clip=0 film_white_clip=0.025",
     0},
    {"aces", "the same with the film curve that it calls ACES",
     "tone=on tone_map=unreal lut=on vignette=0.5657 grain=1 film_slope=0.91 film_toe=0.53 "
     "film_shoulder=0.23 film_black_clip=0 film_white_clip=0.035",
     0},
    {"agx", "T. Sobotka's AgX, by formula", "tone=on tone_map=agx", 0},
    {"hdr", "an HDR display of 1000 cd/m^2: PQ, BT.2020, highlights rolled off by BT.2390",
     "tone=on tone_map=bt2390 encode=pq", 0},
    {"plain", "held to 1 and encoded for an sRGB display, by formula", "tone=on tone_map=none", 0},
    {.name = NULL},
};

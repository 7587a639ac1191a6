/* SPDX-License-Identifier: MIT
 *
 * The table of stages of the post-processing chain.
 */
#include "renderer/post/chain.h"

static const uint32_t meter_code[] = {
#include "shaders/post_meter.comp.inc"
};
static const uint32_t adapt_code[] = {
#include "shaders/post_adapt.comp.inc"
};
static const uint32_t bloom_down_code[] = {
#include "shaders/post_bloom_down.comp.inc"
};
static const uint32_t bloom_up_code[] = {
#include "shaders/post_bloom_up.comp.inc"
};
static const uint32_t lut_code[] = {
#include "shaders/post_lut.comp.inc"
};
static const uint32_t tone_code[] = {
#include "shaders/post_tone.comp.inc"
};
static const uint32_t fxaa_code[] = {
#include "shaders/post_fxaa.comp.inc"
};
static const uint32_t sharpen_code[] = {
#include "shaders/post_sharpen.comp.inc"
};
static const uint32_t upscale_code[] = {
#include "shaders/post_upscale.comp.inc"
};

const struct neph_post_stage neph_post_stages[] = {
    {
        .name = "light meter",
        .pass = NEPH_POST_EXPOSURE,
        .note = "a histogram of the frame's luminance",
        .shader = {"post_meter", meter_code, sizeof(meter_code)},
        .settings = {POST_AUTO_EXPOSURE, POST_AUTO_EXPOSURE},
        .makes = NEPH_POST_MAKES_HISTOGRAM,
    },
    {
        .name = "adaptation",
        .pass = NEPH_POST_EXPOSURE,
        .note = "adapts the exposure to the metered luminance",
        .shader = {"post_adapt", adapt_code, sizeof(adapt_code)},
        .settings = {POST_AUTO_EXPOSURE, POST_AUTO_EXPOSURE},
        .makes = NEPH_POST_MAKES_EXPOSURE,
    },
    {
        .name = "bloom, down",
        .pass = NEPH_POST_BLOOM,
        .note = "downsamples the frame, level by level",
        .shader = {"post_bloom_down", bloom_down_code, sizeof(bloom_down_code)},
        .settings = {POST_BLOOM, POST_BLOOM},
        .makes = NEPH_POST_MAKES_PYRAMID,
    },
    {
        .name = "bloom, up",
        .pass = NEPH_POST_BLOOM,
        .note = "adds the light scattered by the lens",
        .shader = {"post_bloom_up", bloom_up_code, sizeof(bloom_up_code)},
        .settings = {POST_BLOOM, POST_BLOOM},
        .makes = NEPH_POST_MAKES_BLOOM,
    },
    {
        .name = "table of colours",
        .pass = NEPH_POST_TONE_MAPPING,
        .note = "tone curve and display encoding of 32^3 colours",
        .shader = {"post_lut", lut_code, sizeof(lut_code)},
        .settings = {POST_TONE, POST_LUT},
        .makes = NEPH_POST_MAKES_TABLE,
    },
    {
        .name = "tone mapping",
        .pass = NEPH_POST_TONE_MAPPING,
        .note = "exposure, vignette, tone curve, grain",
        .shader = {"post_tone", tone_code, sizeof(tone_code)},
        .settings = {POST_TONE, POST_TONE},
    },
    {
        .name = "fxaa",
        .pass = NEPH_POST_FXAA,
        .note = "anti-aliasing of the encoded image",
        .shader = {"post_fxaa", fxaa_code, sizeof(fxaa_code)},
        .settings = {POST_FXAA, POST_FXAA},
    },
    {
        .name = "upscale",
        .pass = NEPH_POST_UPSCALE,
        .note = "to the size of the display",
        .shader = {"post_upscale", upscale_code, sizeof(upscale_code)},
        .settings = {POST_UPSCALE, POST_UPSCALE},
        .makes = NEPH_POST_MAKES_LARGER,
        .filter = POST_UPSCALE,
        .percent = POST_SCREEN_PERCENT,
    },
    {
        .name = "sharpening",
        .pass = NEPH_POST_SHARPENING,
        .note = "counters the blur of earlier stages",
        .shader = {"post_sharpen", sharpen_code, sizeof(sharpen_code)},
        .settings = {POST_SHARPEN, POST_SHARPEN},
    },
    {
        .name = "secondary upscale",
        .pass = NEPH_POST_SECONDARY_UPSCALE,
        .note = "to the size of the window",
        .shader = {"post_upscale", upscale_code, sizeof(upscale_code)},
        .settings = {POST_SECONDARY_UPSCALE, POST_SECONDARY_UPSCALE},
        .makes = NEPH_POST_MAKES_LARGER,
        .filter = POST_SECONDARY_UPSCALE,
        .percent = POST_SECONDARY_PERCENT,
    },
    {.name = NULL},
};
_Static_assert(sizeof(neph_post_stages) / sizeof(neph_post_stages[0]) <= NEPH_POST_STAGES_MAX + 1,
               "room for every stage in the statistics");

bool neph_post_is_on(const struct neph_post_stage *stage, const struct neph_settings *settings)
{
    return settings->values[stage->settings[0]] != 0.0 &&
           settings->values[stage->settings[1]] != 0.0;
}

bool neph_post_is_displayed(const struct neph_settings *settings)
{
    return settings->values[POST_TONE] != 0.0;
}

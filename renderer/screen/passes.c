/* SPDX-License-Identifier: MIT
 *
 * The table of passes, in the order of execution. A pass reads two targets where one of its inputs
 * may be off.
 */
#include "renderer/screen/screen.h"

static const uint32_t gbuffer_code[] = {
#include "shaders/screen_gbuffer.comp.inc"
};
static const uint32_t ao_code[] = {
#include "shaders/screen_ao.comp.inc"
};
static const uint32_t ao_blur_code[] = {
#include "shaders/screen_ao_blur.comp.inc"
};
static const uint32_t gi_code[] = {
#include "shaders/screen_gi.comp.inc"
};
static const uint32_t ssr_code[] = {
#include "shaders/screen_ssr.comp.inc"
};
static const uint32_t mean_code[] = {
#include "shaders/screen_mean.comp.inc"
};
static const uint32_t smooth_code[] = {
#include "shaders/screen_smooth.comp.inc"
};
static const uint32_t whole_code[] = {
#include "shaders/screen_whole.comp.inc"
};
static const uint32_t compose_code[] = {
#include "shaders/screen_compose.comp.inc"
};

#define BIT(target) (1u << (target))
#define SURFACES (BIT(SCREEN_DEPTH) | BIT(SCREEN_NORMAL))
#define GBUFFER (SURFACES | BIT(SCREEN_BASE) | BIT(SCREEN_DIRECT) | BIT(SCREEN_MARKS))
#define BEFORE (BIT(SCREEN_DEPTH_BEFORE) | BIT(SCREEN_NORMAL_BEFORE))
#define LIGHT_BEFORE (BIT(SCREEN_GI_BEFORE) | BIT(SCREEN_SSR_BEFORE))
#define OPEN (BIT(SCREEN_OPEN) | BIT(SCREEN_OPEN_SMOOTH) | BIT(SCREEN_OPEN_WHOLE))
#define GI_OUT (BIT(SCREEN_GI_MEAN) | BIT(SCREEN_GI_A) | BIT(SCREEN_GI_B))
#define SSR_OUT (BIT(SCREEN_SSR_MEAN) | BIT(SCREEN_SSR_A) | BIT(SCREEN_SSR_B))

const struct neph_screen_pass neph_screen_passes[] = {
    {
        .name = "g-buffer",
        .note = "visible surfaces by rays; sun and lights with shadows",
        .shader = {"screen_gbuffer", gbuffer_code, sizeof(gbuffer_code)},
        .settings = {-1, -1},
        .writes = GBUFFER,
    },
    {
        .name = "ambient occlusion",
        .note = "open fraction of the hemisphere over each surface",
        .shader = {"screen_ao", ao_code, sizeof(ao_code)},
        .settings = {SCREEN_AO, SCREEN_AO},
        .resolution = SCREEN_AO_RESOLUTION,
        .reads = SURFACES,
        .writes = BIT(SCREEN_OPEN),
    },
    {
        .name = "occlusion blur",
        .note = "over the period of the noise, within a plane",
        .shader = {"screen_ao_blur", ao_blur_code, sizeof(ao_blur_code)},
        .settings = {SCREEN_AO, SCREEN_AO_BLUR_PX},
        .resolution = SCREEN_AO_RESOLUTION,
        .reads = SURFACES | BIT(SCREEN_OPEN),
        .writes = BIT(SCREEN_OPEN_SMOOTH),
    },
    {
        .name = "occlusion of all",
        .note = "upsampling from one of 2x2 pixels, within a surface",
        .shader = {"screen_whole", whole_code, sizeof(whole_code)},
        .settings = {SCREEN_AO, SCREEN_AO_RESOLUTION},
        .resolution = SCREEN_AO_RESOLUTION,
        .makes_whole = true,
        .reads = SURFACES | BIT(SCREEN_OPEN) | BIT(SCREEN_OPEN_SMOOTH),
        .writes = BIT(SCREEN_OPEN_WHOLE),
    },
    {
        .name = "indirect light",
        .note = "on diffuse surfaces, by screen-space rays",
        .shader = {"screen_gi", gi_code, sizeof(gi_code)},
        .settings = {SCREEN_GI, SCREEN_GI},
        .resolution = SCREEN_GI_RESOLUTION,
        .reads = GBUFFER | BEFORE | LIGHT_BEFORE | OPEN,
        .writes = BIT(SCREEN_GI_RAW),
    },
    {
        .name = "indirect mean",
        .note = "over frames",
        .shader = {"screen_mean", mean_code, sizeof(mean_code)},
        .settings = {SCREEN_GI, SCREEN_GI},
        .resolution = SCREEN_GI_RESOLUTION,
        .reads = SURFACES | BEFORE | BIT(SCREEN_BASE) | BIT(SCREEN_MARKS) | BIT(SCREEN_GI_RAW) |
                 BIT(SCREEN_GI_BEFORE) | BIT(SCREEN_GI_COUNT_BEFORE),
        .writes = BIT(SCREEN_GI_MEAN) | BIT(SCREEN_GI_COUNT),
        .from = SCREEN_GI_RAW,
        .to = SCREEN_GI_MEAN,
        .before = SCREEN_GI_BEFORE,
    },
    {
        .name = "indirect smoothing",
        .note = "over pixels of the same plane, wider from turn to turn",
        .shader = {"screen_smooth", smooth_code, sizeof(smooth_code)},
        .settings = {SCREEN_GI, SCREEN_GI_SMOOTH},
        .resolution = SCREEN_GI_RESOLUTION,
        .reads = SURFACES | BIT(SCREEN_BASE) | BIT(SCREEN_GI_MEAN),
        .writes = BIT(SCREEN_GI_A) | BIT(SCREEN_GI_B),
        .from = SCREEN_GI_MEAN,
        .to = SCREEN_GI_A,
        .turns_setting = SCREEN_GI_SMOOTH,
    },
    {
        .name = "indirect of all",
        .note = "upsampling from one of 2x2 pixels, within a surface",
        .shader = {"screen_whole", whole_code, sizeof(whole_code)},
        .settings = {SCREEN_GI, SCREEN_GI_RESOLUTION},
        .resolution = SCREEN_GI_RESOLUTION,
        .makes_whole = true,
        .reads = SURFACES | BIT(SCREEN_BASE) | OPEN | GI_OUT,
        .writes = BIT(SCREEN_GI_A) | BIT(SCREEN_GI_B),
        .turn = 1,
    },
    {
        .name = "diffuse light",
        .note = "direct and indirect, of all surfaces except metal",
        .shader = {"screen_compose", compose_code, sizeof(compose_code)},
        .settings = {-1, -1},
        .reads = GBUFFER | OPEN | GI_OUT,
        .writes = BIT(SCREEN_LIT),
    },
    {
        .name = "reflections",
        .note = "of metal, by screen-space rays",
        .shader = {"screen_ssr", ssr_code, sizeof(ssr_code)},
        .settings = {SCREEN_SSR, SCREEN_SSR},
        .resolution = SCREEN_SSR_RESOLUTION,
        .reads = GBUFFER | BEFORE | LIGHT_BEFORE | OPEN | BIT(SCREEN_LIT),
        .writes = BIT(SCREEN_SSR_RAW),
    },
    {
        .name = "reflections mean",
        .note = "over frames",
        .shader = {"screen_mean", mean_code, sizeof(mean_code)},
        .settings = {SCREEN_SSR, SCREEN_SSR},
        .resolution = SCREEN_SSR_RESOLUTION,
        .reads = SURFACES | BEFORE | BIT(SCREEN_BASE) | BIT(SCREEN_MARKS) | BIT(SCREEN_SSR_RAW) |
                 BIT(SCREEN_SSR_BEFORE) | BIT(SCREEN_SSR_COUNT_BEFORE),
        .writes = BIT(SCREEN_SSR_MEAN) | BIT(SCREEN_SSR_COUNT),
        .from = SCREEN_SSR_RAW,
        .to = SCREEN_SSR_MEAN,
        .before = SCREEN_SSR_BEFORE,
        .turn = 1,
    },
    {
        .name = "reflections smoothing",
        .note = "over pixels of the same plane, wider for rough metal",
        .shader = {"screen_smooth", smooth_code, sizeof(smooth_code)},
        .settings = {SCREEN_SSR, SCREEN_SSR_SMOOTH},
        .resolution = SCREEN_SSR_RESOLUTION,
        .reads = SURFACES | BIT(SCREEN_BASE) | BIT(SCREEN_SSR_MEAN),
        .writes = BIT(SCREEN_SSR_A) | BIT(SCREEN_SSR_B),
        .from = SCREEN_SSR_MEAN,
        .to = SCREEN_SSR_A,
        .turns_setting = SCREEN_SSR_SMOOTH,
    },
    {
        .name = "reflections of all",
        .note = "upsampling from one of 2x2 pixels, within a surface",
        .shader = {"screen_whole", whole_code, sizeof(whole_code)},
        .settings = {SCREEN_SSR, SCREEN_SSR_RESOLUTION},
        .resolution = SCREEN_SSR_RESOLUTION,
        .makes_whole = true,
        .reads = SURFACES | BIT(SCREEN_BASE) | OPEN | SSR_OUT,
        .writes = BIT(SCREEN_SSR_A) | BIT(SCREEN_SSR_B),
        .turn = 2,
    },
    {
        .name = "picture",
        .note = "diffuse light and reflections",
        .shader = {"screen_compose", compose_code, sizeof(compose_code)},
        .settings = {-1, -1},
        .reads = GBUFFER | OPEN | SSR_OUT | BIT(SCREEN_LIT),
        .writes = BIT(SCREEN_PICTURE),
        .turn = 1,
    },
    {.name = NULL},
};
_Static_assert(sizeof(neph_screen_passes) / sizeof(neph_screen_passes[0]) <=
                   NEPH_SCREEN_PASSES_MAX + 1,
               "room for every pass in the statistics");

const char *const neph_screen_targets[SCREEN_TARGET_COUNT] = {
    [SCREEN_DEPTH] = "depth",
    [SCREEN_MARKS] = "marks",
    [SCREEN_GI_COUNT] = "indirect count",
    [SCREEN_SSR_COUNT] = "reflected count",
    [SCREEN_GI_COUNT_BEFORE] = "indirect count before",
    [SCREEN_SSR_COUNT_BEFORE] = "reflected count before",
    [SCREEN_NORMAL] = "normal",
    [SCREEN_BASE] = "base colour",
    [SCREEN_DIRECT] = "direct",
    [SCREEN_OPEN] = "open",
    [SCREEN_OPEN_SMOOTH] = "open smooth",
    [SCREEN_OPEN_WHOLE] = "open of all",
    [SCREEN_GI_RAW] = "indirect",
    [SCREEN_GI_MEAN] = "indirect mean",
    [SCREEN_GI_A] = "indirect smooth",
    [SCREEN_GI_B] = "indirect smoother",
    [SCREEN_LIT] = "lit",
    [SCREEN_SSR_RAW] = "reflected",
    [SCREEN_SSR_MEAN] = "reflected mean",
    [SCREEN_SSR_A] = "reflected smooth",
    [SCREEN_SSR_B] = "reflected smoother",
    [SCREEN_PICTURE] = "picture",
    [SCREEN_DEPTH_BEFORE] = "depth before",
    [SCREEN_NORMAL_BEFORE] = "normal before",
    [SCREEN_GI_BEFORE] = "indirect before",
    [SCREEN_SSR_BEFORE] = "reflected before",
};

bool neph_screen_is_on(const struct neph_screen_pass *pass, const struct neph_settings *settings)
{
    return pass->settings[0] < 0 || (settings->values[pass->settings[0]] != 0.0 &&
                                     settings->values[pass->settings[1]] != 0.0);
}

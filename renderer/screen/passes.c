/* SPDX-License-Identifier: MIT
 *
 * The passes in the order in which they run. A pass whose input another may leave out reads both.
 */
#include "renderer/screen/screen.h"

static const uint32_t gbuffer_spirv[] = {
#include "shaders/screen_gbuffer.comp.inc"
};
static const uint32_t ao_spirv[] = {
#include "shaders/screen_ao.comp.inc"
};
static const uint32_t ao_blur_spirv[] = {
#include "shaders/screen_ao_blur.comp.inc"
};
static const uint32_t compose_spirv[] = {
#include "shaders/screen_compose.comp.inc"
};

#define BIT(target) (1u << (target))
#define GBUFFER (BIT(SCREEN_DEPTH) | BIT(SCREEN_NORMAL) | BIT(SCREEN_BASE) | BIT(SCREEN_DIRECT))

const struct neph_screen_pass neph_screen_passes[] = {
    {
        .name = "g-buffer",
        .note = "first solids by rays; sun and lamps with their shadows",
        .shader = {"screen_gbuffer", gbuffer_spirv, sizeof(gbuffer_spirv)},
        .settings = {-1, -1},
        .writes = GBUFFER,
    },
    {
        .name = "ambient occlusion",
        .note = "of the hemisphere over each surface, what is open",
        .shader = {"screen_ao", ao_spirv, sizeof(ao_spirv)},
        .settings = {SCREEN_AO, SCREEN_AO},
        .reads = BIT(SCREEN_DEPTH) | BIT(SCREEN_NORMAL),
        .writes = BIT(SCREEN_OPEN),
    },
    {
        .name = "occlusion blur",
        .note = "over the pixels of the noise, within a plane",
        .shader = {"screen_ao_blur", ao_blur_spirv, sizeof(ao_blur_spirv)},
        .settings = {SCREEN_AO, SCREEN_AO_BLUR_PX},
        .reads = BIT(SCREEN_DEPTH) | BIT(SCREEN_NORMAL) | BIT(SCREEN_OPEN),
        .writes = BIT(SCREEN_OPEN_SMOOTH),
    },
    {
        .name = "composition",
        .note = "direct light and, where it is open, that of the sky",
        .shader = {"screen_compose", compose_spirv, sizeof(compose_spirv)},
        .settings = {-1, -1},
        .reads = GBUFFER | BIT(SCREEN_OPEN) | BIT(SCREEN_OPEN_SMOOTH),
        .writes = BIT(SCREEN_PICTURE),
    },
    {.name = NULL},
};
_Static_assert(sizeof(neph_screen_passes) / sizeof(neph_screen_passes[0]) <=
                   NEPH_SCREEN_PASSES_MAX + 1,
               "room for every pass in the statistics");

const char *const neph_screen_targets[SCREEN_TARGET_COUNT] = {
    [SCREEN_DEPTH] = "depth",   [SCREEN_NORMAL] = "normal", [SCREEN_BASE] = "base colour",
    [SCREEN_DIRECT] = "direct", [SCREEN_OPEN] = "open",     [SCREEN_OPEN_SMOOTH] = "open, smooth",
    [SCREEN_PICTURE] = "picture",
};

bool neph_screen_is_on(const struct neph_screen_pass *pass, const struct neph_settings *settings)
{
    return pass->settings[0] < 0 || (settings->values[pass->settings[0]] != 0.0 &&
                                     settings->values[pass->settings[1]] != 0.0);
}

/* SPDX-License-Identifier: MIT
 *
 * Engine `screen`: solids by direct light and what passes on a G-buffer make of the rest, as
 * games have it. What a screen cannot know is told by `neph study screen`.
 */
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include "harness/engines/frame_stats.h"
#include "harness/engines/own_cost.h"
#include "renderer/reach.h"
#include "renderer/screen/screen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_screen_can(scene, reason, reason_size) &&
           neph_float32_reaches(scene, reason, reason_size);
}

/* ---- passes in words ------------------------------------------------------------------------- */

static void list_targets(unsigned targets, char *text, size_t size)
{
    text[0] = '\0';
    for (int t = 0; t < SCREEN_TARGET_COUNT; t++)
        if (targets >> t & 1u) {
            const size_t length = strlen(text);
            snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "",
                     neph_screen_targets[t]);
        }
}

static bool describe_pass(int index, struct neph_engine_pass *words)
{
    const struct neph_screen_pass *pass = &neph_screen_passes[index];
    if (!pass->name)
        return false;
    *words = (struct neph_engine_pass){
        .name = pass->name, .note = pass->note, .resolution = "full"};
    if (pass->settings[0] >= 0)
        snprintf(words->condition, sizeof(words->condition), "%s",
                 neph_screen_options[pass->settings[1]].name);
    list_targets(pass->reads, words->reads, sizeof(words->reads));
    list_targets(pass->writes, words->writes, sizeof(words->writes));
    return true;
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* "ambient_occlusion_ms" of a pass. */
static enum neph_status label(struct neph_image *image, const struct neph_screen_stats *stats,
                              double *gpu_s, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *gpu_s = 0.0;
    for (int i = 0; neph_screen_passes[i].name && !status; i++) {
        char name[64];
        snprintf(name, sizeof(name), "%s_ms", neph_screen_passes[i].name);
        for (char *c = name; *c; c++)
            *c = *c == ' ' || *c == '-' ? '_' : *c;
        if (stats->gpu_s[i] != 0.0)
            status = neph_frame_stats_set(image, name, 1e3 * stats->gpu_s[i], diag);
        *gpu_s += stats->gpu_s[i];
    }
    return status ? status : neph_frame_stats_set(image, "gpu_ms", 1e3 * *gpu_s, diag);
}

/* The last of several frames in which nothing moves. */
static enum neph_status take_picture(struct neph_vulkan *vulkan, const struct neph_shot *shot,
                                     struct neph_image **image, struct neph_screen_stats *stats,
                                     struct neph_diag *diag)
{
    const struct neph_screen_params params = {
        .settings = shot->settings, .width_px = shot->width_px, .height_px = shot->height_px};
    const int frames = (int)shot->settings.values[SCREEN_FRAMES];
    struct neph_screening *screen = NULL;
    enum neph_status status = neph_screening_create(vulkan, shot->scene, &params, &screen, diag);
    for (int i = 1; i <= frames && !status; i++)
        status = neph_screening_frame(screen, shot->scene, shot->frame, i == frames ? image : NULL,
                                      stats, diag);
    neph_screening_destroy(screen);
    return status;
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct neph_vulkan *vulkan = NULL;
    struct neph_image *image = NULL;
    struct neph_screen_stats stats;
    double gpu_s = NAN;
    enum neph_status status = neph_vulkan_open(&vulkan, diag);
    if (!status)
        status = take_picture(vulkan, shot, &image, &stats, diag);
    if (!status)
        status = label(image, &stats, &gpu_s, diag);
    neph_vulkan_destroy(vulkan);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *cost = neph_own_cost(start, gpu_s);
    *frame = image;
    return NEPH_OK;
}

const struct neph_engine neph_engine_screen = {
    .name = "screen",
    .summary = "solids by direct light, and the rest from depth and normals of the picture alone",
    .rung = NEPH_RUNG_MODEL,
    .look = true,
    .bias = "what is off the screen or behind what it shows is not there; docs/screen.md",
    .is_narrow = true,
    .typical_s = 1.0,
    .options = neph_screen_options,
    .presets = neph_screen_presets,
    .version = 1,
    .describe_pass = describe_pass,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
    .render = render,
};

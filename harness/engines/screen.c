/* SPDX-License-Identifier: MIT
 *
 * Engine `screen`: solids with direct light, and indirect light from screen-space passes on a
 * G-buffer, as in games. `neph study screen` measures the error of the missing off-screen light.
 */
#include "harness/engines/engines.h"

#include "harness/engines/frame_stats.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/reach.h"
#include "renderer/screen/screen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_screen_can(scene, reason, reason_size) &&
           neph_float32_reaches(scene, reason, reason_size);
}

/* ---- descriptions of passes ------------------------------------------------------------------ */

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
        .name = pass->name,
        .note = pass->note,
        .resolution = pass->resolution && !pass->makes_whole ? "full or half" : "full"};
    if (pass->settings[0] >= 0)
        snprintf(words->condition, sizeof(words->condition), "%s",
                 neph_screen_options[pass->settings[1]].name);
    list_targets(pass->reads, words->reads, sizeof(words->reads));
    list_targets(pass->writes, words->writes, sizeof(words->writes));
    return true;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* Render the warm-up frames, as if the sequence had begun earlier; before frame 0 everything stands
 * still. */
static enum neph_status warm_up(struct neph_screening *screen, const struct neph_shot *shot,
                                struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int left = (int)shot->settings.values[SCREEN_WARM_UP]; left > 0 && !status; left--)
        status = neph_screening_frame(screen, shot->scene, shot->frame - left, NULL, NULL, diag);
    return status;
}

static enum neph_status create(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag)
{
    (void)engine;
    const struct neph_screen_params params = {
        .settings = shot->settings, .width_px = shot->width_px, .height_px = shot->height_px};
    struct neph_screening *screen = NULL;
    const enum neph_status status = neph_screening_create(vulkan, shot->scene, &params, &screen,
                                                          diag);
    *renderer = screen;
    return status ? status : warm_up(screen, shot, diag);
}

static void destroy(void *renderer)
{
    neph_screening_destroy(renderer);
}

/* Render a frame, labelled with the times of its passes ("ambient_occlusion_ms"). */
static enum neph_status frame(void *renderer, const struct neph_shot *shot,
                              struct neph_image **image, double *gpu_s, struct neph_diag *diag)
{
    struct neph_screen_stats stats;
    enum neph_status status = neph_screening_frame(renderer, shot->scene, shot->frame, image,
                                                   &stats, diag);
    *gpu_s = 0.0;
    for (int i = 0; neph_screen_passes[i].name && !status; i++) {
        status = neph_frame_stats_set_pass(*image, neph_screen_passes[i].name, "ms", stats.gpu_s[i],
                                           diag);
        *gpu_s += stats.gpu_s[i];
    }
    return status ? status : neph_frame_stats_set(*image, "gpu_ms", 1e3 * *gpu_s, diag);
}

/* Submit a frame and wait for it before the next one: the times of the passes are the same, but the
 * gap between two frames is longer than with frames in flight. */
static enum neph_status submit(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag)
{
    struct neph_screen_stats stats;
    const enum neph_status status = neph_screening_frame(renderer, shot->scene, shot->frame, NULL,
                                                         &stats, diag);
    for (int i = 0; neph_screen_passes[i].name && !status; i++) {
        neph_flight_cost_add(cost, neph_screen_passes[i].name, stats.gpu_s[i], NAN);
        cost->gpu_s += stats.gpu_s[i];
    }
    return status;
}

static const struct neph_gpu_renderer gpu = {
    .create = create, .destroy = destroy, .frame = frame, .submit = submit};

const struct neph_engine neph_engine_screen = {
    .name = "screen",
    .summary = "solids with direct light; indirect light only from depth and normals of the frame",
    .rung = NEPH_RUNG_MODEL,
    .look = true,
    .bias = "light and occluders outside of the frame or behind visible surfaces are missing; "
            "docs/screen.md",
    .is_narrow = true,
    .sequence = &neph_gpu_sequence,
    .gpu = &gpu,
    .remembers = true,
    .typical_s = 1.0,
    .options = neph_screen_options,
    .presets = neph_screen_presets,
    .version = 1,
    .describe_pass = describe_pass,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
};

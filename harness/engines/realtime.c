/* SPDX-License-Identifier: MIT
 *
 * Engine `realtime`: the four-frame pipeline and temporal anti-aliasing, on the same device as
 * `march`. A single frame is the end of a sequence with warm-up frames.
 */
#include "harness/engines/engines.h"

#include "harness/data.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "metrics/extractors/cycle_frequency.h"
#include "renderer/realtime/noise.h"
#include "renderer/realtime/options.h"
#include "renderer/realtime/pipeline.h"
#include "scenes/injection.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)NEPH_FLIGHT_FRAMES_MAX <= (int)NEPH_IN_FLIGHT_FRAMES, "pictures in flight");

/* Whether warm-up frames stay on the device. Without the split, the passes after the march need
 * them on the CPU. On a CPU device, frames that are not read back use another kernel, whose
 * compilation takes longer than reading some small frames. */
static bool stays_on_device(const struct neph_vulkan *vulkan, const struct neph_shot *shot)
{
    const struct neph_rt_settings settings = neph_rt_group_settings(&shot->settings);
    return settings.shared.split != RT_SPLIT_NONE && !neph_vulkan_describe(vulkan).is_cpu;
}

/* Render the warm-up frames before the first frame, as if the sequence had begun earlier. Before
 * frame 0 camera and sun stand still, and the wind blows as in frame 0. A given frame belongs to
 * the first frame. */
static enum neph_status warm_up(const struct neph_vulkan *vulkan, struct neph_realtime *realtime,
                                const struct neph_shot *shot, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int left = neph_rt_group_settings(&shot->settings).shared.warm_up; left > 0 && !status;
         left--) {
        const struct neph_realtime_frame picture = {shot->scene, shot->frame - left, shot->given};
        struct neph_image *image = NULL;
        status = neph_realtime_render(realtime, &picture,
                                      stays_on_device(vulkan, shot) ? NULL : &image, NULL, diag);
        neph_image_destroy(image);
    }
    return status;
}

static enum neph_status create(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag)
{
    (void)engine;
    char *blue_noise = neph_data_path("renderer/blue_noise.png");
    const struct neph_realtime_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .settings = &shot->settings,
        .seed = (uint32_t)shot->seed,
        .blue_noise_path = blue_noise,
    };
    struct neph_realtime *realtime = NULL;
    const enum neph_status status = blue_noise ? neph_realtime_create(vulkan, shot->scene, &params,
                                                                      &realtime, diag)
                                               : neph_fail_memory(diag);
    free(blue_noise);
    *renderer = realtime;
    return status ? status : warm_up(vulkan, realtime, shot, diag);
}

static void destroy(void *renderer)
{
    neph_realtime_destroy(renderer);
}

static enum neph_status resize(void *renderer, const struct neph_shot *shot, struct neph_diag *diag)
{
    return neph_realtime_resize(renderer, shot->scene, shot->width_px, shot->height_px, diag);
}

static enum neph_status label_passes(struct neph_image *image,
                                     const struct neph_realtime_stats *stats,
                                     struct neph_diag *diag)
{
    static const char ending[] = "gpu_ms";
    enum neph_status status = NEPH_OK;
    for (int i = 0; neph_rt_passes[i] && !status; i++)
        status = neph_frame_stats_set_pass(image, neph_rt_passes[i]->name, ending,
                                           stats->pass_gpu_s[i], diag);
    if (!status)
        status = neph_frame_stats_set_pass(image, "higher orders", ending, stats->light_gpu_s,
                                           diag);
    if (!status && stats->places_gpu_s > 0.0)
        status = neph_frame_stats_set_pass(image, "places of meshes", ending, stats->places_gpu_s,
                                           diag);
    if (!status)
        status = neph_frame_stats_set_pass(image, "cloud shadow", ending, stats->shadow_gpu_s,
                                           diag);
    return status
               ? status
               : neph_frame_stats_set_pass(image, "sky", ending, neph_sky_gpu_s(&stats->sky), diag);
}

/* Bytes of the render targets. NaN: the frame needed none, and the march's own memory is not
 * counted. */
static double stat_target_bytes(uint64_t bytes)
{
    return bytes > 0 ? (double)bytes : NAN;
}

/* Label the frame with the periods of these settings, for the flicker metrics. */
static enum neph_status label_cycles(struct neph_image *frame, const struct neph_settings *values,
                                     struct neph_diag *diag)
{
    const struct neph_rt_settings settings = neph_rt_group_settings(values);
    const bool jitters = settings.anti_aliasing.kind != RT_TAA_OFF &&
                         settings.anti_aliasing.jitter != RT_JITTER_NONE;
    const bool splits = settings.shared.split == RT_SPLIT_FOUR;
    const bool rests = splits && settings.tile_index.override != RT_OVERRIDE_NONE;
    const struct {
        const char *name;
        double period; /* frames; below 2: no such period */
    } cycles[] = {
        {"slot", splits ? 4.0 : 0.0},
        {"TAA jitter", jitters ? neph_rt_jitter_length(settings.anti_aliasing.jitter_length,
                                                       settings.shared.screen_percent)
                               : 0.0},
        {"ray dither", settings.ray_march.ray_dither_amount > 0.0
                           ? neph_rt_dither_period(settings.ray_march.ray_dither)
                           : 0.0},
        {"upscale dither",
         settings.upscale.amount_px > 0.0 ? neph_rt_dither_period(settings.upscale.dither) : 0.0},
        {"override rest", rests ? 4.0 * settings.tile_index.override_rest : 0.0},
    };
    char text[256] = "";
    for (size_t i = 0, used = 0; i < sizeof(cycles) / sizeof(cycles[0]); i++)
        if (cycles[i].period >= 2.0)
            used += (size_t)snprintf(text + used, sizeof(text) - used, "%s%s %.0f",
                                     used ? ", " : "", cycles[i].name, cycles[i].period);
    return text[0] ? neph_image_set_attribute(frame, NEPH_CYCLE_ATTRIBUTE, diag, "%s", text)
                   : NEPH_OK;
}

static enum neph_status label(struct neph_image *image, const struct neph_realtime_stats *stats,
                              struct neph_diag *diag)
{
    const double pixels = (double)neph_image_pixel_count(image);
    const struct neph_frame_stat numbers[] = {
        {"density_evaluations", (double)stats->density_evaluations},
        {"density_evaluations_per_pixel", (double)stats->density_evaluations / pixels},
        {"closed_forms", (double)stats->closed_forms},
        {"rays", (double)stats->rays},
        {"view_steps", (double)stats->view_steps},
        {"history_bytes", stat_target_bytes(stats->history_bytes)},
        {"target_bytes", stat_target_bytes(stats->target_bytes)},
        {"traffic_bytes", stat_target_bytes(stats->traffic_bytes)},
        {"gpu_ms", 1e3 * stats->gpu_s},
        {"wall_ms", 1e3 * stats->wall_s},
    };
    const enum neph_status status = neph_frame_stats_set_all(
        image, numbers, sizeof(numbers) / sizeof(numbers[0]), diag);
    return status ? status : label_passes(image, stats, diag);
}

/* Label injections; nothing for a scene without them. */
static enum neph_status label_injections(struct neph_image *frame,
                                         const struct neph_injections *injections,
                                         const struct neph_realtime_stats *stats,
                                         struct neph_diag *diag)
{
    char *text = neph_injections_text(injections);
    if (!text)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    if (text[0])
        status = neph_frame_stats_set(frame, "injected_values", (double)stats->injected_values,
                                      diag);
    if (text[0] && !status)
        status = neph_image_set_attribute(frame, "neph.injected", diag, "%s", text);
    free(text);
    return status;
}

static enum neph_status frame(void *renderer, const struct neph_shot *shot,
                              struct neph_image **image, double *render_s, struct neph_diag *diag)
{
    const struct neph_realtime_frame picture = {shot->scene, shot->frame, shot->given};
    struct neph_realtime_stats stats;
    enum neph_status status = neph_realtime_render(renderer, &picture, image, &stats, diag);
    if (!status)
        status = label(*image, &stats, diag);
    if (!status)
        status = label_injections(*image, neph_scene_injections(shot->scene), &stats, diag);
    if (!status)
        status = label_cycles(*image, &shot->settings, diag);
    if (!status)
        *render_s = isfinite(stats.gpu_s) ? stats.gpu_s : stats.wall_s;
    return status;
}

static enum neph_status submit(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag)
{
    (void)cost;
    const struct neph_realtime_frame picture = {shot->scene, shot->frame, shot->given};
    return neph_realtime_render(renderer, &picture, NULL, NULL, diag);
}

/* Add the cost of work before the passes, if there was any. */
static void add_before(const char *name, double gpu_s, struct neph_flight_cost *cost)
{
    if (gpu_s > 0.0)
        neph_flight_cost_add(cost, name, gpu_s, NAN);
}

static enum neph_status collect(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag)
{
    struct neph_realtime_stats stats;
    const enum neph_status status = neph_realtime_collect(renderer, &stats, diag);
    if (status)
        return status;
    *cost = (struct neph_flight_cost){.gpu_s = stats.gpu_s, .cpu_s = stats.wall_s};
    for (int i = 0; neph_rt_passes[i]; i++)
        neph_flight_cost_add(cost, neph_rt_passes[i]->name, stats.pass_gpu_s[i],
                             stat_target_bytes(stats.pass_traffic_bytes[i]));
    neph_flight_cost_add_sky(cost, &stats.sky);
    add_before("places of meshes", stats.places_gpu_s, cost);
    add_before("higher orders", stats.light_gpu_s, cost);
    add_before("cloud shadow", stats.shadow_gpu_s, cost);
    return NEPH_OK;
}

static enum neph_status watch(void *renderer, uint64_t *bad, struct neph_diag *diag)
{
    return neph_realtime_watch(renderer, bad, diag);
}

static void disable_variants(void *renderer, bool leaves)
{
    neph_realtime_use_readable_shaders(renderer, leaves);
}

static const struct neph_gpu_renderer gpu = {.create = create,
                                             .destroy = destroy,
                                             .resize = resize,
                                             .frame = frame,
                                             .submit = submit,
                                             .collect = collect,
                                             .watch = watch,
                                             .disable_variants = disable_variants,
                                             .set_up_is_free = true};

/* Whether realtime can render the scene; if another lighting could, the reason says so. */
static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    if (neph_realtime_can_render(scene, settings, reason, reason_size))
        return true;
    const char *const *lightings = neph_rt_options[RT_LIGHTING].choices;
    bool some = false;
    for (int i = 0; lightings[i]; i++) {
        struct neph_settings other = *settings;
        char ignored[256];
        other.values[RT_LIGHTING] = i;
        if (neph_realtime_can_render(scene, &other, ignored, sizeof(ignored))) {
            const size_t used = strlen(reason);
            snprintf(reason + used, reason_size - used, "%s%s",
                     some ? ", " : "; lighting=", lightings[i]);
            some = true;
        }
    }
    const size_t used = strlen(reason);
    snprintf(reason + used, reason_size - used, "%s", some ? " could" : "");
    return false;
}

/* ---- passes ---------------------------------------------------------------------------------- */

static void name_targets(uint32_t targets, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int t = 0; t < RT_TARGET_COUNT; t++)
        if (targets & NEPH_RT_BIT(t))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     neph_rt_target_name(t));
}

static void name_condition(struct neph_rt_condition condition, char *text, size_t size)
{
    const struct neph_option *setting = &neph_rt_options[condition.setting];
    if (condition.setting == RT_ORACLE)
        snprintf(text, size, "one of oracle_* is on");
    else
        snprintf(text, size, "%s=%s", setting->name, setting->choices[condition.choice]);
}

static bool describe_pass(int index, struct neph_engine_pass *pass)
{
    static const char *const resolutions[] = {
        [RT_OUTPUT] = "picture",  [RT_FULL] = "full",      [RT_HALF] = "half",
        [RT_QUARTER] = "quarter", [RT_FROXEL] = "froxels", [RT_FROXEL_COLUMN] = "columns"};
    const struct neph_rt_pass *record = neph_rt_passes[index];
    if (!record)
        return false;
    *pass = (struct neph_engine_pass){
        .name = record->name,
        .note = record->note,
        .resolution = resolutions[record->resolution],
    };
    name_condition(record->condition, pass->condition, sizeof(pass->condition));
    name_targets(record->reads, pass->reads, sizeof(pass->reads));
    name_targets(record->writes, pass->writes, sizeof(pass->writes));
    name_targets(neph_rt_targets_before(record), pass->hands_on, sizeof(pass->hands_on));
    return true;
}

const struct neph_engine neph_engine_realtime = {
    .name = "realtime",
    .summary = "the four-frame pipeline: a ray per 4x4 pixels, history, depth-aware upscale, TAA",
    .rung = NEPH_LEVEL_MODEL,
    .typical_s = 3.0,
    .bias = "a real-time method: compare it with `march` with the same steps",
    .options = neph_rt_options,
    .presets = neph_rt_presets,
    .sequence = &neph_gpu_sequence_watched,
    .gpu = &gpu,
    .has_frame_history = true,
    .accepts_given_frame = true,
    .injects = true,
    .version = 6, /* 6: one mask of blue noise, shifted by the seed */
    .shortcut_of = "march",
    .stochastic = true,
    .step = {.option = NULL},
    .describe_pass = describe_pass,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
};

/* SPDX-License-Identifier: MIT
 *
 * Engine `fog_look`: a scene's height fog in closed form, as game engines draw it, with the
 * controls of the scene's `fog_look`. A non-physical model: `neph study fog` measures its model
 * error.
 */
#include "harness/engines/engines.h"

#include "harness/engines/frame_stats.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/float32_range.h"
#include "renderer/fog_look.h"
#include "scenes/fog_translation.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdio.h>

/* In the order of the controls, after "all" and "none". */
static const char *const control_words[] = {"all",
                                            "none",
                                            "sky_light",
                                            "start_distance",
                                            "end_distance",
                                            "cutoff_distance",
                                            "max_opacity",
                                            "volumetric_fog_distance",
                                            "observer_height_max",
                                            "directional",
                                            "directional_start",
                                            NULL};

enum { CONTROLS_ALL, CONTROLS_NONE, CONTROLS_FIRST };

_Static_assert(sizeof(control_words) / sizeof(control_words[0]) ==
                   CONTROLS_FIRST + NEPH_FOG_CONTROL_COUNT + 1,
               "a word for each control");

static const char *const sun_words[] = {"attenuated", "clear", NULL};

enum { OPTION_MODEL, OPTION_CONTROLS, OPTION_SUN };

static const struct neph_option options[] = {
    [OPTION_MODEL] = {"model", NEPH_OPTION_CHOICE, NEPH_FOG_UNREAL, 0, 0, neph_fog_model_words,
                      "formula: of Unreal Engine or of Filament"},
    [OPTION_CONTROLS] = {"controls", NEPH_OPTION_CHOICE, CONTROLS_ALL, 0, 0, control_words,
                         "enabled controls of the scene's fog_look: all, none, or only one"},
    [OPTION_SUN] = {"sun", NEPH_OPTION_CHOICE, 0, 0, 0, sun_words,
                    "on solids: attenuated by the fog in closed form, or clear, as game engines "
                    "have it"},
    {.name = NULL},
};

/* The set of controls for a choice; directional_start has no effect without the directional
 * control. */
static unsigned choose_control_set(int choice)
{
    if (choice == CONTROLS_ALL)
        return NEPH_FOG_CONTROLS_ALL;
    if (choice == CONTROLS_NONE)
        return 0;
    const unsigned control = 1u << (choice - CONTROLS_FIRST);
    return control == 1u << NEPH_FOG_DIRECTIONAL_START ? control | 1u << NEPH_FOG_DIRECTIONAL
                                                       : control;
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    const enum neph_fog_model model = (enum neph_fog_model)settings->values[OPTION_MODEL];
    if (neph_surfaces_obstacle(scene)) {
        snprintf(reason, reason_size, "%s", neph_surfaces_obstacle(scene));
        return false;
    }
    return neph_fog_look_can_model(scene, model, reason, reason_size) &&
           neph_is_in_float32_range(scene, reason, reason_size);
}

/* ---- sequences ------------------------------------------------------------------------------- */

static enum neph_status create(struct neph_vulkan *vulkan, const struct neph_engine *engine,
                               const struct neph_shot *shot, void **renderer,
                               struct neph_diag *diag)
{
    (void)engine;
    const double *values = shot->settings.values;
    const struct neph_fog_look_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .look = neph_fog_look_mask_controls(&shot->scene->fog_look,
                                            choose_control_set((int)values[OPTION_CONTROLS])),
        .model = (enum neph_fog_model)values[OPTION_MODEL],
        .sun_is_clear = values[OPTION_SUN] != 0.0,
    };
    struct neph_fog_renderer *looks = NULL;
    const enum neph_status status = neph_fog_renderer_create(vulkan, shot->scene, &params, &looks,
                                                             diag);
    *renderer = looks;
    return status;
}

static void destroy(void *renderer)
{
    neph_fog_renderer_destroy(renderer);
}

static enum neph_status frame(void *renderer, const struct neph_shot *shot,
                              struct neph_image **image, double *gpu_s, struct neph_diag *diag)
{
    const struct neph_scene *scene = shot->scene;
    const enum neph_status status = neph_fog_renderer_frame(renderer, scene, shot->frame, image,
                                                            gpu_s, diag);
    if (status)
        return status;
    const int layers = scene->medium_count > 0 ? neph_fog_look_find_medium(scene)->layer_count : 0;
    const double pixels = (double)neph_image_pixel_count(*image);
    const struct neph_frame_stat stats[] = {
        {"density_evaluations", 0.0},
        {"closed_forms", pixels * layers},
        {"rays", pixels},
        {"gpu_ms", 1e3 * *gpu_s},
    };
    return neph_frame_stats_set_all(*image, stats, sizeof(stats) / sizeof(stats[0]), diag);
}

static enum neph_status submit(void *renderer, const struct neph_shot *shot,
                               struct neph_flight_cost *cost, struct neph_diag *diag)
{
    (void)cost;
    return neph_fog_renderer_frame(renderer, shot->scene, shot->frame, NULL, NULL, diag);
}

/* A single pass; its memory traffic is one result per pixel. */
static enum neph_status collect(void *renderer, struct neph_flight_cost *cost,
                                struct neph_diag *diag)
{
    const enum neph_status status = neph_fog_renderer_collect(renderer, &cost->gpu_s, diag);
    if (!status)
        neph_flight_cost_add(cost, "fog look", cost->gpu_s, NAN);
    return status;
}

static const struct neph_gpu_renderer gpu = {
    .create = create, .destroy = destroy, .frame = frame, .submit = submit, .collect = collect};

const struct neph_engine neph_engine_fog_look = {
    .name = "fog_look",
    .summary = "height fog as game engines draw it, in closed form; a non-physical model",
    .rung = NEPH_LEVEL_MODEL,
    .look = true,
    .bias =
        "one fog colour for all depths and directions; docs/fog.md has the effect of its controls",
    .typical_s = 1.0,
    .options = options,
    .version = 2,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
    .sequence = &neph_gpu_sequence,
    .gpu = &gpu,
};

/* SPDX-License-Identifier: MIT
 *
 * Engine `fog_look`: a scene's height fog as game engines draw it, with the controls that its
 * `fog_look` sets, in closed form. A look: what it is off by is told by `neph study fog`.
 */
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include "base/clock.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/own_cost.h"
#include "renderer/fog_look.h"
#include "renderer/reach.h"
#include "scenes/fog_translation.h"
#include "scenes/surfaces.h"

#include <math.h>
#include <stdlib.h>

/* In the order of the controls, behind the first two. */
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
                      "whose formula: Unreal Engine's or Filament's"},
    [OPTION_CONTROLS] = {"controls", NEPH_OPTION_CHOICE, CONTROLS_ALL, 0, 0, control_words,
                         "which controls of the scene's fog_look are on: all, none, or one alone"},
    [OPTION_SUN] = {"sun", NEPH_OPTION_CHOICE, 0, 0, 0, sun_words,
                    "on solids: attenuated by the fog in closed form, or clear, as game engines "
                    "have it"},
    {.name = NULL},
};

/* directional_start is nothing by itself. */
static unsigned controls_of(int choice)
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
    return neph_fog_look_is_of(scene, model, reason, reason_size) &&
           neph_float32_reaches(scene, reason, reason_size);
}

static enum neph_status label(struct neph_image *frame, const struct neph_scene *scene,
                              double gpu_s, struct neph_diag *diag)
{
    const int layers = scene->medium_count > 0 ? neph_fog_look_medium(scene)->layer_count : 0;
    const double pixels = (double)neph_image_pixel_count(frame);
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"density_evaluations", 0.0},
        {"closed_forms", pixels * layers},
        {"rays", pixels},
        {"gpu_ms", 1e3 * gpu_s},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]) && !status; i++)
        status = neph_frame_stats_set(frame, numbers[i].name, numbers[i].value, diag);
    return status;
}

/* ---- pictures in a row ----------------------------------------------------------------------- */

struct sequence {
    struct neph_open_device *device;
    struct neph_fog_looks *looks; /* for pictures of this size */
    int width_px, height_px;
    int sent, home; /* pictures that went on their way, and those no longer on it */
    double sent_s[NEPH_FLIGHT_PICTURES_MAX]; /* the CPU's part of each, by number */
};

static void close_sequence(void *opened)
{
    struct sequence *sequence = opened;
    if (!sequence)
        return;
    neph_fog_looks_destroy(sequence->looks);
    neph_device_release(sequence->device);
    free(sequence);
}

static enum neph_status set_up(struct sequence *sequence, const struct neph_shot *shot,
                               struct neph_diag *diag)
{
    const double *values = shot->settings.values;
    const struct neph_fog_look_params params = {
        .width_px = shot->width_px,
        .height_px = shot->height_px,
        .frame = shot->frame,
        .look = neph_fog_look_only(&shot->scene->fog_look,
                                   controls_of((int)values[OPTION_CONTROLS])),
        .model = (enum neph_fog_model)values[OPTION_MODEL],
        .sun_is_clear = values[OPTION_SUN] != 0.0,
    };
    neph_fog_looks_destroy(sequence->looks);
    sequence->looks = NULL;
    sequence->width_px = shot->width_px;
    sequence->height_px = shot->height_px;
    return neph_fog_looks_create(sequence->device->vulkan, shot->scene, &params, &sequence->looks,
                                 diag);
}

static enum neph_status open_sequence(const struct neph_shot *shot, void **opened,
                                      struct neph_diag *diag)
{
    struct sequence *sequence = calloc(1, sizeof(*sequence));
    if (!sequence)
        return neph_fail_memory(diag);
    enum neph_status status = neph_device_acquire(shot->device, &sequence->device, diag);
    if (!status)
        status = set_up(sequence, shot, diag);
    if (status)
        close_sequence(sequence);
    else
        *opened = sequence;
    return status;
}

static enum neph_status next_picture(void *opened, const struct neph_shot *shot,
                                     struct neph_image **frame, struct neph_cost *cost,
                                     struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct neph_image *image = NULL;
    double gpu_s = NAN;
    sequence->home = sequence->sent; /* those in flight are forgotten */
    const bool fits = shot->width_px == sequence->width_px &&
                      shot->height_px == sequence->height_px && sequence->looks;
    enum neph_status status = fits ? NEPH_OK : set_up(sequence, shot, diag);
    if (!status)
        status = neph_fog_looks_frame(sequence->looks, shot->scene, shot->frame, &image, &gpu_s,
                                      diag);
    if (!status)
        status = label(image, shot->scene, gpu_s, diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *cost = neph_own_cost(start, gpu_s);
    *frame = image;
    return NEPH_OK;
}

static enum neph_status send(void *opened, const struct neph_shot *shot, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const double start_s = neph_wall_s();
    const enum neph_status status = neph_fog_looks_frame(sequence->looks, shot->scene, shot->frame,
                                                         NULL, NULL, diag);
    if (!status)
        sequence->sent_s[sequence->sent++ % NEPH_FLIGHT_PICTURES_MAX] = neph_wall_s() - start_s;
    return status;
}

/* All is one pass: what it moves is a pixel's result. */
static enum neph_status home(void *opened, struct neph_flight_cost *cost, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    double gpu_s;
    const enum neph_status status = neph_fog_looks_home(sequence->looks, &gpu_s, diag);
    if (!status)
        *cost = (struct neph_flight_cost){
            .gpu_s = gpu_s,
            .cpu_s = sequence->sent_s[sequence->home++ % NEPH_FLIGHT_PICTURES_MAX],
            .pass_count = 1,
            .passes = {{.name = "fog look", .gpu_s = gpu_s, .traffic_bytes = NAN}},
        };
    return status;
}

static const struct neph_engine_sequence sequence_of_looks = {.open = open_sequence,
                                                              .next = next_picture,
                                                              .send = send,
                                                              .home = home,
                                                              .close = close_sequence};

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    return neph_own_picture(&sequence_of_looks, shot, frame, cost, diag);
}

const struct neph_engine neph_engine_fog_look = {
    .name = "fog_look",
    .summary = "height fog as game engines draw it, in closed form: a look, not physics",
    .rung = NEPH_RUNG_MODEL,
    .look = true,
    .bias = "one colour of fog for all depths and directions; what its controls take and give is "
            "in docs/fog.md",
    .typical_s = 1.0,
    .options = options,
    .version = 2,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
    .render = render,
    .sequence = &sequence_of_looks,
};

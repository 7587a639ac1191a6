/* SPDX-License-Identifier: MIT
 *
 * Engine `screen`: solids by direct light and what passes on a G-buffer make of the rest, as
 * games have it. What a screen cannot know is told by `neph study screen`.
 */
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"

#include "base/clock.h"
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

struct sequence {
    struct neph_open_device *device;
    struct neph_screening *screen; /* of pictures of this size */
    int width_px, height_px;
    struct neph_flight_cost costs[NEPH_FLIGHT_PICTURES_MAX]; /* of pictures sent, by number */
    int sent, home;
};

static void close_sequence(void *opened)
{
    struct sequence *sequence = opened;
    if (!sequence)
        return;
    neph_screening_destroy(sequence->screen);
    neph_device_release(sequence->device);
    free(sequence);
}

/* The pictures before the first, as if the sequence had begun earlier; before picture 0 all stands
 * still. */
static enum neph_status warm_up(struct sequence *sequence, const struct neph_shot *shot,
                                struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int left = (int)shot->settings.values[SCREEN_WARM_UP]; left > 0 && !status; left--)
        status = neph_screening_frame(sequence->screen, shot->scene, shot->frame - left, NULL, NULL,
                                      diag);
    return status;
}

/* Another size begins anew. */
static enum neph_status set_up(struct sequence *sequence, const struct neph_shot *shot,
                               struct neph_diag *diag)
{
    const struct neph_screen_params params = {
        .settings = shot->settings, .width_px = shot->width_px, .height_px = shot->height_px};
    neph_screening_destroy(sequence->screen);
    sequence->screen = NULL;
    sequence->width_px = shot->width_px;
    sequence->height_px = shot->height_px;
    const enum neph_status status = neph_screening_create(sequence->device->vulkan, shot->scene,
                                                          &params, &sequence->screen, diag);
    return status ? status : warm_up(sequence, shot, diag);
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

/* `image`: NULL is fine. */
static enum neph_status make(struct sequence *sequence, const struct neph_shot *shot,
                             struct neph_image **image, struct neph_screen_stats *stats,
                             struct neph_diag *diag)
{
    const bool fits = shot->width_px == sequence->width_px &&
                      shot->height_px == sequence->height_px && sequence->screen;
    const enum neph_status status = fits ? NEPH_OK : set_up(sequence, shot, diag);
    return status ? status
                  : neph_screening_frame(sequence->screen, shot->scene, shot->frame, image, stats,
                                         diag);
}

static enum neph_status next_picture(void *opened, const struct neph_shot *shot,
                                     struct neph_image **frame, struct neph_cost *cost,
                                     struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct neph_screen_stats stats;
    struct neph_image *image = NULL;
    double gpu_s = NAN;
    enum neph_status status = make(sequence, shot, &image, &stats, diag);
    if (!status)
        status = label(image, &stats, &gpu_s, diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *cost = neph_own_cost(start, gpu_s);
    *frame = image;
    return NEPH_OK;
}

/* A picture is waited for before the next one goes: what its passes take is the same, what lies
 * between two pictures more than in flight. */
static enum neph_status send(void *opened, const struct neph_shot *shot, struct neph_diag *diag)
{
    struct sequence *sequence = opened;
    const double start_s = neph_wall_s();
    struct neph_screen_stats stats;
    const enum neph_status status = make(sequence, shot, NULL, &stats, diag);
    if (status)
        return status;
    struct neph_flight_cost *cost = &sequence->costs[sequence->sent++ % NEPH_FLIGHT_PICTURES_MAX];
    *cost = (struct neph_flight_cost){.cpu_s = neph_wall_s() - start_s};
    for (int i = 0; neph_screen_passes[i].name; i++) {
        cost->passes[i].name = neph_screen_passes[i].name;
        cost->passes[i].gpu_s = stats.gpu_s[i];
        cost->passes[i].traffic_bytes = NAN;
        cost->gpu_s += stats.gpu_s[i];
        cost->pass_count = i + 1;
    }
    return NEPH_OK;
}

static enum neph_status home(void *opened, struct neph_flight_cost *cost, struct neph_diag *diag)
{
    (void)diag;
    struct sequence *sequence = opened;
    *cost = sequence->costs[sequence->home++ % NEPH_FLIGHT_PICTURES_MAX];
    return NEPH_OK;
}

static const struct neph_engine_sequence sequence_of = {
    .open = open_sequence,
    .next = next_picture,
    .send = send,
    .home = home,
    .close = close_sequence,
};

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    return neph_own_picture(&sequence_of, shot, frame, cost, diag);
}

const struct neph_engine neph_engine_screen = {
    .name = "screen",
    .summary = "solids by direct light, and the rest from depth and normals of the picture alone",
    .rung = NEPH_RUNG_MODEL,
    .look = true,
    .bias = "what is off the screen or behind what it shows is not there; docs/screen.md",
    .is_narrow = true,
    .sequence = &sequence_of,
    .remembers = true,
    .typical_s = 1.0,
    .options = neph_screen_options,
    .presets = neph_screen_presets,
    .version = 1,
    .describe_pass = describe_pass,
    .probe = neph_vulkan_probe,
    .can_render = can_render,
    .render = render,
};

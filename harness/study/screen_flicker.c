/* SPDX-License-Identifier: MIT */
#include "harness/study/screen_flicker.h"

#include "harness/run/flight.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdlib.h>

void neph_screen_frames(const struct neph_scene *scene, int asked,
                        struct neph_screen_truths *truths)
{
    /* A solid that is turned once, and stays so, has a motion, too. */
    const bool moves = scene->frame_count > 1 &&
                       (neph_scene_moves(scene) || scene->camera_key_count > 1);
    truths->count = moves && asked > scene->frame_count ? scene->frame_count : asked;
    truths->frame_count = moves ? truths->count : 1;
}

void neph_screen_truths_finish(struct neph_screen_truths *truths)
{
    for (int i = 0; i < truths->frame_count && truths->frames; i++)
        neph_image_destroy(truths->frames[i]);
    free(truths->frames);
    truths->frames = NULL;
}

/* `*ms`: the median that the device takes for one. */
static enum neph_status render(const struct neph_job *first, struct neph_image **frames, int count,
                               double *ms, struct neph_diag *diag)
{
    double *seconds = calloc((size_t)count, sizeof(*seconds));
    struct neph_job job = *first;
    enum neph_status status = seconds ? neph_job_open(&job, diag) : neph_fail_memory(diag);
    for (int i = 0; i < count && !status; i++) {
        struct neph_cost cost;
        job.shot.frame = i;
        status = neph_job_render(&job, &frames[i], &cost, diag);
        seconds[i] = cost.render_s;
    }
    if (!status)
        *ms = 1e3 * neph_spread_of(seconds, count).median;
    neph_job_close(&job);
    free(seconds);
    return status;
}

static enum neph_status measure(struct neph_vulkan *vulkan, const struct neph_job *job,
                                const struct neph_screen_truths *truths,
                                struct neph_image *const *frames, struct neph_post_numbers *numbers,
                                struct neph_diag *diag)
{
    const struct neph_post_film film = {
        .tests = (const struct neph_image *const *)frames,
        .references = (const struct neph_image *const *)truths->frames,
        .count = truths->count,
        .reference_count = truths->frame_count,
        .frame_rate_hz = job->shot.scene->frame_rate_hz,
    };
    struct neph_settings settings = neph_options_default(neph_post_options);
    settings.values[POST_TONE] = 1.0;
    const enum neph_status status = neph_post_meter(vulkan, truths->frames[0],
                                                    &settings.values[POST_EXPOSURE_EV], diag);
    return status ? status : neph_post_measure(vulkan, &film, &settings, numbers, diag);
}

enum neph_status neph_screen_flicker(struct neph_vulkan *vulkan, const struct neph_job *job,
                                     const struct neph_screen_truths *truths,
                                     struct neph_post_numbers *numbers, struct neph_diag *diag)
{
    struct neph_image **frames = calloc((size_t)truths->count, sizeof(*frames));
    double ms = NAN;
    enum neph_status status = frames ? render(job, frames, truths->count, &ms, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = measure(vulkan, job, truths, frames, numbers, diag);
    if (!status)
        numbers->ms = ms;
    for (int i = 0; i < truths->count && frames; i++)
        neph_image_destroy(frames[i]);
    free(frames);
    return status;
}

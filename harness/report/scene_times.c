/* SPDX-License-Identifier: MIT */
#include "harness/report/scene_times.h"

#include "harness/engines/engines.h"

/* Time limits of a frame. A default run has minutes for all scenes, so a frame that takes longer to
 * render again is not timed. */
static const double flight_s = 1.5, renders_s = 6.0;

/* True when the frame's render exceeded the limit. Engines with a history are exempt: their later
 * frames are faster than the first one. */
static bool takes_too_long(const struct neph_frame_result *frame)
{
    return neph_flight_applies(frame->engine) && !frame->engine->has_frame_history &&
           frame->cost.render_s > renders_s;
}

/* Collect render times that the run has measured already. The first frame of a built-in engine
 * includes kernel compilation, so only its second seed counts; an external renderer reports the
 * time of its radiance pass only. */
static int known_times(const struct neph_frame_result *frame, double known_s[2])
{
    int count = 0;
    if (frame->engine->rung == NEPH_LEVEL_EXTERNAL)
        known_s[count++] = frame->cost.render_s;
    if (frame->second_path)
        known_s[count++] = frame->second_cost.render_s;
    return count;
}

enum neph_status neph_scene_times(const struct neph_scene_run *run, const struct neph_scene *scene,
                                  struct neph_scene_result *result, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int f = 0; f < result->frame_count && !status; f++) {
        struct neph_frame_result *frame = &result->frames[f];
        struct neph_job job = frame->job;
        double known_s[2];
        if (!frame->path || takes_too_long(frame))
            continue;
        job.shot.scene = scene;
        job.shot.time_limit_s = run->params->budget_s;
        status = neph_speed_measure(&job, known_s, known_times(frame, known_s),
                                    neph_flight_applies(job.engine) ? flight_s : renders_s,
                                    run->store, run->params->times, &frame->speed, diag);
    }
    return status;
}

/* SPDX-License-Identifier: MIT
 *
 * Frames in flight: submits and collects the frames of a sequence and times them.
 */
#include "harness/run/flight.h"

#include "base/clock.h"
#include "metrics/statistics.h"
#include "scenes/motion.h"

#include <limits.h>
#include <math.h>

static const double warm_up_s = 1.0;

enum { HISTORY_FRAMES = 16 }; /* four cycles of the four-frame pipeline */

bool neph_flight_applies(const struct neph_engine *engine)
{
    return engine->sequence && engine->sequence->submit;
}

int neph_flight_frame(long picture, int count)
{
    if (count < 2)
        return 0;
    const long turn = picture % (2L * (count - 1));
    return (int)(turn < count ? turn : 2L * (count - 1) - turn);
}

static enum neph_status submit(struct neph_job *job, long picture, struct neph_diag *diag)
{
    struct neph_shot shot = job->shot;
    struct neph_scene *still = NULL;
    enum neph_status status = NEPH_OK;
    shot.frame = neph_flight_frame(picture, shot.scene->frame_count);
    if (!job->engine->has_frame_history && neph_scene_moves(shot.scene))
        status = neph_scene_at(shot.scene, shot.frame, &still, diag);
    if (still)
        shot.scene = still;
    if (!status)
        status = job->engine->sequence->submit(job->sequence, &shot, diag);
    neph_scene_destroy(still);
    return status;
}

enum neph_status neph_flight_run(struct neph_job *job, long *picture, int least, int most,
                                 double seconds, struct neph_flight_results *flown,
                                 struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    double before_s = start_s;
    int sent = 0, collect = 0;
    enum neph_status status = NEPH_OK;
    while (!status && (collect < sent || sent < most)) {
        const bool goes_on = sent < most && (sent < least || neph_wall_s() - start_s < seconds);
        if (goes_on && sent - collect < NEPH_FLIGHT_FRAMES_MAX) {
            status = submit(job, (*picture)++, diag);
            sent++;
            continue;
        }
        if (collect == sent)
            break;
        struct neph_flight_cost cost;
        status = job->engine->sequence->collect(job->sequence, &cost, diag);
        const double now_s = neph_wall_s();
        if (flown && !status) {
            flown->costs[flown->count] = cost;
            flown->frame_s[flown->count++] = now_s - before_s;
        }
        before_s = now_s;
        collect++;
    }
    if (flown)
        flown->all_s += before_s - start_s;
    return status;
}

enum neph_status neph_flight_open(struct neph_job *job, double *first_s, struct neph_diag *diag)
{
    struct neph_shared_device *const shared = job->shot.device;
    const double start_s = neph_wall_s();
    struct neph_image *image = NULL;
    struct neph_cost cost;
    job->shot.device = NULL;
    enum neph_status status = neph_job_open(job, diag);
    if (!status)
        status = neph_job_render(job, &image, &cost, diag);
    *first_s = neph_wall_s() - start_s;
    job->shot.device = shared;
    neph_image_destroy(image);
    return status;
}

enum neph_status neph_flight_warm_up(struct neph_job *job, long *picture, struct neph_diag *diag)
{
    const int least = job->engine->has_frame_history ? HISTORY_FRAMES : 1;
    return neph_flight_run(job, picture, least, INT_MAX, warm_up_s, NULL, diag);
}

struct neph_spread neph_flight_time(struct neph_flight_results *flown)
{
    const bool has_clock = flown->count > 0 && isfinite(flown->costs[0].gpu_s);
    for (int i = 0; has_clock && i < flown->count; i++)
        flown->frame_s[i] = flown->costs[i].gpu_s;
    return neph_spread_compute(flown->frame_s, flown->count);
}

struct neph_spread neph_spread_compute(double *values, int count)
{
    const size_t size = (size_t)count;
    if (!isfinite(values[0]))
        return (struct neph_spread){NAN, NAN, NAN};
    return (struct neph_spread){
        .median = neph_percentile(values, size, 0.5),
        .low = neph_percentile(values, size, 0.1),
        .high = neph_percentile(values, size, 0.9),
    };
}

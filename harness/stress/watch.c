/* SPDX-License-Identifier: MIT
 *
 * Counts the bad values of a sequence on the device.
 */
#include "harness/stress/watch.h"

#include "base/interrupt.h"
#include "scenes/injection.h"

static enum neph_status count_in_frame(struct neph_job *job, const struct neph_shot *shot,
                                       uint64_t *bad, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    struct neph_cost cost;
    const enum neph_status status = job->engine->sequence->next(job->sequence, shot, &image, &cost,
                                                                diag);
    if (!status)
        *bad = neph_job_count_bad(image);
    neph_image_destroy(image);
    return status;
}

/* Counts the values of one frame. In sequences with a mirrored view (inject.mirror) or changing
 * frame sizes (inject.sizes) frames cannot be in flight: they are collected and dropped. Without
 * images on the device the frame is rendered again and counted on the CPU. */
static enum neph_status count_on_device(struct neph_job *job, const struct neph_shot *shot,
                                        bool *has_images, uint64_t *bad, struct neph_diag *diag)
{
    const struct neph_injections *injections = neph_scene_injections(shot->scene);
    const struct neph_engine_sequence *sequence = job->engine->sequence;
    const bool flies = injections->mirror.count == 0 && injections->size_count == 0;
    enum neph_status status = flies ? sequence->submit(job->sequence, shot, diag)
                                    : count_in_frame(job, shot, bad, diag);
    if (status)
        return status;
    status = sequence->watch(job->sequence, bad, diag);
    *has_images = status != NEPH_ERR_UNSUPPORTED;
    return *has_images ? status : count_in_frame(job, shot, bad, diag);
}

/* Removes the engine's own warm-up, which collects its frames, and returns its length. */
static int extract_warm_up(struct neph_job *job)
{
    const int setting = neph_option_find(job->engine->options, "warm_up");
    if (setting < 0)
        return 0;
    const int count = (int)job->shot.settings.values[setting];
    job->shot.settings.values[setting] = 0.0;
    return count;
}

enum neph_status neph_count_bad_values(struct neph_job *job, int frame_count, uint64_t *bad,
                                       struct neph_diag *diag)
{
    const struct neph_engine_sequence *sequence = job->engine->sequence;
    if (!sequence || !sequence->watch)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s does not count bad values on the device",
                         job->engine->name);
    const int warm_up = extract_warm_up(job);
    bool has_images = true;
    uint64_t found = 0;
    enum neph_status status = neph_job_open(job, diag);
    for (int frame = -warm_up; frame < frame_count && !status; frame++) {
        struct neph_shot shot = job->shot;
        uint64_t of_frame = 0;
        shot.frame = frame;
        status = has_images ? count_on_device(job, &shot, &has_images, &of_frame, diag)
                            : count_in_frame(job, &shot, &of_frame, diag);
        if (!status && neph_interrupted())
            status = neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted at frame %d", frame);
        found += of_frame;
    }
    neph_job_close(job);
    if (!status)
        *bad = found;
    return status;
}

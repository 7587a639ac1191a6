/* SPDX-License-Identifier: MIT
 *
 * Frames with noise and the means over their pixels.
 */
#include "harness/run/noisy_frame.h"

#include "metrics/statistics.h"

enum neph_status neph_noisy_render(const struct neph_job *of, int samples, uint64_t seed,
                                   struct neph_noisy_frame *frame, struct neph_diag *diag)
{
    struct neph_job job = *of;
    struct neph_cost cost;
    float *planes[3];
    *frame = (struct neph_noisy_frame){.image = NULL};
    job.shot.settings.values[neph_engine_samples(job.engine)] = samples;
    job.shot.seed = seed;
    const enum neph_status status = neph_job_render(&job, &frame->image, &cost, diag);
    if (status)
        return status;
    frame->render_s = cost.render_s;
    if (!neph_image_rgb(frame->image, NULL, planes))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "%s gave no radiance", job.engine->name);
    for (int c = 0; c < 3; c++)
        frame->planes[c] = planes[c];
    return NEPH_OK;
}

void neph_noisy_finish(struct neph_noisy_frame *frame)
{
    neph_image_destroy(frame->image);
    frame->image = NULL;
}

static double read_pixel(const struct neph_noisy_frame *frame, int channel, size_t pixel)
{
    return frame ? (double)frame->planes[channel][pixel] : 0.0;
}

double neph_noisy_cross(const struct neph_noisy_frame *a, const struct neph_noisy_frame *r,
                        const struct neph_noisy_frame *b, const struct neph_noisy_frame *s)
{
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(a->image);
    for (int k = 0; k < 3; k++)
        for (size_t p = 0; p < count; p++)
            neph_sum_add(&sum, (read_pixel(a, k, p) - read_pixel(r, k, p)) *
                                   (read_pixel(b, k, p) - read_pixel(s, k, p)));
    return neph_sum_value(&sum) / (3.0 * (double)count);
}

double neph_noisy_compute_noise2(const struct neph_noisy_frame frames[NEPH_NOISE_SEEDS])
{
    return 0.5 * neph_noisy_cross(&frames[0], &frames[1], &frames[0], &frames[1]);
}

double neph_noisy_compute_mean(const struct neph_noisy_frame *frame)
{
    struct neph_sum sum = {0.0, 0.0};
    const size_t count = neph_image_pixel_count(frame->image);
    for (int k = 0; k < 3; k++)
        for (size_t p = 0; p < count; p++)
            neph_sum_add(&sum, (double)frame->planes[k][p]);
    return neph_sum_value(&sum) / (3.0 * (double)count);
}

/* SPDX-License-Identifier: MIT */
#include "renderer/march_average.h"

#include <stdlib.h>
#include <string.h>

/* The bits of `index` reversed behind the binary point (van der Corput). */
static double radical_inverse(unsigned index)
{
    double value = 0.0;
    for (double digit = 0.5; index > 0; index >>= 1, digit *= 0.5)
        value += digit * (index & 1);
    return value;
}

void neph_march_point(int ray, int rays_per_px, float jitter_px[2])
{
    const double half_step = 0.5 / rays_per_px;
    jitter_px[0] = (float)((double)ray / rays_per_px + half_step - 0.5);
    jitter_px[1] = (float)(radical_inverse((unsigned)ray) + half_step - 0.5);
}

static bool is_averaged(const struct neph_channel *channel)
{
    return strcmp(channel->name, "Z") != 0 && strcmp(channel->name, "volume.distance") != 0;
}

static void add_stats(struct neph_march_stats *sum, const struct neph_march_stats *stats)
{
    sum->gpu_s += stats->gpu_s;
    sum->wall_s += stats->wall_s;
    sum->density_evaluations += stats->density_evaluations;
    sum->closed_forms += stats->closed_forms;
    sum->rays += stats->rays;
    sum->view_steps += stats->view_steps;
    sum->dispatches += stats->dispatches;
}

/* Add the samples of all channels, one channel after the other. */
static void add_image(const struct neph_image *image, double *sums)
{
    const size_t count = neph_image_pixel_count(image);
    for (int c = 0; c < image->channel_count; c++)
        for (size_t p = 0; p < count; p++)
            sums[(size_t)c * count + p] += image->channels[c].samples[p];
}

static void take_means(const double *sums, int rays_per_px, struct neph_image *image)
{
    const size_t count = neph_image_pixel_count(image);
    for (int c = 0; c < image->channel_count; c++)
        for (size_t p = 0; p < count && is_averaged(&image->channels[c]); p++)
            image->channels[c].samples[p] = (float)(sums[(size_t)c * count + p] / rays_per_px);
}

/* Render one frame with an offset and add it to the sums. */
static enum neph_status add_ray(struct neph_march *march, const struct neph_scene *scene,
                                double frame, const struct neph_march_moment *moment, double *sums,
                                struct neph_march_stats *total, struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    struct neph_march_stats stats;
    const enum neph_status status = neph_march_frame(march, scene, frame, moment, &image, &stats,
                                                     diag);
    if (status)
        return status;
    add_image(image, sums);
    add_stats(total, &stats);
    neph_image_destroy(image);
    return NEPH_OK;
}

enum neph_status neph_march_average(struct neph_march *march, const struct neph_scene *scene,
                                    double frame, int rays_per_px, struct neph_image **image,
                                    struct neph_march_stats *stats, struct neph_diag *diag)
{
    struct neph_march_stats total;
    struct neph_image *made = NULL;
    double *sums = NULL;
    if (rays_per_px < 1 || rays_per_px > NEPH_MARCH_RAYS_PER_PX_MAX ||
        (rays_per_px & (rays_per_px - 1)) != 0)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "march: rays_per_px is %d; allowed are powers of two in 1..%d",
                         rays_per_px, NEPH_MARCH_RAYS_PER_PX_MAX);
    enum neph_status status = neph_march_frame(march, scene, frame, NULL, &made, &total, diag);
    if (!status && rays_per_px > 1 &&
        !(sums = calloc(neph_image_pixel_count(made) * (size_t)made->channel_count, sizeof(*sums))))
        status = neph_fail_memory(diag);
    for (int ray = 0; ray < rays_per_px && rays_per_px > 1 && !status; ray++) {
        struct neph_march_moment moment = {.continues = false};
        neph_march_point(ray, rays_per_px, moment.jitter_px);
        status = add_ray(march, scene, frame, &moment, sums, &total, diag);
    }
    if (!status && rays_per_px > 1)
        take_means(sums, rays_per_px, made);
    free(sums);
    if (status) {
        neph_image_destroy(made);
        return status;
    }
    *image = made;
    if (stats)
        *stats = total;
    return NEPH_OK;
}

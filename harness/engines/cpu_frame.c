/* SPDX-License-Identifier: MIT */
#include "harness/engines/cpu_frame.h"

#include "base/threads.h"

#include <math.h>
#include <stdlib.h>

struct job {
    const struct neph_shot *shot;
    struct neph_camera camera;
    neph_compute_ray_light *see_ray;
    const void *context;
    float *radiance[3], *volume[3], *transmittance[3], *depth;
    double *row_error; /* largest quadrature error of each row */
};

static void store_rgb(float *layer[3], size_t pixel, struct neph_rgb value)
{
    if (!layer[0])
        return;
    layer[0][pixel] = (float)value.r;
    layer[1][pixel] = (float)value.g;
    layer[2][pixel] = (float)value.b;
}

static void render_row(int row, void *context)
{
    struct job *job = context;
    const struct neph_shot *shot = job->shot;
    for (int column = 0; column < shot->width_px; column++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&job->camera, shot->width_px,
                                                          shot->height_px, column, row);
        const struct neph_ray_light light = job->see_ray(job->context, ray.origin_m, ray.direction);
        const size_t pixel = (size_t)row * (size_t)shot->width_px + (size_t)column;
        store_rgb(job->radiance, pixel, light.radiance);
        store_rgb(job->volume, pixel, light.volume);
        store_rgb(job->transmittance, pixel, light.transmittance);
        if (job->depth)
            job->depth[pixel] = (float)(light.hit_m *
                                        neph_vec3_dot(ray.direction, job->camera.forward));
        job->row_error[row] = fmax(job->row_error[row], light.quadrature_error);
    }
}

static enum neph_status add_layers(struct neph_image *frame, struct job *job,
                                   struct neph_diag *diag)
{
    const unsigned layers = job->shot->layers;
    enum neph_status status = NEPH_OK;
    if (layers & NEPH_LAYER_RADIANCE) {
        status = neph_image_add_rgb(frame, NULL, job->radiance, diag);
        if (!status)
            status = neph_image_add_rgb(frame, "volume", job->volume, diag);
    }
    if (!status && (layers & NEPH_LAYER_TRANSMITTANCE))
        status = neph_image_add_rgb(frame, "transmittance", job->transmittance, diag);
    if (!status && (layers & NEPH_LAYER_DEPTH))
        status = neph_image_add_channel(frame, "Z", &job->depth, diag);
    return status;
}

enum neph_status neph_cpu_frame(const struct neph_shot *shot, neph_compute_ray_light *see_ray,
                                const void *context, struct neph_image **frame, double *error,
                                struct neph_diag *diag)
{
    struct job job = {.shot = shot,
                      .camera = neph_scene_camera(shot->scene, shot->frame),
                      .see_ray = see_ray,
                      .context = context};
    struct neph_image *image = NULL;
    enum neph_status status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    if (status)
        return status;
    job.row_error = calloc((size_t)shot->height_px, sizeof(*job.row_error));
    status = job.row_error ? add_layers(image, &job, diag) : neph_fail_memory(diag);
    if (!status)
        status = neph_parallel_rows(shot->height_px, render_row, &job, diag);
    *error = 0.0;
    for (int row = 0; !status && row < shot->height_px; row++)
        *error = fmax(*error, job.row_error[row]);
    free(job.row_error);
    if (status)
        neph_image_destroy(image);
    else
        *frame = image;
    return status;
}

/* SPDX-License-Identifier: MIT
 *
 * Engine `exact`: the top rung. Every pixel is neph_transport_ray() of its centre ray, in double
 * precision; the only error is the rounding to the 32-bit floats of the frame and the estimated
 * error of the quadrature, whose largest value is kept as an attribute.
 */
#include "harness/engines/engines.h"

#include "base/threads.h"
#include "harness/engines/own_cost.h"
#include "truth/transport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct neph_option no_options[] = {{.name = NULL}};

struct job {
    const struct neph_shot *shot;
    struct neph_camera camera;
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
        const struct neph_ray_light light = neph_transport_ray(shot->scene, ray.origin_m,
                                                               ray.direction);
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

static enum neph_status add_attributes(struct neph_image *frame, const struct job *job,
                                       struct neph_diag *diag)
{
    double error = 0.0;
    for (int row = 0; row < job->shot->height_px; row++)
        error = fmax(error, job->row_error[row]);
    return neph_image_set_attribute(frame, "neph.exact.quadrature_error", diag, "%.3g", error);
}

static enum neph_status render(const struct neph_shot *shot, struct neph_image **frame,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    const struct neph_stopwatch start = neph_stopwatch_start();
    struct job job = {.shot = shot, .camera = neph_scene_camera(shot->scene, shot->frame)};
    struct neph_image *image = NULL;
    enum neph_status status = neph_image_create(shot->width_px, shot->height_px, &image, diag);
    if (status)
        return status;
    job.row_error = calloc((size_t)shot->height_px, sizeof(*job.row_error));
    status = job.row_error ? add_layers(image, &job, diag) : neph_fail_memory(diag);
    if (!status)
        status = neph_parallel_rows(shot->height_px, render_row, &job, diag);
    if (!status)
        status = add_attributes(image, &job, diag);
    free(job.row_error);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    *cost = neph_own_cost(start, NAN);
    *frame = image;
    return NEPH_OK;
}

static void probe(struct neph_shared_device *device, struct neph_engine_info *info)
{
    (void)device;
    *info = (struct neph_engine_info){.available = true};
    snprintf(info->version, sizeof(info->version), "closed forms and quadrature, revision %u",
             (unsigned)neph_engine_exact.version);
    snprintf(info->device, sizeof(info->device), "CPU, double precision");
}

static bool can_render(const struct neph_scene *scene, const struct neph_settings *settings,
                       char *reason, size_t reason_size)
{
    (void)settings;
    return neph_transport_is_exact(scene, reason, reason_size);
}

const struct neph_engine neph_engine_exact = {
    .name = "exact",
    .summary = "closed forms and adaptive quadrature in double precision",
    .rung = NEPH_RUNG_EXACT,
    .typical_s = 5.0,
    .options = no_options,
    .version = 2, /* 2: colour, clouds */
    .probe = probe,
    .can_render = can_render,
    .render = render,
};
